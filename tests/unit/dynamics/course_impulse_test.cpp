// The collision formulas of the course's slides (session 6, "Angular collision impulse"), one test a formula.
#include <gtest/gtest.h>

#include "dynamics/impact.h"
#include "support/problem_builder.h"

namespace tumble {
namespace {

using namespace test;

constexpr double kRound = 4e-16;

const Vec3 kN = Vec3(1.0, 2.0, -2.0) / 3.0;
const Vec3 kArmA(0.3, -0.2, 0.5), kArmB(-0.4, 0.1, 0.25);

/// Two bodies with unequal moments about tilted axes, in rotation.
ContactProblem two_bodies(double restitution) {
  ContactProblem problem;
  problem.h = 1.0 / 240.0;
  problem.bodies.push_back(
      moving_body(2.0, Vec3(0.3, 0.5, 0.7), Vec3(0, 0, 0), Vec3(1, 2, -1), Vec3(0.5, -1, 2)));
  problem.bodies.push_back(
      moving_body(3.0, Vec3(0.9, 0.6, 0.4), Vec3(1, 2, 3), Vec3(-2, -1, 1), Vec3(1, 1, -0.5)));
  for (SolverBody& body : problem.bodies) {
    const Mat3 R = exp_map(Vec3(0.3, -0.7, 0.4)).toRotationMatrix();
    body.inv_I_W = R * body.inv_I_W * R.transpose();
  }
  PointContact c;
  c.a = 0;
  c.b = 1;
  c.n = kN;
  c.rA = kArmA;
  c.rB = kArmB;
  c.separation = 0.0;
  c.friction = 0.0;
  c.restitution = restitution;
  set_tangents(c);
  problem.contacts.push_back(c);
  prepare(problem, kNoSlop);
  return problem;
}

/// v_c = n . v_A - n . v_B with the velocity of a surface point v = v_r x x' + v_l.
double closing_velocity(const ContactProblem& problem) {
  const SolverBody &A = problem.bodies[0], &B = problem.bodies[1];
  return kN.dot(A.w.cross(kArmA) + A.v) - kN.dot(B.w.cross(kArmB) + B.v);
}

TEST(CourseImpulse, ClosingVelocityIsOfTheSurfacePoints) {
  const ContactProblem problem = two_bodies(0.0);
  EXPECT_NEAR(problem.contacts[0].un0, -closing_velocity(problem), kRound);
}

TEST(CourseImpulse, UnitImpulseChangesTranslationByNormalOverMass) {
  const ContactProblem problem = two_bodies(0.0);
  const UnitImpulse unit = unit_impulse(problem.bodies[0], problem.bodies[1], kN, kArmA, kArmB);
  EXPECT_LT((unit.dv_A - (-kN / 2.0)).norm(), kRound);
  EXPECT_LT((unit.dv_B - kN / 3.0).norm(), kRound);
}

TEST(CourseImpulse, UnitImpulseChangesRotationByInverseWorldInertiaTimesLeverArmCrossNormal) {
  const ContactProblem problem = two_bodies(0.0);
  const SolverBody &A = problem.bodies[0], &B = problem.bodies[1];
  const UnitImpulse unit = unit_impulse(A, B, kN, kArmA, kArmB);
  EXPECT_LT((A.inv_I_W.inverse() * unit.dw_A - kArmA.cross(-kN)).norm(), 1e-15);
  EXPECT_LT((B.inv_I_W.inverse() * unit.dw_B - kArmB.cross(kN)).norm(), 1e-15);
}

TEST(CourseImpulse, UnitImpulseChangesTheClosingVelocityByTheSumOfBothDeltaS) {
  ContactProblem problem = two_bodies(0.0);
  SolverBody &A = problem.bodies[0], &B = problem.bodies[1];
  const UnitImpulse unit = unit_impulse(A, B, kN, kArmA, kArmB);
  // delta v = delta v_l + delta v_r x x', delta s = delta v . n, of both objects
  const double ds_A = (unit.dv_A + unit.dw_A.cross(kArmA)).dot(kN);
  const double ds_B = (unit.dv_B + unit.dw_B.cross(kArmB)).dot(kN);
  EXPECT_NEAR(unit.ds, ds_B - ds_A, kRound);
  const double before = closing_velocity(problem);
  A.v += unit.dv_A;
  A.w += unit.dw_A;
  B.v += unit.dv_B;
  B.w += unit.dw_B;
  EXPECT_NEAR(before - closing_velocity(problem), unit.ds, 2e-15);
}

TEST(CourseImpulse, FractionOfTheUnitImpulseGivesTheSeparatingVelocity) {
  for (const double restitution : {0.0, 0.3, 0.8, 1.0}) {
    const double v_c = 2.5, ds = 0.75;
    const double f = impulse_fraction(-v_c, restitution, ds);
    EXPECT_NEAR(v_c - f * ds, -restitution * v_c, kRound) << "-C_r v_c = v_s = v_c - f (ds_A + ds_B)";
  }
}

TEST(CourseImpulse, SolverAppliesTheFractionToBothVelocities) {
  ContactProblem problem = two_bodies(0.6);
  const std::vector<SolverBody> before = problem.bodies;
  const double v_c = closing_velocity(problem);
  ASSERT_GT(v_c, 1.0);
  solve_course_impulse(problem, {});
  EXPECT_NEAR(closing_velocity(problem), -0.6 * v_c, 4e-15);
  const UnitImpulse unit = unit_impulse(before[0], before[1], kN, kArmA, kArmB);
  const double f = problem.contacts[0].lambda.x();
  EXPECT_LT((problem.bodies[0].v - (before[0].v + f * unit.dv_A)).norm(), kRound);
  EXPECT_LT((problem.bodies[0].w - (before[0].w + f * unit.dw_A)).norm(), kRound);
  EXPECT_LT((problem.bodies[1].v - (before[1].v + f * unit.dv_B)).norm(), kRound);
  EXPECT_LT((problem.bodies[1].w - (before[1].w + f * unit.dw_B)).norm(), kRound);
}

TEST(CourseImpulse, WithoutLeverArmsItIsTheTextbookTwoBodyCollision) {
  const double m1 = 2.0, m2 = 5.0, v1 = 3.0, v2 = -1.0, e = 0.7;
  ContactProblem problem;
  problem.h = 1.0 / 240.0;
  problem.bodies = {ball(m1, 0.5, Vec3(0, 0, 0), Vec3(v1, 0, 0)),
                    ball(m2, 0.5, Vec3(1, 0, 0), Vec3(v2, 0, 0))};
  problem.contacts = {contact_at(problem, 0, 1, Vec3(0.5, 0, 0), Vec3::UnitX(), 0.0, 0.0, e)};
  prepare(problem, kNoSlop);
  solve_course_impulse(problem, {});
  EXPECT_NEAR(problem.bodies[0].v.x(), (m1 * v1 + m2 * v2 - m2 * e * (v1 - v2)) / (m1 + m2), 1e-15);
  EXPECT_NEAR(problem.bodies[1].v.x(), (m1 * v1 + m2 * v2 + m1 * e * (v1 - v2)) / (m1 + m2), 1e-15);
}

TEST(CourseImpulse, MicrocollisionGivesNoRestitutionToOneStepOfAcceleration) {
  for (const double v0 : {0.0, -2.0}) {
    ContactProblem problem;
    problem.h = 1.0 / 240.0;
    problem.bodies = {fixed_body(), ball(1.0, 0.5, Vec3(0, 0, 0.5), Vec3(0, 0, v0))};
    problem.contacts = {contact_at(problem, 0, 1, Vec3::Zero(), Vec3::UnitZ(), 0.0, 0.0, 0.9)};
    apply_gravity(problem);
    prepare(problem, kNoSlop);
    solve_course_impulse(problem, {});
    EXPECT_NEAR(problem.bodies[1].v.z(), -0.9 * v0, kRound) << "at rest it stays at rest; the rest bounces";
  }
}

TEST(CourseImpulse, InterpenetrationIsResolvedWithRotation) {
  // A cube whose corner region overlaps the floor: both the linear and the angular share of the unit impulse move it.
  ContactProblem problem;
  problem.h = 1.0 / 240.0;
  problem.bodies = {fixed_body(), cube(1.0, Vec3(0, 0, 0.5))};
  problem.contacts = {contact_at(problem, 0, 1, Vec3(0.5, 0.5, 0), Vec3::UnitZ(), -0.01, 0.5)};
  prepare(problem, {.slop = 0.0, .push_fraction = 1.0, .push_speed = 100.0});
  solve_course_impulse(problem, {});
  const SolverBody& body = problem.bodies[1];
  const Vec3& r = problem.contacts[0].rB;
  EXPECT_NEAR((body.shift + body.turn.cross(r)).z(), 0.01, 1e-17)
      << "all of the overlap, none of it as velocity";
  EXPECT_TRUE(body.v.isZero(0.0) && body.w.isZero(0.0));
  // 1/m : (r x n) . I^-1 (r x n) = 1 : 6 (1/4 + 1/4) = 1 : 3
  EXPECT_NEAR(body.shift.z(), 0.01 / 4.0, 1e-17);
  EXPECT_NEAR(body.turn.cross(r).z(), 0.03 / 4.0, 1e-17);
  // The pose itself: the corner comes out of the floor but for the second order of the turn.
  const Vec3 corner = body.shift + exp_map(body.turn) * r - r;
  EXPECT_NEAR(corner.z(), 0.01, 1e-4);
}

TEST(CourseImpulse, TwoMovingBodiesShareTheOverlapByInverseMass) {
  ContactProblem problem;
  problem.h = 1.0 / 240.0;
  problem.bodies = {ball(1.0, 0.5, Vec3(0, 0, 0)), ball(3.0, 0.5, Vec3(0.98, 0, 0))};
  problem.contacts = {contact_at(problem, 0, 1, Vec3(0.49, 0, 0), Vec3::UnitX(), -0.02, 0.0)};
  prepare(problem, {.slop = 0.0, .push_fraction = 1.0, .push_speed = 100.0});
  solve_course_impulse(problem, {});
  EXPECT_NEAR(problem.bodies[0].shift.x(), -0.015, 1e-17);
  EXPECT_NEAR(problem.bodies[1].shift.x(), 0.005, 1e-17);
}

}  // namespace
}  // namespace tumble
