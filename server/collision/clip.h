// Face against face: the incident polygon is cut by the sides of the reference face (Sutherland-Hodgman), both seen along
// the contact normal, and what is left becomes contact points. A point lies in the middle of its gap. Its id names what
// meets in it, a vertex of A, a vertex of B, or an edge of each, and not who was cut by whom.
#pragma once

#include <array>

#include "collision/manifold_builder.h"
#include "math/four.h"

namespace tumble {

/// Faces with more vertices are thinned to this many, always with the deepest vertex kept.
inline constexpr int kMaxFaceVertices = 96;

/// The reference face's plane in A's frame: right-handed unit axes, face normal f outward, a point of the face [m]. The
/// contact normal n (unit, from the reference to the incident body) need not be f, only near it.
struct FacePlane {
  Vec3 origin_A, u_A, v_A, f_A, n_A;

  /// x, y: where the line through p along n meets the plane; z: the distance to there along n.
  Vec3 to_plane(const Vec3& p_A) const { return direction_to_plane(p_A - origin_A); }
  /// The same of the difference of two points.
  Vec3 direction_to_plane(const Vec3& d_A) const {
    const double z = f_A.dot(d_A) / f_A.dot(n_A);
    const Vec3 foot = d_A - z * n_A;
    return {u_A.dot(foot), v_A.dot(foot), z};
  }
  /// The middle between such a point and its foot on the plane, in A.
  Vec3 middle_A(const Vec3& p) const { return origin_A + p.x() * u_A + p.y() * v_A + (0.5 * p.z()) * n_A; }
};

/// One side of the reference face, from vertex `tail` to `head`: inside is nx x + ny y <= offset, (nx, ny) unit.
struct ClipSide {
  /// How far p lies outside [m].
  double outside(const Four& p) const { return nx * p[0] + ny * p[1] - offset; }

  double nx, ny, offset;
  std::uint32_t tail, head;
  std::uint32_t mark = 0;  ///< A bit by which corners on this side can be told.
};

/// A convex polygon over the reference plane (z = gap along the normal).
class ClipPolygon {
 public:
  explicit ClipPolygon(bool reference_is_a) : reference_is_a_(reference_is_a) {}
  /// Vertices in loop order; `vertex` is its number in its body, `mark` a bit of the edge that starts there.
  void add_vertex(const Vec3& p, std::uint32_t vertex, std::uint32_t mark = 0);
  /// After the last vertex.
  void close();

  /// Cuts away what is further outside than `tolerance` [m].
  void cut(const ClipSide& side, double tolerance);

  /// What is left, corner by corner. `marks`: of the edges and sides that meet in it.
  struct Corner {
    Vec3 p;
    std::uint32_t name, marks;
  };
  int count() const { return count_; }
  Corner corner(int i) const {
    const Vertex& vertex = loops_[static_cast<std::size_t>(current_)][static_cast<std::size_t>(i)];
    return {Vec3(vertex.p[0], vertex.p[1], vertex.p[2]), vertex.name, vertex.marks};
  }

  /// Everything up to the margin as manifold with normal_A (from A to B). If that is nothing although the bodies overlap, by
  /// rounding, the lowest corner of what is left speaks for it.
  Manifold make_manifold(const FacePlane& plane, const Vec3& normal_A, bool overlap, double margin,
                         double merge) const;

 private:
  static constexpr int kCapacity = 2 * kMaxFaceVertices + 2;
  struct Vertex {
    Four p;
    std::uint32_t name;
    std::uint32_t tail, head;   ///< Of the edge that starts here, as numbered in its body.
    bool on_side;               ///< That edge is a side of the reference face.
    std::uint32_t mark, marks;  ///< Of that edge; of all that meets in the vertex.
  };
  using Loop = std::array<Vertex, kCapacity>;
  /// Of what is left.
  Corner lowest_corner() const;
  static void continue_along(const ClipSide& side, Vertex& vertex);
  std::uint32_t name_meeting(const Vertex& edge, const ClipSide& side) const;

  bool reference_is_a_;
  int count_ = 0;
  int current_ = 0;  ///< Which of the two loops holds the polygon; the other one receives what a cut leaves.
  std::array<Loop, 2> loops_;
};

}  // namespace tumble
