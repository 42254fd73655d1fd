// One view of everything with flat faces (boxes, hulls), so that exact feature searches are written once; and the
// signed distance of a point from it. Lengths in [m], in the polytope's own frame.
#pragma once

#include <array>
#include <span>

#include "collision/convex_hull.h"
#include "collision/shape.h"

namespace tumble {

struct Polytope {
  std::span<const Vec3> vertices{};
  std::span<const std::uint32_t> loops{};
  std::span<const ConvexHull::Face> faces{};
  std::span<const ConvexHull::Edge> edges{};
  std::span<const std::uint32_t> neighbour_offsets{}, neighbours{}, edges_around{};
  std::span<const FourVectors> vertex_fours{};
  std::span<const ConvexHull::FourFaces> face_fours{};
  Vec3 centre = Vec3::Zero();  ///< Well inside.
  double radius = 0.0;

  std::span<const std::uint32_t> loop(const ConvexHull::Face& face) const {
    return loops.subspan(face.first, face.count);
  }
  std::span<const std::uint32_t> edges_around_vertex(std::uint32_t vertex) const {
    const std::uint32_t first = neighbour_offsets[vertex];
    return edges_around.subspan(first, neighbour_offsets[vertex + 1] - first);
  }
};

/// Corners and face planes of a box; face 2i looks along +axis i, face 2i + 1 along -axis i.
class BoxFeatures {
 public:
  explicit BoxFeatures(const Box& box);
  BoxFeatures(const BoxFeatures&) = delete;  // views point into this object
  BoxFeatures& operator=(const BoxFeatures&) = delete;
  Polytope view() const;

 private:
  double radius_;
  std::array<Vec3, 8> vertices_;
  std::array<ConvexHull::Face, 6> faces_;
  std::array<FourVectors, 2> vertex_fours_;
  std::array<ConvexHull::FourFaces, 2> face_fours_;
};

/// A triangle (corners counter-clockwise about its unit normal) as a body without thickness: face 0 looks along the normal.
class TriangleFeatures {
 public:
  TriangleFeatures(const std::array<Vec3, 3>& corners, const Vec3& normal);
  TriangleFeatures(const TriangleFeatures&) = delete;  // views point into this object
  TriangleFeatures& operator=(const TriangleFeatures&) = delete;
  Polytope view() const;

 private:
  std::array<Vec3, 3> vertices_;
  std::array<ConvexHull::Face, 2> faces_;
  FourVectors vertex_four_;
  ConvexHull::FourFaces face_four_;
  Vec3 centre_;
  double radius_ = 0.0;
};

Polytope view_of(const ConvexHull& hull);

/// Vertex with the least height along d, by descent over edges from vertex `start`. Stops at once below `enough`: the
/// true least height is then below it too.
Lowest descend(const Polytope& polytope, const Vec3& d, std::uint32_t start, double enough);
/// What that says, to the bit, if this vertex is the lowest.
Lowest lowest_at(const Polytope& polytope, const Vec3& d, std::uint32_t vertex);

/// Among the faces that meet in the furthest vertex along d, the one whose normal goes along d the most: the face that
/// another body coming from there meets. A function of d alone.
std::uint32_t face_towards(const Polytope& polytope, const Vec3& d);
/// The same if that vertex is known.
std::uint32_t face_towards(const Polytope& polytope, const Vec3& d, std::uint32_t vertex);

/// Of the two faces of an edge, the one that looks along d more.
std::uint32_t flatter_face(const Polytope& polytope, const ConvexHull::Edge& edge, const Vec3& d);

/// A direction (of any length > 0) in the middle of those along which the edge `along` (tail to head) between two faces is
/// furthest out: their sum, and what lies between them if they look opposite ways, as on a flat body.
inline Vec3 outward_from_edge(const Vec3& along, const Vec3& left_normal, const Vec3& right_normal) {
  return left_normal + right_normal + along.cross(left_normal - right_normal);
}

/// Whether the foot of p on the face's plane lies in the face.
bool is_over_face(const Polytope& polytope, std::uint32_t face, const Vec3& p);

/// How far the foot of p on the face's plane lies beside the face, by the lines of its edges [m]; < 0 inside.
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
