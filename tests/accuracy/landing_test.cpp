// Bodies that land without restitution: at their own time within a step, so that what follows (friction, sliding, rolling,
// falling over) starts at the right time and place whatever the step. Level ground, closed forms, default options.
#include <gtest/gtest.h>

#include <cmath>

#include "math/rotation.h"
#include "support/gravity.h"
#include "support/world_builder.h"
#include "world/world.h"

namespace tumble {
namespace {

using namespace test;

constexpr double kLandingSteps[] = {1.0 / 60.0, 1.0 / 240.0, 1e-3};

/// Of a fall of 1 m.
const double kFall = std::sqrt(2.0 / kG), kLandingSpeed = std::sqrt(2.0 * kG);

struct Landing {
  Motion motion;
  Counters counters;
};

/// Dropped from 1 m above the ground with the sideways velocity v.
Landing drop(const Shape& shape, double height, double friction, const Vec3& v, double t, double step,
             int landing_bodies = Options{}.landing_bodies) {
  Options options;
  options.time_step = step;
  options.landing_bodies = landing_bodies;
  const Material material{.friction = friction};
  World world(options);
  world.create_body(ground(material));
  BodyDefinition definition = body("body", shape, Vec3(0, 0, 1.0 + height), material);
  definition.v_WB = v;
  const BodyId id = world.create_body(definition);
  run(world, static_cast<int>(std::lround(t / step)));
  return {world.motion(id.index), world.counters()};
}

/// The blow of the landing takes mu times as much of the sideways speed as it stops of the fall; then friction does the rest.
double block_way(double v0, double friction) {
  const double v = v0 - friction * kLandingSpeed;
  return v0 * kFall + v * v / (2.0 * friction * kG);
}

TEST(Landing, ABlockThatLandsFlatSlidesOnAndStopsWhereItShould) {
  const double friction = 0.25, v0 = 3.0;
  for (const double step : kLandingSteps) {
    for (const double heading : {0.0, 0.9}) {
      const Vec3 along(std::cos(heading), std::sin(heading), 0);
      const Landing block = drop(Box{Vec3(0.5, 0.4, 0.25)}, 0.25, friction, v0 * along, 2.0, step);
      // Measured 2e-15..2e-14.
      EXPECT_LE((block.motion.x - block_way(v0, friction) * along - Vec3(0, 0, 0.25)).norm(), 1e-12) << step;
      EXPECT_EQ(block.motion.v.norm(), 0.0) << step;
      EXPECT_EQ(block.counters.landings, 1u) << step;
    }
  }
}

TEST(Landing, ABallThatLandsSlidesAndThenRolls) {
  const double friction = 0.2, v0 = 4.0, r = 0.25, t = 1.5;
  const double blow = friction * kLandingSpeed, v1 = v0 - blow, slip = v0 - 3.5 * blow;
  const double sliding = slip / (3.5 * friction * kG), v2 = v1 - friction * kG * sliding;
  const double way =
      v0 * kFall + v1 * sliding - 0.5 * friction * kG * sliding * sliding + v2 * (t - kFall - sliding);
  for (const double step : kLandingSteps) {
    const Landing ball = drop(Sphere{r}, r, friction, Vec3(v0, 0, 0), t, step);
    EXPECT_LE((ball.motion.x - Vec3(way, 0, r)).norm(), 1e-11) << step;      // 9e-15..1.7e-13
    EXPECT_LE(std::abs(ball.motion.v.x() - 5.0 / 7.0 * v0), 1e-11) << step;  // 1e-15..4e-14
  }
}

TEST(Landing, WithoutCutStepsALandingIsWrongByTheStep) {
  const double friction = 0.25, v0 = 3.0;
  const Landing late = drop(Box{Vec3(0.5, 0.4, 0.25)}, 0.25, friction, Vec3(v0, 0, 0), 2.0, 1.0 / 60.0, 0);
  EXPECT_GE(std::abs(late.motion.x.x() - block_way(v0, friction)), 1e-4);
  EXPECT_EQ(late.counters.landings, 0u);
}

/// Where a box is 0.5 s after it was thrown, edge or corner first: it strikes, slides, and falls over.
Motion thrown(const Vec3& tilt, const Vec3& v, const Vec3& w, double step) {
  Options options;
  options.time_step = step;
  const Material material{.friction = 0.5};
  World world(options);
  world.create_body(ground(material));
  BodyDefinition box = body_of_mass("box", Box{Vec3(0.2, 0.15, 0.1)}, 5.0, Vec3(0, 0, 0.5), material);
  box.X_WL.q = exp_map(tilt);
  box.v_WB = v;
  box.w_WB = w;
  const BodyId id = world.create_body(box);
  run(world, static_cast<int>(std::lround(0.5 / step)));
  return world.motion(id.index);
}

double apart(const Motion& a, const Motion& b) {
  return (a.x - b.x).norm() + 0.5 * (a.q * b.q.conjugate()).vec().norm();
}

TEST(Landing, AThrownBoxStrikesAndFallsOverWithErrorsOfTheSquareOfTheStep) {
  const Vec3 tilt(0, 0.5, 0), v(1.5, 0, 0), w(0, 2, 0);
  const Motion truth = thrown(tilt, v, w, 1.0 / 20000.0);
  const double coarse = apart(thrown(tilt, v, w, 1.0 / 500.0), truth);
  const double fine = apart(thrown(tilt, v, w, 1.0 / 2000.0), truth);
  EXPECT_LE(coarse, 1e-5);  // measured 2.5e-6 and 1.6e-7
  EXPECT_LE(fine, coarse / 12.0);
}

}  // namespace
}  // namespace tumble
