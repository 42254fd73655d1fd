// Surfaces for tests: flat ground of good and of irregular triangles, boxes of triangles, grooves and ridges.
#pragma once

#include <cmath>
#include <memory>

#include "collision/shape.h"
#include "unit/collision/random_pose.h"

namespace tumble::test {

/// n x n rows of triangles with side `a` in the plane z = 0, centred; irregular: every vertex is moved at random.
inline TriangleMeshPointer flat_mesh(std::uint32_t n, double a, bool irregular) {
  std::vector<Vec3> vertices;
  std::vector<TriangleMesh::Corners> triangles;
  RandomPose random(3);
  const double middle = 0.5 * n;
  for (std::uint32_t j = 0; j <= n; ++j) {
    for (std::uint32_t i = 0; i <= n; ++i) {
      Vec3 p((i - middle + 0.5 * (j % 2)) * a, (j - middle) * a * std::sqrt(0.75), 0.0);
      if (irregular) {
        p.x() += random.uniform(-0.3, 0.3) * a;
        p.y() += random.uniform(-0.3, 0.3) * a;
      }
      vertices.push_back(p);
    }
  }
  for (std::uint32_t j = 0; j < n; ++j) {
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::uint32_t v = j * (n + 1) + i, up = v + n + 1;
      if (j % 2 == 1) {
        triangles.push_back({v, v + 1, up + 1});
        triangles.push_back({v, up + 1, up});
      } else {
        triangles.push_back({v, v + 1, up});
        triangles.push_back({v + 1, up + 1, up});
      }
    }
  }
  return std::make_shared<const TriangleMesh>(vertices, triangles);
}

/// The surface of a box, each face of n x n squares cut in two.
inline TriangleMeshPointer box_mesh(const Vec3& half_extents, std::uint32_t n) {
  std::vector<Vec3> vertices;
  std::vector<TriangleMesh::Corners> triangles;
  for (int face = 0; face < 6; ++face) {
    const int axis = face / 2, u = (axis + 1) % 3, v = (axis + 2) % 3;
    const bool positive = face % 2 == 0;
    const auto base = static_cast<std::uint32_t>(vertices.size());
    for (std::uint32_t j = 0; j <= n; ++j) {
      for (std::uint32_t i = 0; i <= n; ++i) {
        Vec3 p;
        p[axis] = positive ? half_extents[axis] : -half_extents[axis];
        p[u] = half_extents[u] * (2.0 * i / n - 1.0);
        p[v] = half_extents[v] * (2.0 * j / n - 1.0);
        vertices.push_back(p);
      }
    }
    for (std::uint32_t j = 0; j < n; ++j) {
      for (std::uint32_t i = 0; i < n; ++i) {
        const std::uint32_t a = base + j * (n + 1) + i, b = a + 1, c = a + n + 2, d = a + n + 1;
        triangles.push_back(positive ? TriangleMesh::Corners{a, b, c} : TriangleMesh::Corners{a, c, b});
        triangles.push_back(positive ? TriangleMesh::Corners{a, c, d} : TriangleMesh::Corners{a, d, c});
      }
    }
  }
  return std::make_shared<const TriangleMesh>(vertices, triangles);
}

/// Two slopes of inclination `slope` (tangent; > 0: a groove, < 0: a ridge) that meet along the y axis at z = 0, each
/// `length` wide and 2 `length` long.
inline TriangleMeshPointer fold_mesh(double slope, double length) {
  const double z = slope * length;
  const std::vector<Vec3> vertices = {Vec3(-length, -length, z), Vec3(0, -length, 0),
                                      Vec3(length, -length, z),  Vec3(-length, length, z),
                                      Vec3(0, length, 0),        Vec3(length, length, z)};
  return std::make_shared<const TriangleMesh>(
      vertices, std::vector<TriangleMesh::Corners>{{0, 1, 4}, {0, 4, 3}, {1, 2, 5}, {1, 5, 4}});
}

}  // namespace tumble::test
