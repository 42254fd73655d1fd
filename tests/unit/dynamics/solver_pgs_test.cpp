// The sweeping solvers pgs and nncg: momentum, Coulomb's law, support forces, standing stacks; and what soft_step and
// course_impulse share of it.
#include <gtest/gtest.h>

#include <cmath>

#include "support/problem_builder.h"

namespace tumble {
namespace {

using namespace test;

const BoundSettings kSlop{.slop = 1e-3, .push_fraction = 0.2, .push_speed = 3.0};

class EverySolver : public testing::TestWithParam<const char*> {
 protected:
  SolverReport solve(ContactProblem& problem, const SolverSettings& settings = {}) const {
    return solve_function(solver_from_name(GetParam()).value())(problem, settings);
  }
};

/// A row of balls and cubes that press, slide and spin against each other without support.
ContactProblem floating_cluster() {
  ContactProblem problem;
  problem.h = kStep;
  for (int i = 0; i < 8; ++i) {
    const double s = i % 2 == 0 ? 1.0 : -1.0;
    problem.bodies.push_back(cube(1.0 + i, Vec3(0.98 * i, 0.1 * s, 0.05 * i), Vec3(2.0 - i, 0.3 * s, 0.7),
                                  Vec3(0.5 * s, 1.0 - 0.2 * i, 0.4)));
  }
  for (std::uint32_t i = 0; i + 1 < 8; ++i) {
    for (const double y : {-0.4, 0.4}) {
      const Vec3 n = Vec3(1.0, 0.1 * y, 0.2 * y) / Vec3(1.0, 0.1 * y, 0.2 * y).norm();
      problem.contacts.push_back(contact_at(problem, i, i + 1, Vec3(0.98 * i + 0.5, y, -y), n, -0.002, 0.6));
    }
  }
  ScalarRow row;
  row.a = 0;
  row.b = 7;
  row.n = Vec3::UnitX();
  row.rA = Vec3(0.1, 0.2, 0.3);
  row.rB = Vec3(-0.3, 0.1, 0.0);
  row.softness = 0.7;
  row.stiffness = 0.7 * 4.0 / (kStep * kStep);
  row.bias = 0.4;
  problem.rows.push_back(row);
  prepare(problem, kNoSlop);
  return problem;
}

TEST_P(EverySolver, ConservesMomentumOfAnIsland) {
  ContactProblem problem = floating_cluster();
  const Momentum before = momentum(problem);
  solve(problem);
  // Impulses meet at one line of action for contacts; the row's arms do not, so its couple is taken out.
  const Momentum after = momentum(problem);
  const ScalarRow& row = problem.rows[0];
  const Vec3 offset = problem.bodies[7].x + row.rB - problem.bodies[0].x - row.rA;
  const Vec3 couple = offset.cross(row.lambda * row.n);
  EXPECT_LT((after.linear - before.linear).norm() / before.scale, 1e-15);             // measured below 2e-16
  EXPECT_LT((after.angular - couple - before.angular).norm() / before.scale, 1e-15);  // measured below 3e-16
}

/// A ball pressed on the floor cannot turn, so it slides like a block on one contact.
ContactProblem block(double speed, double direction, double friction) {
  ContactProblem problem;
  problem.h = kStep;
  problem.bodies = {fixed_body(), ball(2.0, 0.5, Vec3(0, 0, 0.5))};
  problem.bodies[1].inv_I_W.setZero();
  const SinCos s = sincos(direction);
  problem.bodies[1].v = problem.bodies[1].v0 = speed * Vec3(s.cos, s.sin, 0.0);
  problem.contacts = {contact_at(problem, 0, 1, Vec3::Zero(), Vec3::UnitZ(), 0.0, friction)};
  apply_gravity(problem);
  prepare(problem, kNoSlop);
  return problem;
}

TEST_P(EverySolver, SlidingFrictionIsMuTimesWeightInEveryDirection) {
  const double mu = 0.3;
  for (int degrees = 0; degrees < 360; degrees += 15) {
    ContactProblem problem = block(1.0, degrees * 3.14159265358979323846 / 180.0, mu);
    const Vec3 direction = problem.bodies[1].v0;
    solve(problem, {.max_sweeps = 100});
    const Vec3& v = problem.bodies[1].v;
    EXPECT_NEAR(v.norm(), 1.0 - mu * 9.81 * kStep, 1e-14) << degrees;
    EXPECT_LT(v.cross(direction).norm(), 1e-15) << "friction opposes the sliding: a cone, not a pyramid";
  }
}

TEST_P(EverySolver, StopsWhatFrictionCanStopWithinTheStep) {
  const double mu = 0.3, most = mu * 9.81 * kStep;
  ContactProblem slow = block(0.999 * most, 0.5, mu);
  solve(slow, {.max_sweeps = 100});
  EXPECT_LT(slow.bodies[1].v.norm(), 1e-15);
  ContactProblem fast = block(1.001 * most, 0.5, mu);
  solve(fast, {.max_sweeps = 100});
  EXPECT_NEAR(fast.bodies[1].v.norm(), 0.001 * most, 1e-15);
}

INSTANTIATE_TEST_SUITE_P(Solvers, EverySolver, testing::Values("course_impulse", "pgs", "nncg", "soft_step"));

class SweepingSolver : public EverySolver {};

TEST_P(SweepingSolver, StickThresholdOnASlopeIsTheFrictionAngle) {
  const double slope = 0.4;
  const SinCos s = sincos(slope);
  const Vec3 g(9.81 * s.sin, 0.0, -9.81 * s.cos);
  const auto speed_after_a_step = [&](double mu) {
    ContactProblem problem;
    problem.h = kStep;
    problem.bodies = {fixed_body(Vec3(0, 0, -0.5)), cube(1.0, Vec3(0, 0, 0.5))};
    for (const double x : {-0.5, 0.5}) {
      for (const double y : {-0.5, 0.5}) {
        problem.contacts.push_back(contact_at(problem, 0, 1, Vec3(x, y, 0), Vec3::UnitZ(), 0.0, mu));
      }
    }
    apply_gravity(problem, g);
    prepare(problem, kNoSlop);
    solve(problem, {.max_sweeps = 10000, .tolerance = 1e-12});
    return problem.bodies[1].v.x();
  };
  const double tangent = s.sin / s.cos;
  // Closer to the angle the sweeps converge more slowly: 1e-6 above it 10 000 of pgs leave 1.3e-6 m/s.
  EXPECT_LT(std::abs(speed_after_a_step(tangent + 1e-3)), 1e-10);
  EXPECT_NEAR(speed_after_a_step(tangent - 1e-3), 1e-3 * 9.81 * s.cos * kStep, 1e-10);
}

TEST_P(SweepingSolver, SupportForceOfAStackIsItsWeight) {
  CubePile pile = make_stack(5, kStep);
  pile.prepare_step();
  const SolverReport report = solve(pile.problem(), {.max_sweeps = 100000, .tolerance = 1e-10});
  EXPECT_LT(report.residual, 1e-10);
  double support = 0.0;
  for (const PointContact& c : pile.problem().contacts) {
    if (c.a == 0) support += c.lambda.x();
  }
  EXPECT_NEAR(support / (5.0 * 9.81 * kStep), 1.0, 1e-7);  // measured 1e-9
}

TEST_P(SweepingSolver, AcceptsAWarmStartThatIsGoodAsItIs) {
  CubePile pile = make_stack(3, kStep);
  pile.prepare_step();
  solve(pile.problem(), {.max_sweeps = 100000, .tolerance = 1e-9});
  ContactProblem again = pile.problem();
  for (SolverBody& body : again.bodies) {
    body.v = body.v0;
    body.w = body.w0;
  }
  apply_gravity(again);
  const SolverReport report = solve(again, {.tolerance = 1e-8});
  EXPECT_TRUE(report.accepted);
  EXPECT_EQ(report.sweeps, 0);
  EXPECT_LT(report.residual, 1e-8);
}

struct Standing {
  double rest_time = -1.0;  // [s] first certified rest
  double drift = 0.0;       // [m] farthest any body has moved at the end
};

Standing stand(CubePile pile, SolveFunction solve, double seconds) {
  std::vector<Vec3> start;
  for (const SolverBody& body : pile.problem().bodies) start.push_back(body.x);
  Standing standing;
  const int steps = static_cast<int>(seconds / kStep);
  for (int i = 0; i < steps; ++i) {
    const SolverReport report = pile.step(solve, {.max_sweeps = 30, .tolerance = 1e-8}, kSlop);
    double speed = 0.0;
    for (const SolverBody& body : pile.problem().bodies)
      speed = std::max(speed, body.v.norm() + body.w.norm());
    if (standing.rest_time < 0.0 && report.residual < 1e-6 && speed < 6e-5 * kStep)
      standing.rest_time = i * kStep;
  }
  for (std::size_t i = 0; i < start.size(); ++i) {
    standing.drift = std::max(standing.drift, (pile.problem().bodies[i].x - start[i]).norm());
  }
  return standing;
}

TEST_P(SweepingSolver, StackOfFiveComesToCertifiedRest) {
  const Standing standing =
      stand(make_stack(5, kStep), solve_function(solver_from_name(GetParam()).value()), 5.0);
  EXPECT_GE(standing.rest_time, 0.0);
  EXPECT_LT(standing.drift, 1e-4);  // measured: pgs 5e-5, nncg 8e-6 m
}

TEST_P(SweepingSolver, StackOfTenStandsWithThirtySweeps) {
  const Standing standing =
      stand(make_stack(10, kStep), solve_function(solver_from_name(GetParam()).value()), 10.0);
  EXPECT_LT(standing.drift, 1e-3);  // measured: pgs 3.3e-4, nncg 8e-5 m
}

TEST_P(SweepingSolver, PyramidOfFiftyFiveComesToCertifiedRest) {
  const Standing standing =
      stand(make_pyramid(10, kStep), solve_function(solver_from_name(GetParam()).value()), 4.0);
  EXPECT_GE(standing.rest_time, 0.0);
  EXPECT_LT(standing.drift, 2e-4);  // measured: pgs 1e-4, nncg 2e-5 m
}

// Sweeps carry a load from body to body; a heavy top on light ones takes too many of them. This is what the exact tiers
// are for, and it is said here so that nobody relies on it.
TEST_P(SweepingSolver, HeavyTopIsHeldToTenTimesTheMassBelow) {
  const SolveFunction solve = solve_function(solver_from_name(GetParam()).value());
  EXPECT_LT(stand(make_stack(10, kStep, 10.0), solve, 10.0).drift, 5e-3);   // measured: pgs 1e-3, nncg 2e-4 m
  EXPECT_GT(stand(make_stack(10, kStep, 1000.0), solve, 10.0).drift, 1.0);  // collapses
}

INSTANTIATE_TEST_SUITE_P(Solvers, SweepingSolver, testing::Values("pgs", "nncg"));

TEST(Solver, NamesAndFunctionsBelongTogether) {
  for (const Solver solver : {Solver::course_impulse, Solver::pgs, Solver::nncg, Solver::soft_step}) {
    EXPECT_EQ(solver_from_name(solver_name(solver)), solver);
    EXPECT_NE(solve_function(solver), nullptr);
  }
  EXPECT_FALSE(solver_from_name("PGS").has_value());
}

}  // namespace
}  // namespace tumble
