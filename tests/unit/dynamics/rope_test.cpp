// Ropes: free when slack, hold when taut, give back what their restitution says.
#include <gtest/gtest.h>

#include <cmath>

#include "dynamics/joint_rope.h"
#include "support/problem_builder.h"

namespace tumble {
namespace {

using namespace test;

struct RopeScene {
  ContactProblem problem;
  Rope rope;
  Vec3 gravity = kGravity;
  Vec3 anchor_B = Vec3::Zero();
  double impulse = 0.0;

  void step() {
    apply_gravity(problem, gravity);
    ScalarRow row;
    row.a = 0;
    row.b = 1;
    row.rA = Vec3::Zero();
    row.rB = problem.bodies[1].q * anchor_B;
    problem.rows.clear();
    if (make_rope_row(rope, problem.bodies[0], problem.bodies[1], problem.h, kNoSlop, row)) {
      problem.rows.push_back(row);
    }
    prepare(problem, kNoSlop);
    solve_pgs(problem, {.max_sweeps = 50, .tolerance = 1e-14});
    impulse = problem.rows.empty() ? 0.0 : problem.rows[0].lambda;
    move_bodies(problem);
  }
  double distance() const {
    return (problem.bodies[1].x + problem.bodies[1].q * anchor_B - problem.bodies[0].x).norm();
  }
};

/// A ball of 1 kg at x, v on a rope from the origin.
RopeScene hung(const Vec3& x, const Vec3& v, const Rope& rope) {
  RopeScene scene;
  scene.problem.h = 1.0 / 240.0;
  scene.problem.bodies = {fixed_body(), ball(1.0, 0.1, x, v)};
  scene.rope = rope;
  return scene;
}

TEST(Rope, SlackRopeHasNoRow) {
  RopeScene scene = hung(Vec3(0, 0, -0.5), Vec3::Zero(), {.length = 1.0});
  scene.step();
  EXPECT_TRUE(scene.problem.rows.empty());
  EXPECT_DOUBLE_EQ(scene.problem.bodies[1].v.z(), -9.81 / 240.0);
}

TEST(Rope, TautRopeHoldsTheWeight) {
  RopeScene scene = hung(Vec3(0, 0, -1.0), Vec3::Zero(), {.length = 1.0});
  for (int i = 0; i < 240; ++i) scene.step();
  EXPECT_NEAR(scene.impulse * 240.0, 9.81, 1e-10);
  EXPECT_NEAR(scene.distance(), 1.0, 1e-14);
}

TEST(Rope, PendulumKeepsLengthAndEnergy) {
  RopeScene scene = hung(Vec3(0.6, 0, -0.8), Vec3(0, 0.5, 0), {.length = 1.0});
  const auto energy = [&] { return kinetic_energy(scene.problem) + 9.81 * scene.problem.bodies[1].x.z(); };
  const double start = energy();
  double stretch = 0.0, change = 0.0;
  for (int i = 0; i < 2400; ++i) {
    scene.step();
    stretch = std::max(stretch, std::abs(scene.distance() - 1.0));
    change = std::max(change, std::abs(energy() - start));
  }
  EXPECT_LT(stretch, 1e-6);  // measured 2.5e-7 m
  EXPECT_LT(change, 1e-4);   // measured 1.1e-5 J in 10 s
}

TEST(Rope, SnappingTautGivesBackItsRestitution) {
  for (const double e : {0.0, 0.5, 1.0}) {
    RopeScene scene = hung(Vec3(1.0, 0, 0), Vec3(2.0, 0, 0), {.length = 1.0, .restitution = e});
    scene.gravity.setZero();
    scene.step();
    EXPECT_NEAR(scene.problem.bodies[1].v.x(), -2.0 * e, 1e-15);
  }
}

TEST(Rope, FallIntoTheRopeEndsAtItsLength) {
  RopeScene scene = hung(Vec3(0, 0, -0.2), Vec3::Zero(), {.length = 1.0});
  double longest = 0.0;
  for (int i = 0; i < 480; ++i) {
    scene.step();
    longest = std::max(longest, scene.distance());
  }
  EXPECT_LT(longest - 1.0, 1e-8);
  EXPECT_NEAR(scene.distance(), 1.0, 1e-8);
  EXPECT_LT(scene.problem.bodies[1].v.norm(), 1e-8);
}

TEST(Rope, TwoBodiesConserveMomentumAndAngularMomentum) {
  RopeScene scene;
  scene.problem.h = 1.0 / 240.0;
  scene.gravity.setZero();
  scene.problem.bodies = {ball(1.0, 0.2, Vec3::Zero(), Vec3(-1, 0.3, 0)),
                          cube(3.0, Vec3(1.3, 0, 0), Vec3(1, -0.5, 0.2))};
  scene.anchor_B = Vec3(0, 0.5, 0.3);
  scene.rope = {.length = 1.5};
  const Momentum start = momentum(scene.problem);
  for (int i = 0; i < 2400; ++i) scene.step();
  const Momentum end = momentum(scene.problem);
  EXPECT_LT((end.linear - start.linear).norm() / start.scale, 1e-14);
  // Exact while it swings; a step that snaps taut but moves with the average velocity adds its second order.
  EXPECT_LT((end.angular - start.angular).norm() / start.scale, 5e-5);  // measured 1.4e-5
  EXPECT_LT(scene.distance(), 1.5 + 1e-5);
}

}  // namespace
}  // namespace tumble
