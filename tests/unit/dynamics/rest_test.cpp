// An island rests only when it is proven still, or has been calm for long; and only if something holds it.
#include "dynamics/rest.h"

#include <gtest/gtest.h>

#include <cmath>

namespace tumble {
namespace {

constexpr RestSettings kRestSettings;

ContactProblem island(double speed) {
  ContactProblem problem;
  problem.h = 1.0 / 64;
  SolverBody body;
  body.x = Vec3::Zero();
  body.q = Quat::Identity();
  body.inv_mass = 2.0;
  body.inv_I_W = Mat3::Identity();
  body.v = body.v0 = Vec3(0.0, 0.6 * speed, 0.0);
  body.w = body.w0 = Vec3(0.0, 0.0, 0.4 * speed);
  SolverBody belt = body;  // immovable: its speed is not the island's
  belt.inv_mass = 0.0;
  belt.v = belt.v0 = Vec3(5.0, 0.0, 0.0);
  problem.bodies = {belt, body};
  problem.contacts.resize(1);
  return problem;
}

bool rests_at_once(double speed, double residual) {
  double calm_for = 0.0;
  return check_rest(island(speed), residual, kRestSettings, calm_for);
}

TEST(Rest, SpeedIsTheLargestOfTheMovableBodies) {
  EXPECT_DOUBLE_EQ(island_speed(island(0.3)), 0.3);
}

TEST(Rest, IsCertifiedByResidualAndSpeedTogether) {
  const double limit = std::min(kRestSettings.speed, kRestSettings.acceleration / 64);
  EXPECT_TRUE(rests_at_once(0.99 * limit, 0.99 * kRestSettings.residual));
  EXPECT_FALSE(rests_at_once(1.01 * limit, 0.0));
  EXPECT_FALSE(rests_at_once(0.0, 1.01 * kRestSettings.residual));
  EXPECT_FALSE(rests_at_once(0.0, std::nan("")));
}

TEST(Rest, ANonFiniteBodyIsNotCalmed) {
  for (const double bad : {std::nan(""), HUGE_VAL}) {
    ContactProblem problem = island(0.0);
    problem.bodies[1].w.y() = bad;
    double calm_for = kRestSettings.calm_time;
    EXPECT_FALSE(check_rest(problem, 0.0, kRestSettings, calm_for));
    EXPECT_FALSE(check_rest(problem, std::nan(""), kRestSettings, calm_for));
  }
}

TEST(Rest, ATurningPointIsNotRest) {
  ContactProblem problem = island(0.0);
  problem.bodies[1].v0 = Vec3(0.0, 0.0, -0.01);
  double calm_for = 0.0;
  EXPECT_FALSE(check_rest(problem, 0.0, kRestSettings, calm_for));
}

TEST(Rest, AShortStepDoesNotHideAnAcceleration) {
  // One step of the acceleration limit stays below the speed limit; it must not count as rest.
  ContactProblem problem = island(7e-8);
  problem.h = 1e-3;  // limit 6e-8 m/s
  double calm_for = 0.0;
  EXPECT_FALSE(check_rest(problem, 0.0, kRestSettings, calm_for));
}

TEST(Rest, ComesAfterACalmTimeAndAnyHasteStartsItAnew) {
  double calm_for = 0.0;
  const double slow = 0.9 * kRestSettings.calm_speed;
  for (int i = 1; i < 32; ++i) EXPECT_FALSE(check_rest(island(slow), 1.0, kRestSettings, calm_for)) << i;
  EXPECT_FALSE(check_rest(island(2.0 * kRestSettings.calm_speed), 1.0, kRestSettings, calm_for));
  EXPECT_EQ(calm_for, 0.0);
  for (int i = 1; i < 32; ++i) EXPECT_FALSE(check_rest(island(slow), 1.0, kRestSettings, calm_for)) << i;
  EXPECT_TRUE(check_rest(island(slow), 1.0, kRestSettings, calm_for));  // 32/64 s = calm_time
}

TEST(Rest, WhatIsFasterThanItsSolverErrsIsNotCalmedAway) {
  double calm_for = 0.0;
  for (int i = 0; i < 100; ++i) EXPECT_FALSE(check_rest(island(2e-3), 1e-3, kRestSettings, calm_for)) << i;
  calm_for = kRestSettings.calm_time;
  EXPECT_TRUE(check_rest(island(2e-3), 1e-2, kRestSettings, calm_for));
}

TEST(Rest, CalmIsJudgedByTheEnergyOfASmallBodyNotByItsTurning) {
  ContactProblem problem = island(0.0);
  problem.bodies[1].w = problem.bodies[1].w0 = Vec3(0.0, 0.0, 1.0);
  double calm_for = kRestSettings.calm_time;
  EXPECT_FALSE(check_rest(problem, 1.0, kRestSettings, calm_for));  // sqrt(2) m/s
  problem.bodies[1].inv_I_W *= 1e4;
  calm_for = kRestSettings.calm_time;
  EXPECT_TRUE(check_rest(problem, 1.0, kRestSettings, calm_for));  // sqrt(2) cm/s
}

TEST(Rest, SlowMotionThatIsSolvedExactlyIsNeverCalmedAway) {
  double calm_for = 100.0;
  EXPECT_FALSE(check_rest(island(1e-4), 1e-9, kRestSettings, calm_for));
  EXPECT_EQ(calm_for, 0.0);
}

TEST(Rest, NothingHoldsABodyWithoutContact) {
  ContactProblem problem = island(0.0);
  problem.contacts.clear();
  double calm_for = 100.0;
  EXPECT_FALSE(check_rest(problem, 0.0, kRestSettings, calm_for));
  problem.rows.resize(1);
  EXPECT_TRUE(check_rest(problem, 0.0, kRestSettings, calm_for));
}

}  // namespace
}  // namespace tumble
