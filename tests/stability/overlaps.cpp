// Bodies that overlap from the start come apart without a kick.
#include <cmath>

#include "stability/case.h"
#include "support/impact_scenes.h"
#include "support/standing_scenes.h"

namespace tumble::stability {
namespace {

using namespace test;

/// Speed above which coming apart is a kick [m/s]. Lifting by half a metre at once would take 3.
constexpr double kKick = 1.0;

/// Box2D's overlap recovery: a wall whose rows stand a quarter of a cube in each other.
void overlapped_wall(Trial& trial) {
  trial.begin(cube_pyramid(trial.options(), 4, {.gap = -0.25}));
  trial.run(trial.lasting(5.0, 20.0));
  trial.expect("speed [m/s]", trial.fastest(), kKick);
  trial.expect("penetration at the end [m]", trial.deepest_now(), 1e-3);
  trial.expect("speed at the end [m/s]", trial.fastest_now(), 1e-3);
}

/// Bodies of one kind, all at one place above the ground.
void same_place(Trial& trial, const Shape& shape) {
  World world(trial.options());
  world.create_body(ground());
  for (int i = 0; i < 4; ++i) world.create_body(body("body" + std::to_string(i), shape, Vec3(0, 0, 0.5)));
  trial.begin(std::move(world));
  trial.run(trial.lasting(10.0, 20.0));
  trial.expect("speed [m/s]", trial.fastest(), 5.0);
  trial.expect("penetration at the end [m]", trial.deepest_now(), 1e-2);
}

/// A ball pressed a tenth of a metre too deep between two walls: nothing that it could do satisfies both.
void too_narrow(Trial& trial) {
  World world(trial.options());
  world.create_body(ground());
  for (const double side : {-1.0, 1.0}) {
    BodyDefinition wall = body("wall" + std::to_string(side), Box{Vec3(0.5, 2, 2)}, Vec3(0.9 * side, 0, 2));
    wall.type = BodyType::fixed;
    world.create_body(wall);
  }
  world.create_body(body("ball", Sphere{0.5}, Vec3(0, 0, 2)));
  trial.begin(std::move(world));
  trial.run(trial.lasting(5.0, 60.0));
  const double fall =
      std::sqrt(2.0 * 9.81 * 1.5);  // nothing presses, nothing rubs: it slides down to the ground
  trial.expect("speed [m/s]", trial.fastest(), fall + 1e-6);
  trial.expect("off the middle [m]", std::abs(trial.world().motion(3).x.x()), 1e-6);
  trial.expect("speed at the end [m/s]", trial.fastest_now(), 1e-6);
}

/// Box2D's "confined": balls fill a closed box without gravity, each a little in its neighbours.
void confined(Trial& trial) {
  Options options = trial.options();
  options.gravity.setZero();
  World world(options);
  const int n = trial.extent(4, 7);
  const double half = 0.5 * n - 0.02;
  for (int k = 0; k < 6; ++k) {
    BodyDefinition wall = ground();
    wall.name = "wall" + std::to_string(k);
    Vec3 normal = Vec3::Zero();
    normal[k / 2] = k % 2 == 0 ? 1.0 : -1.0;
    wall.X_WL = {rotation_to_normal(normal), -half * normal};
    world.create_body(wall);
  }
  for (int i = 0; i < n * n * n; ++i) {
    const Vec3 place = Vec3(i % n, i / n % n, i / (n * n)) - Vec3::Constant(0.5 * (n - 1));
    world.create_body(body("ball" + std::to_string(i), Sphere{0.5}, place));
  }
  trial.begin(std::move(world));
  trial.run(trial.lasting(2.0, 10.0));
  trial.expect("speed at the end [m/s]", trial.fastest_now(), kKick);
  trial.expect("penetration [m]", trial.deepest(), 0.05);
}

}  // namespace

std::vector<Case> overlap_cases() {
  const auto pile_up = [](const Shape& shape) { return [shape](Trial& trial) { same_place(trial, shape); }; };
  return {
      {"overlapped_wall", "A wall whose rows overlap by a quarter comes apart below 1 m/s and lies still",
       precise(), overlapped_wall},
      {"same_place_boxes", "Four boxes at one place come apart, below 5 m/s", sturdy(),
       pile_up(Box{Vec3(0.5, 0.5, 0.5)})},
      {"same_place_balls", "Four balls at one place come apart, below 5 m/s", precise(),
       pile_up(Sphere{0.5})},
      {"same_place_capsules", "Four capsules at one place come apart, below 5 m/s", sturdy(),
       pile_up(Capsule{0.2, 0.3})},
      {"too_narrow", "A ball 10 cm too deep between two walls stays between them, no faster than it falls",
       precise(), too_narrow},
      {"confined", "Balls that fill a closed box, 2 cm too small, stay inside and slow", sturdy(), confined},
  };
}

}  // namespace tumble::stability
