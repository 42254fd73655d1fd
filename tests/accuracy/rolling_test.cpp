// From sliding to rolling and to rest, in closed form: a ball that starts sliding, one with back-spin, a block that
// stops, a coin that rolls on its rim. Level ground, default options.
#include <gtest/gtest.h>

#include <cmath>

#include "math/rotation.h"
#include "support/gravity.h"
#include "support/world_builder.h"
#include "world/world.h"

namespace tumble {
namespace {

using namespace test;

Motion launch(const Shape& shape, double height, double friction, const Vec3& v, const Vec3& w, double t,
              double step) {
  Options options;
  options.time_step = step;
  const Material material{.friction = friction};
  World world(options);
  world.create_body(ground(material));
  BodyDefinition definition = body("body", shape, Vec3(0, 0, height), material);
  definition.v_WB = v;
  definition.w_WB = w;
  const BodyId id = world.create_body(definition);
  run(world, static_cast<int>(std::lround(t / step)));
  return world.motion(id.index);
}

/// A ball of radius r that starts with v0 and turns forward with w0: it slides for 2 (v0 - r w0)/(7 mu g), and rolls
/// with (5 v0 + 2 r w0)/7 from then on. Its place after t, t after the end of sliding.
double rolled(double v0, double w0, double r, double friction, double t) {
  const double slip = v0 - r * w0, end = 2.0 * std::abs(slip) / (7.0 * friction * kG);
  const double a = slip > 0.0 ? -friction * kG : friction * kG;
  return v0 * end + 0.5 * a * end * end + (v0 + a * end) * (t - end);
}

TEST(Rolling, ASlidingBallRollsOnWithFiveSeventhsOfItsSpeed) {
  const double v0 = 3.0, friction = 0.2, r = 0.3, t = 1.0;
  for (const double step : kStepLengths) {
    for (const double heading : {0.0, 0.9}) {
      const Vec3 along(std::cos(heading), std::sin(heading), 0);
      const Motion ball = launch(Sphere{r}, r, friction, v0 * along, Vec3::Zero(), t, step);
      EXPECT_LE((ball.v - 5.0 / 7.0 * v0 * along).norm(), 1e-11) << step;  // measured 3e-14..1.2e-12
      // Measured 9e-15..3e-13; 4.6e-5 at 60 Hz where the slide ends with the step.
      EXPECT_LE((ball.x - Vec3(0, 0, r) - rolled(v0, 0.0, r, friction, t) * along).norm(), 1e-11) << step;
    }
  }
}

TEST(Rolling, BackSpinBringsABallBack) {
  const double v0 = 2.0, w0 = -30.0, friction = 0.3, r = 0.25, t = 1.5;
  for (const double step : kStepLengths) {
    const Motion ball = launch(Sphere{r}, r, friction, Vec3(v0, 0, 0), Vec3(0, w0, 0), t, step);
    EXPECT_LE((ball.v - Vec3((5.0 * v0 + 2.0 * r * w0) / 7.0, 0, 0)).norm(), 1e-11) << step;  // 2e-15..5e-14
    EXPECT_LE((ball.x - Vec3(rolled(v0, w0, r, friction, t), 0, r)).norm(), 1e-11) << step;   // 5e-16..5e-14
  }
}

TEST(Rolling, WithoutCutStepsTheEndOfASlideIsWrongByTheSquareOfTheStep) {
  double errors[2];
  for (int i = 0; i < 2; ++i) {
    Options options;
    options.time_step = i == 0 ? 1e-2 : 1e-3;
    options.slide_bodies = 0;
    World world(options);
    world.create_body(ground());
    BodyDefinition definition = body("ball", Sphere{0.3}, Vec3(0, 0, 0.3));
    definition.v_WB = Vec3(3, 0, 0);
    const BodyId id = world.create_body(definition);
    run(world, i == 0 ? 100 : 1000);
    errors[i] = std::abs(world.motion(id.index).x.x() - rolled(3.0, 0.0, 0.3, 0.5, 1.0));
    EXPECT_EQ(world.counters().slides_ended, 0u);
  }
  EXPECT_GE(errors[0], 1e-6);  // measured 3e-5 and 1e-7
  EXPECT_LE(errors[1], 0.1 * errors[0]);
}

TEST(Rolling, ASlidingBlockStopsAfterVSquaredOverTwoMuG) {
  const double friction = 0.4, v0 = 3.0;
  for (const double step : kStepLengths) {
    for (const double heading : {0.0, 0.9}) {
      const Vec3 along(std::cos(heading), std::sin(heading), 0);
      const Motion block =
          launch(Box{Vec3(0.5, 0.5, 0.25)}, 0.25, friction, v0 * along, Vec3::Zero(), 2.0, step);
      // Measured 4e-12..1.3e-10; 6e-5 at 60 Hz where the slide ends with the step.
      EXPECT_LE((block.x - Vec3(0, 0, 0.25) - v0 * v0 / (2.0 * friction * kG) * along).norm(), 1e-9) << step;
      EXPECT_EQ(block.v.norm(), 0.0) << step;
    }
  }
}

/// A coin of radius a and thickness t that rolls on its rim at the inclination alpha while its centre stands still: the
/// point of contact is at rest, so w is along the arm, and the torque of the ground turns L with the rate
///   W^2 = m g (a/sin) (a cos - t/2 sin) / (I1 a cos - I3 t/2 sin),   4 g/(a sin) for t = 0.
struct CoinErrors {
  double moved = 0.0, tilted = 0.0, end = 0.0;
};

CoinErrors roll_coin(Options options, double step) {
  const double a = 0.5, thickness = 0.02, alpha = 0.4, t = 1.0;
  const double sine = std::sin(alpha), cosine = std::cos(alpha);
  options.time_step = step;
  const Material rough{.friction = 5.0};
  World world(options);
  world.create_body(ground(rough));
  BodyDefinition coin = body("coin", Cylinder{a, 0.5 * thickness}, Vec3::Zero(), rough);
  const Inertia inertia = compute_inertia(coin.geometries[0].shape, 1000.0);
  const double I1 = inertia.moments(0, 0), I3 = inertia.moments(2, 2), half = 0.5 * thickness;
  const double rate = std::sqrt(inertia.mass * kG * a / sine * (a * cosine - half * sine) /
                                (I1 * a * cosine - I3 * half * sine));
  const Vec3 down(cosine, 0, -sine), axis(sine, 0, cosine);  // the arm is a down - t/2 axis
  const double height = a * sine + half * cosine;
  coin.X_WL.p = Vec3(0, 0, height);
  coin.X_WL.q = exp_map(Vec3(0, alpha, 0));
  coin.w_WB = -rate * sine / a * (a * down - half * axis);
  const BodyId id = world.create_body(coin);
  CoinErrors errors;
  for (int i = 0; i < std::lround(t / step); ++i) {
    world.step();
    const Motion motion = world.motion(id.index);
    errors.moved = std::max(errors.moved, (motion.x - coin.X_WL.p).norm());
    errors.tilted = std::max(errors.tilted, std::abs((motion.q * Vec3::UnitZ()).z() - cosine));
  }
  const Vec3 exact(sine * std::cos(rate * t), sine * std::sin(rate * t), cosine);
  errors.end = (world.motion(id.index).q * Vec3::UnitZ() - exact).norm();
  return errors;
}

TEST(Rolling, ACoinRollsSteadilyOnItsRim) {
  for (const double step : kStepLengths) {
    const CoinErrors errors = roll_coin({}, step);
    // Second order, and a turn of 0.05 rad at most: measured 2.6e-4, 6.3e-5, 3.6e-6 m
    EXPECT_LE(errors.moved, 5.0 * step * step) << step;
    EXPECT_LE(errors.tilted, 2.5 * step * step) << step;  // 1.3e-4, 3.1e-5, 1.7e-6
    EXPECT_LE(errors.end, 25.0 * step * step) << step;    // 1.0e-3, 2.8e-4, 1.7e-5 after 1.1 rounds
  }
}

TEST(Rolling, ACoinWithShorterTurnsKeepsAMillionthOfAMetre) {
  Options exact;
  set_accuracy(exact, Accuracy::exact);
  EXPECT_LE(roll_coin(exact, 1e-3).moved, 1e-6);
}

TEST(Rolling, ByTheForcesOfTheStartOfAStepACoinIsWrongByTheStep) {
  Options options;
  options.midpoint_bodies = 0;
  EXPECT_GE(roll_coin(options, 1e-3).moved, 5e-3);  // measured 7.3e-3
}

}  // namespace
}  // namespace tumble
