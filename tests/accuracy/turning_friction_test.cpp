// Friction against rolling and against turning on the spot, in closed form: how far a ball rolls, how long it spins, on
// what slope it holds; by every solver that knows it.
#include <gtest/gtest.h>

#include <cmath>

#include "support/gravity.h"
#include "support/world_builder.h"
#include "world/contact_forces.h"

namespace tumble {
namespace {

using namespace test;

constexpr double kRadius = 0.3;  // [m]

struct Way {
  Solver solver;
  double motion;  // relative error of a speed or a way
  double creep;   // [m] of what should hold, in 2 s: sweeps leave it to their slop
};

World ball_world(const Options& options, const Material& material, const Vec3& v, const Vec3& w) {
  World world(options);
  world.create_body(ground({.friction = material.friction}));
  BodyDefinition ball = body("ball", Sphere{kRadius}, Vec3(0, 0, kRadius), material);
  ball.v_WB = v;
  ball.w_WB = w;
  world.create_body(ball);
  return world;
}

class TurningFriction : public ::testing::TestWithParam<Way> {
 protected:
  Options options() const {
    Options options;
    options.solver = GetParam().solver;
    return options;
  }
};

TEST_P(TurningFriction, ARollingBallStopsAfterVSquaredOverTwoA) {
  const double v0 = 1.5, rolling = 0.02, a = 5.0 / 7.0 * rolling * kG / kRadius;
  const Vec3 along(std::cos(0.4), std::sin(0.4), 0.0);
  World world = ball_world(options(), {.friction = 0.5, .rolling_friction = rolling}, v0 * along,
                           v0 / kRadius * Vec3::UnitZ().cross(along));
  run(world, 240);
  EXPECT_LE((world.motion(1).v - (v0 - a) * along).norm() / v0,
            GetParam().motion);  // 5e-15; soft_step 8.5e-3
  run(world, 720);
  const Vec3 stop = Vec3(0, 0, kRadius) + v0 * v0 / (2.0 * a) * along;
  EXPECT_LE((world.motion(1).x - stop).norm() / v0,
            std::max(1e-6, GetParam().motion));  // 6e-7: it stops with the step; soft_step 5e-4
  EXPECT_LE(world.motion(1).v.norm(), 1e-6);
}

TEST_P(TurningFriction, ASpinningBallStopsAfterItsSpinOverItsTorque) {
  const double w0 = 20.0, torsional = 0.01, slowing = torsional * kG / (0.4 * kRadius * kRadius);
  World world =
      ball_world(options(), {.friction = 0.5, .torsional_friction = torsional}, Vec3::Zero(), Vec3(0, 0, w0));
  run(world, 240);
  EXPECT_LE(std::abs(world.motion(1).w.z() - (w0 - slowing)) / w0, GetParam().motion);  // 1.4e-14
  const double t = w0 / slowing;                                                        // 7.3 s
  run(world, static_cast<int>(240.0 * (t - 1.0)) - 1);
  EXPECT_GT(world.motion(1).w.z(), 0.0);
  run(world, 3);
  EXPECT_LE(std::abs(world.motion(1).w.z()), 1e-6);
  EXPECT_LE((world.motion(1).x - Vec3(0, 0, kRadius)).norm(), 1e-4);  // soft_step sinks by 4e-6
}

TEST_P(TurningFriction, ABallHoldsOnASlopeIffItsTangentIsBelowTheRollingFrictionOverTheRadius) {
  const double rolling = 0.03, limit = rolling / kRadius;
  for (const double excess : {-1e-3, 1e-3}) {
    Options tilted = options();
    const double tangent = limit * (1.0 + excess), cosine = 1.0 / std::sqrt(1.0 + tangent * tangent);
    tilted.gravity = kG * cosine * Vec3(tangent, 0, -1);
    World world =
        ball_world(tilted, {.friction = 0.5, .rolling_friction = rolling}, Vec3::Zero(), Vec3::Zero());
    run(world, 480);
    const double moved = world.motion(1).x.x();
    if (excess < 0.0) {
      EXPECT_LE(std::abs(moved), GetParam().creep);
      if (GetParam().creep > 0.0) continue;
      // The moments are read with the forces: nothing is left to turn it. Measured 1e-16.
      EXPECT_LE(sum_contact_forces(world, world.id(1)).torque.norm(),
                1e-12 * rolling * kG * world.mass_properties(1).mass);
    } else if (GetParam().creep == 0.0) {
      const double exact = 0.5 * 5.0 / 7.0 * kG * cosine * limit * excess * 4.0;  // 1.4 mm
      EXPECT_LE(std::abs(moved - exact) / exact, 1e-9);                           // 1e-12
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Solvers, TurningFriction,
                         ::testing::Values(Way{Solver::automatic, 1e-12, 0.0}, Way{Solver::exact, 1e-12, 0.0},
                                           Way{Solver::pgs, 1e-12, 1e-6}, Way{Solver::nncg, 1e-12, 1e-3},
                                           Way{Solver::soft_step, 2e-2, 1e-3}),
                         [](const auto& info) { return solver_name(info.param.solver); });

TEST(TurningFrictionOff, IsTheDefault) {
  World world = ball_world(Options{}, {}, Vec3(1, 0, 0), Vec3(0, 1.0 / kRadius, 0));
  run(world, 480);
  EXPECT_LE(std::abs(world.motion(1).v.x() - 1.0), 1e-12);
}

TEST(TurningFrictionPair, TwoBallsPressedTogetherEndTurningAsOne) {
  // Two movable bodies and several contacts: the moments act on both, momentum is conserved.
  Options options = weightless();
  World world(options);
  const Material sticky{.friction = 0.5, .rolling_friction = 0.05, .torsional_friction = 0.05};
  BodyDefinition left = body("left", Sphere{0.5}, Vec3(-0.5, 0, 0), sticky);
  BodyDefinition right = body("right", Sphere{0.5}, Vec3(0.5, 0, 0), sticky);
  left.v_WB = Vec3(0.1, 0, 0);
  left.w_WB = Vec3(5, 0, 0);
  world.create_body(left);
  world.create_body(right);
  Push squeeze;
  for (std::uint32_t slot = 0; slot < 2; ++slot) {
    squeeze.body = world.id(slot);
    squeeze.force = Vec3(slot == 0 ? 1e4 : -1e4, 0, 0);
    squeeze.duration = 10.0;
    world.push(squeeze);
  }
  const Conserved before = world.compute_conserved();
  run(world, 480);
  const Conserved after = world.compute_conserved();
  EXPECT_LE((after.momentum - before.momentum).norm(), 1e-9 * before.momentum.norm());
  EXPECT_LE((after.angular_momentum - before.angular_momentum).norm(), 1e-9 * before.angular_momentum.norm());
  // Torsional friction made them turn as one.
  EXPECT_LE((world.motion(0).w - world.motion(1).w).norm(), 1e-6);
  EXPECT_NEAR(world.motion(0).w.x(), 2.5, 1e-6);
}

}  // namespace
}  // namespace tumble
