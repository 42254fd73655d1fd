// Hulls for tests, built by brute force: random points on an ellipsoid (triangles only, every triple of points with all
// others on one side), and a box as hull (quads).
#pragma once

#include <algorithm>
#include <map>
#include <memory>

#include "collision/box_polytope.h"
#include "random_pose.h"

namespace tumble::test {

inline HullPointer finish_hull(ConvexHull::Parts hull) {
  add_topology(hull);
  return std::make_shared<const ConvexHull>(std::move(hull));
}

inline HullPointer random_hull(RandomPose& random, int points, const Vec3& radii) {
  ConvexHull::Parts hull;
  for (int i = 0; i < points; ++i) {
    const Vec3 d = random.direction();
    hull.vertices.push_back(d.cwiseProduct(radii));
  }
  const std::uint32_t n = static_cast<std::uint32_t>(points);
  for (std::uint32_t i = 0; i < n; ++i) {
    for (std::uint32_t j = 0; j < n; ++j) {
      for (std::uint32_t k = 0; k < n; ++k) {
        if (j <= i || k <= i || j == k) continue;
        const Vec3 normal =
            (hull.vertices[j] - hull.vertices[i]).cross(hull.vertices[k] - hull.vertices[i]).normalized();
        const double offset = normal.dot(hull.vertices[i]);
        bool outer = true;
        for (std::uint32_t m = 0; m < n && outer; ++m) {
          outer = m == i || m == j || m == k || normal.dot(hull.vertices[m]) < offset;
        }
        if (!outer) continue;
        hull.faces.push_back({normal, offset, static_cast<std::uint32_t>(hull.loops.size()), 3});
        hull.loops.insert(hull.loops.end(), {i, j, k});
      }
    }
  }
  return finish_hull(std::move(hull));
}

inline HullPointer box_hull(const Box& box) {
  const BoxPolytope view(box);
  ConvexHull::Parts hull;
  hull.vertices.assign(view.vertices.begin(), view.vertices.end());
  hull.faces.assign(view.faces.begin(), view.faces.end());
  hull.loops.assign(view.loops.begin(), view.loops.end());
  return finish_hull(std::move(hull));
}

}  // namespace tumble::test
