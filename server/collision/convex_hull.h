// A convex polyhedron: vertices, merged planar faces with counter-clockwise loops (seen from outside), unique edges.
// Built once from points (3-D quickhull with coplanar faces merged); constant afterwards and shared between bodies.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "math/types.h"

namespace tumble {

struct ConvexHull {
  struct Face {
    Vec3 normal;                 ///< Outward unit normal.
    double offset;               ///< normal . x = offset on the face [m].
    std::uint32_t first, count;  ///< Slice of `loops`: the face's vertices, counter-clockwise from outside.
    double width = 0.0;          ///< Across where it is narrow: twice its area over its perimeter [m].
  };
  struct Edge {
    std::uint32_t tail, head;             ///< Vertex indices.
    std::uint32_t left_face, right_face;  ///< Faces on either side; the loop of left_face runs tail -> head.
  };

  std::vector<Vec3> vertices;  ///< [m], only points on the hull.
  std::vector<std::uint32_t> loops;
  std::vector<Face> faces;
  std::vector<Edge> edges;
  std::vector<std::uint32_t> neighbour_offsets;  ///< Size vertices + 1: slice of `neighbours` of each vertex.
  std::vector<std::uint32_t> neighbours;         ///< Vertices joined by an edge, for hill climbing.
  std::vector<std::uint32_t> edges_around;       ///< The edge to each of `neighbours`.
  Vec3 centre = Vec3::Zero();                    ///< Mean of the vertices [m].
  double radius = 0.0;                           ///< Largest |vertex| [m].
};

/// Fills in edges, neighbours, edges around, widths, centre and radius from vertices, loops and faces.
void add_topology(ConvexHull& hull);

/// Of a face, the inradius of regular shapes [m].
double compute_width(const ConvexHull& hull, const ConvexHull::Face& face);

/// Looking at every vertex costs no more than going from neighbour to neighbour, up to here (measured: nothing gained at
/// 32 vertices, 2-4 times at 200).
inline constexpr std::size_t kScannedVertices = 64;

/// The vertex with the least height along d, the first of equals.
struct Lowest {
  std::uint32_t vertex;
  double height;
};
/// Of at least one and at most kScannedVertices.
Lowest scan_lowest(std::span<const Vec3> vertices, const Vec3& d);

/// Hull of at least 4 points [m] that span a volume. Throws std::invalid_argument naming the cause and the point
/// (fewer than 4 distinct points, non-finite coordinate, all in one plane within 1e-9 of their extent).
ConvexHull build_convex_hull(const std::vector<Vec3>& points);

}  // namespace tumble
