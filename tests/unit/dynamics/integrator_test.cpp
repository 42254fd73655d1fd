// Each rival against bodies whose end is known to 17 digits, and what it promises to keep exactly.
#include "dynamics/integrator.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>

#include "support/rotation_cases.h"

namespace tumble {
namespace {

/// The body's motion at the end of the case, in steps of h.
Motion run(const RotationCase& c, IntegrateFunction integrate, double h) {
  const MassProperties mass = principal_body(c.I);
  Motion body = start_of(c);
  const Vec3 L0 = body.L;
  const int steps = static_cast<int>(std::lround(c.time / h));
  for (int i = 0; i < steps; ++i) {
    // From the start of the case, so that no rounding adds up in the given path; `course` has a momentum of its own.
    const Vec3 L1 = integrate == integrate_course ? Vec3(body.L + c.torque * (c.time / steps))
                                                  : Vec3(L0 + c.torque * (c.time * (i + 1) / steps));
    integrate(mass, {Vec3::Zero(), Vec3::Zero(), body.L, L1}, c.time / steps, body);
  }
  return body;
}

double end_error(const RotationCase& c, IntegrateFunction integrate, double h) {
  return angle_between(run(c, integrate, h).q, c.q);
}

double rotation_energy(const Motion& body) {
  return 0.5 * body.w.dot(body.L);
}

// Bounds are about 10 times the errors measured, which stand beside them.
TEST(Taylor8, EndsWhereTheExactSolutionDoes) {
  EXPECT_LT(end_error(kGeneric, integrate_taylor8, 1.0 / 60), 1e-13);   // 1.1e-14
  EXPECT_LT(end_error(kGeneric, integrate_taylor8, 1.0 / 240), 2e-13);  // 1.6e-14
  EXPECT_LT(end_error(kPlate, integrate_taylor8, 1.0 / 60), 3e-13);     // 8.5e-14
  EXPECT_LT(end_error(kPlate, integrate_taylor8, 1.0 / 240), 2e-13);    // 1.3e-13
  EXPECT_LT(end_error(kTorque, integrate_taylor8, 1.0 / 60), 2e-13);    // 2.1e-14
  EXPECT_LT(end_error(kTorque, integrate_taylor8, 1.0 / 240), 2e-13);   // 2.4e-14
  // The rounding of each step, 1e-16, is amplified wherever the body turns over.
  EXPECT_LT(end_error(kDzhanibekov, integrate_taylor8, 1.0 / 60), 3e-6);   // 3.1e-7
  EXPECT_LT(end_error(kDzhanibekov, integrate_taylor8, 1.0 / 240), 4e-7);  // 2.2e-8
  // The rod's small moment amplifies the rounding of its momentum in body axes.
  EXPECT_LT(end_error(kRod, integrate_taylor8, 1.0 / 60), 2e-7);   // 1.6e-8
  EXPECT_LT(end_error(kRod, integrate_taylor8, 1.0 / 240), 8e-8);  // 6.3e-9
}

TEST(Taylor8, AngularVelocityAtTheEndIsTheExactOne) {
  for (const RotationCase& c : {kGeneric, kPlate, kTorque}) {
    const Motion body = run(c, integrate_taylor8, 1.0 / 240);
    EXPECT_LT((body.q.conjugate() * body.w - c.w_B).norm(), 1e-12) << c.name;
  }
}

TEST(Taylor8, AFastBodyIsSubSteppedToTheSameEnd) {
  // 7.5 rad/s in steps of 1 s: 75 sub-steps each.
  EXPECT_LT(end_error(kPlate, integrate_taylor8, 1.0), 6e-11);  // 6.3e-12
}

TEST(Taylor8, ABodySpunUpFromRestWithinOneStepIsSubStepped) {
  const MassProperties mass = principal_body(kPlate.I);
  const Vec3 L1(1.0, -0.5, 2.0);
  const auto turned = [&](int steps) {
    Motion body;
    for (int i = 0; i < steps; ++i) {
      const VelocityPath path{Vec3::Zero(), Vec3::Zero(), L1 * i / steps, L1 * (i + 1) / steps};
      integrate_taylor8(mass, path, 1.0 / steps, body);
    }
    return body.q;
  };
  EXPECT_LT(angle_between(turned(1), turned(400)), 3e-12);  // 3.4e-13
}

TEST(Taylor8, ErrorFallsWithTheEighthPowerWhereTheSeriesIsCutOff) {
  // 0.0995 and 0.067 rad a step, both without sub-steps: 1.5^8 = 25. Measured 73.
  EXPECT_GT(end_error(kPlate, integrate_taylor8, 1.0 / 75.2),
            20 * end_error(kPlate, integrate_taylor8, 1.0 / 112));
}

TEST(Dmv8, EndsNearTheExactSolutionAndKeepsTheEnergy) {
  EXPECT_LT(end_error(kGeneric, integrate_dmv8, 1.0 / 60), 1e-13);   // 1.0e-14
  EXPECT_LT(end_error(kGeneric, integrate_dmv8, 1.0 / 240), 2e-13);  // 2.1e-14
  EXPECT_LT(end_error(kPlate, integrate_dmv8, 1.0 / 60), 4e-10);     // 3.7e-11
  EXPECT_LT(end_error(kPlate, integrate_dmv8, 1.0 / 240), 2e-12);    // 1.8e-13
  EXPECT_LT(end_error(kRod, integrate_dmv8, 1.0 / 60), 3e-8);        // 2.9e-9
  EXPECT_LT(end_error(kTorque, integrate_dmv8, 1.0 / 60), 3e-4);     // 2.5e-5: order 2 under torque
  EXPECT_LT(end_error(kTorque, integrate_dmv8, 1.0 / 240), 2e-5);    // 1.6e-6
  const double energy = rotation_energy(start_of(kPlate));
  EXPECT_NEAR(rotation_energy(run(kPlateLong, integrate_dmv8, 1.0 / 60)) / energy, 1.0, 1e-13);
}

TEST(Dmv8, AFastBodyIsSubSteppedToTheSameEnd) {
  EXPECT_LT(end_error(kPlate, integrate_dmv8, 1.0), 5e-7);  // 25 turns of 0.3 rad a step
}

TEST(ClosedForm, EndsWhereTheExactSolutionDoes) {
  // Made anew at each step: each start rounds. One flight over the whole time is exacter, see FreeRotation.
  EXPECT_LT(end_error(kGeneric, integrate_closed_form, 1.0 / 60), 7e-13);  // 6.6e-14
  EXPECT_LT(end_error(kPlate, integrate_closed_form, 1.0 / 60), 9e-13);    // 8.3e-14
  EXPECT_LT(end_error(kPlate, integrate_closed_form, 1.0), 1e-12);         // 1.1e-13
  EXPECT_LT(end_error(kTorque, integrate_closed_form, 1.0 / 60), 2e-13);   // 2.9e-14
}

TEST(Rk4, EndsWithTheErrorOfItsOrder) {
  EXPECT_LT(end_error(kGeneric, integrate_rk4, 1.0 / 60), 1e-6);   // 2.0e-7
  EXPECT_LT(end_error(kGeneric, integrate_rk4, 1.0 / 240), 5e-9);  // 7.7e-10
  EXPECT_LT(end_error(kPlate, integrate_rk4, 1.0 / 60), 1e-3);     // 1.1e-4
  EXPECT_LT(end_error(kPlate, integrate_rk4, 1.0 / 240), 2e-6);    // 2.5e-7
  EXPECT_LT(end_error(kTorque, integrate_rk4, 1.0 / 60), 1e-4);    // 1.2e-5
  EXPECT_LT(end_error(kTorque, integrate_rk4, 1.0 / 240), 5e-7);   // 4.6e-8
  // Keeping L but not the energy is bad near the separatrix: at 1/60 the body flips at the wrong times (1.2 rad).
  EXPECT_LT(end_error(kDzhanibekov, integrate_rk4, 1.0 / 240), 1e-2);  // 2.3e-3
}

TEST(Integrators, ErrorFallsWithTheirOrder) {
  const auto order = [](IntegrateFunction integrate) {
    return std::log2(end_error(kGeneric, integrate, 1.0 / 120) / end_error(kGeneric, integrate, 1.0 / 240));
  };
  EXPECT_NEAR(order(integrate_rk4), 4.0, 0.1);
  // From a smaller step, where 10 s of the first-order scheme still resemble the motion.
  const double coarse = end_error(kGeneric, integrate_semi_implicit_euler, 1.0 / 1000);
  const double fine = end_error(kGeneric, integrate_semi_implicit_euler, 1.0 / 2000);
  EXPECT_NEAR(std::log2(coarse / fine), 1.0, 0.2);
}

TEST(Course, DoesNotConvergeToTheMotion) {
  // No gyroscopic term: smaller steps end at the same wrong orientation.
  const double coarse = end_error(kGeneric, integrate_course, 1.0 / 60);
  const double fine = end_error(kGeneric, integrate_course, 1.0 / 960);
  EXPECT_GT(coarse, 0.5);
  EXPECT_NEAR(coarse, fine, 0.05);
}

TEST(Integrators, AllButCourseKeepTheMomentumToTheBit) {
  for (const Integrator integrator : {Integrator::semi_implicit_euler, Integrator::rk4, Integrator::taylor8,
                                      Integrator::dmv8, Integrator::closed_form}) {
    const Motion body = run(kPlate, integrate_function(integrator), 1.0 / 60);
    EXPECT_EQ(body.L, kPlate.I.cwiseProduct(kPlate.w0)) << integrator_name(integrator);
    EXPECT_NEAR(body.q.norm(), 1.0, 3e-16);
    EXPECT_EQ(body.w, angular_velocity(principal_body(kPlate.I), body.q, body.L));
  }
  const Motion course = run(kPlate, integrate_course, 1.0 / 60);
  EXPECT_GT((course.L - kPlate.I.cwiseProduct(kPlate.w0)).norm(), 0.1);
}

TEST(Integrators, EnergyErrorFallsFromEulerToRk4ToTaylor8) {
  const double exact = 0.5 * kPlate.w0.dot(kPlate.I.cwiseProduct(kPlate.w0));
  const auto error = [&](IntegrateFunction integrate) {
    return std::abs(rotation_energy(run(kPlate, integrate, 1.0 / 60)) / exact - 1.0);
  };
  const double taylor8 = error(integrate_taylor8), rk4 = error(integrate_rk4),
               euler = error(integrate_semi_implicit_euler);
  EXPECT_LT(taylor8, 1e-13);
  EXPECT_LT(taylor8, 1e-3 * rk4);
  EXPECT_LT(rk4, 1e-3 * euler);
}

TEST(Taylor8, AThrownBodyFallsOnItsParabola) {
  const MassProperties mass = principal_body(Vec3(1, 2, 3));
  const Vec3 g(0.0, 0.0, -9.81), v0(3.0, -1.0, 12.0), x0(1.0, 2.0, 3.0);
  constexpr int kSteps = 600;
  constexpr double h = 1.0 / 60;
  for (const Integrator integrator : {Integrator::taylor8, Integrator::rk4}) {
    Motion body;
    body.x = x0;
    for (int i = 0; i < kSteps; ++i) {
      const VelocityPath path{v0 + g * (i * h), v0 + g * ((i + 1) * h), Vec3::Zero(), Vec3::Zero()};
      integrate_function(integrator)(mass, path, h, body);
    }
    const double t = kSteps * h;
    EXPECT_LT((body.x - (x0 + v0 * t + 0.5 * t * t * g)).norm(), 1e-11);
    EXPECT_EQ(body.v, v0 + g * (kSteps * h));
    EXPECT_EQ(body.q.coeffs(), Quat::Identity().coeffs());
  }
}

TEST(Integrators, CourseAndEulerDriftWithTheEndVelocity) {
  const MassProperties mass = principal_body(Vec3(1, 2, 3));
  const VelocityPath path{Vec3(1, 2, 3), Vec3(0.5, -1, 0.25), Vec3::Zero(), Vec3::Zero()};
  for (const Integrator integrator : {Integrator::course, Integrator::semi_implicit_euler}) {
    Motion body;
    body.x = Vec3(7, 8, 9);
    integrate_function(integrator)(mass, path, 0.125, body);
    EXPECT_EQ(body.x, Vec3(Vec3(7, 8, 9) + 0.125 * path.v1));
    EXPECT_EQ(body.v, path.v1);
  }
}

TEST(Course, IsItsFormula) {
  // w(t+dt) = w + dt M^-T I^-1 M^T tau;  q(t+dt) = q(t) q_r(dt);  w stays over the turn.
  const MassProperties mass = principal_body(Vec3(0.5, 0.75, 1.2));
  const double h = 1.0 / 60;
  const Vec3 torque(1.0, -2.0, 0.5);
  Motion body;
  body.q = exp_map(Vec3(0.3, -0.8, 0.4));
  body.w = Vec3(6, -2, 4);
  body.L = angular_momentum(mass, body.q, body.w);
  const Vec3 w1 = body.w + h * world_inertia(mass.inv_I, mass.q_BP, body.q) * torque;
  const Quat q1 = exp_map(h * w1) * body.q;
  integrate_course(mass, {Vec3::Zero(), Vec3::Zero(), body.L, body.L + h * torque}, h, body);
  EXPECT_LT((body.w - w1).norm(), 1e-14);
  EXPECT_LT(angle_between(body.q, q1), 1e-15);
  EXPECT_LT((body.L - angular_momentum(mass, q1, w1)).norm(), 1e-14);
}

TEST(Taylor8, ABallTurnsExactlyAtAnySpeedAndStep) {
  const MassProperties ball = compute_mass_properties(compute_inertia(Sphere{0.5}, 1000.0));
  const Vec3 axis(2.0 / 7, 3.0 / 7, 6.0 / 7);
  Motion body;
  const Vec3 L0 = ball.I.x() * 500.0 * axis, L1 = ball.I.x() * 700.0 * axis;
  body.L = L0;
  integrate_taylor8(ball, {Vec3::Zero(), Vec3::Zero(), L0, L1}, 0.5, body);
  EXPECT_LT(angle_between(body.q, exp_map(300.0 * axis)), 1e-13);  // 300 rad: rounding of the angle is 3e-14
  EXPECT_LT((body.w - 700.0 * axis).norm(), 1e-12);
}

TEST(Taylor8, ABallWhoseAxisWandersFollowsTheTorque) {
  const MassProperties ball = principal_body(Vec3(2, 2, 2));
  const auto turned = [&](int steps) {
    Motion body;
    const Vec3 L0(4, 0, 2), torque(-1, 3, 0);
    for (int i = 0; i < steps; ++i) {
      integrate_taylor8(ball,
                        {Vec3::Zero(), Vec3::Zero(), L0 + torque * i / steps, L0 + torque * (i + 1) / steps},
                        1.0 / steps, body);
    }
    return body.q;
  };
  EXPECT_LT(angle_between(turned(1), turned(400)), 1e-14);
  EXPECT_GT(angle_between(turned(1), exp_map(Vec3(1.75, 0.75, 1.0))),
            1e-2);  // not a turn about the mean axis
}

TEST(Taylor8, ABodyWithTiltedPrincipalAxesMovesTheSame) {
  const MassProperties straight = principal_body(kPlate.I);
  MassProperties tilted = straight;
  tilted.q_BP = exp_map(Vec3(0.4, -1.1, 0.7));
  const Vec3 L = kPlate.I.cwiseProduct(kPlate.w0);
  for (const Integrator integrator : {Integrator::semi_implicit_euler, Integrator::rk4, Integrator::taylor8,
                                      Integrator::dmv8, Integrator::closed_form}) {
    Motion a, b;
    b.q = tilted.q_BP.conjugate();
    for (int i = 0; i < 120; ++i) {
      integrate_function(integrator)(straight, {Vec3::Zero(), Vec3::Zero(), L, L}, 1.0 / 60, a);
      integrate_function(integrator)(tilted, {Vec3::Zero(), Vec3::Zero(), L, L}, 1.0 / 60, b);
    }
    EXPECT_LT(angle_between(a.q, b.q * tilted.q_BP), 1e-12) << integrator_name(integrator);
  }
}

TEST(Integrators, StayFiniteAtAbsurdSpeed) {
  const MassProperties mass = principal_body(Vec3(1, 2, 3));
  for (const Integrator integrator : {Integrator::course, Integrator::semi_implicit_euler, Integrator::rk4,
                                      Integrator::taylor8, Integrator::dmv8, Integrator::closed_form}) {
    for (const double speed : {1e3, 1e6, 1e9, 1e20}) {
      Motion body;
      const Vec3 L(speed, -2.0 * speed, 0.5 * speed);
      integrate_function(integrator)(mass, {Vec3::Zero(), Vec3::Zero(), L, L}, 1.0 / 60, body);
      EXPECT_NEAR(body.q.norm(), 1.0, 1e-15) << integrator_name(integrator) << " " << speed;
      EXPECT_TRUE(body.w.allFinite());
    }
  }
}

TEST(InContact, KeepsEnergyHoweverFarAndHoweverThinABodyTurns) {
  for (const Vec3& I : {Vec3(1e-6, 1, 1), Vec3(1e-6, 1, 1 - 5e-7), Vec3(1, 2, 3)}) {
    for (const double turn : {0.1, 1.0, 10.0, 1000.0}) {  // [rad]
      const MassProperties mass = principal_body(I);
      Motion body;
      body.w = turn * 60 * Vec3(0.9, 0.4, 0.2);
      body.L = I.cwiseProduct(body.w);
      const double energy = rotation_energy(body);
      integrate_in_contact(mass, {Vec3::Zero(), Vec3::Zero(), body.L, body.L}, 1.0 / 60, body);
      EXPECT_NEAR(rotation_energy(body) / energy, 1.0, 1e-11) << I.transpose() << ", " << turn;  // 1e-12
    }
  }
}

TEST(InContact, FollowsAThinRodAsTheClosedFormDoes) {
  const MassProperties mass = principal_body(Vec3(1e-6, 1, 1 - 5e-7));
  Motion body, exact;
  body.w = exact.w = Vec3(3.0, 12.0, 5.0);
  body.L = exact.L = mass.I.cwiseProduct(body.w);
  const VelocityPath path{Vec3::Zero(), Vec3::Zero(), body.L, body.L};
  integrate_in_contact(mass, path, 1.0 / 60, body);
  integrate_closed_form(mass, path, 1.0 / 60, exact);
  EXPECT_LT(angle_between(body.q, exact.q), 1e-12);  // 0; by dmv8 alone 6e-6
}

TEST(Kinematic, FollowsItsVelocitiesExactly) {
  Motion body;
  body.v = Vec3(1, -2, 3);
  body.w = Vec3(0.0, 0.0, 2.0);
  for (int i = 0; i < 64; ++i) move_kinematic(body, 1.0 / 64);
  EXPECT_EQ(body.x, Vec3(1, -2, 3));
  EXPECT_LT(angle_between(body.q, exp_map(Vec3(0, 0, 2))), 1e-15);
  EXPECT_EQ(body.v, Vec3(1, -2, 3));
  EXPECT_EQ(body.w, Vec3(0, 0, 2));
}

TEST(Integrators, NamesAndEnumBelongTogether) {
  for (const Integrator integrator : {Integrator::course, Integrator::semi_implicit_euler, Integrator::rk4,
                                      Integrator::taylor8, Integrator::dmv8, Integrator::closed_form}) {
    EXPECT_EQ(integrator_from_name(integrator_name(integrator)), integrator);
  }
  EXPECT_EQ(integrator_from_name("euler"), std::nullopt);
  EXPECT_STREQ(integrator_name(Integrator::semi_implicit_euler), "semi_implicit_euler");
}

}  // namespace
}  // namespace tumble
