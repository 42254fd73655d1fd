// Heaps: many bodies dropped on each other come to rest, none is lost, none creeps.
#include <cmath>

#include "scene/sdf.h"
#include "stability/case.h"
#include "support/heap_scenes.h"
#include "support/impact_scenes.h"

namespace tumble::stability {
namespace {

using namespace test;

/// Boxes at random turns, in layers of n x n over the ground.
World dropped_boxes(const Options& options, int n, int layers) {
  World world(options);
  world.create_body(ground());
  Dice dice(21);
  for (int i = 0; i < n * n * layers; ++i) {
    const Vec3 place(1.8 * (i % n), 1.8 * (i / n % n), 1.5 + 1.8 * (i / (n * n)));
    BodyDefinition box = body_of_mass("box" + std::to_string(i), Box{Vec3(0.5, 0.5, 0.5)}, 1.0, place);
    box.X_WL.q = exp_map(3.0 * (2.0 * dice.vector() - Vec3::Ones()));
    world.create_body(box);
  }
  return world;
}

void expect_heap(Trial& trial, double seconds) {
  trial.run(seconds);
  trial.expect("penetration at rest [m]", trial.deepest_now(), 1e-3);
  trial.expect("bodies awake", trial.world().report().bodies_awake, 0.0);
  trial.expect("energy gain", trial.energy_gain(), 1e-2);
  double lowest = 0.0;
  for (std::uint32_t slot = 0; slot < trial.world().body_capacity(); ++slot) {
    lowest = std::min(lowest, trial.world().motion(slot).x.z());
  }
  trial.expect("below the ground [m]", -lowest, 0.0);
  trial.begin(World(trial.world()));
  trial.run(trial.lasting(2.0, 600.0));
  trial.expect("creep [m]", trial.drift(), 0.0);
}

void heap_of_boxes(Trial& trial) {
  trial.begin(dropped_boxes(trial.options(), trial.extent(3, 10), trial.extent(5, 10)));
  expect_heap(trial, trial.extent(8.0, 20.0));
}

/// The pile of tests/scenes, of 1000 mixed shapes, with this way's options.
void heap_of_all(Trial& trial) {
  Scene scene = read_sdf(std::string(TUMBLE_SCENES_DIR) + "/pile.sdf").scene;
  const Options own = scene.options;
  scene.options = trial.options();
  scene.options.gravity = own.gravity;
  trial.begin(build_world(scene));
  expect_heap(trial, trial.extent(3.0, 20.0));
}

/// 30 bodies, or 1000, in a bin.
void heap_in_bin(Trial& trial, bool mixed) {
  trial.begin(heap(trial.options(), trial.extent(30, 1000), trial.extent(3, 8), mixed));
  expect_heap(trial, trial.extent(8.0, 30.0));
}

void nothing_lost(Trial& trial) {
  Scene scene = read_sdf(std::string(TUMBLE_SCENES_DIR) + "/pile.sdf").scene;
  const Options own = scene.options;
  scene.options = trial.options();
  scene.options.gravity = own.gravity;
  trial.begin(build_world(scene));
  trial.run(trial.extent(1.0, 20.0));
  double lowest = 0.0;
  for (std::uint32_t slot = 0; slot < trial.world().body_capacity(); ++slot) {
    lowest = std::min(lowest, trial.world().motion(slot).x.z());
  }
  trial.expect("below the ground [m]", -lowest, 0.5);
}

}  // namespace

std::vector<Case> heap_cases() {
  const auto in_bin = [](bool mixed) { return [mixed](Trial& trial) { heap_in_bin(trial, mixed); }; };
  return {
      {"heap_boxes", "A heap of dropped boxes: at rest, penetration <= 1 mm, no creep in 10 min",
       by_default(), heap_of_boxes, false, true},
      {"heap_mixed",
       "The pile of 1000 mixed shapes: at rest, penetration <= 1 mm, no creep in 10 min",
       {},
       heap_of_all,
       false,
       true},
      {"bin_boxes", "Boxes dropped into a bin: at rest, penetration <= 1 mm, no creep", precise(),
       in_bin(false), false, true},
      {"bin_mixed", "Mixed shapes dropped into a bin: at rest, penetration <= 1 mm, no creep", precise(),
       in_bin(true), false, true},
      {"heap_kept", "The pile of 1000 mixed shapes loses nobody through the ground", sturdy(1.0 / 240.0),
       nothing_lost, false, true},
  };
}

}  // namespace tumble::stability
