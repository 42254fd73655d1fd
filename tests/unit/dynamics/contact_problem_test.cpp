// The contact problem: frames, masses, bounds, residual, drift.
#include "dynamics/contact_problem.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "support/problem_builder.h"

namespace tumble {
namespace {

using namespace test;

/// A ball of 1 kg on the floor.
ContactProblem ball_on_floor(double gap, double friction = 0.5) {
  ContactProblem problem;
  problem.h = 0.01;
  problem.bodies = {fixed_body(), ball(1.0, 0.5, Vec3(0, 0, 0.5))};
  problem.contacts = {contact_at(problem, 0, 1, Vec3::Zero(), Vec3::UnitZ(), gap, friction)};
  return problem;
}

TEST(ContactProblem, TangentsAreRightHandedForEveryNormal) {
  for (int i = 0; i < 1000; ++i) {
    PointContact c;
    c.n = Vec3(std::fmod(i * 0.618, 1.0) - 0.5, std::fmod(i * 0.755, 1.0) - 0.5,
               std::fmod(i * 0.570, 1.0) - 0.5);
    if (i < 6) c.n = (i % 2 ? 1.0 : -1.0) * Vec3::Unit(i / 2);
    c.n /= c.n.norm();
    set_tangents(c);
    Mat3 frame;
    frame << c.n, c.t1, c.t2;
    EXPECT_LT((frame.transpose() * frame - Mat3::Identity()).cwiseAbs().maxCoeff(), 1e-15);  // measured 7e-16
    EXPECT_NEAR(frame.determinant(), 1.0, 1e-15);
  }
}

TEST(ContactProblem, LocalMassesOfABallOnTheFloor) {
  ContactProblem problem = ball_on_floor(0.0);
  prepare(problem, kNoSlop);
  EXPECT_NEAR(problem.contacts[0].mass_n, 1.0, 1e-15);
  EXPECT_NEAR(problem.contacts[0].mass_t, 2.0 / 7.0, 1e-15) << "solid sphere: 1/m + r^2/I = 7/2 1/m";
}

TEST(ContactProblem, ContactOfImmovableBodiesHasNoMassAndNoResidual) {
  ContactProblem problem = ball_on_floor(-0.1);
  problem.bodies[1] = fixed_body();
  prepare(problem, kNoSlop);
  EXPECT_EQ(problem.contacts[0].mass_n, 0.0);
  EXPECT_EQ(compute_residual(problem), 0.0);
  for (const char* name : {"course_impulse", "pgs", "nncg", "soft_step"}) {
    ContactProblem copy = problem;
    solve_function(solver_from_name(name).value())(copy, {});
    EXPECT_TRUE(copy.bodies[1].v.isZero(0.0) && copy.contacts[0].lambda.isZero(0.0)) << name;
  }
}

TEST(ContactProblem, BoundsLetAGapCloseButNotCrossAndPushOverlapOut) {
  const BoundSettings settings{.slop = 0.001, .push_fraction = 0.2, .push_speed = 3.0};
  const auto bound = [&](double gap) {
    ContactProblem problem = ball_on_floor(gap);
    prepare(problem, settings);
    return problem.contacts[0].bound;
  };
  EXPECT_DOUBLE_EQ(bound(0.005), -0.5);
  EXPECT_EQ(bound(0.0), 0.0);
  EXPECT_EQ(bound(-0.001), 0.0);
  EXPECT_DOUBLE_EQ(bound(-0.011), 0.2);
  EXPECT_EQ(bound(-1.0), 3.0);
}

TEST(ContactProblem, ResidualOfAnOpenContactIsTheMissingVelocity) {
  ContactProblem problem = ball_on_floor(0.0);
  apply_gravity(problem);
  prepare(problem, kNoSlop);
  EXPECT_NEAR(compute_residual(problem), 9.81 * 0.01, 1e-16);
  problem.contacts[0].lambda.x() = 9.81 * 0.01;
  apply_stored_impulses(problem);
  EXPECT_LT(compute_residual(problem), 1e-16);
}

TEST(ContactProblem, ResidualMeasuresStickingFrictionInVelocity) {
  ContactProblem problem = ball_on_floor(0.0, 1e3);
  prepare(problem, kNoSlop);
  problem.contacts[0].lambda.x() = 1.0;
  problem.bodies[1].v = Vec3(0.003, 0.004, 0.0);
  EXPECT_NEAR(compute_residual(problem), 0.005, 1e-16);
}

TEST(ContactProblem, NothingNonFiniteIsReportedAsSolved) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  ContactProblem problem = ball_on_floor(0.0);
  problem.contacts.push_back(problem.contacts[0]);
  prepare(problem, kNoSlop);
  ContactProblem velocity = problem;
  velocity.bodies[1].w.y() = nan;
  EXPECT_TRUE(std::isnan(compute_residual(velocity)));
  ContactProblem impulse = problem;
  impulse.contacts[0].lambda.z() = nan;
  EXPECT_TRUE(std::isnan(compute_residual(impulse)));
  impulse.contacts[0].lambda.z() = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(std::isnan(compute_residual(impulse)));
}

TEST(ContactProblem, DriftIsAverageUnlessAContactWouldSinkIn) {
  ContactProblem resting = ball_on_floor(0.0);
  prepare(resting, kNoSlop);
  EXPECT_EQ(choose_drift(resting), ContactProblem::Drift::average);

  ContactProblem landing = ball_on_floor(0.005);  // arrives with 1 m/s, leaves the step with b = -0.5 m/s
  landing.bodies[1].v0 = Vec3(0, 0, -1.0);
  landing.bodies[1].v = Vec3(0, 0, -0.5);
  prepare(landing, kNoSlop);
  EXPECT_EQ(choose_drift(landing), ContactProblem::Drift::end);
}

}  // namespace
}  // namespace tumble
