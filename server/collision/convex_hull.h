// A convex polyhedron: vertices, merged planar faces with counter-clockwise loops (seen from outside), unique edges.
// Built once from points (3-D quickhull with coplanar faces merged); constant afterwards and shared between bodies.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "math/four.h"
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

  /// Planes of four faces.
  struct FourFaces {
    FourVectors normal;
    Four offset;
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
  /// The vertices and faces once more, lane by lane; after the last one the first again.
  std::vector<FourVectors> vertex_fours;
  std::vector<FourFaces> face_fours;
};

/// Fills in edges, neighbours, edges around, widths, centre, radius and fours from vertices, loops and faces.
void add_topology(ConvexHull& hull);

/// Fills in the fours from vertices and faces.
void add_fours(ConvexHull& hull);

/// The fours of vertices and of faces; there must be room for (count + 3) / 4 of them.
void put_in_fours(std::span<const Vec3> vertices, FourVectors* fours);
void put_in_fours(std::span<const ConvexHull::Face> faces, ConvexHull::FourFaces* fours);

/// Largest |point| [m].
double bounding_radius(std::span<const Vec3> points);

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
/// Of at least one.
Lowest scan_lowest(std::span<const FourVectors> vertices, const Vec3& d);
/// By descent over edges from vertex `start`, which ends at once below `enough`: the least height is then below it too.
Lowest descend_edges(std::span<const Vec3> vertices, std::span<const std::uint32_t> neighbour_offsets,
                     std::span<const std::uint32_t> neighbours, const Vec3& d, std::uint32_t start,
                     double enough);
/// By what costs less.
Lowest lowest_vertex(const ConvexHull& hull, const Vec3& d);

/// Hull of at least 4 points [m] that span a volume. Throws std::invalid_argument naming the cause and the point
/// (fewer than 4 distinct points, non-finite coordinate, all in one plane within 1e-9 of their extent).
ConvexHull build_convex_hull(const std::vector<Vec3>& points);

}  // namespace tumble
