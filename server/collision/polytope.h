// One view of everything with flat faces (boxes, hulls, triangles), so that exact feature searches are written once; and
// the signed distance of a point from it. Lengths in [m], in the polytope's own frame.
#pragma once

#include <cstdint>
#include <span>

#include "collision/segment.h"
#include "math/four.h"
#include "math/types.h"

namespace tumble {

/// Merged planar faces, unique edges. Whoever has a body of this kind owns what it views.
struct Polytope {
  struct Face {
    Vec3 normal;                 ///< Outward unit normal.
    double offset;               ///< normal . x = offset on the face [m].
    std::uint32_t first, count;  ///< Slice of `loops`: the face's vertices, counter-clockwise from outside.
    double width = 0.0;          ///< Across where it is narrow: twice its area over its perimeter [m].
  };
  /// The plane through one side of a face and its normal: inside is outward . x <= offset.
  struct Side {
    Vec3 outward;   ///< Unit, in the face's plane; zero if the side has no length.
    double offset;  ///< [m]
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

  std::span<const Vec3> vertices{};
  std::span<const std::uint32_t> loops{};
  std::span<const Side> sides{};  ///< To each of `loops`: from there to the next of its face.
  std::span<const Face> faces{};
  std::span<const Edge> edges{};
  std::span<const std::uint32_t> neighbour_offsets{};  ///< Size vertices + 1: slice of `neighbours` of each.
  std::span<const std::uint32_t> neighbours{};         ///< Vertices joined by an edge, for hill climbing.
  std::span<const std::uint32_t> edges_around{};       ///< The edge to each of `neighbours`.
  /// The vertices and faces once more, lane by lane; after the last one the first again.
  std::span<const FourVectors> vertex_fours{};
  std::span<const FourFaces> face_fours{};
  Vec3 centre = Vec3::Zero();  ///< Well inside.
  double radius = 0.0;         ///< Largest |vertex| [m].

  std::span<const Side> sides_of(const Face& face) const { return sides.subspan(face.first, face.count); }
  std::span<const std::uint32_t> loop(const Face& face) const {
    return loops.subspan(face.first, face.count);
  }
  std::span<const std::uint32_t> edges_around_vertex(std::uint32_t vertex) const {
    const std::uint32_t first = neighbour_offsets[vertex];
    return edges_around.subspan(first, neighbour_offsets[vertex + 1] - first);
  }
};

/// The side of a face with this normal from one vertex to the next.
inline Polytope::Side make_side(const Vec3& normal, const Vec3& tail, const Vec3& head) {
  const Vec3 outward = direction_or((head - tail).cross(normal), Vec3::Zero());
  return {outward, outward.dot(tail)};
}

/// Fills in the fours; there must be room for (count + 3) / 4 of them.
void put_in_fours(std::span<const Vec3> vertices, FourVectors* fours);
void put_in_fours(std::span<const Polytope::Face> faces, Polytope::FourFaces* fours);

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
/// By a scan or, of many vertices, by descent over edges from vertex `start`. Stops at once below `enough`: the true least
/// height is then below it too.
Lowest descend(const Polytope& polytope, const Vec3& d, std::uint32_t start, double enough);
/// What that says, to the bit, if this vertex is the lowest.
Lowest lowest_at(const Polytope& polytope, const Vec3& d, std::uint32_t vertex);

/// Among the faces that meet in the furthest vertex along d, the one whose normal goes along d the most: the face that
/// another body coming from there meets. A function of d alone.
std::uint32_t face_towards(const Polytope& polytope, const Vec3& d);
/// The same if that vertex is known.
std::uint32_t face_towards(const Polytope& polytope, const Vec3& d, std::uint32_t vertex);

/// Of the two faces of an edge, the one that looks along d more.
std::uint32_t flatter_face(const Polytope& polytope, const Polytope::Edge& edge, const Vec3& d);

/// A direction (of any length > 0) in the middle of those along which the edge `along` (tail to head) between two faces is
/// furthest out: their sum, and what lies between them if they look opposite ways, as on a flat body.
inline Vec3 outward_from_edge(const Vec3& along, const Vec3& left_normal, const Vec3& right_normal) {
  return left_normal + right_normal + along.cross(left_normal - right_normal);
}

/// How far the foot of p on the face's plane lies beside the face, by the lines of its sides [m]; < 0 inside.
double height_beside_face(const Polytope& polytope, std::uint32_t face, const Vec3& p);

/// How deep p lies behind the nearest face but this one [m]; < 0: beyond one of them.
double depth_behind_others(const Polytope& polytope, std::uint32_t face, const Vec3& p);

struct PointDistance {
  double distance;  ///< < 0 inside [m].
  Vec3 normal;      ///< Unit, out of the polytope towards the point.
  Vec3 foot;        ///< Closest point of the surface.
  std::uint32_t feature;
};
/// Distance of point p. Ends early with any lower bound above `enough` [m] once there is one.
PointDistance compute_distance(const Polytope& polytope, const Vec3& p, double enough);

}  // namespace tumble
