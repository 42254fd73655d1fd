// The triangles of a convex hull, decided without rounding: points on an integer grid, signs by 128-bit integers. So
// slivers and coplanar points cannot confuse it. Quickhull (Barber, Dobkin & Huhdanpaa 1996).
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace tumble {

/// Coordinates 0..kGridSize; the products of the sign test then stay below 2^123.
struct GridPoint {
  std::int64_t x, y, z;
};
inline constexpr std::int64_t kGridSize = std::int64_t{1} << 40;

struct HullTriangle {
  std::array<std::uint32_t, 3> vertex;     ///< Counter-clockwise from outside.
  std::array<std::uint32_t, 3> neighbour;  ///< Triangle across the edge vertex[i] -> vertex[i + 1].
};

/// Hull of distinct points, starting from the tetrahedron of four of them that do not lie in one plane. Points within a
/// face, an edge or the hull are in no triangle, except where the order of insertion met them as corners of coplanar
/// triangles.
std::vector<HullTriangle> compute_hull_triangles(const std::vector<GridPoint>& points,
                                                 const std::array<std::uint32_t, 4>& tetrahedron);

/// Sign of the volume of a tetrahedron: > 0 if d is in front of the triangle a b c (counter-clockwise from d).
int orientation(const GridPoint& a, const GridPoint& b, const GridPoint& c, const GridPoint& d);

}  // namespace tumble
