// Face against face: the incident polygon is cut by the sides of the reference face (Sutherland-Hodgman), both seen along
// the contact normal, and what is left becomes contact points. A point lies in the middle of its gap. Its id names what
// meets in it, a vertex of A, a vertex of B, or an edge of each, and not who was cut by whom.
#pragma once

#include <array>

#include "collision/manifold_builder.h"
#include "collision/polytope.h"
#include "collision/segment.h"
#include "math/four.h"

namespace tumble {

/// Faces with more vertices are thinned to this many, always with the deepest vertex kept.
inline constexpr int kMaxFaceVertices = 96;

/// One side of the reference face, from vertex `tail` to `head`: inside is nx x + ny y <= offset, (nx, ny) unit.
struct ClipSide {
  /// How far p lies outside [m].
  double outside(const Four& p) const { return nx * p[0] + ny * p[1] - offset; }

  double nx, ny, offset;
  std::uint32_t tail, head;
  std::uint32_t mark = 0;  ///< A bit by which corners on this side can be told.
};

/// Axes in the plane of a face with this unit normal, from one of its vertices: u along its first side, v = normal x u.
class FaceAxes {
 public:
  FaceAxes(const Vec3& origin, const Vec3& normal, const Polytope::Side& first)
      : origin_(origin),
        u_(first.outward.isZero(0.0) ? perpendicular_to(normal) : normal.cross(first.outward)),
        v_(normal.cross(u_)) {}
  const Vec3& origin() const { return origin_; }
  const Vec3& u() const { return u_; }
  /// A side, from vertex `tail` to `head`, as these axes see it.
  ClipSide see(const Polytope::Side& side, std::uint32_t tail, std::uint32_t head) const {
    return {u_.dot(side.outward), v_.dot(side.outward), side.offset - side.outward.dot(origin_), tail, head};
  }

 private:
  Vec3 origin_, u_, v_;
};

/// The reference face's plane in A's frame, in right-handed unit axes u, v, f, and how it is seen along a contact normal
/// (unit, from the reference to the incident body), which need not be f, only near it.
class FacePlane {
 public:
  /// A point of the face [m], its first axis and its unit outward normal.
  FacePlane(const Vec3& origin_A, const Vec3& u_A, const Vec3& f_A, const Vec3& n_A)
      : origin_A_(origin_A),
        u_A_(u_A),
        v_A_(f_A.cross(u_A_)),
        f_A_(f_A),
        n_A_(n_A),
        gap_per_height_(1.0 / f_A.dot(n_A)),
        un_(u_A_.dot(n_A)),
        vn_(v_A_.dot(n_A)) {}

  const Vec3& n_A() const { return n_A_; }
  /// x, y: where the line through p along n meets the plane; z: the distance to there along n.
  Vec3 to_plane(const Vec3& p_A) const {
    const Vec3 d = p_A - origin_A_;
    const double z = f_A_.dot(d) * gap_per_height_;
    return {u_A_.dot(d) - z * un_, v_A_.dot(d) - z * vn_, z};
  }
  /// The middle between such a point and its foot on the plane, in A.
  Vec3 middle_A(const Vec3& p) const {
    return origin_A_ + p.x() * u_A_ + p.y() * v_A_ + (0.5 * p.z()) * n_A_;
  }

 private:
  Vec3 origin_A_, u_A_, v_A_, f_A_, n_A_;
  double gap_per_height_, un_, vn_;
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
