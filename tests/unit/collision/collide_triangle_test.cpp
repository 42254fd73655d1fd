// A triangle of a surface against every convex shape. Reference: a box, whose surface as triangles must give the
// contacts that the box gives as a solid.
#include <gtest/gtest.h>

#include "collision/collide_triangle_hull.h"
#include "first_query.h"
#include "math/rotation.h"
#include "sample_hulls.h"
#include "support/surface_meshes.h"

namespace tumble::test {
namespace {

struct Touch {
  Vec3 normal_W, p_W;
  double separation;
};

void append(const Manifold& manifold, const Pose& X_WA, std::vector<Touch>& touches) {
  for (int i = 0; i < manifold.count; ++i) {
    const ManifoldPoint& point = manifold.points[static_cast<std::size_t>(i)];
    touches.push_back({X_WA.q * manifold.normal_A, X_WA * point.p_A, point.separation});
  }
}

/// All contact points of the body with a surface, which lies in W.
std::vector<Touch> touches_with(const Shape& body, const Pose& X_WA, const Shape& surface, double margin) {
  std::vector<Touch> touches;
  for (std::uint32_t part = 0; part < surface_of(surface)->triangle_count(); ++part) {
    append(query(body, X_WA, surface, Pose{}, margin, {}, part), X_WA, touches);
  }
  return touches;
}

const Touch* deepest_of(const std::vector<Touch>& touches) {
  const Touch* deepest = nullptr;
  for (const Touch& touch : touches) {
    if (!deepest || touch.separation < deepest->separation) deepest = &touch;
  }
  return deepest;
}

struct Body {
  const char* name;
  Shape shape;
  double size;
};

std::vector<Body> bodies() {
  RandomPose random(9);
  return {{"sphere", Sphere{0.3}, 0.3},
          {"capsule", Capsule{0.2, 0.3}, 0.5},
          {"box", Box{Vec3(0.4, 0.3, 0.2)}, 0.54},
          {"hull", random_hull(random, 16, Vec3(0.4, 0.3, 0.3)), 0.4},
          {"cylinder", Cylinder{0.3, 0.25}, 0.39},
          {"cone", Cone{0.3, 0.3}, 0.42},
          {"ellipsoid", Ellipsoid{Vec3(0.4, 0.3, 0.25)}, 0.4}};
}

/// Distance along d from the origin at which `body` and `solid` just touch.
double touching_distance(const Shape& body, const Quat& q, const Vec3& d, const Shape& solid) {
  double low = 0.0, high = 4.0;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    std::vector<Touch> touches;
    append(query(body, {q, middle * d}, solid, Pose{}, 10.0), {q, middle * d}, touches);
    (deepest_of(touches)->separation < 0.0 ? low : high) = middle;
  }
  return high;
}

/// Up to 1 cm within the solid or up to 1.5 cm off it, every third one within 0.1 mm, in any direction.
Pose near_pose(RandomPose& random, const Shape& body, const Shape& solid, int i) {
  const Quat q = random.rotation();
  const Vec3 d = random.direction();
  const double offset = random.uniform(-1.0, 0.0);
  const double reach = i % 3 == 0 ? 1e-4 : (i % 3 == 1 ? 0.01 : -0.015);
  return {q, (touching_distance(body, q, d, solid) + offset * reach) * d};
}

// The depth and the normal of the deepest point are those of the solid.
TEST(CollideTriangle, ABoxOfTrianglesTouchesLikeTheBox) {
  const Vec3 half(0.8, 0.6, 0.5);
  const Box solid{half};
  for (const std::uint32_t n : {1u, 3u}) {
    const TriangleMeshPointer mesh = box_mesh(half, n);
    for (const Body& body : bodies()) {
      RandomPose random(31);
      int cases = 0;
      for (int i = 0; i < 150; ++i) {
        const Pose X = near_pose(random, body.shape, solid, i);
        std::vector<Touch> of_solid;
        append(query(body.shape, X, solid, Pose{}, 0.02), X, of_solid);
        const std::vector<Touch> of_mesh = touches_with(body.shape, X, mesh, 0.02);
        const Touch* expected = deepest_of(of_solid);
        const Touch* found = deepest_of(of_mesh);
        ASSERT_NE(expected, nullptr);
        ASSERT_NE(found, nullptr) << body.name << " " << i << " depth " << expected->separation;
        ++cases;
        EXPECT_NEAR(found->separation, expected->separation, 1e-13) << body.name << " " << i;  // 1.1e-14
        EXPECT_LE((found->normal_W - expected->normal_W).norm(), 1e-6) << body.name << " " << i;
      }
      EXPECT_EQ(cases, 150);
    }
  }
}

/// A hull's surface; faces of many corners as fans.
TriangleMeshPointer mesh_of(const ConvexHull& hull) {
  std::vector<TriangleMesh::Corners> triangles;
  for (const Polytope::Face& face : hull.faces) {
    for (std::uint32_t k = 1; k + 1 < face.count; ++k) {
      const std::uint32_t* const loop = hull.loops.data() + face.first;
      triangles.push_back({loop[0], loop[k], loop[k + 1]});
    }
  }
  return std::make_shared<const TriangleMesh>(hull.parts().vertices, triangles);
}

// Ridges of any bend, peaks of any shape: what is deepest is as deep as in the solid that they bound, along its normal.
TEST(CollideTriangle, RandomRidgesTouchLikeTheHullThatTheyBound) {
  for (const Body& body : bodies()) {
    RandomPose random(43);
    int cases = 0, wrong = 0;
    for (int i = 0; i < 400; ++i) {
      const HullPointer solid = random_hull(random, 8 + i % 8, Vec3(1.0, 0.8, 0.9));
      const auto is_deep = [](const Polytope::Face& face) { return face.offset > 0.1; };
      if (!std::all_of(solid->faces.begin(), solid->faces.end(), is_deep)) continue;
      const TriangleMeshPointer mesh = mesh_of(*solid);
      const Pose X = near_pose(random, body.shape, solid, i);
      std::vector<Touch> of_solid;
      append(query(body.shape, X, solid, Pose{}, 0.02), X, of_solid);
      const std::vector<Touch> of_mesh = touches_with(body.shape, X, mesh, 0.02);
      const Touch *expected = deepest_of(of_solid), *found = deepest_of(of_mesh);
      ASSERT_NE(expected, nullptr);
      ASSERT_NE(found, nullptr) << body.name << " " << i << " depth " << expected->separation;
      ++cases;
      wrong += std::abs(found->separation - expected->separation) > 1e-13;
    }
    EXPECT_GT(cases, 200) << body.name;
    EXPECT_EQ(wrong, 0) << body.name;
  }
}

// The round bodies are exact: distance to the surface of a box, outside of it, whatever the triangles.
TEST(CollideTriangle, ASpheresGapIsItsDistanceFromTheSurface) {
  const Vec3 half(0.8, 0.6, 0.5);
  const TriangleMeshPointer mesh = box_mesh(half, 3);
  RandomPose random(33);
  for (int i = 0; i < 2000; ++i) {
    const Vec3 p = random.vector(-1.2, 1.2);
    const Vec3 outside = (p.cwiseAbs() - half).cwiseMax(0.0);
    if (outside.isZero(0.0)) continue;
    const std::vector<Touch> touches = touches_with(Sphere{0.2}, {Quat::Identity(), p}, mesh, 5.0);
    const Touch* nearest = deepest_of(touches);
    ASSERT_NE(nearest, nullptr);
    EXPECT_NEAR(nearest->separation, outside.norm() - 0.2, 4e-15);  // measured 4.4e-16
    const Vec3 away = outside.cwiseProduct(p.cwiseQuotient(p.cwiseAbs())).normalized();
    EXPECT_LE((nearest->normal_W + away).norm(), 1e-14);
  }
}

// Whatever lies on flat ground has the contacts of the half-space, each once or, within 0.1 mm of a seam, twice.
TEST(CollideTriangle, SeamsOfFlatGroundMakeNoContacts) {
  const TriangleMeshPointer mesh = flat_mesh(12, 0.3, true);
  for (const Body& body : bodies()) {
    RandomPose random(35);
    for (int i = 0; i < 200; ++i) {
      const Quat q = random.rotation();
      Vec3 p = random.vector(-0.3, 0.3);
      std::vector<Touch> lifted;
      append(query(HalfSpace{}, Pose{}, body.shape, {q, Vec3(p.x(), p.y(), 5.0)}, 10.0), Pose{}, lifted);
      p.z() = 5.0 - deepest_of(lifted)->separation + random.uniform(-0.01, 0.01);
      const Pose X{q, p};
      std::vector<Touch> plane;
      append(query(HalfSpace{}, Pose{}, body.shape, X, 0.02), Pose{}, plane);
      const std::vector<Touch> touches = touches_with(body.shape, X, mesh, 0.02);
      for (const Touch& touch : touches) {
        EXPECT_LE((touch.normal_W + Vec3::UnitZ()).norm(), 1e-14) << body.name;
        double nearest = 1.0;
        for (const Touch& expected : plane) {
          nearest = std::min(
              nearest, (touch.p_W - expected.p_W).norm() + std::abs(touch.separation - expected.separation));
        }
        EXPECT_LE(nearest, 1e-14) << body.name << " " << i;
      }
      const Touch *expected = deepest_of(plane), *found = deepest_of(touches);
      ASSERT_NE(found, nullptr);
      EXPECT_NEAR(found->separation, expected->separation, 1e-15);
    }
  }
}

TEST(CollideTriangle, ASwappedQueryIsTheSameContactTurnedRound) {
  const Vec3 half(0.8, 0.6, 0.5);
  const TriangleMeshPointer mesh = box_mesh(half, 2);
  RandomPose random(37);
  for (const Body& body : bodies()) {
    int contacts = 0;
    for (int i = 0; i < 400; ++i) {
      const Pose X_WA = random.pose(1.0), X_WB = random.pose(0.1);
      const auto part = static_cast<std::uint32_t>(i) % mesh->triangle_count();
      const Manifold ab = query(body.shape, X_WA, mesh, X_WB, 0.3, {}, part);
      Manifold ba = query(mesh, X_WB, body.shape, X_WA, 0.3, {}, part);
      ASSERT_EQ(ab.count, ba.count);
      if (ab.count == 0) continue;
      ++contacts;
      Manifold turned = ab;
      swap_shapes(turned, relative_pose(X_WA, X_WB));
      EXPECT_EQ(turned.normal_A, ba.normal_A);
      for (std::size_t k = 0; k < static_cast<std::size_t>(ab.count); ++k) {
        EXPECT_EQ(turned.points[k].p_A, ba.points[k].p_A);
        EXPECT_EQ(turned.points[k].separation, ba.points[k].separation);
        EXPECT_EQ(turned.points[k].feature, ba.points[k].feature);
      }
    }
    EXPECT_GT(contacts, 5) << body.name;
  }
}

// Curved shapes take the way through a flat body; here a sphere takes it too, as an ellipsoid.
TEST(CollideTriangle, TheWayThroughAFlatBodyAgreesWithTheExactOne) {
  const Sphere sphere{0.3};
  const Ellipsoid ellipsoid{Vec3(0.3, 0.3, 0.3)};
  for (const TriangleMeshPointer& mesh : {box_mesh(Vec3(0.8, 0.6, 0.5), 2), flat_mesh(12, 0.3, true)}) {
    RandomPose random(39);
    int contacts = 0;
    for (int i = 0; i < 3000; ++i) {
      const Pose X = random.pose(1.0);
      const std::vector<Touch> exact = touches_with(sphere, X, mesh, 0.02);
      if (exact.empty()) continue;
      std::vector<Touch> touches;
      for (std::uint32_t part = 0; part < mesh->triangle_count(); ++part) {
        PlacedTriangle triangle(*mesh, part, relative_pose(X, Pose{}));
        append(collide_triangle_hull(ellipsoid, triangle, 0.02), X, touches);
      }
      const Touch *expected = deepest_of(exact), *found = deepest_of(touches);
      ASSERT_NE(found, nullptr) << i << " " << expected->separation;
      EXPECT_NEAR(found->separation, expected->separation, 1e-12) << i;
      EXPECT_LE((found->normal_W - expected->normal_W).norm(), 1e-6) << i;
      ++contacts;
    }
    EXPECT_GT(contacts, 100);
  }
}

TEST(CollideTriangle, TheSurfaceHasOneSide) {
  const TriangleMeshPointer mesh = flat_mesh(4, 1.0, false);
  for (const Body& body : bodies()) {
    const double above = 0.15, below = -0.15;
    EXPECT_FALSE(touches_with(body.shape, {Quat::Identity(), Vec3(0.1, 0.1, above)}, mesh, 0.02).empty());
    EXPECT_TRUE(touches_with(body.shape, {Quat::Identity(), Vec3(0.1, 0.1, below)}, mesh, 0.02).empty())
        << body.name << ": its middle is behind the plane";
  }
}

}  // namespace
}  // namespace tumble::test
