// Changes under way: bodies come and go in contact, floods of forces, inputs that are no numbers, overflow.
#include <cmath>
#include <limits>
#include <stdexcept>

#include "stability/case.h"
#include "support/impact_scenes.h"
#include "support/standing_scenes.h"

namespace tumble::stability {
namespace {

using namespace test;

/// The lowest cube of a column at rest is taken away: from that step on the others fall freely.
void support_removed(Trial& trial) {
  trial.begin(cube_stack(trial.options(), std::vector<double>(5, 1.0)));
  trial.run(1.0);
  World& world = trial.world();
  const double top = world.motion(5).x.z();
  world.destroy_body(world.id(1));
  const double start = world.time();
  trial.run(0.3);
  const double t = world.time() - start;
  trial.expect("fall of the top [m]", std::abs(top - world.motion(5).x.z() - 0.5 * 9.81 * t * t), 1e-6);
}

/// Every few steps a box of a heap is removed and another put in at its place, half in its neighbours.
void coming_and_going(Trial& trial) {
  World world(trial.options());
  world.create_body(ground());
  Dice dice(9);
  for (int i = 0; i < 30; ++i) {
    const Vec3 place = Vec3(2, 2, 3).cwiseProduct(dice.vector()) + Vec3(0, 0, 0.3);
    world.create_body(body("box" + std::to_string(i), Box{Vec3(0.25, 0.25, 0.25)}, place));
  }
  trial.begin(std::move(world));
  int count = 0;
  trial.run(trial.lasting(3.0, 20.0), [&](World& now) {
    if (++count % 10 != 0) return;
    const auto slot = 1 + static_cast<std::uint32_t>(30 * dice());
    const Vec3 place = now.motion(slot).x + 0.1 * dice.vector();
    now.destroy_body(now.id(slot));
    now.create_body(body("new" + std::to_string(count), Box{Vec3(0.25, 0.25, 0.25)}, place));
  });
  trial.expect("bodies", std::abs(static_cast<double>(trial.world().body_count()) - 31.0), 0.0);
  trial.expect("speed [m/s]", trial.fastest(), 20.0);
  trial.run(10.0);
  trial.expect("penetration at the end [m]", trial.deepest_now(), 1e-2);
}

/// Pushes on every body at every step, of another size and direction: momentum is their sum.
void force_flood(Trial& trial) {
  Options options = trial.options();
  options.gravity.setZero();
  World world(options);
  Dice dice(13);
  for (int i = 0; i < 50; ++i) {
    world.create_body(body_of_mass("box" + std::to_string(i), Box{Vec3(0.3, 0.3, 0.3)}, 1.0,
                                   Vec3(i % 5, i / 5 % 5, i / 25)));
  }
  trial.begin(std::move(world));
  Vec3 given = Vec3::Zero();
  double sum = 0.0;
  trial.run(trial.lasting(1.0, 5.0), [&](World& now) {
    for (std::uint32_t slot = 0; slot < 50; ++slot) {
      for (int k = 0; k < 4; ++k) {
        const Vec3 force = 2e3 * (dice.vector() - Vec3::Constant(0.5));
        const Vec3 point = 0.3 * dice.vector();
        now.push({.body = now.id(slot), .force = force, .point_B = point});
        given += now.options().time_step * force;
        sum += now.options().time_step * force.norm();
      }
    }
  });
  trial.expect("momentum error / sum of impulses",
               (trial.world().compute_conserved().momentum - given).norm() / sum, 1e-12);
}

/// 400 balls rush to one point, pulled by a force that grows with the distance.
void rush(Trial& trial) {
  Options options = trial.options();
  options.gravity.setZero();
  World world(options);
  Dice dice(17);
  const int balls = trial.extent(16, 400);
  for (int i = 0; i < balls; ++i) {
    const Vec3 place = 20.0 * dice.vector() - Vec3(10, 10, 10);
    world.create_body(body_of_mass("ball" + std::to_string(i), Sphere{0.5}, 1.0, place));
  }
  trial.begin(std::move(world));
  // A cluster that leans on friction gives way once more after seconds, at a time that every way has of its own.
  trial.run(trial.lasting(10.0, 20.0), [&](World& now) {
    for (std::uint32_t slot = 0; slot < now.body_capacity(); ++slot) {
      const Motion motion = now.motion(slot);
      now.push({.body = now.id(slot), .force = -10.0 * motion.x - 2.0 * motion.v});
    }
  });
  trial.expect("speed at the end [m/s]", trial.fastest_now(), 0.5);
}

bool refuses(World& world, const Push& push) {
  try {
    world.push(push);
  } catch (const std::invalid_argument&) {
    return true;
  }
  return false;
}

void no_numbers(Trial& trial) {
  World& world = trial.begin(cube_stack(trial.options(), std::vector<double>(3, 1.0)));
  const BodyId cube = world.id(1);
  trial.run(0.5);
  const std::uint64_t before = world.state_hash();
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), kInfinity, -kInfinity, 1e308}) {
    trial.expect_true("force refused", refuses(world, {.body = cube, .force = Vec3(0, bad, 0)}));
    trial.expect_true("torque refused", refuses(world, {.body = cube, .torque = Vec3(bad, 0, 0)}));
    trial.expect_true("point refused",
                      refuses(world, {.body = cube, .force = Vec3(1, 0, 0), .point_B = Vec3(0, 0, bad)}));
    trial.expect_true("time refused",
                      refuses(world, {.body = cube, .force = Vec3(1, 0, 0), .duration = bad}));
  }
  trial.expect_true("nothing changed", world.state_hash() == before);
}

