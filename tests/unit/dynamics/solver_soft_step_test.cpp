// soft_step: soft contacts hold what they should, sub-steps add up, and the poses they lead to are told by shift and turn.
#include <gtest/gtest.h>

#include "support/problem_builder.h"

namespace tumble {
namespace {

using namespace test;

double deepest(const ContactProblem& problem) {
  double depth = 0.0;
  for (const PointContact& c : problem.contacts) depth = std::max(depth, -c.separation);
  return depth;
}

TEST(SoftStep, StackOfFiveStandsOnMillimetres) {
  CubePile pile = make_stack(5, kStep);
  for (int i = 0; i < 2400; ++i) pile.step(&solve_soft_step, {});
  EXPECT_LT(deepest(pile.problem()), 3e-3);  // measured 2.2e-3 m
  EXPECT_NEAR(pile.problem().bodies[5].x.x(), 0.01, 1e-3);
  EXPECT_LT(momentum(pile.problem()).linear.norm(), 1e-4);
}

TEST(SoftStep, SumOfSubStepImpulsesIsTheStepsImpulse) {
  CubePile pile = make_stack(5, kStep);
  for (int i = 0; i < 2400; ++i) pile.step(&solve_soft_step, {});
  double support = 0.0;
  for (const PointContact& c : pile.problem().contacts) {
    if (c.a == 0) support += c.lambda.x();
  }
  EXPECT_NEAR(support / (5.0 * 9.81 * kStep), 1.0, 1e-4);
}

TEST(SoftStep, FreeBodyOfAnIslandMovesTheSumOfItsSubSteps) {
  ContactProblem problem;
  problem.h = kStep;
  problem.bodies = {fixed_body(), ball(1.0, 0.5, Vec3(0, 0, 1.0), Vec3(1, 0, 0), Vec3(0, 0, 2))};
  problem.contacts = {contact_at(problem, 0, 1, Vec3::Zero(), Vec3::UnitZ(), 0.5, 0.5)};
  apply_gravity(problem);
  prepare(problem, kNoSlop);
  solve_soft_step(problem, {.sub_steps = 4});
  EXPECT_TRUE(problem.contacts[0].lambda.isZero(0.0));
  const SolverBody& body = problem.bodies[1];
  const Vec3 moved = problem.h * body.v + body.shift;
  EXPECT_NEAR(moved.x(), kStep, 1e-17);
  EXPECT_NEAR(moved.z(), -9.81 * kStep * kStep * (1.0 + 2.0 + 3.0 + 4.0) / 16.0, 1e-18);
  EXPECT_LT(body.turn.norm(), 1e-17);
}

TEST(SoftStep, OverlapIsPushedOutWithoutLeavingSpeed) {
  ContactProblem problem;
  problem.h = kStep;
  problem.bodies = {fixed_body(), ball(1.0, 0.5, Vec3(0, 0, 0.45))};
  problem.contacts = {contact_at(problem, 0, 1, Vec3::Zero(), Vec3::UnitZ(), -0.05, 0.5)};
  prepare(problem, kNoSlop);
  solve_soft_step(problem, {});
  EXPECT_GT(problem.bodies[1].shift.z() + kStep * problem.bodies[1].v.z(), 1e-3);
  EXPECT_LT(std::abs(problem.bodies[1].v.z()), 1e-12);
}

}  // namespace
}  // namespace tumble
