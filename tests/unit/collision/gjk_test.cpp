// libccd behind its certificate: whatever it answers, "apart" is always proven.
#include "collision/gjk.h"
#include "collision/box_polytope.h"

#include <gtest/gtest.h>

#include "math/rotation.h"
#include "polytope_reference.h"
#include "sample_hulls.h"

namespace tumble::test {
namespace {

/// Box against box of very different sizes, deep to far, aligned and touching: what makes libccd wrong.
TEST(Gjk, ApartIsNeverFalse) {
  RandomPose random(61);
  int apart = 0, touching = 0, wrong = 0, blind = 0, over_budget = 0;
  for (int i = 0; i < 20000; ++i) {
    const double scale = i % 4 == 0 ? 1000.0 : i % 4 == 1 ? 1e-3 : 1.0;
    const Box a{scale * random.vector(0.3, 1.0)}, b{(i % 4 == 0 ? 1.0 : scale) * random.vector(0.3, 1.0)};
    Pose X_AB{i % 4 == 3 ? Quat::Identity() : random.rotation(), Vec3::Zero()};
    const double height = rotation_matrix(X_AB.q).row(2).cwiseAbs().dot(b.half_extents.transpose());
    const double gap = i % 3 == 0 ? 0.0 : b.half_extents.x() * random.log_uniform(1e-9, 1.0);
    X_AB.p = Vec3(0.1 * b.half_extents.x(), 0, a.half_extents.z() + height + (i % 2 == 0 ? gap : -gap));
    const GjkAnswer answer = decide_apart(a, b, X_AB);
    const BoxPolytope features_a(a), features_b(b);
    const PolytopeReference truth(features_a, {}, features_b, X_AB);
    over_budget += answer.budget_hit;
    EXPECT_NEAR(answer.axis_A.norm(), 1.0, 1e-15);
    if (answer.kind == GjkAnswer::Kind::apart) {
      ++apart;
      const long double along = truth.separation_along(answer.axis_A.cast<long double>());
      wrong += !(answer.gap > 0.0) || along < answer.gap * answer.axis_A.cast<long double>().norm();
    } else {
      ++touching;
      blind += truth.separation() > 1e-6 * (bounding_radius(a) + bounding_radius(b)) &&
               answer.kind == GjkAnswer::Kind::touching;
    }
  }
  EXPECT_EQ(wrong, 0);
  EXPECT_EQ(blind, 0);
  EXPECT_EQ(over_budget, 0);
  EXPECT_GT(apart, 5000);
  EXPECT_GT(touching, 5000);
}

TEST(Gjk, RoundShapes) {
  RandomPose random(62);
  const HullPointer hull = random_hull(random, 16, Vec3(0.5, 0.4, 0.6));
  for (int i = 0; i < 5000; ++i) {
    const Sphere sphere{random.uniform(0.1, 1.0)};
    const Pose X_AB = random.pose(1.5);
    const GjkAnswer answer = decide_apart(hull, sphere, X_AB);
    const double gap = compute_distance(*hull, X_AB.p, 1e300).distance - sphere.radius;
    if (answer.kind == GjkAnswer::Kind::apart) {
      EXPECT_LE(answer.gap, gap);
    } else if (answer.kind == GjkAnswer::Kind::touching) {
      EXPECT_LE(gap, 1e-6);
    }
  }
}

/// Unscaled, libccd calls every pair of overlapping 1 mm cubes apart.
TEST(Gjk, SmallCubesOverlap) {
  RandomPose random(63);
  const Box grain{Vec3::Constant(5e-4)};
  for (int i = 0; i < 2000; ++i) {
    const Pose X_AB{random.rotation(), 5e-4 * random.direction()};
    EXPECT_NE(decide_apart(grain, grain, X_AB).kind, GjkAnswer::Kind::apart);
  }
}

TEST(Gjk, CoincidentCentresAreFinite) {
  const std::vector<Shape> shapes = {Sphere{1.0}, Capsule{0.5, 1.0}, Box{Vec3::Ones()}};
  for (const Shape& a : shapes) {
    for (const Shape& b : shapes) {
      const GjkAnswer answer = decide_apart(a, b, {});
      EXPECT_NE(answer.kind, GjkAnswer::Kind::apart);
      EXPECT_NEAR(answer.axis_A.norm(), 1.0, 1e-15);
      EXPECT_TRUE(std::isfinite(answer.gap));
      EXPECT_FALSE(answer.budget_hit);
    }
  }
}

}  // namespace
}  // namespace tumble::test
