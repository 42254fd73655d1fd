// The course's formulas, one test each, quoted in its first comment (slides: Game Physics, session 6: angular momentum).
// Letters as on the slides: v_r angular velocity, v_l linear velocity, x' lever arm from the centre of mass, p momentum,
// M the model matrix's rotation. The collision impulse has a file of its own.
#include <gtest/gtest.h>

#include <cmath>

#include "dynamics/integrator.h"

namespace tumble {
namespace {

const Vec3 v_l(0.4, -1.0, 2.0);
const Vec3 v_r(0.6, -1.5, 2.0);
const Vec3 x_prime(0.3, 0.1, -0.2);
const Quat kOrientation = exp_map(Vec3(0.5, -0.7, 1.1));

MassProperties brick() {
  return compute_mass_properties(compute_inertia(Box{Vec3(0.2, 0.3, 0.5)}, 1000.0));
}
Mat3 object_inertia() {
  return brick().I.asDiagonal();
}
/// For a rotation M^-T = M, but the formulas are tested as they stand.
Mat3 M() {
  return rotation_matrix(kOrientation);
}
Mat3 M_inverse_transposed() {
  return M().inverse().transpose();
}

double turn_angle(const Quat& a, const Quat& b) {
  const Quat d = a.conjugate() * b;
  return 2.0 * std::atan2(d.vec().norm(), std::abs(d.w()));
}

Motion spinning_brick() {
  Motion body;
  body.q = kOrientation;
  body.v = v_l;
  body.w = v_r;
  body.L = angular_momentum(brick(), body.q, body.w);
  return body;
}

TEST(CourseFormula, AngularVelocityIsSpeedTimesAxis) {
  // v_r = s r, and s is the time derivative of the angle: after t the body has turned by s t about r.
  const Vec3 r = Vec3(2, 3, 6) / 7.0;
  Motion body;
  body.w = 0.25 * r;
  move_kinematic(body, 2.0);
  EXPECT_LT((body.q.vec() - std::sin(0.25) * r).norm(), 1e-15);
  EXPECT_NEAR(body.q.w(), std::cos(0.25), 1e-15);
}

TEST(CourseFormula, AngularVelocitiesAreAdditive) {
  // v_r = v_r1 + v_r2. About one axis turns add up exactly; about two, the turns one after the other differ from the
  // turn of the sum by h^2 |v_r1 x v_r2| / 2, so the velocities are additive.
  const Vec3 other(1.0, 0.5, -0.25);
  EXPECT_LT(turn_angle(exp_map(0.3 * v_r) * exp_map(0.5 * v_r), exp_map(0.8 * v_r)), 1e-15);
  for (const double h : {1e-2, 1e-3, 1e-4}) {
    const double apart = turn_angle(exp_map(h * v_r) * exp_map(h * other), exp_map(h * (v_r + other)));
    EXPECT_NEAR(apart / (0.5 * h * h * v_r.cross(other).norm()), 1.0, 5.0 * h);
  }
}

TEST(CourseFormula, LinearVelocityAndPositionUpdate) {
  // v(t + dt) = v(t) + dt a,   x(t + dt) = x(t) + dt v(t + dt).
  Motion body = spinning_brick();
  const double dt = 0.125;
  const Vec3 a(0.0, 0.5, -9.75);
  integrate_course(brick(), {v_l, v_l + dt * a, body.L, body.L}, dt, body);
  EXPECT_EQ(body.v, Vec3(v_l + dt * a));
  EXPECT_EQ(body.x, Vec3(dt * (v_l + dt * a)));
}

TEST(CourseFormula, AngularVelocityUpdate) {
  // v_r(t + dt) = v_r(t) + dt alpha,   alpha = M^-T I^-1 M^T tau.
  Motion body = spinning_brick();
  const double dt = 1.0 / 60;
  const Vec3 tau(3.0, -1.0, 2.0);
  const Vec3 alpha = M_inverse_transposed() * object_inertia().inverse() * M().transpose() * tau;
  integrate_course(brick(), {v_l, v_l, body.L, body.L + dt * tau}, dt, body);
  EXPECT_LT((body.w - (v_r + dt * alpha)).norm(), 2e-15);
}

TEST(CourseFormula, QuaternionFromAngularVelocity) {
  // q_r = (cos theta/2, sin(theta/2) (x, y, z)),   theta = |v_r| dt.
  const double dt = 0.3, theta = v_r.norm() * dt;
  const Vec3 axis = v_r / v_r.norm();
  const Quat q_r = exp_map(dt * v_r);
  EXPECT_NEAR(q_r.w(), std::cos(theta / 2), 2e-16);
  EXPECT_LT((q_r.vec() - std::sin(theta / 2) * axis).norm(), 3e-16);
}

TEST(CourseFormula, OrientationUpdate) {
  // q(t + dt) = q(t) q_r(dt), with v_r in body axes; the same as turning by v_r in world axes: exp(dt v_r) q(t).
  Motion body = spinning_brick();
  const double dt = 1.0 / 60;
  integrate_course(brick(), {v_l, v_l, body.L, body.L}, dt, body);
  const Vec3 v_r_body = kOrientation.conjugate() * v_r;
  EXPECT_LT(turn_angle(body.q, kOrientation * exp_map(dt * v_r_body)), 1e-15);
  EXPECT_LT(turn_angle(body.q, exp_map(dt * v_r) * kOrientation), 1e-15);
}

TEST(CourseFormula, TorqueOfForcesChangesTheMomentum) {
  // tau = x' x F and tau = sum x'_i x F_i: two opposite forces turn the body and leave its linear momentum alone.
  const Vec3 F(1.0, 2.0, -3.0), x1 = x_prime, x2 = -2.0 * x_prime;
  const Vec3 tau = x1.cross(F) + x2.cross(-F);
  EXPECT_LT((tau - (x1 - x2).cross(F)).norm(), 1e-15);
  Motion body;
  const double dt = 0.01;
  integrate_taylor8(brick(), {Vec3::Zero(), Vec3::Zero(), Vec3::Zero(), dt * tau}, dt, body);
  EXPECT_EQ(body.L, Vec3(dt * tau));
  EXPECT_LT((body.w - dt * object_inertia().inverse() * tau).norm(),
            1e-5 * body.w.norm());  // it has turned by 1e-5 rad
}

TEST(CourseFormula, InertiaOfASphere) {
  // I = 2/5 m r^2 on the diagonal.
  const double r = 0.3;
  const Inertia sphere = compute_inertia(Sphere{r}, 800.0);
  EXPECT_NEAR(sphere.mass, 800.0 * 4.0 / 3.0 * 3.14159265358979324 * r * r * r, 1e-13);
  EXPECT_LT((sphere.moments - 0.4 * sphere.mass * r * r * Mat3::Identity()).norm(), 1e-15);
}

TEST(CourseFormula, InertiaOfABox) {
  // I = 1/12 m diag(w^2 + d^2, h^2 + d^2, h^2 + w^2) with edges h, w, d along x, y, z.
  const double h = 0.4, w = 0.6, d = 1.0;
  const Inertia box = compute_inertia(Box{Vec3(h / 2, w / 2, d / 2)}, 1000.0);
  EXPECT_NEAR(box.mass, 1000.0 * h * w * d, 1e-12);
  const Vec3 expected = box.mass / 12.0 * Vec3(w * w + d * d, h * h + d * d, h * h + w * w);
  EXPECT_LT((box.moments - expected.asDiagonal().toDenseMatrix()).norm(), 1e-13);
}

TEST(CourseFormula, TorqueIsInertiaTimesAngularAcceleration) {
  // tau = I alpha in object space, alpha = M^-T I^-1 M^T tau in world space.
  const Vec3 tau(3.0, -1.0, 2.0);
  const MassProperties mass = brick();
  const Vec3 alpha = world_inertia(mass.inv_I, mass.q_BP, kOrientation) * tau;
  EXPECT_LT((alpha - M_inverse_transposed() * object_inertia().inverse() * M().transpose() * tau).norm(),
            1e-15);
  EXPECT_LT((M().transpose() * tau - object_inertia() * (M().transpose() * alpha)).norm(), 1e-14);
}

TEST(CourseFormula, InertiaInWorldSpace) {
  // M^-T I M^T.
  const MassProperties mass = brick();
  const Mat3 expected = M_inverse_transposed() * object_inertia() * M().transpose();
  const Mat3 I_W = world_inertia(mass.I, mass.q_BP, kOrientation);
  EXPECT_LT((I_W - expected).norm(), 1e-14 * expected.norm());
  EXPECT_EQ(I_W, Mat3(I_W.transpose()));
}

TEST(CourseFormula, AngularMomentum) {
  // p_r = I v_r, beside p_l = m v.
  const MassProperties mass = brick();
  EXPECT_LT((angular_momentum(mass, Quat::Identity(), v_r) - object_inertia() * v_r).norm(), 1e-14);
  const Mat3 I_W = M_inverse_transposed() * object_inertia() * M().transpose();
  EXPECT_LT((angular_momentum(mass, kOrientation, v_r) - I_W * v_r).norm(), 1e-15 * I_W.norm() * v_r.norm());
}

TEST(CourseFormula, MomentumChangeAtALeverArm) {
  // dp_r = x' x dp_l   and   dv_r = I^-1 dp_r = I^-1 (x' x dp_l).
  const MassProperties mass = brick();
  const Vec3 dp_l(5.0, -2.0, 1.0);
  const Vec3 dp_r = x_prime.cross(dp_l);
  Motion body = spinning_brick();
  const Vec3 v_r_after = angular_velocity(mass, body.q, body.L + dp_r);
  const Mat3 inv_I_W = M_inverse_transposed() * object_inertia().inverse() * M().transpose();
  EXPECT_LT((v_r_after - (v_r + inv_I_W * x_prime.cross(dp_l))).norm(), 2e-15);
}

TEST(CourseFormula, VelocityOfASurfacePoint) {
  // v = v_r x x' + v_l: the derivative of the point's path.
  const Motion body = spinning_brick();
  EXPECT_EQ(point_velocity(body, x_prime), Vec3(v_l + v_r.cross(x_prime)));
  const auto path = [&](double t) -> Vec3 { return t * v_l + exp_map(t * v_r) * x_prime; };
  const double dt = 1e-5;
  EXPECT_LT(((path(dt) - path(-dt)) / (2 * dt) - point_velocity(body, x_prime)).norm(), 1e-9);
}

}  // namespace
}  // namespace tumble
