// Collocation against closed forms, what it keeps, its order, and where it gives up.
#include "dynamics/smooth_motion.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/rotation_cases.h"

namespace tumble {
namespace {

SmoothBody dynamic_body(const Vec3& I, const Vec3& x, const Vec3& v = Vec3::Zero(),
                        const Vec3& w = Vec3::Zero()) {
  SmoothBody body;
  body.type = BodyType::dynamic;
  body.mass = principal_body(I);
  body.motion.x = x;
  body.motion.v = v;
  body.motion.w = w;
  body.motion.L = I.cwiseProduct(w);
  return body;
}

void advance(SmoothSystem& system, double time, int steps) {
  for (int i = 0; i < steps; ++i) ASSERT_TRUE(advance_smoothly(system, time / steps));
}

double energy(const SmoothSystem& system) {
  double sum = 0.0;
  for (const SmoothBody& body : system.bodies) {
    sum += 0.5 * (body.mass.mass * body.motion.v.squaredNorm() + body.motion.L.dot(body.motion.w));
  }
  for (const SmoothSpring& tie : system.springs) {
    const Motion &A = system.bodies[tie.a].motion, &B = system.bodies[tie.b].motion;
    sum += spring_energy(tie.spring, (B.x + B.q * tie.pB - A.x - A.q * tie.pA).norm());
  }
  return sum;
}

/// Two tumbling bodies tied at their corners.
SmoothSystem tied_pair() {
  SmoothSystem system;
  system.bodies = {dynamic_body(Vec3(0.5, 0.75, 1.2), Vec3::Zero(), Vec3(0.1, 0, 0), Vec3(1, -2, 0.5)),
                   dynamic_body(Vec3(0.6, 0.8, 1.0), Vec3(2, 0, 0), Vec3(0, -0.3, 0.2), Vec3(-1, 0.3, 2))};
  system.springs = {
      {.a = 0, .b = 1, .pA = Vec3(0.3, 0.2, 0.1), .pB = Vec3(-0.2, 0.4, 0), .spring = {0.5, 20.0, 0.0}}};
  return system;
}

TEST(SmoothMotion, KeepsMomentumAndEnergyOfATiedPair) {
  SmoothSystem system = tied_pair();
  const auto momenta = [&] {
    Vec3 p = Vec3::Zero(), L = Vec3::Zero();
    for (const SmoothBody& body : system.bodies) {
      p += body.motion.v;
      L += body.motion.x.cross(body.motion.v) + body.motion.L;
    }
    return std::pair{p, L};
  };
  const auto [p0, L0] = momenta();
  const double E0 = energy(system);
  advance(system, 10.0, 1000);
  const auto [p1, L1] = momenta();
  EXPECT_LT((p1 - p0).norm(), 1e-13);
  EXPECT_LT((L1 - L0).norm(), 1e-12);
  EXPECT_NEAR(energy(system), E0, 1e-10 * E0);
}

TEST(SmoothMotion, ErrorFallsWithTheSixthPower) {
  const auto end = [](int steps) {
    SmoothSystem system = tied_pair();
    advance(system, 1.0, steps);
    return system.bodies[1].motion;
  };
  const Motion truth = end(960);
  const auto error = [&](int steps) {
    return (end(steps).x - truth.x).norm() + angle_between(end(steps).q, truth.q);
  };
  EXPECT_NEAR(std::log2(error(120) / error(240)), 6.0, 0.5);  // both without sub-steps
}

TEST(SmoothMotion, ADampedOscillatorDecaysAsItsClosedForm) {
  // m = 1, k = 25, c = 0.8: x = e^-0.4t (cos wt + 0.4/w sin wt), w^2 = 25 - 0.16.
  SmoothSystem system;
  system.bodies = {SmoothBody{}, dynamic_body(Vec3(1, 1, 1), Vec3(2.0, 0, 0))};
  system.springs = {{.a = 0, .b = 1, .pA = {0, 0, 0}, .pB = {0, 0, 0}, .spring = {1.0, 25.0, 0.8}}};
  advance(system, 3.0, 720);
  const double w = std::sqrt(24.84), t = 3.0;
  const double x = std::exp(-0.4 * t) * (std::cos(w * t) + 0.4 / w * std::sin(w * t));
  EXPECT_NEAR(system.bodies[1].motion.x.x() - 1.0, x, 1e-12);
}

TEST(SmoothMotion, ASpringFollowsAKinematicPartner) {
  // The anchor moves at 0.5 m/s: in its frame an oscillator that starts with -0.5 m/s.
  SmoothSystem system;
  SmoothBody carrier;
  carrier.type = BodyType::kinematic;
  carrier.motion.v = Vec3(0.5, 0, 0);
  system.bodies = {carrier, dynamic_body(Vec3(1, 1, 1), Vec3(1.0, 0, 0))};
  system.springs = {{.a = 0, .b = 1, .pA = {0, 0, 0}, .pB = {0, 0, 0}, .spring = {1.0, 25.0, 0.0}}};
  const double t = 2.0;
  for (int i = 0; i < 480; ++i) {
    ASSERT_TRUE(advance_smoothly(system, t / 480));
    system.bodies[0].motion.x.x() = 0.5 * t * (i + 1) / 480;
  }
  EXPECT_NEAR(system.bodies[1].motion.x.x(), 1.0 + 0.5 * t - 0.1 * std::sin(5.0 * t), 1e-12);
}

TEST(SmoothMotion, DampedMotionDecaysExponentially) {
  SmoothSystem system;
  system.bodies = {dynamic_body(Vec3(1, 2, 3), Vec3::Zero(), Vec3(1, 0, 0), Vec3(0, 0, 2))};
  system.bodies[0].linear_damping = 0.7;
  system.bodies[0].angular_damping = 1.3;
  advance(system, 1.0, 60);
  EXPECT_NEAR(system.bodies[0].motion.v.x(), std::exp(-0.7), 1e-12);
  EXPECT_NEAR(system.bodies[0].motion.w.z(), 2.0 * std::exp(-1.3), 1e-12);
}

TEST(SmoothMotion, AForceAtAPointTurnsTheBodyLikeAPendulum) {
  // F along x at (1, 0, 0) of a body that turns about z: I theta'' = -F sin theta. Energy: I w^2 / 2 - F cos theta.
  SmoothSystem system;
  const double theta = 1.0, force = 4.0;
  system.bodies = {dynamic_body(Vec3(1, 1, 2), Vec3::Zero())};
  system.bodies[0].motion.q = exp_map(Vec3(0, 0, theta));
  system.bodies[0].load.add_world_force(Vec3(force, 0, 0), Vec3(1, 0, 0));
  advance(system, 1.7, 200);
  const Motion& motion = system.bodies[0].motion;
  const Vec3 arm = motion.q * Vec3(1, 0, 0);
  EXPECT_NEAR(0.5 * 2.0 * motion.w.z() * motion.w.z() - force * arm.x(), -force * std::cos(theta), 1e-12);
  EXPECT_NEAR(motion.v.x(), force * 1.7, 1e-13);
}

TEST(SmoothMotion, GivesUpOnSpringsTooStiffForItAndMovesNothing) {
  SmoothSystem system = tied_pair();
  system.springs[0].spring.stiffness = 1e9;
  const Vec3 x = system.bodies[0].motion.x, v = system.bodies[0].motion.v;
  EXPECT_FALSE(advance_smoothly(system, 1.0 / 60.0));
  EXPECT_EQ(system.bodies[0].motion.x, x);
  EXPECT_EQ(system.bodies[0].motion.v, v);
}

}  // namespace
}  // namespace tumble
