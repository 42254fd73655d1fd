// Triangle meshes and height fields as surfaces: construction, neighbourhood, queries against brute force.
#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>

#include "support/surface_meshes.h"

namespace tumble::test {
namespace {

using Corners = TriangleMesh::Corners;

template <class Make>
std::string error_of(Make make) {
  try {
    make();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

Aabb bounds_of(const SurfaceTriangle& triangle) {
  Aabb box;
  for (const Vec3& p : triangle.corner) box = box.united({p, p});
  return box;
}

void expect_queries_like_brute_force(const TriangleSurface& surface, double reach) {
  RandomPose random(7);
  for (int i = 0; i < 300; ++i) {
    const Vec3 middle = random.vector(-reach, reach);
    const double size = random.log_uniform(1e-3, 2.0) * reach;
    const Aabb box{middle, middle + Vec3::Constant(size)};
    std::vector<std::uint32_t> found, expected;
    surface.query(box, found);
    for (std::uint32_t t = 0; t < surface.triangle_count(); ++t) {
      if (bounds_of(surface.triangle(t)).overlaps(box)) expected.push_back(t);
    }
    ASSERT_EQ(found, expected) << i;
  }
}

/// What each triangle says of its neighbours, its neighbours say of it.
void expect_neighbours_agree(const TriangleSurface& surface) {
  for (std::uint32_t t = 0; t < surface.triangle_count(); ++t) {
    const SurfaceTriangle own = surface.triangle(t);
    const TriangleNeighbours across = surface.neighbours(t);
    EXPECT_NEAR(own.normal.norm(), 1.0, 1e-15);
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 &tail = own.corner[k], &head = own.corner[(k + 1) % 3];
      int sharing = 0;
      for (std::uint32_t other = 0; other < surface.triangle_count(); ++other) {
        const SurfaceTriangle that = surface.triangle(other);
        for (std::size_t j = 0; j < 3; ++j) {
          if (that.corner[j] != head || that.corner[(j + 1) % 3] != tail) continue;
          ++sharing;
          EXPECT_EQ(across.beyond[k], that.corner[(j + 2) % 3]);
          EXPECT_EQ(across.beyond_normal[k], that.normal);
          EXPECT_EQ(across.bend[k], surface.neighbours(other).bend[j]);
        }
      }
      EXPECT_EQ(sharing, across.bend[k] == Bend::open ? 0 : 1);
    }
  }
}

HeightField bumpy_field(std::uint32_t columns, std::uint32_t rows) {
  RandomPose random(17);
  std::vector<double> heights;
  for (std::uint32_t i = 0; i < columns * rows; ++i) heights.push_back(random.uniform(-1.0, 1.0));
  return HeightField(columns, rows, 0.5, 0.25, std::move(heights));
}

TEST(TriangleMesh, ABoxOfTrianglesIsClosedAndConvex) {
  const TriangleMeshPointer mesh = box_mesh(Vec3(1, 2, 3), 2);
  EXPECT_EQ(mesh->triangle_count(), 48u);
  EXPECT_EQ(mesh->vertices().size(), 26u) << "shared corners and edges are welded";
  EXPECT_EQ(mesh->open_edges(), 0u);
  EXPECT_EQ(mesh->odd_edges(), 0u);
  EXPECT_EQ(mesh->dropped(), 0u);
  EXPECT_EQ(mesh->bounds().lower, Vec3(-1, -2, -3));
  EXPECT_EQ(mesh->bounds().upper, Vec3(1, 2, 3));
  int convex = 0, flat = 0;
  for (std::uint32_t t = 0; t < 48; ++t) {
    for (const Bend bend : mesh->neighbours(t).bend) {
      convex += bend == Bend::convex;
      flat += bend == Bend::flat;
    }
    EXPECT_GT(mesh->triangle(t).normal.dot(mesh->triangle(t).corner[0]), 0.0) << "outward";
  }
  EXPECT_EQ(convex, 12 * 2 * 2);  // 12 edges of the box in two pieces, seen from both sides
  EXPECT_EQ(flat, 48 * 3 - convex);
  expect_neighbours_agree(*mesh);
}

TEST(TriangleMesh, BendsTellGroovesFromRidges) {
  const auto bend_of = [](double slope) { return fold_mesh(slope, 1.0)->neighbours(0).bend[1]; };
  EXPECT_EQ(bend_of(0.5), Bend::concave);
  EXPECT_EQ(bend_of(-0.5), Bend::convex);
  EXPECT_EQ(bend_of(0.0), Bend::flat);
  EXPECT_EQ(bend_of(1e-4), Bend::concave);
  EXPECT_EQ(bend_of(1e-6), Bend::flat);
  EXPECT_EQ(fold_mesh(0.5, 1.0)->neighbours(0).bend[0], Bend::open);
  // Both sides of a sheet: the rim is a ridge of 180 degrees.
  const std::vector<Vec3> v = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)};
  const TriangleMesh sheet(v, {{0, 1, 2}, {0, 2, 1}});
  for (const Bend bend : sheet.neighbours(0).bend) EXPECT_EQ(bend, Bend::convex);
}

TEST(TriangleMesh, TopsAreWhereAPlaneTouches) {
  const TriangleMeshPointer mesh = box_mesh(Vec3(1, 1, 1), 2);
  for (std::uint32_t i = 0; i < mesh->vertices().size(); ++i) {
    const Vec3& p = mesh->vertices()[i];
    const bool corner = p.cwiseAbs() == Vec3(1, 1, 1);
    EXPECT_EQ(mesh->is_top(i, p.normalized()), corner || p.cwiseAbs().sum() <= 2.0) << p.transpose();
    if (p.z() == 1.0) {
      EXPECT_TRUE(mesh->is_top(i, Vec3::UnitZ()));
      // Leaning towards the middle of the face is allowed nowhere but in the rim's own cone.
      EXPECT_EQ(mesh->is_top(i, Vec3(1e-3, 0, 1).normalized()), p.x() == 1.0);
    }
  }
}

TEST(TriangleMesh, WhatHasNoAreaIsDroppedAndCounted) {
  const std::vector<Vec3> v = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(2, 0, 0), Vec3(1, 0, 0)};
  const TriangleMesh mesh(v, {{0, 1, 2}, {0, 1, 3}, {1, 1, 2}, {1, 4, 2}});
  EXPECT_EQ(mesh.triangle_count(), 1u);
  EXPECT_EQ(mesh.dropped(), 3u);
  EXPECT_EQ(mesh.open_edges(), 3u);
}