/// The lightest of all is pushed with as much as a push may have, until its numbers end. The others go on as if nothing
/// were.
void overflow(Trial& trial) {
  trial.allow_containment();
  World world = cube_stack(trial.options(), std::vector<double>(3, 1.0));
  BodyDefinition speck = body("speck", Sphere{0.05}, Vec3(5, 0, 0.05));
  speck.inertia = Inertia{1e-100, Vec3::Zero(), Vec3(1e-103, 1e-103, 1e-103).asDiagonal()};
  const BodyId doomed = world.create_body(speck);
  const BodyId falling = world.create_body(body("stone", Sphere{0.5}, Vec3(20, 0, 100)));
  trial.begin(std::move(world));
  World& now = trial.world();
  trial.run(0.5);
  const Vec3 held = now.motion(doomed.index).x;
  now.push({.body = doomed, .force = Vec3(7e14, 0, -7e14), .torque = Vec3(0, 1e15, 0), .duration = 0.5});
  trial.run(0.5);
  trial.expect_true("contained", now.counters().non_finite_contained > 0);
  trial.expect("way of the held body [m]", (now.motion(doomed.index).x - held).norm(), 1e-3);
  trial.run(1.0);
  for (std::uint32_t slot = 1; slot <= 3; ++slot) {
    trial.expect("column [m]", std::abs(now.motion(slot).x.z() - (slot - 0.5)), 1e-2);
  }
  const double t = now.time();
  trial.expect("fall of the stone [m]",
               std::abs(now.motion(falling.index).x.z() - (100.0 - 0.5 * 9.81 * t * t)), 1e-9);
}

}  // namespace

std::vector<Case> change_cases() {
  return {
      {"support_removed", "What stood on a removed body falls freely from that step on", precise(),
       support_removed},
      {"coming_and_going",
       "Boxes removed from a heap and put in overlapping: slower than 20 m/s, then at rest", sturdy(),
       coming_and_going},
      {"force_flood", "200 pushes a step on 50 boxes: momentum is the sum of impulses", everyone(),
       force_flood},
      {"rush", "Balls pulled to one point press together and come to rest", sturdy(), rush, false, true},
      {"no_numbers", "A push of NaN, infinite or 1e308 is refused, and no bit changes", everyone(),
       no_numbers},
      {"overflow", "A body pushed beyond all numbers is held where it was; all else goes on", everyone(),
       overflow},
  };
}

}  // namespace tumble::stability
