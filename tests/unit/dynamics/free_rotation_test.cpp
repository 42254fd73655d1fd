// The closed form against bodies whose end is known to 17 digits, the values inside it against 40-digit arithmetic, and
// what holds at any time.
#include "dynamics/free_rotation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "support/rotation_cases.h"

namespace tumble {
namespace {

FreeRotation rotation_of(const RotationCase& c) {
  return {principal_body(c.I), start_of(c)};
}

struct Bound {
  const RotationCase& rotation;
  double angle;     ///< [rad]
  double velocity;  ///< [rad/s]
};

// Bounds are 10 times the errors measured, which stand beside them (angle, velocity).
TEST(FreeRotation, EndsWhereTheExactSolutionDoes) {
  const std::vector<Bound> bounds = {
      {kGeneric, 5e-14, 5e-14},          // 5.0e-15, 1.3e-15
      {kGenericLong, 7e-12, 2e-12},      // 6.4e-13, 1.3e-13
      {kDzhanibekov, 8e-14, 1e-13},      // 8.8e-15, 3.1e-14: what the last place of its rate makes in 10 s
      {kDzhanibekovLong, 1e-11, 1e-13},  // 9.9e-13, 4.5e-15
      {kPlate, 2e-13, 4e-13},            // 3.9e-15, 3.2e-14
      {kPlateLong, 2e-11, 3e-11},        // 2.7e-13, 2.7e-12
      {kRod, 7e-14, 5e-13},              // 3.3e-14, 3.8e-14
      {kNearSymmetric, 8e-15, 3e-15},    // 2.2e-16, 2.2e-16
      {kNearSpin, 1e-14, 1e-15},         // 1.4e-15, 1.0e-23
      {kSeparatrix, 2e-14, 2e-14},       // 1.3e-15, 3.6e-15: the last place of |w|
  };
  for (const Bound& bound : bounds) {
    const RotationCase& c = bound.rotation;
    const FreeRotation::State end = rotation_of(c).at(c.time);
    EXPECT_LT(angle_between(end.q_WB, c.q), bound.angle) << c.name;
    EXPECT_LT((end.q_WB.conjugate() * end.w_WB - c.w_B).norm(), bound.velocity) << c.name;
  }
}

/// One column of values of the generic motion, to all digits of a double.
struct Column {
  Vec3 I, w;  // sorted
  double A, C, m, m1, w_p, K, K1, excess, u0, F, E_v, precession;
};

TEST(FreeRotation, ValuesInsideAreThoseOf40DigitArithmetic) {
  const std::vector<Column> columns = {
      {Vec3(1.0, 0.8, 0.6), Vec3(-0.9, -0.5, 3.0), 0.36400000000000005, 2.2, 0.16545454545454538,
       0.83454545454545462, -0.95742710775633827, 1.6426136897500093, 2.343849610819954, 0.0845968168523308,
       -2.9462893577000839, 1.0344797413452776, 0.81318910110803854, 2.3439998146177994},
      {Vec3(0.5, 0.75, 1.2), Vec3(6.0, -2.0, 4.0), 13.949999999999999, 14.189999999999999,
       0.54615926708949972, 0.45384073291050028, 3.7669616403674723, 1.8952910912196605, 1.8168263365658318,
       0.29983027133808091, -0.31922909974983509, 0.74110515696896373, 0.68808680062875081,
       9.1747487196607849},
      {Vec3(1.0, 2.0, 3.0), Vec3(1e-3, 5.0, 1e-3), 50.000002, 50.000006, 0.9999999200000096,
       7.9999990400001155e-8, 2.8867515191532044, 9.5569141933944192, 1.5707963582108208, 0.89536367680608545,
       8.8984352144419253, 0.52359877741002015, 0.52359877378657761, 5.3163156011427352}};
  for (const Column& c : columns) {
    const Tumbling::Invariants found = Tumbling::compute_invariants(c.I, c.w, c.I.cwiseProduct(c.w).norm());
    const auto near = [&](const char* name, double value, double expected) {
      EXPECT_NEAR(value, expected, 3e-15 * std::abs(expected)) << name;  // largest measured: 1.4e-15
    };
    near("A", found.A, c.A);
    near("C", found.C, c.C);
    near("m", found.m, c.m);
    near("m1", found.m1, c.m1);
    near("w_p", found.w_p, c.w_p);
    near("K", found.K, c.K);
    near("K'", found.K1, c.K1);
    near("1-E/K", found.excess, c.excess);
    near("u0", found.u0, c.u0);
    near("F", found.F, c.F);
    near("E_v", found.E_v, c.E_v);
    near("precession", found.precession, c.precession);
  }
}

TEST(FreeRotation, StartsWhereItWasTold) {
  for (const RotationCase* c : {&kGeneric, &kDzhanibekov, &kPlate, &kRod, &kSeparatrix}) {
    Motion start = start_of(*c);
    const Quat turn = exp_map(Vec3(0.3, -1.2, 2.0));
    start.q = turn;
    start.w = turn * start.w;
    start.L = turn * start.L;
    const FreeRotation::State state = FreeRotation(principal_body(c->I), start).at(0.0);
    EXPECT_LT(angle_between(state.q_WB, start.q), 5e-16) << c->name;
    EXPECT_LT((state.w_WB - start.w).norm(), 1e-14 * start.w.norm()) << c->name;
  }
}

TEST(FreeRotation, ABodyWithTiltedPrincipalAxesMovesTheSame) {
  const MassProperties straight = principal_body(kPlate.I);
  MassProperties tilted = straight;
  tilted.q_BP = exp_map(Vec3(0.4, -1.1, 0.7));
  Motion start = start_of(kPlate);
  const FreeRotation::State a = FreeRotation(straight, start).at(10.0);
  start.q = tilted.q_BP.conjugate();
  const FreeRotation::State b = FreeRotation(tilted, start).at(10.0);
  EXPECT_LT(angle_between(a.q_WB, b.q_WB * tilted.q_BP), 2e-13);
  EXPECT_LT((a.w_WB - b.w_WB).norm(), 1e-12);
}

TEST(FreeRotation, SpheresAndPureSpinsTurnAboutTheirAxis) {
  const Vec3 w(0.0, 5.0, 0.0);
  for (const Vec3& I : {Vec3(2, 2, 2), Vec3(1, 2, 3), Vec3(2, 1, 3), Vec3(1, 3, 2), Vec3(2, 1, 2)}) {
    Motion start;
    start.w = w;
    start.L = I.cwiseProduct(w);
    // The middle axis of (1, 2, 3) too: nothing tips it over, however long.
    const FreeRotation::State end = FreeRotation(principal_body(I), start).at(1000.0);
    EXPECT_LT(angle_between(end.q_WB, exp_map(1000.0 * w)), 1e-12);
    EXPECT_LT((end.w_WB - w).norm(), 1e-14);
  }
}

TEST(FreeRotation, ASymmetricTopPrecessesAboutItsMomentum) {
  // Precession L/I_1 about L, spin w_3 (1 - I_3/I_1) about its own axis.
  const Vec3 I(2.0, 2.0, 3.0), w(0.5, -1.0, 4.0);
  Motion start;
  start.w = w;
  start.L = I.cwiseProduct(w);
  const double t = 7.0;
  const FreeRotation::State end = FreeRotation(principal_body(I), start).at(t);
  const Quat expected = exp_map(t / 2.0 * start.L) * exp_map(Vec3(0, 0, t * 4.0 * (1.0 - 3.0 / 2.0)));
  EXPECT_LT(angle_between(end.q_WB, expected), 1e-14);
  EXPECT_LT((end.w_WB - angular_velocity(principal_body(I), end.q_WB, start.L)).norm(), 1e-14);
}

TEST(FreeRotation, ABodyAtRestStaysThere) {
  const FreeRotation::State end = FreeRotation(principal_body(Vec3(1, 2, 3)), Motion{}).at(1e4);
  EXPECT_EQ(end.q_WB.coeffs(), Quat::Identity().coeffs());
  EXPECT_TRUE(end.w_WB.isZero(0.0));
}

}  // namespace
}  // namespace tumble
