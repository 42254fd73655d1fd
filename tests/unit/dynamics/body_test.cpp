// Angular velocity and momentum belong to each other through the inertia in world axes.
#include "dynamics/body.h"

#include <gtest/gtest.h>

#include <random>

namespace tumble {
namespace {

struct BodyTest : testing::Test {
  std::mt19937 random{1};

  Vec3 random_vector() {
    std::normal_distribution<double> normal;
    Vec3 v;
    for (int i = 0; i < 3; ++i) v[i] = normal(random);
    return v;
  }
  Quat random_rotation() { return exp_map(2.0 * random_vector()); }
};

TEST_F(BodyTest, MomentumAndVelocityAreInverse) {
  for (int i = 0; i < 100; ++i) {
    const Inertia turned =
        transformed(compute_inertia(Box{Vec3(0.2, 0.3, 0.9)}, 800.0), {random_rotation(), Vec3::Zero()});
    const MassProperties mass = compute_mass_properties(turned);
    const Quat q_WB = random_rotation();
    const Vec3 w = random_vector();
    const Vec3 L = angular_momentum(mass, q_WB, w);
    EXPECT_LT((angular_velocity(mass, q_WB, L) - w).norm(), 2e-14 * w.norm());
    const Mat3 R = rotation_matrix(q_WB);
    EXPECT_LT((R * turned.moments * R.transpose() * w - L).norm(), 1e-14 * L.norm());
    EXPECT_LT((world_inertia(mass.I, mass.q_BP, q_WB) * w - L).norm(), 1e-14 * L.norm());
    EXPECT_LT((world_inertia(mass.inv_I, mass.q_BP, q_WB) * L - w).norm(), 2e-14 * w.norm());
  }
}

TEST_F(BodyTest, ABallTurnsExactlyAlongItsMomentum) {
  const MassProperties ball = compute_mass_properties(compute_inertia(Sphere{0.5}, 1000.0));
  const Vec3 L = random_vector();
  EXPECT_EQ(angular_velocity(ball, random_rotation(), L), Vec3(ball.inv_I.x() * L));
}

TEST_F(BodyTest, WhatCannotMoveDoesNotTurn) {
  EXPECT_EQ(angular_velocity(MassProperties{}, random_rotation(), random_vector()), Vec3::Zero());
}

TEST_F(BodyTest, AStaleHandleIsNotTheNewBody) {
  EXPECT_NE((BodyId{3, 1}), (BodyId{3, 2}));
  EXPECT_EQ((BodyId{3, 1}), (BodyId{3, 1}));
}

}  // namespace
}  // namespace tumble
