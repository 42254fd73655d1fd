// Springs against closed forms: period, damping, conserved quantities, stiffness without limit.
#include <gtest/gtest.h>

#include <cmath>

#include "dynamics/force_spring.h"
#include "support/problem_builder.h"

namespace tumble {
namespace {

using namespace test;

struct SpringScene {
  ContactProblem problem;
  Spring spring;
  Vec3 anchor_A = Vec3::Zero(), anchor_B = Vec3::Zero();  // in body frames
  Solver solver = Solver::pgs;

  void step() {
    ScalarRow row;
    row.a = 0;
    row.b = 1;
    row.rA = problem.bodies[0].q * anchor_A;
    row.rB = problem.bodies[1].q * anchor_B;
    problem.rows.clear();
    if (make_spring_row(spring, problem.bodies[0], problem.bodies[1], problem.h, row))
      problem.rows.push_back(row);
    prepare(problem, kNoSlop);
    solve_function(solver)(problem, {.max_sweeps = 50, .tolerance = 1e-14});
    move_bodies(problem);
  }
  double length() const {
    const SolverBody &A = problem.bodies[0], &B = problem.bodies[1];
    return (B.x + B.q * anchor_B - A.x - A.q * anchor_A).norm();
  }
  double energy() const { return kinetic_energy(problem) + spring_energy(spring, length()); }
};

/// m = 2 kg at x = 1 + stretch on a spring of rest length 1 m from the origin.
SpringScene oscillator(double stiffness, double damping, double h, double stretch = 0.1) {
  SpringScene scene;
  scene.problem.h = h;
  scene.problem.bodies = {fixed_body(), ball(2.0, 0.1, Vec3(1.0 + stretch, 0, 0))};
  scene.spring = {.rest_length = 1.0, .stiffness = stiffness, .damping = damping};
  return scene;
}

/// Error of x after one second against x = 1 + 0.1 cos(omega t).
double phase_error(double h, Solver solver) {
  SpringScene scene = oscillator(200.0, 0.0, h);  // omega = 10 rad/s
  scene.solver = solver;
  const int steps = static_cast<int>(std::lround(1.0 / h));
  for (int i = 0; i < steps; ++i) scene.step();
  return std::abs(scene.problem.bodies[1].x.x() - (1.0 + 0.1 * sincos(10.0).cos));
}

TEST(Spring, TensionIsStiffnessTimesExtensionPlusDampingTimesRate) {
  const Spring spring{.rest_length = 2.0, .stiffness = 50.0, .damping = 3.0};
  EXPECT_DOUBLE_EQ(spring_tension(spring, 2.5, 0.0), 25.0);
  EXPECT_DOUBLE_EQ(spring_tension(spring, 2.0, -1.0), -3.0);
  EXPECT_DOUBLE_EQ(spring_energy(spring, 1.0), 25.0);
}

TEST(Spring, StretchedSpringPullsTheBodiesTogether) {
  SpringScene scene = oscillator(200.0, 0.0, 1.0 / 240.0);
  scene.step();
  EXPECT_LT(scene.problem.rows[0].lambda, 0.0);
  EXPECT_LT(scene.problem.bodies[1].v.x(), 0.0);
}

TEST(Spring, PhaseErrorIsOfSecondOrder) {
  // omega^3 h^2 t / 12 = 1.4e-3 rad at 1/240 s: times 0.1 m |sin 10| = 7.9e-5 m
  const double coarse = phase_error(1.0 / 240.0, Solver::pgs), fine = phase_error(1.0 / 480.0, Solver::pgs);
  EXPECT_NEAR(coarse, 7.9e-5, 2e-6);
  EXPECT_NEAR(coarse / fine, 4.0, 0.02);
}

TEST(Spring, SubStepsHaveThePeriodOfTheShorterStep) {
  EXPECT_NEAR(phase_error(1.0 / 240.0, Solver::soft_step), phase_error(1.0 / 960.0, Solver::pgs), 1e-9);
}

TEST(Spring, UndampedEnergyStaysToRounding) {
  SpringScene scene = oscillator(200.0, 0.0, 1.0 / 240.0);
  const double start = scene.energy();
  double worst = 0.0;
  for (int i = 0; i < 24000; ++i) {
    scene.step();
    worst = std::max(worst, std::abs(scene.energy() - start) / start);
  }
  EXPECT_LT(worst, 1e-11);  // 100 s
}

TEST(Spring, DampedOscillationDecaysAsTheClosedForm) {
  // m x'' + c x' + k x = 0 with decay c/2m = 1/s and omega_d = sqrt(100 - 1)
  SpringScene scene = oscillator(200.0, 4.0, 1.0 / 960.0);
  for (int i = 0; i < 960; ++i) scene.step();
  const double omega = std::sqrt(99.0);
  const SinCos s = sincos(omega);
  const double exact = 0.1 * exp_decay(-1.0) * (s.cos + s.sin / omega);
  EXPECT_NEAR(scene.problem.bodies[1].x.x() - 1.0, exact, 3e-6);  // second order: 1.4e-3/16 rad x 0.037 m
}

TEST(Spring, StiffnessHasNoLimit) {
  SpringScene scene = oscillator(1e9, 0.0, 1.0 / 240.0, 1e-3);
  for (int i = 0; i < 2400; ++i) {
    scene.step();
    ASSERT_LT(std::abs(scene.problem.bodies[1].x.x() - 1.0), 1.1e-3) << i;
  }
}

TEST(Spring, OrbitKeepsEnergyAndAngularMomentum) {
  SpringScene scene = oscillator(200.0, 0.0, 1.0 / 240.0);
  scene.problem.bodies[1].v = scene.problem.bodies[1].v0 = Vec3(0, 2.0, 1.0);
  const double energy = scene.energy();
  const Momentum start = momentum(scene.problem);
  double worst = 0.0;
  for (int i = 0; i < 2400; ++i) {
    scene.step();
    worst = std::max(worst, std::abs(scene.energy() - energy) / energy);
  }
  EXPECT_LT((momentum(scene.problem).angular - start.angular).norm(), 1e-12);  // 10 s, of 4.9 N m s
  EXPECT_LT(worst, 1e-3) << "midpoint rule: bounded, not drifting";
}

TEST(Spring, TwoBodiesWithOffCentreAnchorsConserveMomentumAndAngularMomentum) {
  SpringScene scene;
  scene.problem.h = 1.0 / 240.0;
  scene.problem.bodies = {cube(1.0, Vec3(0, 0, 0), Vec3(0.5, 0.2, -0.1), Vec3(1, 2, 3)),
                          cube(3.0, Vec3(2, 0.5, 0), Vec3(0, -0.3, 0.4), Vec3(-1, 0.5, 0.2))};
  scene.anchor_A = Vec3(0.5, 0.5, -0.2);
  scene.anchor_B = Vec3(-0.5, 0.1, 0.4);
  scene.spring = {.rest_length = 1.0, .stiffness = 100.0, .damping = 0.0};
  const Momentum start = momentum(scene.problem);
  for (int i = 0; i < 2400; ++i) scene.step();
  const Momentum end = momentum(scene.problem);
  EXPECT_LT((end.linear - start.linear).norm() / start.scale, 1e-14);
  EXPECT_LT((end.angular - start.angular).norm() / start.scale, 1e-13);
}

TEST(Spring, CoincidentAnchorsMakeNoRow) {
  SpringScene scene = oscillator(200.0, 0.0, 1.0 / 240.0);
  scene.problem.bodies[1].x.setZero();
  scene.step();
  EXPECT_TRUE(scene.problem.rows.empty());
}

}  // namespace
}  // namespace tumble
