// The flat or straight part of a shape that looks along a direction: a cap, a face, the line on which a cylinder lies. Two
// such parts that face each other make a contact of several points. In A's frame, lengths in [m].
#pragma once

#include <array>

#include "collision/convex_pieces.h"
#include "collision/manifold.h"

namespace tumble {

struct Patch {
  enum class Kind { point, line, polygon, disc };
  /// Corners of a disc: points of its rim, fixed to the body so that their names stay.
  static constexpr int kRimPoints = 8, kMaxCorners = 96;

  Kind kind = Kind::point;
  int count = 0;
  std::array<Vec3, kMaxCorners> corners;  ///< In loop order.
  std::array<std::uint32_t, kMaxCorners> names;
  Vec3 normal, centre;  ///< Of a polygon or disc: outward, unit; a point of it, the middle of a disc.
  double radius = 0.0;  ///< Of a disc.
  double width = 0.0;   ///< Across the narrow side; 0 for a point.

  bool is_flat() const { return kind == Kind::polygon || kind == Kind::disc; }
};

/// The part of the shape that looks along n (unit, outward) within 0.1 rad, else the furthest point.
Patch patch_towards(const ConvexPieces& shape, const Vec3& n_A);

/// How two patches meet: along n (unit, from A to B) the shapes are `separation` apart, at p_A and p_B of their cores, and
/// around the cores lie the roundings.
struct PatchContact {
  Vec3 normal_A;
  double separation;
  Vec3 p_A, p_B;
  double rounding_a, rounding_b;
};

/// All points up to the margin in which the patches meet, always with one as deep as the separation.
Manifold make_patch_manifold(const Patch& a, const Patch& b, const PatchContact& contact, double margin);

/// The same of a patch of B above the plane z_A = 0; `lowest` is B's lowest point.
Manifold make_ground_manifold(const Patch& b, const Vec3& lowest, double margin);

}  // namespace tumble
