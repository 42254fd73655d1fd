// Bounds, supports and checks of the shapes.
#include "collision/shape.h"

#include <gtest/gtest.h>

#include <limits>

#include "sample_hulls.h"

namespace tumble::test {
namespace {

std::vector<Shape> solids() {
  RandomPose random(71);
  return {Sphere{0.4},
          Capsule{0.3, 0.6},
          Box{Vec3(0.5, 0.3, 0.7)},
          random_hull(random, 16, Vec3(0.6, 0.5, 0.7)),
          Cylinder{0.4, 0.5},
          Cone{0.4, 0.5},
          Ellipsoid{Vec3(0.3, 0.5, 0.7)}};
}

TEST(Shape, BoundsAreTheSupportsAlongTheAxes) {
  RandomPose random(72);
  for (const Shape& shape : solids()) {
    for (int i = 0; i < 200; ++i) {
      const Pose X_WS = random.pose(3.0);
      const Aabb bounds = compute_aabb(shape, X_WS);
      for (int k = 0; k < 3; ++k) {
        const Vec3 d_S = X_WS.q.conjugate() * Vec3::Unit(k);
        EXPECT_NEAR(bounds.upper[k], (X_WS * support(shape, d_S))[k], 2e-15) << shape_name(shape);
        EXPECT_NEAR(bounds.lower[k], (X_WS * support(shape, -d_S))[k], 2e-15) << shape_name(shape);
      }
    }
  }
}

TEST(Shape, SupportIsFurthestAndInsideTheRadius) {
  RandomPose random(73);
  for (const Shape& shape : solids()) {
    double furthest = 0.0;
    for (int i = 0; i < 2000; ++i) {
      const Vec3 d = random.direction(), other = random.direction();
      const double length = random.log_uniform(1e-200, 1e100);
      const Vec3 p = support(shape, d), q = support(shape, other);
      EXPECT_GE(d.dot(p), d.dot(q) - 1e-15) << shape_name(shape);
      EXPECT_NEAR(extent_along(shape, d), d.dot(p), 3e-16) << shape_name(shape);  // 1.2e-16
      EXPECT_LE((support(shape, length * d) - p).norm(), 1e-15) << shape_name(shape);
      EXPECT_LE(p.norm(), bounding_radius(shape) * (1.0 + 1e-15)) << shape_name(shape);
      furthest = std::max(furthest, p.norm());
    }
    EXPECT_GT(furthest, 0.999 * bounding_radius(shape)) << shape_name(shape);
  }
}

TEST(Shape, SupportOfMirroredDirectionsIsMirrored) {
  const Box box{Vec3(1, 2, 3)};
  EXPECT_EQ(support(box, Vec3(0.0, 0.0, 1.0)), Vec3(1, 2, 3));
  EXPECT_EQ(support(box, Vec3(-0.0, -0.0, -1.0)), Vec3(-1, -2, -3));
  for (const Vec3& d : {Vec3(0, 0, 1), Vec3(1, 2, 0), Vec3(-1, 2, 3)}) {
    EXPECT_EQ(support(Cylinder{2, 3}, -d), -support(Cylinder{2, 3}, d));
    EXPECT_EQ(support(Ellipsoid{Vec3(1, 2, 3)}, -d), -support(Ellipsoid{Vec3(1, 2, 3)}, d));
  }
  for (const Shape& shape : solids()) EXPECT_TRUE(support(shape, Vec3::Zero()).allFinite());
  EXPECT_TRUE(support(Sphere{1.0}, Vec3::Zero()).allFinite());
  EXPECT_TRUE(support(Capsule{1.0, 1.0}, Vec3::Zero()).allFinite());
}

TEST(Shape, ClimbingOverAManyVertexHullFindsTheFurthest) {
  // A fine cylinder: 120 vertices, above the number that are scanned.
  ConvexHull::Parts hull;
  constexpr std::uint32_t kSides = 60;
  std::vector<std::uint32_t> top, bottom;
  for (std::uint32_t i = 0; i < kSides; ++i) {
    const double angle = 2.0 * 3.14159265358979 * i / kSides;
    hull.vertices.emplace_back(std::cos(angle), std::sin(angle), 0.5);
    hull.vertices.emplace_back(std::cos(angle), std::sin(angle), -0.5);
    top.push_back(2 * i);
    bottom.insert(bottom.begin(), 2 * i + 1);
  }
  const auto add_face = [&](const std::vector<std::uint32_t>& loop, const Vec3& normal, double offset) {
    hull.faces.push_back({normal, offset, static_cast<std::uint32_t>(hull.loops.size()),
                          static_cast<std::uint32_t>(loop.size())});
    hull.loops.insert(hull.loops.end(), loop.begin(), loop.end());
  };
  add_face(top, Vec3::UnitZ(), 0.5);
  add_face(bottom, -Vec3::UnitZ(), 0.5);
  for (std::uint32_t i = 0; i < kSides; ++i) {
    const std::uint32_t j = (i + 1) % kSides;
    const Vec3 normal = Vec3(hull.vertices[2 * i] + hull.vertices[2 * j + 1]).normalized();
    add_face({2 * i, 2 * i + 1, 2 * j + 1, 2 * j}, normal, normal.dot(hull.vertices[2 * i]));
  }
  const HullPointer cylinder = finish_hull(hull);
  RandomPose random(74);
  for (int i = 0; i < 500; ++i) {
    const Vec3 d = random.direction();
    double most = -kInfinity;
    for (const Vec3& v : cylinder->vertices) most = std::max(most, d.dot(v));
    EXPECT_EQ(d.dot(support(cylinder, d)), most);
  }
}

TEST(Shape, HalfSpaceIsBoundedOnlyWhereItIsAligned) {
  const Aabb level = compute_aabb(HalfSpace{}, {Quat::Identity(), Vec3(1, 2, 3)});
  EXPECT_EQ(level.upper.z(), 3.0);
  EXPECT_EQ(level.lower.z(), -kInfinity);
  EXPECT_EQ(level.upper.x(), kInfinity);
  const Aabb ceiling = compute_aabb(HalfSpace{}, {Quat(0, 1, 0, 0), Vec3(1, 2, 3)});
  EXPECT_EQ(ceiling.lower.z(), 3.0);
  const Aabb tilted = compute_aabb(HalfSpace{}, {turn(Vec3::UnitX(), 0.1), Vec3::Zero()});
  EXPECT_EQ(tilted.upper.z(), kInfinity);
  EXPECT_EQ(bounding_radius(HalfSpace{}), kInfinity);
}

TEST(Shape, ChecksNameFieldAndValue) {
  EXPECT_EQ(check_shape(Sphere{0.5}), "");
  EXPECT_EQ(check_shape(Sphere{-2.0}), "radius: must be finite and > 0, is -2");
  EXPECT_EQ(check_shape(Capsule{1.0, 0.0}), "half_length: must be finite and > 0, is 0");
  EXPECT_EQ(check_shape(Cylinder{-1.0, 1.0}), "radius: must be finite and > 0, is -1");
  EXPECT_EQ(check_shape(Cone{1.0, kInfinity}), "half_length: must be finite and > 0, is inf");
  EXPECT_EQ(check_shape(Ellipsoid{Vec3(1, 1, 0)}), "half_axes.z: must be finite and > 0, is 0");
  EXPECT_EQ(check_shape(Box{Vec3(1, kInfinity, 1)}), "half_extents.y: must be finite and > 0, is inf");
  EXPECT_NE(check_shape(HullPointer{}), "");
  EXPECT_EQ(check_shape(solids()[3]), "");
  EXPECT_EQ(check_shape(HalfSpace{}), "");
}

TEST(Shape, NamesAreThoseOfTheWire) {
  EXPECT_STREQ(shape_name(HalfSpace{}), "half_space");
  EXPECT_STREQ(shape_name(Sphere{1}), "sphere");
  EXPECT_STREQ(shape_name(Capsule{1, 1}), "capsule");
  EXPECT_STREQ(shape_name(Box{Vec3::Ones()}), "box");
  EXPECT_STREQ(shape_name(HullPointer{}), "convex_hull");
  EXPECT_STREQ(shape_name(Cylinder{1, 1}), "cylinder");
  EXPECT_STREQ(shape_name(Cone{1, 1}), "cone");
  EXPECT_STREQ(shape_name(Ellipsoid{Vec3::Ones()}), "ellipsoid");
}

}  // namespace
}  // namespace tumble::test
