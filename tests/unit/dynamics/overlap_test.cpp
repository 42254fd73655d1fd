// Overlaps removed at position level: how far, who gives way, and what happens where nothing can.
#include "dynamics/overlap.h"

#include <gtest/gtest.h>

#include "support/island_problem.h"

namespace tumble {
namespace {

using namespace test;

/// More than any overlap in here in one step.
constexpr OverlapSettings kAtOnce{.speed = 1e3};

/// What contact i lacks after the shifts, the bodies not moving otherwise [m].
double lack(const ContactProblem& problem, const PointContact& c) {
  const SolverBody &A = problem.bodies[c.a], &B = problem.bodies[c.b];
  const Vec3 moved = B.shift + B.turn.cross(c.rB) - A.shift - A.turn.cross(c.rA);
  return -c.separation - c.n.dot(moved);
}

void stop(ContactProblem& problem) {
  for (SolverBody& body : problem.bodies) body.v = body.w = body.v0 = body.w0 = Vec3::Zero();
  prepare(problem, {.slop = 0.0, .push_fraction = 0.0, .push_speed = 0.0});
}

TEST(Overlap, OfAStackAtTheGroundLiftsAllAndGivesNoSpeed) {
  ContactProblem problem = stack_problem(10);
  stop(problem);
  for (PointContact& c : problem.contacts) c.separation = c.a == 0 ? -0.003 : 0.0;
  const OverlapReport report = remove_overlaps(problem, kAtOnce);
  EXPECT_LE(report.factorizations, 12);  // measured: see README of dynamics
  for (const SolverBody& body : problem.bodies) {
    if (body.inv_mass == 0.0) continue;
    EXPECT_NEAR(body.shift.z(), 0.003, 1e-6);  // measured: 2.9e-7
    EXPECT_LE(body.turn.norm(), 1e-6);
    EXPECT_TRUE(body.v.isZero(0.0) && body.w.isZero(0.0));
  }
}

TEST(Overlap, IsRemovedNoFasterThanAsked) {
  ContactProblem problem = stack_problem(1);
  stop(problem);
  for (PointContact& c : problem.contacts) c.separation = -0.3;
  remove_overlaps(problem, {.speed = 3.0});
  EXPECT_NEAR(problem.bodies[1].shift.z(), 3.0 / 60.0, 1e-6);
}

TEST(Overlap, BelowRoundingIsNone) {
  ContactProblem problem = stack_problem(3);
  stop(problem);
  for (PointContact& c : problem.contacts) c.separation = -5e-11;
  const OverlapReport report = remove_overlaps(problem, kAtOnce);
  EXPECT_EQ(report.factorizations, 0);
  EXPECT_EQ(report.largest, 0.0);
}

TEST(Overlap, BetweenWallsThatBothOverlapEndsInTheMiddle) {
  ContactProblem problem;
  problem.h = 1.0 / 60.0;
  add_cube(problem, 0.0, Vec3(-1, 0, 0));
  add_cube(problem, 0.0, Vec3(1, 0, 0));
  add_sphere(problem, 1.0, 0.5, Vec3::Zero());
  add_contact(problem, 0, 2, Vec3(-0.5, 0, 0), Vec3::UnitX(), 0.5, -0.02);
  add_contact(problem, 1, 2, Vec3(0.5, 0, 0), -Vec3::UnitX(), 0.5, -0.05);
  stop(problem);
  remove_overlaps(problem, kAtOnce);
  EXPECT_NEAR(problem.bodies[2].shift.x(), -0.015, 1e-7);
}

/// Random overlaps of a random graph: the displacement is the least that removes them, by the conditions of Karush, Kuhn
/// and Tucker: M dx = J^T f with forces f >= 0 of contacts that end closed. Then nothing moves as a whole either.
TEST(Overlap, TakesTheShortestWay) {
  for (std::uint32_t seed = 1; seed <= 30; ++seed) {
    ContactProblem problem = random_problem(seed, 6, 9);
    stop(problem);
    std::uint32_t i = 0;
    for (PointContact& c : problem.contacts) c.separation = ++i % 3 == 0 ? 0.01 : -1e-3 * i;
    const OverlapReport report = remove_overlaps(problem, kAtOnce);
    EXPECT_LE(report.factorizations, 10);
    double largest = 0.0;
    for (const PointContact& c : problem.contacts) largest = std::max(largest, lack(problem, c));
    EXPECT_LE(largest, 1e-7) << seed;
    double mass = 0.0;
    for (const SolverBody& body : problem.bodies) mass += body.inv_mass > 0.0 ? 1.0 / body.inv_mass : 0.0;
    std::vector<Vec3> p(problem.bodies.size(), Vec3::Zero()), L = p;
    for (std::size_t k = 0; k < problem.contacts.size(); ++k) {
      const PointContact& c = problem.contacts[k];
      const double f = (1e6 * c.mass_n + 1e3 * mass) * std::max(0.0, lack(problem, c));
      p[c.a] -= f * c.n;
      L[c.a] -= f * c.rA.cross(c.n);
      p[c.b] += f * c.n;
      L[c.b] += f * c.rB.cross(c.n);
    }
    for (std::size_t k = 0; k < problem.bodies.size(); ++k) {
      const SolverBody& body = problem.bodies[k];
      EXPECT_LE((body.shift - body.inv_mass * p[k]).norm(), 1e-6) << seed;
      EXPECT_LE((body.turn - body.inv_I_W * L[k]).norm(), 1e-6) << seed;
    }
  }
}

/// Under a million times its mass, on a slope of 0.01 rad, a light body would rather go 0.1 m aside than lift by 1 mm.
TEST(Overlap, DrawsNobodyOutOfATower) {
  ContactProblem problem = stack_problem(2);
  problem.bodies[2].inv_mass *= 1e-6;
  problem.bodies[2].inv_I_W *= 1e-6;
  for (PointContact& c : problem.contacts) {
    if (c.a != 0) c.n = Vec3(std::sin(0.01), 0, std::cos(0.01));
    set_tangents(c);
  }
  stop(problem);
  for (PointContact& c : problem.contacts) c.separation = c.a == 0 ? 0.0 : -0.001;
  const OverlapReport report = remove_overlaps(problem, kAtOnce);
  // 1.0e-4 m; 0.1 m if the weight on top counted in full.
  EXPECT_NEAR(problem.bodies[1].shift.norm(), 10.0 * 0.01 * 0.001, 2e-6);
  EXPECT_NEAR(problem.bodies[2].shift.z(), 0.001, 1e-5);
  EXPECT_LE(report.largest, 1.1e-3);
}

TEST(Overlap, OfFreeBodiesMovesNothingAsAWhole) {
  ContactProblem problem;
  problem.h = 1.0 / 60.0;
  add_cube(problem, 1.0, Vec3(0, 0, 0));
  add_cube(problem, 3.0, Vec3(0.9, 0.3, 0.1));
  add_contact(problem, 0, 1, Vec3(0.45, 0.2, 0.3), Vec3::UnitX(), 0.5, -0.1);
  stop(problem);
  remove_overlaps(problem, kAtOnce);
  Vec3 shift = Vec3::Zero(), turn = Vec3::Zero();
  for (const SolverBody& body : problem.bodies) {
    shift += body.shift / body.inv_mass;
    turn += body.x.cross(body.shift) / body.inv_mass + body.inv_I_W.inverse() * body.turn;
  }
  EXPECT_LE(shift.norm(), 1e-10);  // of 0.1 m
  EXPECT_LE(turn.norm(), 1e-10);
  EXPECT_NEAR(lack(problem, problem.contacts[0]), 0.0, 1e-6);
}

}  // namespace
}  // namespace tumble
