// Poses compose as their letters say.
#include "math/pose.h"

#include <gtest/gtest.h>

#include "math/rotation.h"

namespace tumble {
namespace {

const Pose X_AB{exp_map(Vec3(0.3, -0.2, 1.0)), Vec3(1, 2, 3)};
const Pose X_BC{exp_map(Vec3(-1.0, 0.5, 0.1)), Vec3(-2, 0.5, 4)};
const Vec3 p_C(0.7, -0.3, 2.0);

TEST(Pose, ProductMapsThroughBothFrames) {
  EXPECT_LT(((X_AB * X_BC) * p_C - X_AB * (X_BC * p_C)).norm(), 2e-15);
}

TEST(Pose, InverseLeadsBack) {
  EXPECT_LT((X_AB.inverse() * (X_AB * p_C) - p_C).norm(), 2e-15);
  const Pose X_AA = X_AB * X_AB.inverse();
  EXPECT_LT(X_AA.p.norm(), 2e-15);
  EXPECT_LT(X_AA.q.vec().norm(), 2e-16);
}

TEST(Pose, DefaultChangesNothing) {
  EXPECT_EQ(Pose{} * p_C, p_C);
  EXPECT_EQ((Pose{} * X_AB).p, X_AB.p);
  EXPECT_EQ((X_AB * Pose{}).q.coeffs(), X_AB.q.coeffs());
}

TEST(Pose, TranslatesAfterItTurns) {
  const Pose X{exp_map(Vec3(0, 0, 1.5707963267948966)), Vec3(10, 0, 0)};
  EXPECT_LT((X * Vec3(1, 0, 0) - Vec3(10, 1, 0)).norm(), 1e-15);
}

}  // namespace
}  // namespace tumble
