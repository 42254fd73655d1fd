// Simultaneous impacts on contact problems alone. 100 000 random blows are run by ./run bench impacts.
#include "dynamics/reflection.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/random_blows.h"

namespace tumble {
namespace {

using namespace test;

TEST(Reflection,
     RandomBlowsWithFrictionGainNoEnergyAndStayInTheCone) {  // 1500 of 100 000 for each number of points
  for (const int points : {1, 3, 4}) {
    const BlowTally tally = strike_random_boxes(points, 1500);
    EXPECT_LE(tally.gain, 1e-13) << points;  // 4e-16 of the kinetic energy before
    EXPECT_LE(tally.beyond_cone, 1e-13) << points;
    EXPECT_LE(tally.approach, 1e-8) << points;  // of the speeds before
    EXPECT_LE(tally.momentum, 1e-13) << points;
  }
}

TEST(Reflection, BlowsThatEndAtTheBoundOfPassesAreSafeToo) {
  // 31 of 100 000 blows in three points need more than 32 passes. With a bound of one, one in ten ends there.
  for (const int points : {3, 4}) {
    const BlowTally tally = strike_random_boxes(points, 1500, {.max_passes = 1});
    EXPECT_GE(tally.capped, 100) << points;
    EXPECT_LE(tally.gain, 1e-13) << points;
    EXPECT_LE(tally.beyond_cone, 1e-13) << points;
    EXPECT_LE(tally.approach, 1e-8) << points;
    EXPECT_LE(tally.momentum, 1e-13) << points;
  }
}

TEST(Reflection, DifferentRestitutionsAreClampedWhereTheyWouldGain) {
  // Two contacts on a bar that resist each other: alone, the livelier would give back more than came in.
  ContactProblem problem;
  problem.bodies = {moving_body(1.0, Vec3(0.02, 0.02, 0.02), Vec3::Zero(), Vec3(0, 0, -1)), fixed_body()};
  problem.contacts = {contact_at(problem, 1, 0, Vec3(0.05, 0, -0.1), Vec3::UnitZ(), 0.0, 0.0, 1.0),
                      contact_at(problem, 1, 0, Vec3(-0.04, 0, -0.1), Vec3::UnitZ(), 0.0, 0.0, 0.0)};
  problem.h = 1.0;
  prepare(problem, kNoSlop);
  const double before = kinetic_energy(problem);
  reflect(problem);
  EXPECT_LE(kinetic_energy(problem), before * (1.0 + 1e-14));
}

TEST(Reflection, FourCornersActLikeOneFace) {
  // A box that lands flat leaves as it came, whatever share of the blow each corner takes.
  ContactProblem problem;
  problem.bodies = {fixed_body(), cube(2.0, Vec3(0, 0, 0.5), Vec3(0.3, 0, -2))};
  for (const double x : {-0.5, 0.5}) {
    for (const double y : {-0.5, 0.5}) {
      problem.contacts.push_back(contact_at(problem, 0, 1, Vec3(x, y, 0), Vec3::UnitZ(), 0.0, 0.0, 0.8));
    }
  }
  problem.h = 1.0;
  prepare(problem, kNoSlop);
  const ReflectionReport report = reflect(problem);
  EXPECT_EQ(report.passes, 1);
  EXPECT_LE((problem.bodies[1].v - Vec3(0.3, 0, 1.6)).norm(), 1e-14);
  EXPECT_LE(problem.bodies[1].w.norm(), 1e-14);
}

TEST(Reflection, ThePassesEndInelasticallyAtTheirBound) {
  // A light ball between two heavy ones, of which one comes: each pass hands it from one to the other.
  ContactProblem problem;
  problem.bodies = {ball(1000.0, 0.5, Vec3(-1, 0, 0), Vec3(1, 0, 0)), ball(1.0, 0.5, Vec3::Zero()),
                    ball(1000.0, 0.5, Vec3(1, 0, 0))};
  problem.contacts = {contact_at(problem, 0, 1, Vec3(-0.5, 0, 0), Vec3::UnitX(), 0.0, 0.0, 0.9),
                      contact_at(problem, 1, 2, Vec3(0.5, 0, 0), Vec3::UnitX(), 0.0, 0.0, 0.9)};
  problem.h = 1.0;
  prepare(problem, kNoSlop);
  const double before = kinetic_energy(problem);
  const Momentum momentum_before = momentum(problem);
  const ReflectionReport report = reflect(problem, {.max_passes = 1});
  EXPECT_TRUE(report.capped);
  EXPECT_LE(kinetic_energy(problem), before);
  EXPECT_LE((momentum(problem).linear - momentum_before.linear).norm(), 1e-10);
  for (const PointContact& c : problem.contacts) {
    const Vec3 u = relative_velocity(problem.bodies[c.a], problem.bodies[c.b], c.rA, c.rB);
    EXPECT_GE(u.dot(c.n), -1e-9);
  }
}

}  // namespace
}  // namespace tumble
