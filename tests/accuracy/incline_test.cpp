// Coulomb's law on inclined planes, against closed forms: who sticks, who slides how far, who rolls how fast, and that
// the direction in the plane does not matter. The plane is level and gravity is tilted, which is the same world.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "math/rotation.h"
#include "support/gravity.h"
#include "support/world_builder.h"
#include "world/world.h"

namespace tumble {
namespace {

using namespace test;

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

constexpr double kHeadings[] = {0.0, 0.3, 0.7853981633974483, 1.1, 2.0, 4.5};
constexpr double kBlockSpeed = 1e-11, kBlockWay = 1e-10;  // [m/s], [m]
const Box kBlock{Vec3(0.5, 0.5, 0.25)};

TEST(Incline, ABlockSlidesByHalfGSinMinusMuCosTSquaredInAnyDirection) {
  const double slope = 0.5, friction = 0.3, t = 2.0;
  const double a = kG * (std::sin(slope) - friction * std::cos(slope));
  for (const double step : kStepLengths) {
    for (const double heading : kHeadings) {
      const Slide block = slide(kBlock, 0.25, slope, heading, friction, t, step);
      EXPECT_LE((block.velocity - a * t * direction(heading)).norm(), kBlockSpeed) << heading << ", " << step;
      EXPECT_LE((block.moved - 0.5 * a * t * t * direction(heading)).norm(), kBlockWay)
          << heading << ", " << step;
    }
  }
}

TEST(Incline, ABlockThatSticksDoesNotMove) {
  for (const double step : kStepLengths) {
    for (const double heading : kHeadings) {
      const Slide block = slide(kBlock, 0.25, 0.5, heading, 0.6, 2.0, step);
      EXPECT_EQ(block.moved.norm(), 0.0) << heading << ", " << step;
      EXPECT_EQ(block.velocity.norm(), 0.0) << heading << ", " << step;
    }
  }
}

TEST(Incline, ABlockSticksBelowTheFrictionAngleAndSlidesAboveIt) {
  const double slope = 0.4, t = 10.0;
  for (const double step : kStepLengths) {
    for (const double excess : {1e-2, 1e-3, 1e-4}) {
      const Slide held = slide(kBlock, 0.25, slope, 0.3, std::tan(slope) + excess, t, step);
      EXPECT_EQ(held.moved.norm(), 0.0) << excess << ", " << step;
      const Slide sliding = slide(kBlock, 0.25, slope, 0.3, std::tan(slope) - excess, t, step);
      const double exact = 0.5 * kG * std::cos(slope) * excess * t * t;
      EXPECT_LE((sliding.moved - exact * direction(0.3)).norm(), kBlockWay) << excess << ", " << step;
    }
  }
}

/// Of the sliding acceleration, what a rolling solid keeps: 1/(1 + I/(m r^2)).
TEST(Incline, BallsAndCylindersRollWithTheirShareOfTheSlidingAcceleration) {
  struct Roller {
    Shape shape;
    double share, heading;
  };
  const double slope = 0.3, t = 2.0;
  std::vector<Roller> rollers;
  for (const double heading : kHeadings) rollers.push_back({Sphere{0.5}, 5.0 / 7.0, heading});
  rollers.push_back({Cylinder{0.5, 0.25}, 2.0 / 3.0, 0.0});
  for (const double step : kStepLengths) {
    for (const Roller& roller : rollers) {
      Options options;
      options.time_step = step;
      options.gravity = tilted_gravity(slope, roller.heading);
      World world(options);
      world.create_body(ground());
      const Vec3 start(0, 0, 0.5);
      BodyDefinition definition = body("roller", roller.shape, start);
      if (std::holds_alternative<Cylinder>(roller.shape)) {
        definition.X_WL.q = exp_map(Vec3(1.5707963267948966, 0, 0));  // its axis along y
      }
      const BodyId id = world.create_body(definition);
      run(world, static_cast<int>(std::lround(t / step)));
      const Motion motion = world.motion(id.index);
      const double a = roller.share * kG * std::sin(slope);
      const bool ball = std::holds_alternative<Sphere>(roller.shape);
      EXPECT_LE((motion.v - a * t * direction(roller.heading)).norm(), ball ? 1e-11 : kBlockSpeed)
          << roller.share << ", " << step;  // balls: 1e-15..2e-13
      EXPECT_LE((motion.x - start - 0.5 * a * t * t * direction(roller.heading)).norm(),
                ball ? 1e-9 : kBlockWay)
          << roller.share << ", " << step;
    }
  }
}

TEST(Incline, ABallOnASteepSlopeRollsAndSlides) {
  const double slope = 1.0, friction = 0.3, t = 2.0;  // tan(slope) > 3.5 mu
  const double a = kG * (std::sin(slope) - friction * std::cos(slope));
  for (const double step : kStepLengths) {
    for (const double heading : kHeadings) {
      const Slide ball = slide(Sphere{0.5}, 0.5, slope, heading, friction, t, step);
      EXPECT_LE((ball.velocity - a * t * direction(heading)).norm(), 1e-11) << heading << ", " << step;
      EXPECT_LE((ball.moved - 0.5 * a * t * t * direction(heading)).norm(), 1e-9) << heading << ", " << step;
    }
  }
}

}  // namespace
}  // namespace tumble
