// A triangle of a surface in the frame of the body A that meets it, with the question all contact with surfaces turns on:
// may the surface push along this direction here?
#pragma once

#include "collision/triangle_surface.h"
#include "math/pose.h"
#include "math/rotation.h"

namespace tumble {

/// Its neighbours are not known before `place_neighbours`.
struct PlacedTriangle : SurfaceTriangle, TriangleNeighbours {
  PlacedTriangle(const TriangleSurface& of, std::uint32_t part, const Pose& X_AB)
      : SurfaceTriangle(of.triangle(part)),
        surface(of),
        index(part),
        R_AB(rotation_matrix(X_AB.q)),
        p_AB(X_AB.p) {
    normal = R_AB * normal;
    for (std::size_t k = 0; k < 3; ++k) corner[k] = R_AB * corner[k] + p_AB;
  }

  void place_neighbours() {
    static_cast<TriangleNeighbours&>(*this) = surface.neighbours(index);
    for (std::size_t k = 0; k < 3; ++k) {
      if (bend[k] == Bend::open) continue;
      beyond[k] = R_AB * beyond[k] + p_AB;
      beyond_normal[k] = R_AB * beyond_normal[k];
    }
  }

  static std::size_t next(std::size_t k) { return k == 2 ? 0 : k + 1; }
  static std::size_t previous(std::size_t k) { return k == 0 ? 2 : k - 1; }
  Vec3 along(std::size_t k) const { return corner[next(k)] - corner[k]; }
  /// Corner that is furthest along c.
  std::size_t top(const Vec3& c) const {
    std::size_t best = 0;
    for (std::size_t k = 1; k < 3; ++k) {
      if (c.dot(corner[k]) > c.dot(corner[best])) best = k;
    }
    return best;
  }
  /// Across the triangle where it is narrow [m].
  double width() const {
    return along(0).cross(along(1)).norm() / (along(0).norm() + along(1).norm() + along(2).norm());
  }

  /// Two directions that are one, up to what an iterative search leaves.
  static bool same_direction(const Vec3& a, const Vec3& b) {
    return (a - b).squaredNorm() <= kAbout * kAbout;
  }

  /// Can the surface be furthest out along an edge?
  bool is_ridge(std::size_t k) const { return bend[k] == Bend::convex || bend[k] == Bend::open; }
  /// Normal of what lies across a ridge: the neighbour or the wall below a rim.
  Vec3 normal_across(std::size_t k) const {
    return bend[k] == Bend::open ? Vec3(along(k).cross(normal).normalized()) : beyond_normal[k];
  }
  /// Edges of the surface that leave corner k, from there on; of more than kSpokes the first. Returns how many.
  static constexpr std::size_t kSpokes = 32;
  std::size_t find_spokes(std::size_t k, std::array<Vec3, kSpokes>& spokes) const {
    const std::size_t count = surface.ring(vertex[k], spokes);
    for (std::size_t i = 0; i < count; ++i) spokes[i] = R_AB * spokes[i] + p_AB - corner[k];
    return count;
  }
  /// Does the surface end at one of its edges?
  bool is_at_rim() const { return bend[0] == Bend::open || bend[1] == Bend::open || bend[2] == Bend::open; }
  /// Is c (unit, normal to edge k) between the normals of the two sides of the edge?
  bool edge_allows(std::size_t k, const Vec3& c) const {
    if (!stays_below(corner[previous(k)], corner[k], c)) return false;
    return bend[k] == Bend::open ? c.dot(normal) >= 0.0 : stays_below(beyond[k], corner[k], c);
  }
  /// Is c (unit) within the cone of corner k, in which the surface is furthest out there?
  bool corner_allows(std::size_t k, const Vec3& c) const { return c.dot(normal) >= -kAlong && is_top(k, c); }
  /// Is c (unit) within the cone of corner k, a convex peak, but behind this triangle? Then it belongs to others there.
  bool corner_yields(std::size_t k, const Vec3& c) const {
    return c.dot(normal) < -kAlong && bend[k] == Bend::convex && bend[previous(k)] == Bend::convex &&
           is_top(k, c);
  }

  /// May the surface push along c here, if that is known up to kAbout? Across an edge it is taken as exactly so.
  bool allows_about(const Vec3& c) const {
    const std::size_t highest = top(c);
    if (corner_allows(highest, c)) return true;
    for (const std::size_t k : {highest, previous(highest)}) {
      const Vec3 edge = along(k).normalized();
      const double slant = edge.dot(c);
      if (is_ridge(k) && std::abs(slant) <= kAbout && edge_allows(k, (c - slant * edge).normalized()))
        return true;
    }
    return false;
  }

  bool is_top(std::size_t k, const Vec3& c) const {
    return stays_below(corner[next(k)], corner[k], c) && stays_below(corner[previous(k)], corner[k], c) &&
           surface.is_top(vertex[k], R_AB.transpose() * c);
  }

  /// Sine of the angle that an iterative search leaves of a direction.
  static constexpr double kAbout = 1e-6;
  /// Sine by which a direction may point into the triangle's plane.
  static constexpr double kAlong = 1e-9;

  const TriangleSurface& surface;
  std::uint32_t index;
  Mat3 R_AB;
  Vec3 p_AB;
};

}  // namespace tumble
