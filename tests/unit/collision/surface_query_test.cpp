// Queries of a surface: the skin of a box, cut into triangles, answers from outside as the box does.
#include "collision/surface_query.h"

#include <gtest/gtest.h>

#include <array>

#include "collision/box_polytope.h"
#include "collision/ray_cast.h"
#include "sample_shapes.h"

namespace tumble::test {
namespace {

/// Every face as a grid of n x n quads, each two triangles, counter-clockwise from outside.
TriangleMeshPointer skin_of(const Box& box, std::uint32_t n) {
  const BoxPolytope view(box);
  std::vector<Vec3> vertices;
  std::vector<TriangleMesh::Corners> triangles;
  for (const Polytope::Face& face : view.faces) {
    const auto loop = view.loop(face);
    const Vec3 origin = view.vertices[loop[0]];
    const Vec3 u = (view.vertices[loop[1]] - origin) / n, v = (view.vertices[loop[3]] - origin) / n;
    const auto first = static_cast<std::uint32_t>(vertices.size());
    for (std::uint32_t i = 0; i <= n; ++i) {
      for (std::uint32_t j = 0; j <= n; ++j) vertices.push_back(origin + i * u + j * v);
    }
    for (std::uint32_t i = 0; i < n; ++i) {
      for (std::uint32_t j = 0; j < n; ++j) {
        const std::uint32_t a = first + i * (n + 1) + j, b = a + n + 1;
        triangles.push_back({a, b, b + 1});
        triangles.push_back({a, b + 1, a + 1});
      }
    }
  }
  return std::make_shared<const TriangleMesh>(vertices, triangles);
}

TEST(SurfaceQuery, SkinOfABoxAnswersAsTheBox) {
  RandomPose random(41);
  int ray_hits = 0, cast_hits = 0, misses = 0;
  double ray_error = 0.0;
  std::array<double, 2> cast_error{}, distance_error{};  // of flat and round, of curved shapes
  for (int i = 0; i < 60; ++i) {
    const Box box{random.vector(0.4, 1.2)};
    const Shape skin = skin_of(box, 4);
    for (const Shape& shape : random_shapes(random, 0.1, 0.4)) {
      for (int k = 0; k < 5; ++k) {
        const Vec3 d = random.direction();
        const Quat q = random.rotation();
        const Pose X_AB = place_apart(shape, box, d, q, random.log_uniform(1e-6, 2.0));
        const Distance to_box = compute_distance(shape, box, X_AB);
        const Distance to_skin = compute_distance(shape, *surface_of(skin), X_AB);
        const std::size_t kind = is_curved(shape) ? 1 : 0;
        distance_error[kind] = std::max(distance_error[kind], std::abs(to_box.upper - to_skin.upper));
        EXPECT_FALSE(overlaps_surface(shape, *surface_of(skin), X_AB));

        const Vec3 way = 1.5 * X_AB.p + random.vector(-1.5, 1.5);
        const auto on_box = cast_shape(shape, box, X_AB, way), on_skin = cast_shape(shape, skin, X_AB, way);
        ASSERT_EQ(on_box.has_value(), on_skin.has_value());
        (on_box ? cast_hits : misses)++;
        if (on_box) {
          cast_error[kind] = std::max(
              cast_error[kind], std::abs(on_box->fraction - on_skin->fraction) * -on_box->normal_A.dot(way));
        }
        const Vec3 from = 5.0 * random.direction(), to = random.vector(-1.0, 1.0);
        const Ray ray{from, (to - from).normalized()};
        const auto box_hit = cast_ray(box, ray), skin_hit = cast_ray(skin, ray);
        ASSERT_EQ(box_hit.has_value(), skin_hit.has_value());
        if (!box_hit) continue;
        ++ray_hits;
        ray_error = std::max(ray_error, std::abs(box_hit->distance - skin_hit->distance) *
                                            -box_hit->normal.dot(ray.direction));
        EXPECT_NEAR((box_hit->normal - skin_hit->normal).norm(), 0.0, 1e-14);
      }
    }
  }
  EXPECT_GT(ray_hits, 300);
  EXPECT_GT(cast_hits, 300);
  EXPECT_GT(misses, 50);
  EXPECT_LE(ray_error, 1e-14);          // measured 2.4e-15
  EXPECT_LE(cast_error[0], 3e-14);      // measured 7e-15
  EXPECT_LE(distance_error[0], 2e-15);  // measured 4e-16
  EXPECT_LE(cast_error[1], 1e-12);      // measured 1.2e-13
  EXPECT_LE(distance_error[1], 1e-13);  // measured 2.3e-14
}

TEST(SurfaceQuery, StartsOnAndInTheSurface) {
  const Shape skin = skin_of({Vec3::Ones()}, 2);
  const Box box{Vec3::Constant(0.5)};
  const Pose on_top{Quat::Identity(), Vec3(0, 0, -1.5)};
  EXPECT_TRUE(overlaps_surface(box, *surface_of(skin), on_top));
  EXPECT_FALSE(cast_shape(box, skin, on_top, Vec3(1, 0, 0)).has_value());  // slides
  EXPECT_FALSE(cast_shape(box, skin, on_top, Vec3(0, 0, 1)).has_value());  // leaves
  const auto into = cast_shape(box, skin, on_top, Vec3(0.1, 0, -1));
  ASSERT_TRUE(into.has_value());
  EXPECT_EQ(into->fraction, 0.0);
  EXPECT_FALSE(into->inside);
  EXPECT_EQ(into->normal_A, Vec3::UnitZ());
  const auto through = cast_shape(box, skin, {Quat::Identity(), Vec3(0, 0, -1.25)}, Vec3(0, 0, -1));
  ASSERT_TRUE(through.has_value());
  EXPECT_TRUE(through->inside);
  EXPECT_EQ(through->normal_A, Vec3::UnitZ());
  // A surface has no inside: a box within it touches nothing and leaves through the back of it.
  const Box small{Vec3::Constant(0.1)};
  EXPECT_FALSE(overlaps_surface(small, *surface_of(skin), {}));
  EXPECT_FALSE(cast_shape(small, skin, {}, Vec3(3, 0, 0)).has_value());
  EXPECT_NEAR(compute_distance(small, *surface_of(skin), {}).upper, 0.9, 1e-15);
}

/// Six slopes round a peak at the origin, the first of them turned on by `turn`.
TriangleMeshPointer peak_mesh(std::uint32_t turn) {
  const std::vector<Vec3> vertices = {Vec3(0, 0, 0),       Vec3(1, 0, -0.5),  Vec3(0.5, 1, -0.5),
                                      Vec3(-0.5, 1, -0.5), Vec3(-1, 0, -0.5), Vec3(-0.5, -1, -0.5),
                                      Vec3(0.5, -1, -0.5)};
  std::vector<TriangleMesh::Corners> triangles;
  for (std::uint32_t i = turn; i < turn + 6; ++i) triangles.push_back({0, 1 + i % 6, 1 + (i + 1) % 6});
  return std::make_shared<const TriangleMesh>(vertices, triangles);
}

/// In whatever order the surface's tree visits them.
TEST(SurfaceQuery, OfEqualTrianglesTheLowestIndexAnswers) {
  const Box box{Vec3::Constant(0.5)};
  for (std::uint32_t turn = 0; turn < 6; ++turn) {
    const TriangleMeshPointer peak = peak_mesh(turn);
    const SurfaceTriangle lowest = peak->triangle(0);
    const auto ray_hit = cast_ray(Shape(peak), {Vec3::UnitZ(), -Vec3::UnitZ()});
    ASSERT_TRUE(ray_hit.has_value());
    EXPECT_EQ(ray_hit->distance, 1.0);
    EXPECT_EQ(ray_hit->feature, 0u);
    const auto cast_hit = cast_shape(box, Shape(peak), {}, -Vec3::UnitZ());
    ASSERT_TRUE(cast_hit.has_value());
    EXPECT_TRUE(cast_hit->inside);
    EXPECT_EQ(cast_hit->normal_A, lowest.normal);
    EXPECT_EQ(compute_distance(box, *peak, {}).b_A, compute_distance(box, lowest.corner, {}).b_A);
  }
}

}  // namespace
}  // namespace tumble::test
