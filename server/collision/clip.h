// Face against face: the incident polygon is cut by the sides of the reference face (Sutherland-Hodgman) in the plane of
// the reference face, and what is left becomes contact points. Rules: inside tolerance and merging as in
// manifold_builder.h; the point lies in the middle of the gap; ids name the edges that meet in the point.
#pragma once

#include <array>

#include "collision/manifold_builder.h"

namespace tumble {

/// Faces with more vertices are thinned to this many, always with the deepest vertex kept.
inline constexpr int kMaxFaceVertices = 96;

/// Plane of the reference face in A's frame: right-handed unit axes, n outward, and a point of the face [m].
struct FacePlane {
  Vec3 origin_A, u_A, v_A, n_A;
  Vec3 to_plane(const Vec3& p_A) const {
    const Vec3 d = p_A - origin_A;
    return {u_A.dot(d), v_A.dot(d), n_A.dot(d)};
  }
  /// The middle between a point of the plane's frame and its foot on the plane, in A.
  Vec3 middle_A(const Vec3& p) const { return origin_A + p.x() * u_A + p.y() * v_A + (0.5 * p.z()) * n_A; }
};

/// One side of the reference face: inside is nx x + ny y <= offset, (nx, ny) unit.
struct ClipSide {
  double nx, ny, offset;
};

/// A convex polygon in the reference plane's frame (z = height above it).
class ClipPolygon {
 public:
  /// Vertices in loop order; vertex i starts edge i.
  void add_vertex(const Vec3& p) {
    vertices_[static_cast<std::size_t>(count_)] = {p, 0, static_cast<std::uint32_t>(count_)};
    ++count_;
  }
  /// After the last vertex: names each vertex by its two edges and remembers the lowest.
  void close();
  int count() const { return count_; }
  const Vec3& point(int i) const { return vertices_[static_cast<std::size_t>(i)].p; }

  /// Cuts away what is outside side number `index`.
  void cut(const ClipSide& side, std::uint32_t index, double tolerance);

  /// Everything up to the margin as manifold with normal_A (from A to B); `faces` distinguishes the pair of faces. If
  /// nothing lies over the reference face, the lowest vertex of the uncut polygon speaks for it.
  Manifold make_manifold(const FacePlane& plane, const Vec3& normal_A, double margin, double merge,
                         std::uint32_t faces) const;

 private:
  static constexpr int kCapacity = 2 * kMaxFaceVertices + 2;
  struct Vertex {
    Vec3 p;
    std::uint32_t id, edge;  ///< Where it comes from; label of the edge that starts here.
  };
  int count_ = 0;
  Vertex lowest_;
  std::array<Vertex, kCapacity> vertices_;
};

}  // namespace tumble