TEST(TriangleMesh, OddEdgesCountAsOpen) {
  const std::vector<Vec3> v = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, -1, 0), Vec3(0, 0, 1)};
  const TriangleMesh fan(v, {{0, 1, 2}, {1, 0, 3}, {1, 0, 4}});
  EXPECT_EQ(fan.odd_edges(), 1u);
  const TriangleMesh flipped(v, {{0, 1, 2}, {0, 1, 3}});
  EXPECT_EQ(flipped.odd_edges(), 1u);
  EXPECT_EQ(flipped.neighbours(0).bend[0], Bend::open);
}

TEST(TriangleMesh, ErrorsNameTheCulprit) {
  const std::vector<Vec3> v = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)};
  std::vector<Vec3> bad = v;
  bad[1].y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(error_of([&] {
              TriangleMesh(bad, {{0, 1, 2}});
            }),
            "triangle mesh: vertex 1 is not within 1e9 m (1 nan 0)");
  EXPECT_EQ(error_of([&] {
              TriangleMesh(v, {{0, 1, 2}, {0, 1, 3}});
            }),
            "triangle mesh: triangle 1 names vertex 3 of 3");
  EXPECT_EQ(error_of([&] {
              TriangleMesh(v, {{0, 1, 1}});
            }),
            "triangle mesh: none of its 1 triangles has an area");
  EXPECT_EQ(error_of([&] { TriangleMesh(v, {}); }), "triangle mesh: none of its 0 triangles has an area");
}

TEST(TriangleMesh, QueriesFindExactlyTheTrianglesWhoseBoundsMeet) {
  expect_queries_like_brute_force(*flat_mesh(20, 0.1, true), 1.2);
  expect_queries_like_brute_force(*box_mesh(Vec3(1, 0.7, 0.4), 9), 1.2);
}

TEST(HeightField, IsTheMeshOfItsGrid) {
  const HeightField field = bumpy_field(6, 9);
  ASSERT_EQ(field.triangle_count(), 2u * 5 * 8);
  EXPECT_EQ(field.bounds().lower.head<2>(), Eigen::Vector2d(-1.25, -1.0));
  EXPECT_EQ(field.bounds().upper.head<2>(), Eigen::Vector2d(1.25, 1.0));
  expect_neighbours_agree(field);
  std::vector<Vec3> vertices;
  std::vector<Corners> triangles;
  for (std::uint32_t t = 0; t < field.triangle_count(); ++t) {
    const SurfaceTriangle triangle = field.triangle(t);
    EXPECT_GT(triangle.normal.z(), 0.0);
    for (const Vec3& p : triangle.corner) vertices.push_back(p);
    triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
  }
  const TriangleMesh mesh(vertices, triangles);
  EXPECT_EQ(mesh.vertices().size(), 54u);
  RandomPose random(3);
  for (std::uint32_t t = 0; t < field.triangle_count(); ++t) {
    const SurfaceTriangle own = field.triangle(t), other = mesh.triangle(t);
    EXPECT_EQ(own.corner, other.corner);
    EXPECT_EQ(field.neighbours(t).bend, mesh.neighbours(t).bend);
    for (std::size_t k = 0; k < 3; ++k) {
      for (int i = 0; i < 20; ++i) {
        const Vec3 d = random.direction();
        EXPECT_EQ(field.is_top(own.vertex[k], d), mesh.is_top(other.vertex[k], d));
      }
    }
  }
}

TEST(HeightField, QueriesFindExactlyTheTrianglesWhoseBoundsMeet) {
  expect_queries_like_brute_force(bumpy_field(2, 2), 1.0);
  expect_queries_like_brute_force(bumpy_field(14, 23), 2.0);
}

TEST(HeightField, ErrorsNameTheValue) {
  const auto make = [](std::uint32_t columns, std::uint32_t rows, double dx, double h) {
    return error_of([&] { HeightField(columns, rows, dx, 1.0, {0, 0, 0, h}); });
  };
  EXPECT_EQ(make(2, 2, 1.0, 0.0), "");
  EXPECT_EQ(make(1, 4, 1.0, 0.0), "height field: needs 2 x 2 to 1e8 heights (1 x 4)");
  EXPECT_EQ(make(2, 3, 1.0, 0.0), "height field: 2 x 3 needs 6 heights (4)");
  EXPECT_EQ(make(2, 2, 0.0, 0.0), "height field: dx must be finite, > 0 and <= 1e9 m (0)");
  EXPECT_EQ(make(2, 2, 1.0, std::numeric_limits<double>::infinity()),
            "height field: height of column 1, row 1 is not within 1e9 m (inf)");
}

}  // namespace
}  // namespace tumble::test
