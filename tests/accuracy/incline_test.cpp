// Coulomb's law on inclined planes, against closed forms: who sticks, who slides how far, who rolls how fast, and that
// the direction in the plane does not matter. The plane is level and gravity is tilted, which is the same world.
#include <gtest/gtest.h>

#include <cmath>

#include "support/world_builder.h"
#include "world/world.h"

namespace tumble {
namespace {

using namespace test;

constexpr double kG = 9.81;  // [m/s^2]

/// Gravity of a plane that falls by `slope` [rad] towards `heading` [rad from x].
Vec3 tilted_gravity(double slope, double heading) {
  return kG *
         Vec3(std::sin(slope) * std::cos(heading), std::sin(slope) * std::sin(heading), -std::cos(slope));
}

struct Slide {
  Vec3 moved, velocity;
};

Slide slide(const Shape& shape, double height, double slope, double heading, double friction, double seconds,
            double time_step = 1.0 / 240.0) {
  Options options;
  options.time_step = time_step;
  options.gravity = tilted_gravity(slope, heading);
  const Material material{.friction = friction};
  World world(options);
  world.create_body(ground(material));
  const Vec3 start(0, 0, height);
  const BodyId id = world.create_body(body("block", shape, start, material));
  run(world, static_cast<int>(std::lround(seconds / time_step)));
  return {world.motion(id.index).x - start, world.motion(id.index).v};
}

Vec3 direction(double heading) {
  return {std::cos(heading), std::sin(heading), 0.0};
}

TEST(Incline, ABlockSlidesByHalfGSinMinusMuCosTSquaredInAnyDirection) {
  const double slope = 0.5, friction = 0.3, t = 2.0;
  const double a = kG * (std::sin(slope) - friction * std::cos(slope));
  for (const double heading : {0.0, 0.3, 0.7853981633974483, 1.1, 2.0, 4.5}) {
    const Slide result = slide(Box{Vec3(0.5, 0.5, 0.25)}, 0.25, slope, heading, friction, t);
    EXPECT_LE((result.velocity - a * t * direction(heading)).norm(), 1e-5) << heading;
    EXPECT_LE((result.moved - 0.5 * a * t * t * direction(heading)).norm(), 1e-5) << heading;
  }
}

TEST(Incline, ABlockSticksBelowTheFrictionAngleAndSlidesAboveIt) {
  const double slope = 0.4;
  for (const double excess : {1e-2, 1e-3}) {
    const Slide held = slide(Box{Vec3(0.5, 0.5, 0.25)}, 0.25, slope, 0.3, std::tan(slope) + excess, 5.0);
    EXPECT_LE(held.moved.norm(), 1e-6) << excess;
    const Slide sliding = slide(Box{Vec3(0.5, 0.5, 0.25)}, 0.25, slope, 0.3, std::tan(slope) - excess, 5.0);
    const double exact = 0.5 * kG * std::cos(slope) * excess * 25.0;
    EXPECT_NEAR(sliding.moved.norm(), exact, 1e-3 * exact) << excess;
  }
}

TEST(Incline, ASphereRollsWithFiveSeventhsOfTheSlidingAcceleration) {
  const double slope = 0.3, t = 2.0;
  const double a = 5.0 / 7.0 * kG * std::sin(slope);
  const Slide result = slide(Sphere{0.5}, 0.5, slope, 0.3, 0.5, t);
  EXPECT_LE((result.velocity - a * t * direction(0.3)).norm(), 1e-9);
  EXPECT_LE((result.moved - 0.5 * a * t * t * direction(0.3)).norm(), 1e-9);
}

TEST(Incline, ASlidingBlockStopsAfterVSquaredOverTwoMuG) {
  const double friction = 0.4, v0 = 3.0;
  const Material material{.friction = friction};
  Options options;
  World world(options);
  world.create_body(ground(material));
  BodyDefinition block = body("block", Box{Vec3(0.5, 0.5, 0.25)}, Vec3(0, 0, 0.25), material);
  block.v_WB = Vec3(v0, 0, 0);
  const BodyId id = world.create_body(block);
  run(world, 480);
  EXPECT_NEAR(world.motion(id.index).x.x(), v0 * v0 / (2 * friction * kG), 1e-3);
  EXPECT_TRUE(world.resting(id.index));
}

}  // namespace
}  // namespace tumble
