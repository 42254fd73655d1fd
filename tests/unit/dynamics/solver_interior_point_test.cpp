// The exact solver against closed forms: support forces, friction, ropes and springs; and what it does where there is
// no solution. Residuals are those of the natural map on v = v* + M^-1 J^T lambda.
#include <gtest/gtest.h>

#include <algorithm>

#include "dynamics/alm_newton.h"
#include "dynamics/interior_point.h"
#include "support/island_problem.h"

namespace tumble {
namespace {

using namespace test;

SolverSettings settings() {
  SolverSettings settings;
  settings.gravity = Vec3(0, 0, -kG);
  return settings;
}

/// Interior point alone, best impulses restored.
struct InteriorResult {
  int iterations;
  double residual;
};
InteriorResult interior_point(ContactProblem& problem) {
  BestImpulses best(problem);
  VelocitySystem system(problem, VelocitySystem::find_pattern(problem));
  const int iterations = run_interior_point(problem, system, 1e-9, best);
  best.restore();
  return {iterations, best.residual()};
}

TEST(InteriorPoint, EveryLevelOfAStackCarriesTheWeightAboveIt) {
  // A residual r [m/s] at the top body is an error r/(g h) of its share: 1e-9 m/s are 6e-9 of the weight. Measured 1.2e-9,
  // 1.1e-9, 4e-8.
  for (const auto& [top, bound] : {std::pair(1.0, 6e-9), {1e3, 6e-9}, {1e6, 1e-7}}) {
    ContactProblem problem = stack_problem(10, top);
    const SolverReport report = solve_exact(problem, settings());
    EXPECT_LT(report.residual, 1e-8) << top;
    for (std::uint32_t level = 0; level < 10; ++level) {
      const double weight = (9.0 - level + top) * kG * problem.h;
      EXPECT_NEAR(normal_impulse(problem, level, level + 1), weight, bound * weight)
          << top << " level " << level;
    }
  }
}

TEST(InteriorPoint, NeedsAFewIterationsMoreForAHigherStack) {
  // measured 5, 6, 7, 7, 9 from a cold start
  for (const auto& [count, limit] : {std::pair(1, 7), {5, 8}, {10, 9}, {20, 10}, {50, 11}}) {
    ContactProblem problem = stack_problem(count);
    const InteriorResult result = interior_point(problem);
    EXPECT_LT(result.residual, 1e-9) << count;
    EXPECT_LE(result.iterations, limit) << count;
  }
}

TEST(InteriorPoint, SolvesPyramids) {
  // measured 6, 6, 7
  for (const auto& [base, limit] : {std::pair(5, 8), {10, 8}, {20, 9}}) {
    ContactProblem problem = pyramid_problem(base);
    const InteriorResult result = interior_point(problem);
    EXPECT_LT(result.residual, 1e-9) << base;
    EXPECT_LE(result.iterations, limit) << base;
  }
}

TEST(InteriorPoint, AGrooveCarriesASphereByItsTwoNormals) {
  for (const double friction : {0.0, 1e-7}) {
    ContactProblem problem;
    problem.h = 1.0 / 60.0;
    add_body(problem, 0.0, Vec3::Zero(), Vec3::Zero());
    const std::uint32_t sphere = add_sphere(problem, 2.0, 0.5, Vec3(0, 0, 1));
    const double cosine = 0.6, sine = 0.8;
    for (const double side : {-1.0, 1.0}) {
      const Vec3 n(side * sine, 0, cosine);
      add_contact(problem, 0, sphere, Vec3(0, 0, 1) - 0.5 * n, n, friction);
    }
    prepare_rigid(problem);
    const SolverReport report = solve_exact(problem, settings());
    EXPECT_LT(report.residual, 1e-8);
    const double expected = 2.0 * kG * problem.h / (2.0 * cosine);
    for (const PointContact& c : problem.contacts)
      EXPECT_NEAR(c.lambda.x(), expected, 1e-6 * expected) << friction;
  }
}

TEST(InteriorPoint, SlidingFrictionIsTheSameInEveryDirection) {
  for (double heading = 0.1; heading < 6.3; heading += 0.7) {
    ContactProblem problem = stack_problem(1);
    const Vec3 direction(std::cos(heading), std::sin(heading), 0.0);
    problem.bodies[1].v += 3.0 * direction;
    // A low box, which friction cannot tip.
    for (PointContact& c : problem.contacts) c.rB.z() = -0.1;
    prepare_rigid(problem);
    const SolverReport report = solve_exact(problem, settings());
    EXPECT_LT(report.residual, 1e-8) << heading;
    const Vec3 expected = (3.0 - 0.5 * kG * problem.h) * direction;
    EXPECT_LE((problem.bodies[1].v - expected).norm(), 1e-8) << heading;
  }
}

TEST(InteriorPoint, ImpulsesAreEqualAndOpposite) {
  for (std::uint32_t seed = 0; seed < 20; ++seed) {
    ContactProblem problem = random_problem(seed, 5, 8);
    Vec3 before = Vec3::Zero(), after = Vec3::Zero(), from_ground = Vec3::Zero();
    for (const SolverBody& body : problem.bodies) {
      if (body.inv_mass > 0.0) before += body.v / body.inv_mass;
    }
    solve_exact(problem, settings());
    for (const SolverBody& body : problem.bodies) {
      if (body.inv_mass > 0.0) after += body.v / body.inv_mass;
    }
    for (const PointContact& c : problem.contacts) {
      const Vec3 impulse = c.lambda.x() * c.n + c.lambda.y() * c.t1 + c.lambda.z() * c.t2;
      if (c.a == 0) from_ground += impulse;
      if (c.b == 0) from_ground -= impulse;
    }
    EXPECT_LE((after - before - from_ground).norm(), 1e-13) << seed;  // measured 1e-14
  }
}

TEST(InteriorPoint, ASolutionIsAcceptedAsTheWarmStartOfTheSameProblem) {
  const ContactProblem fresh = stack_problem(10);
  ContactProblem problem = fresh;
  EXPECT_FALSE(solve_exact(problem, settings()).accepted);
  ContactProblem again = fresh;
  for (std::size_t i = 0; i < again.contacts.size(); ++i)
    again.contacts[i].lambda = problem.contacts[i].lambda;
  EXPECT_TRUE(solve_exact(again, settings()).accepted);
  EXPECT_EQ(again.contacts[7].lambda, problem.contacts[7].lambda);
}

/// Two cubes, the lower on a row from the world, the upper on a row from the lower one; n along z, from b to a or back.
ContactProblem hanging_problem(const ScalarRow& law, double upwards) {
  ContactProblem problem;
  problem.h = 0.01;
  add_cube(problem, 0.0, Vec3::Zero());
  add_cube(problem, 1.0, Vec3(0, 0, -1));
  add_cube(problem, 3.0, Vec3(0, 0, -2));
  for (std::uint32_t i = 0; i < 2; ++i) {
    ScalarRow row = law;
    row.a = i;
    row.b = i + 1;
    row.n = Vec3(0, 0, upwards);
    row.rA = row.rB = Vec3::Zero();
    problem.rows.push_back(row);
  }
  prepare_rigid(problem);
  return problem;
}

TEST(InteriorPoint, RopesCarryWhatHangsOnThem) {
  ContactProblem problem = hanging_problem(ScalarRow{}, 1.0);
  const SolverReport report = solve_exact(problem, settings());
  EXPECT_LT(report.residual, 1e-8);
  EXPECT_NEAR(problem.rows[0].lambda, 4.0 * kG * problem.h, 1e-8);
  EXPECT_NEAR(problem.rows[1].lambda, 3.0 * kG * problem.h, 1e-8);
}

TEST(InteriorPoint, TwoSidedRowsPushAndPull) {
  ScalarRow rod;
  rod.lower = -std::numeric_limits<double>::infinity();
  ContactProblem problem = hanging_problem(rod, -1.0);
  const SolverReport report = solve_exact(problem, settings());
  EXPECT_LT(report.residual, 1e-8);
  EXPECT_NEAR(problem.rows[0].lambda, -4.0 * kG * problem.h, 1e-8);
}

TEST(InteriorPoint, SpringsFollowTheirLaw) {
  ScalarRow spring;
  spring.softness = 0.7;
  spring.bias = 0.2;
  ContactProblem problem = hanging_problem(spring, -1.0);
  const SolverReport report = solve_exact(problem, settings());
  EXPECT_LT(report.residual, 1e-12);
  EXPECT_LE(report.iterations, 2);
}

TEST(InteriorPoint, AWedgedSphereStaysFiniteAndSlow) {
  ContactProblem problem;
  problem.h = 1.0 / 60.0;
  add_body(problem, 0.0, Vec3::Zero(), Vec3::Zero());
  const std::uint32_t sphere = add_sphere(problem, 1.0, 0.5, Vec3(0, 0, 1));
  for (const double side : {-1.0, 1.0}) {
    const Vec3 n(side, 0, 0);
    add_contact(problem, 0, sphere, Vec3(0, 0, 1) - 0.4 * n, n, 0.5, -0.1);
  }
  prepare_rigid(problem);
  const SolverReport report = solve_exact(problem, settings());
  EXPECT_TRUE(report.fallback);
  EXPECT_LE(problem.bodies[sphere].v.norm(), 0.5);
  for (const PointContact& c : problem.contacts) EXPECT_LE(c.lambda.norm(), 600.0);  // measured 503
}

TEST(ExactSolver, SolvesEveryRandomFrictionalProblemToRounding) {
  for (const auto& [bodies, contacts] : {std::pair(3, 4), {5, 6}, {20, 26}}) {
    for (std::uint32_t seed = 0; seed < 300; ++seed) {
      ContactProblem problem = random_problem(seed, bodies, contacts);
      const SolverReport report = solve_exact(problem, settings());
      EXPECT_LT(report.residual, 1e-9) << bodies << " bodies, seed " << seed;
      EXPECT_FALSE(report.fallback) << bodies << " bodies, seed " << seed;
    }
  }
}

TEST(AlmNewton, TakesTwoOrThreeStepsFromANearWarmStart) {
  // Impulses wrong by up to 1 %; measured 2, 2, 3, 2, 2.
  const ContactProblem problems[] = {stack_problem(5), stack_problem(20), stack_problem(50),
                                     pyramid_problem(5), pyramid_problem(20)};
  for (const ContactProblem& fresh : problems) {
    ContactProblem solved = fresh, problem = fresh;
    solve_exact(solved, settings());
    for (std::size_t i = 0; i < problem.contacts.size(); ++i) {
      const double error = 1e-2 * (static_cast<double>(i * 7919 % 13) / 6.5 - 1.0);
      problem.contacts[i].lambda = (1.0 + error) * solved.contacts[i].lambda;
    }
    SolverSettings wanted = settings();
    wanted.tolerance = 1e-8;
    const SolverReport report = solve_alm_newton(problem, wanted);
    EXPECT_LT(report.residual, 1e-9) << fresh.bodies.size();
    EXPECT_LE(report.newton_steps, 3) << fresh.bodies.size();
  }
}

TEST(AlmNewton, EndsWhatTheInteriorPointLeavesOfSlidingContacts) {
  double worst_before = 0.0, worst = 0.0;
  for (std::uint32_t seed = 0; seed < 100; ++seed) {
    ContactProblem problem = random_problem(seed, 5, 6);
    BestImpulses best(problem);
    VelocitySystem system(problem, VelocitySystem::find_pattern(problem));
    run_interior_point(problem, system, 1e-13, best);
    worst_before = std::max(worst_before, best.residual());
    run_alm_newton(problem, system, 1e-13, 12, best);
    worst = std::max(worst, best.residual());
  }
  EXPECT_GT(worst_before, 1e-8);
  EXPECT_LT(worst, 1e-11);
}

TEST(AutomaticSolver, ChoosesByTheWorkOfAFactorizationAndTheSpeedOfTheIsland) {
  SolverSettings limited = settings();
  limited.exact_work = 10 * 3;  // a chain of ten bodies takes 9 * 3 + 1 products
  limited.exact_calm_factor = 1.0;
  ContactProblem small = stack_problem(10), large = stack_problem(11);
  EXPECT_TRUE(solve_automatic(small, limited).exact);
  EXPECT_FALSE(solve_automatic(large, limited).exact);
  limited.exact_calm_factor = 2.0;
  ContactProblem calm = stack_problem(11), fast = stack_problem(11);
  fast.bodies[1].v0.x() = 2.0 * limited.exact_calm_speed;
  EXPECT_TRUE(solve_automatic(calm, limited).exact);
  EXPECT_FALSE(solve_automatic(fast, limited).exact);
}

}  // namespace
}  // namespace tumble
