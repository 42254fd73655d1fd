// Impacts: what enters, what leaves, and that no sequence of them creates momentum or energy.
#include "dynamics/impact.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "dynamics/point_impact.h"
#include "support/problem_builder.h"

namespace tumble {
namespace {

using namespace test;

const ImpactSettings kSettings{.threshold_speed = 0.01, .max_impacts = 64};

/// Touching balls in a row along x with the given speeds.
ContactProblem cradle(const std::vector<double>& speeds, double restitution) {
  ContactProblem problem;
  problem.h = 1.0 / 240.0;
  for (std::size_t i = 0; i < speeds.size(); ++i) {
    problem.bodies.push_back(ball(0.7, 0.5, Vec3(static_cast<double>(i), 0, 0), Vec3(speeds[i], 0, 0)));
  }
  for (std::uint32_t i = 0; i + 1 < speeds.size(); ++i) {
    problem.contacts.push_back(
        contact_at(problem, i, i + 1, Vec3(i + 0.5, 0, 0), Vec3::UnitX(), 0.0, 0.0, restitution));
  }
  prepare(problem, kNoSlop);
  return problem;
}

void expect_speeds(const ContactProblem& problem, const std::vector<double>& speeds, double bound) {
  for (std::size_t i = 0; i < speeds.size(); ++i) {
    EXPECT_NEAR(problem.bodies[i].v0.x(), speeds[i], bound) << i;
    EXPECT_NEAR(problem.bodies[i].v.x(), speeds[i], bound) << i;
  }
}

TEST(Impact, CradleGivesOutAsManyBallsAsCameIn) {
  const std::vector<std::pair<std::vector<double>, std::vector<double>>> cases = {
      {{1, 0, 0, 0, 0}, {0, 0, 0, 0, 1}},
      {{1, 1, 0, 0, 0}, {0, 0, 0, 1, 1}},
      {{1, 1, 1, 0, 0}, {0, 0, 1, 1, 1}},
      {{1, 0, 0, 0, -1}, {-1, 0, 0, 0, 1}},
  };
  for (const auto& [in, out] : cases) {
    ContactProblem problem = cradle(in, 1.0);
    const Momentum before = momentum(problem);
    const double energy = kinetic_energy(problem);
    resolve_impacts(problem, kSettings);
    expect_speeds(problem, out, 1e-15);  // measured 0
    EXPECT_LT((momentum(problem).linear - before.linear).norm(), 1e-15);
    EXPECT_NEAR(kinetic_energy(problem), energy, 1e-15);
  }
}

TEST(Impact, CradleWithLossesPassesTheLargerPartOn) {
  ContactProblem problem = cradle({1, 0, 0, 0, 0}, 0.9);
  const Momentum before = momentum(problem);
  resolve_impacts(problem, kSettings);
  // Ball by ball (1 + e)/2 = 0.95 is passed on and 0.05 stays: 0.95^4 at the far end.
  expect_speeds(problem, {0.05, 0.0475, 0.045125, 0.04286875, 0.81450625}, 5e-3);
  EXPECT_NEAR(problem.bodies[4].v0.x(), 0.81450625, 1e-15);
  EXPECT_LT((momentum(problem).linear - before.linear).norm(), 1e-15);
}

TEST(Impact, NormalVelocityIsReversedByTheCoefficient) {
  for (const double e : {0.1, 0.5, 1.0}) {
    ContactProblem problem;
    problem.h = 1.0 / 240.0;
    problem.bodies = {fixed_body(), ball(1.0, 0.5, Vec3(0, 0, 0.5), Vec3(1.0, 0.0, -3.0), Vec3(0, 2, 0))};
    problem.contacts = {contact_at(problem, 0, 1, Vec3::Zero(), Vec3::UnitZ(), 0.0, 0.4, e)};
    apply_gravity(problem);
    prepare(problem, kNoSlop);
    const ImpactReport report = resolve_impacts(problem, kSettings);
    EXPECT_EQ(report.impacts, 1u);
    EXPECT_NEAR(problem.bodies[1].v0.z(), 3.0 * e, 1e-15);
    EXPECT_NEAR(problem.contacts[0].un0, 3.0 * e, 1e-15);
    EXPECT_NEAR(problem.bodies[1].v.z(), 3.0 * e - 9.81 * problem.h, 2e-15) << "v keeps the step of forces";
  }
}

// Sticking friction takes the sliding away, 2/7 of it into spin, and does not throw it back as 1 + e would.
TEST(Impact, GrippingBallLeavesRolling) {
  ContactProblem problem;
  problem.h = 1.0 / 240.0;
  problem.bodies = {fixed_body(), ball(1.0, 0.5, Vec3(0, 0, 0.5), Vec3(1.0, 0.0, -3.0))};
  problem.contacts = {contact_at(problem, 0, 1, Vec3::Zero(), Vec3::UnitZ(), 0.0, 0.8, 1.0)};
  prepare(problem, kNoSlop);
  resolve_impacts(problem, kSettings);
  EXPECT_NEAR(problem.bodies[1].v0.x(), 5.0 / 7.0, 1e-15);
  EXPECT_NEAR(problem.bodies[1].w0.y() * 0.5, 5.0 / 7.0, 1e-15);
}

TEST(Impact, SlidingBallLosesMuTimesTheWholeNormalImpulse) {
  ContactProblem problem;
  problem.h = 1.0 / 240.0;
  problem.bodies = {fixed_body(), ball(2.0, 0.5, Vec3(0, 0, 0.5), Vec3(3.0, 4.0, -1.0))};
  problem.contacts = {contact_at(problem, 0, 1, Vec3::Zero(), Vec3::UnitZ(), 0.0, 0.1, 0.5)};
  prepare(problem, kNoSlop);
  resolve_impacts(problem, kSettings);
  const Vec3 lost = Vec3(3.0, 4.0, 0.0) - Vec3(problem.bodies[1].v0.x(), problem.bodies[1].v0.y(), 0.0);
  EXPECT_NEAR(lost.norm(), 0.1 * 1.5, 1e-15);
  EXPECT_LT(lost.cross(Vec3(3.0, 4.0, 0.0)).norm(), 1e-15);
}

TEST(Impact, OnlyFastClosingContactsWithRestitutionBounce) {
  const auto impacts = [](double gap, double speed, double restitution) {
    ContactProblem problem;
    problem.h = 0.01;
    problem.bodies = {fixed_body(), ball(1.0, 0.5, Vec3(0, 0, 0.5 + gap), Vec3(0, 0, -speed))};
    problem.contacts = {contact_at(problem, 0, 1, Vec3::Zero(), Vec3::UnitZ(), gap, 0.5, restitution)};
    apply_gravity(problem);
    prepare(problem, kNoSlop);
    return resolve_impacts(problem, kSettings).impacts;
  };
  EXPECT_EQ(impacts(0.0, 1.0, 0.5), 1u);
  EXPECT_EQ(impacts(0.0, 1.0, 0.0), 0u) << "no restitution";
  EXPECT_EQ(impacts(0.0, 0.1, 0.5), 0u) << "microcollision: threshold 0.01 + one step of gravity 0.0981 m/s";
  EXPECT_EQ(impacts(0.0, 0.11, 0.5), 1u);
  EXPECT_EQ(impacts(0.02, 1.0, 0.5), 0u) << "does not close within the step";
  EXPECT_EQ(impacts(0.0105, 1.0, 0.5), 1u) << "closes with the speed at its end";
  EXPECT_EQ(impacts(0.0, -1.0, 0.5), 0u) << "separating";
}

TEST(Impact, BoundedEvenIfItNeverEnds) {
  ContactProblem problem = cradle({1, 0, 0, 0, 0}, 1.0);
  const ImpactReport report = resolve_impacts(problem, {.threshold_speed = 0.0, .max_impacts = 0});
  EXPECT_EQ(report.impacts, 0u);
  EXPECT_TRUE(report.capped);
}

class RandomImpacts : public testing::Test {
 protected:
  double uniform(double low, double high) { return low + (high - low) * unit_(generator_); }
  Vec3 vector(double size) {
    const double x = uniform(-size, size), y = uniform(-size, size), z = uniform(-size, size);
    return {x, y, z};
  }
  Vec3 direction() {
    Vec3 d = vector(1.0);
    while (d.norm() < 0.1) d = vector(1.0);
    return d / d.norm();
  }
  SolverBody body() {
    const double mass = uniform(0.1, 10.0);
    const double a = uniform(0.01, 1.0), b = uniform(0.01, 1.0), c = uniform(0.01, 1.0);
    const Vec3 x = vector(1.0), v = vector(5.0), w = vector(10.0);
    SolverBody made = moving_body(mass, mass * Vec3(b + c, a + c, a + b), x, v, w);
    const Mat3 R = exp_map(vector(2.0)).toRotationMatrix();
    made.inv_I_W = R * made.inv_I_W * R.transpose();
    return made;
  }
  ContactProblem problem(int contacts) {
    ContactProblem made;
    made.h = 1.0 / 240.0;
    made.bodies = {body(), body()};
    if (uniform(0.0, 1.0) < 0.3) made.bodies[0] = fixed_body();
    const Vec3 mean = direction();
    for (int i = 0; i < contacts; ++i) {
      PointContact c;
      c.a = 0;
      c.b = 1;
      c.n = (mean + vector(0.3)).normalized();
      c.rA = vector(1.0);
      c.rB = made.bodies[0].x + c.rA - made.bodies[1].x;
      c.separation = 0.0;
      c.friction = uniform(0.0, 1.5);
      c.restitution = uniform(0.01, 1.0);
      set_tangents(c);
      made.contacts.push_back(c);
    }
    prepare(made, kNoSlop);
    return made;
  }
  std::mt19937_64 generator_{2016};
  std::uniform_real_distribution<double> unit_{0.0, 1.0};
};

TEST_F(RandomImpacts, EnergyNeverRisesAndMomentumStays) {
  double worst_gain = 0.0, worst_momentum = 0.0;
  std::uint64_t impacts = 0;
  int capped = 0;
  for (int i = 0; i < 20000; ++i) {
    ContactProblem p = problem(1 + i % 4);
    const Momentum before = momentum(p);
    const double energy = kinetic_energy(p);
    const ImpactReport report = resolve_impacts(p, kSettings);
    impacts += report.impacts;
    capped += report.capped;
    worst_gain = std::max(worst_gain, (kinetic_energy(p) - energy) / energy);
    if (p.bodies[0].inv_mass > 0.0) {
      const Momentum after = momentum(p);
      worst_momentum = std::max({worst_momentum, (after.linear - before.linear).norm() / before.scale,
                                 (after.angular - before.angular).norm() / before.scale});
    }
  }
  EXPECT_GT(impacts, 10000u) << "many draws separate";  // measured 14733
  EXPECT_LT(worst_gain, 1e-13) << "relative, rounding";
  EXPECT_LT(worst_momentum, 1e-14);
  EXPECT_LE(capped, 20) << "of 20000 clusters";
}

TEST_F(RandomImpacts, CompressionSatisfiesCoulombsLaw) {
  for (int i = 0; i < 20000; ++i) {
    Mat3 root;
    root << vector(1.0), vector(1.0), vector(1.0);
    const Mat3 K = root * root.transpose() + 0.05 * Mat3::Identity();
    Vec3 u = vector(3.0);
    u.x() = -uniform(0.1, 3.0);
    const double mu = uniform(0.0, 1.5);
    const Vec3 p = solve_compression(K, u, mu);
    const Vec3 after = u + K * p;
    const double p_t = std::sqrt(p.y() * p.y() + p.z() * p.z());
    const double slide = std::sqrt(after.y() * after.y() + after.z() * after.z());
    ASSERT_GT(p.x(), 0.0);
    ASSERT_NEAR(after.x(), 0.0, 1e-11) << i;
    ASSERT_LE(p_t, mu * p.x() * (1.0 + 1e-12)) << i;
    if (p_t < mu * p.x() * (1.0 - 1e-9)) {
      ASSERT_LT(slide, 1e-11) << "sticks inside the cone " << i;
    } else if (slide > 1e-9) {
      const double along = (p.y() * after.y() + p.z() * after.z()) / (p_t * slide);
      ASSERT_NEAR(mu > 0.0 ? along : -1.0, -1.0, 1e-9) << "friction against the sliding " << i;
    }
  }
}

}  // namespace
}  // namespace tumble
