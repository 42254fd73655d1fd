// One view of every convex shape as a few smooth pieces, so that searches over directions are written once. A piece is a
// vertex, a rim, an ellipsoid: for each direction n it has one furthest point, which moves with n by its matrix of
// curvature radii. Spheres and capsules are a point and a segment, rounded. All in A's frame, lengths in [m].
#pragma once

#include <optional>

#include "collision/polytope.h"
#include "collision/shape.h"

namespace tumble {

/// Curvature radii u W u, u W v, v W v [m].
struct Curvature {
  double uu, uv, vv;
  Curvature operator+(const Curvature& other) const { return {uu + other.uu, uv + other.uv, vv + other.vv}; }
  Curvature operator*(double s) const { return {uu * s, uv * s, vv * s}; }
  /// Of W - t.
  bool is_positive(double t) const { return uu + vv > 2.0 * t && (uu - t) * (vv - t) > uv * uv; }
};

/// Pieces of round shapes: rims and ends, of a cone the rim and the apex. Of boxes and hulls pieces are the vertices.
inline constexpr std::uint32_t kLowPiece = 0, kHighPiece = 1;

class ConvexPieces {
 public:
  /// Not for half-spaces and surfaces. Keeps a reference to the shape or polytope.
  ConvexPieces(const Shape& shape, const Mat3& R_AS, const Vec3& p_AS);
  /// Something with flat faces that is no shape of its own, as a triangle.
  ConvexPieces(const Polytope& polytope, const Mat3& R_AS, const Vec3& p_AS);

  struct Point {
    Vec3 p_A;
    std::uint32_t piece;
  };
  /// Furthest point of the core along n (any length > 0).
  Point furthest(const Vec3& n_A) const;
  /// The same of one piece alone; n unit.
  Vec3 point(std::uint32_t piece, const Vec3& n_A) const;
  /// The matrix W = d point / d n in two directions u, v across n: symmetric, positive semi-definite, 0 for vertices,
  /// infinite for a rim that is seen along its axis.
  Curvature curvature(std::uint32_t piece, const Vec3& n_A, const Vec3& u_A, const Vec3& v_A) const;
  /// How far a point inside is from the core's surface [m], and so the radius of the ball around it that lies in the core;
  /// < 0 outside. What is flat or a segment has no inside.
  double depth(const Vec3& p_A) const;
  /// What lies around the core on all sides.
  double rounding() const { return rounding_; }
  /// Is its face across z on this side (-1 or 1) a disc?
  bool has_cap(double side) const;
  /// Normal of its flat face that looks most along n; none if it is round, or flat itself.
  std::optional<Vec3> face_towards(const Vec3& n_A) const;
  const Mat3& R() const { return R_; }
  const Vec3& p() const { return p_; }
  /// No point is further from the origin of its frame, roundings included [m].
  double radius() const { return shape_ ? bounding_radius(*shape_) : polytope_->radius; }
  /// One of the two: null if it is the other.
  const Shape* shape() const { return shape_; }
  const Polytope* polytope() const { return polytope_; }

 private:
  const Shape* shape_ = nullptr;
  const Polytope* polytope_ = nullptr;
  Mat3 R_;
  Vec3 p_;
  double rounding_;
};

}  // namespace tumble
