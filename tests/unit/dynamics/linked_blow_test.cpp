// Blows on bodies that joints and taut ropes hold, against closed forms: what holds answers in the same instant.
#include <gtest/gtest.h>

#include <cmath>

#include "dynamics/reflection.h"
#include "support/problem_builder.h"

namespace tumble {
namespace {

using namespace test;

/// Three rows that hold the bodies together at `point` (W).
void add_ball_joint(ContactProblem& problem, std::uint32_t a, std::uint32_t b, const Vec3& point) {
  for (int k = 0; k < 3; ++k) {
    ScalarRow row;
    row.a = a;
    row.b = b;
    row.n = Vec3::Unit(k);
    row.rA = point - problem.bodies[a].x;
    row.rB = point - problem.bodies[b].x;
    row.lower = -kInfinity;
    problem.rows.push_back(row);
  }
}

/// A taut rope between the centres of mass.
void add_rope(ContactProblem& problem, std::uint32_t a, std::uint32_t b) {
  ScalarRow row;
  row.a = a;
  row.b = b;
  row.n = (problem.bodies[a].x - problem.bodies[b].x).normalized();
  row.rA = row.rB = Vec3::Zero();
  problem.rows.push_back(row);
}

void strike(ContactProblem& problem) {
  problem.h = 1.0;
  prepare(problem, kNoSlop);
  const double before = kinetic_energy(problem);
  const ReflectionReport report = reflect(problem);
  EXPECT_FALSE(report.capped);
  EXPECT_LE(kinetic_energy(problem), before * (1.0 + 1e-14));
}

/// A rod of length 2 l hangs from the ceiling; a ball of 0.5 kg comes along x and meets it `depth` below the hinge.
struct HungRod {
  static constexpr double kMass = 2.0, kHalf = 0.5, kBall = 0.5, kSpeed = 3.0;
  static constexpr double kInertia = kMass * kHalf * kHalf / 3.0;  // about its centre, thin
  ContactProblem problem;

