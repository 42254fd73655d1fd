// How far two convex shapes are apart, between two bounds: a plane that separates them and a pair of points. Gilbert,
// Johnson and Keerthi's search on the Minkowski difference ("A fast procedure for computing the distance between
// complex objects", 1988), our own, since libccd answers only yes or no. Used by shape casts and queries of the world.
#pragma once

#include <array>

#include "collision/shape.h"

namespace tumble {

/// Pairs of points of the two shapes, one to three, that carry the closest points between them.
struct Carriers {
  int count = 0;
  std::array<Vec3, 3> a_A, b_B;  ///< Each in the frame of its own shape [m].
};

struct DistanceSettings {
  /// [m] upper - lower at which the search ends; rounding ends it anyway. Round flanks (cylinder, cone, ellipsoid) take
  /// about one step a digit, flat faces end by themselves.
  double tolerance = 0.0;
  double beyond = kInfinity;  ///< [m] ends as soon as lower exceeds this.
  Carriers start =
      {};           ///< Warm start: the carriers of this pair's last search; none: from the line of centres.
  int budget = 64;  ///< Support pairs at most; what is known then is returned.
};

struct Distance {
  double lower = 0.0;  ///< The plane pair square to axis_A is this far apart, rounding deducted; >= 0 [m].
  double upper = 0.0;  ///< Distance of the two points below [m]; upper - lower is the error that may be left.
  bool overlap = false;         ///< No plane was found and none can be, up to rounding: both bounds are 0.
  Vec3 axis_A = Vec3::UnitZ();  ///< Unit, from A to B. On overlap the last direction tried.
  Vec3 a_A = Vec3::Zero();  ///< Point of A nearest to B, in A's frame [m]; on overlap a common point of both.
  Vec3 b_A = Vec3::Zero();  ///< Point of B nearest to A, in A's frame [m].
  Carriers carriers;        ///< To start the pair's next search with; none on overlap.
  int iterations = 0;       ///< Support pairs asked for, <= the budget.
};

/// Distance of two convex shapes with B at X_AB (no half-space: nothing limits its support).
Distance compute_distance(const Shape& a, const Shape& b, const Pose& X_AB,
                          const DistanceSettings& settings = {});

/// The same for B or A a triangle, given by its corners in its own frame.
Distance compute_distance(const Shape& a, const std::array<Vec3, 3>& corners, const Pose& X_AB,
                          const DistanceSettings& settings = {});
Distance compute_distance(const std::array<Vec3, 3>& corners, const Shape& b, const Pose& X_AB,
                          const DistanceSettings& settings = {});

}  // namespace tumble