  HungRod(double depth, double restitution, bool hinged) {
    problem.bodies = {fixed_body(), moving_body(kMass, Vec3(kInertia, kInertia, 1e-4), Vec3(0, 0, -kHalf)),
                      ball(kBall, 0.1, Vec3(-0.1, 0, -depth), Vec3(kSpeed, 0, 0))};
    if (hinged) add_ball_joint(problem, 0, 1, Vec3::Zero());
    problem.contacts = {contact_at(problem, 2, 1, Vec3(0, 0, -depth), Vec3::UnitX(), 0.0, 0.0, restitution)};
    strike(problem);
  }
};

TEST(LinkedBlow, ABallTurnsAHungRodAboutItsHinge) {
  for (const double restitution : {0.0, 0.6, 1.0}) {
    for (const double depth : {0.2, 0.5, 2.0 / 3.0, 1.0}) {
      const HungRod hung(depth, restitution, true);
      const double about_hinge = HungRod::kInertia + HungRod::kMass * HungRod::kHalf * HungRod::kHalf;
      const double impulse =
          (1.0 + restitution) * HungRod::kSpeed / (1.0 / HungRod::kBall + depth * depth / about_hinge);
      const SolverBody &rod = hung.problem.bodies[1], &ball = hung.problem.bodies[2];
      const double turn = -impulse * depth / about_hinge;  // about y
      EXPECT_NEAR(ball.v.x(), HungRod::kSpeed - impulse / HungRod::kBall, 1e-14);
      EXPECT_LE((rod.w - Vec3(0, turn, 0)).norm(), 1e-14);
      EXPECT_LE((rod.v - Vec3(-turn * HungRod::kHalf, 0, 0)).norm(), 1e-14);
    }
  }
}

TEST(LinkedBlow, TheHingeFeelsNothingAtTheCentreOfPercussion) {
  // At I / (m l) below the hinge a free rod would turn about the hinge by itself.
  const double centre = 4.0 / 3.0 * HungRod::kHalf;
  const HungRod hung(centre, 1.0, true), loose(centre, 1.0, false);
  for (const std::size_t i : {1u, 2u}) {
    EXPECT_LE((hung.problem.bodies[i].v - loose.problem.bodies[i].v).norm(), 1e-14);
    EXPECT_LE((hung.problem.bodies[i].w - loose.problem.bodies[i].w).norm(), 1e-14);
  }
  const HungRod above(0.5 * centre, 1.0, true), loose_above(0.5 * centre, 1.0, false);
  EXPECT_GE((above.problem.bodies[1].v - loose_above.problem.bodies[1].v).norm(), 0.1);
}

TEST(LinkedBlow, WeldedBodiesTakeABlowAsOne) {
  // Two cubes held at three points of their common face against one body of their mass and moments; with friction.
  for (const double friction : {0.0, 0.2, 0.8}) {
    ContactProblem two, one;
    const Vec3 v(1.0, 0.4, -3.0), w(0.5, -1.0, 2.0);
    const auto velocity = [&](const Vec3& r) { return Vec3(v + w.cross(r)); };
    two.bodies = {fixed_body(), cube(1.0, Vec3(-0.5, 0, 0), velocity(Vec3(-0.5, 0, 0)), w),
                  cube(1.0, Vec3(0.5, 0, 0), velocity(Vec3(0.5, 0, 0)), w)};
    for (const Vec3& point : {Vec3(0, 0.4, 0), Vec3(0, -0.2, 0.3), Vec3(0, -0.2, -0.3)})
      add_ball_joint(two, 1, 2, point);
    one.bodies = {fixed_body(),
                  moving_body(2.0, Vec3(2.0 / 6.0, 2.0 / 6.0 + 0.5, 2.0 / 6.0 + 0.5), Vec3::Zero(), v, w)};
    const Vec3 corner(0.9, 0.3, -0.5);
    two.contacts = {contact_at(two, 0, 2, corner, Vec3::UnitZ(), 0.0, friction, 0.7)};
    one.contacts = {contact_at(one, 0, 1, corner, Vec3::UnitZ(), 0.0, friction, 0.7)};
    strike(two);
    strike(one);
    const SolverBody& whole = one.bodies[1];
    EXPECT_LE((two.contacts[0].lambda - one.contacts[0].lambda).norm(), 1e-12) << friction;
    for (const std::size_t i : {1u, 2u}) {
      const Vec3 expected = whole.v + whole.w.cross(two.bodies[i].x);
      EXPECT_LE((two.bodies[i].v - expected).norm(), 1e-12) << friction;
      EXPECT_LE((two.bodies[i].w - whole.w).norm(), 1e-12) << friction;
    }
  }
}

TEST(LinkedBlow, ATautRopePullsInTheSameInstantAndASlackeningOneDoesNot) {
  // A ball hangs by a rope along r and is struck along n: it moves as if its mass across the rope were its own and along
  // it infinite, or as a free one where the blow slackens the rope.
  const double mass = 2.0, hammer = 6.0, speed = 3.0, restitution = 1.0;
  for (const double angle : {0.0, 0.4, 0.9, 2.0, 3.0}) {  // between n and down
    ContactProblem problem;
    const Vec3 n(std::sin(angle), 0, -std::cos(angle)), up = Vec3::UnitZ();
    problem.bodies = {fixed_body(Vec3(0, 0, 1)), ball(mass, 0.1, Vec3::Zero()),
                      ball(hammer, 0.1, -0.2 * n, speed * n)};
    add_rope(problem, 0, 1);
    problem.contacts = {contact_at(problem, 2, 1, -0.1 * n, n, 0.0, 0.0, restitution)};
    strike(problem);
    const bool pulls = n.z() < 0.0;
    const Vec3 across = pulls ? Vec3(n - n.dot(up) * up) : n;
    const double impulse = (1.0 + restitution) * speed / (1.0 / hammer + across.dot(n) / mass);
    EXPECT_LE((problem.bodies[1].v - impulse / mass * across).norm(), 1e-13) << angle;
    EXPECT_LE((problem.bodies[2].v - (speed - impulse / hammer) * n).norm(), 1e-13) << angle;
  }
}

TEST(LinkedBlow, RandomChainsHoldTogetherAndGainNoEnergy) {
  std::uint64_t state = 7;
  const auto random = [&state] {
    state = state * 6364136223846793005ull + 1442695040888963407ull;
    return static_cast<double>(state >> 11) * 0x1p-53;
  };
  const auto random_vector = [&random] {
    const double x = random(), y = random(), z = random();
    return Vec3(2.0 * x - 1.0, 2.0 * y - 1.0, 2.0 * z - 1.0);
  };
  double parted = 0.0, approach = 0.0, beyond_cone = 0.0;
  for (int trial = 0; trial < 400; ++trial) {
    ContactProblem problem;
    problem.bodies = {fixed_body(Vec3(0, 0, -5))};
    const int links = 2 + trial % 4;
    for (int i = 0; i < links; ++i) {
      const double mass = 0.2 + 3.0 * random();
      const Vec3 moments = mass * (0.05 * Vec3::Ones() + 0.03 * random_vector().cwiseAbs());
      problem.bodies.push_back(
          moving_body(mass, moments, Vec3(i, 0, 0), random_vector() - Vec3(0, 0, 2), random_vector()));
    }
    const auto last = static_cast<std::uint32_t>(links);
    for (std::uint32_t i = 1; i < last; ++i) add_ball_joint(problem, i, i + 1, Vec3(i - 0.5, 0.1, 0));
    if (trial % 2 == 0) add_rope(problem, 1, last);
    const int contacts = 1 + trial % 3;
    for (int i = 0; i < contacts; ++i) {
      const std::uint32_t body = 1 + (static_cast<std::uint32_t>(trial + i) % last);
      const Vec3 point = problem.bodies[body].x + 0.3 * random_vector() - Vec3(0, 0, 0.3);
      const double friction = trial % 5 == 0 ? 0.0 : random(), restitution = random();
      problem.contacts.push_back(
          contact_at(problem, 0, body, point, Vec3::UnitZ(), 0.0, friction, restitution));
    }
    problem.h = 1.0;
    prepare(problem, kNoSlop);
    const double before = kinetic_energy(problem);
    reflect(problem);
    EXPECT_LE(kinetic_energy(problem), before * (1.0 + 1e-12)) << trial;
    for (const ScalarRow& row : problem.rows) {
      const double u =
          row.n.dot(relative_velocity(problem.bodies[row.a], problem.bodies[row.b], row.rA, row.rB));
      parted = std::max(parted, row.is_two_sided() ? std::abs(u) : -u);
    }
    for (const PointContact& c : problem.contacts) {
      const Vec3 u = relative_velocity(problem.bodies[c.a], problem.bodies[c.b], c.rA, c.rB);
      const double p_t = std::sqrt(c.lambda.y() * c.lambda.y() + c.lambda.z() * c.lambda.z());
      approach = std::max(approach, -u.dot(c.n));
      beyond_cone = std::max(beyond_cone, p_t - c.friction * c.lambda.x());
    }
  }
  EXPECT_LE(parted, 1e-8);
  EXPECT_LE(approach, 1e-8);
  EXPECT_LE(beyond_cone, 1e-12);
}

}  // namespace
}  // namespace tumble
