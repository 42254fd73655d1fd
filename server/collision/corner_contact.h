// Two polytopes that are apart, but nearer than the margin, with no face or pair of edges between their closest points:
// corners that look at each other. The best face's separation is then less than the distance, and its normal not the way
// from one to the other.
#pragma once

#include "collision/manifold.h"
#include "collision/pair_cache.h"
#include "collision/shape.h"

namespace tumble {

/// A manifold made along the axis that separates most.
struct AxisContact {
  Manifold& manifold;
  double separation;  ///< Along the axis [m].
  double size;        ///< The bodies' radii together [m].
  /// Clipped with the tolerance for bodies that lie face to face: the lowest point may be beside the reference face by that.
  bool face_to_face = false;
  double overhang = 0.0;  ///< By this [m]. Known of bodies that are apart along a face's normal.
  double tilt =
      0.0;  ///< Sine of the angle between the faces; where 0 it does not matter where the lowest point is.
};

/// Overlapping, or if the lowest point is as near as the axis says, this point gets the separation: true. False: the axis
/// is not the whole truth, or rounding left no point over the face, ask for the closest points.
bool touches_along_axis(AxisContact& contact);

/// What the closest points say where it does not.
struct ClosestContact {
  Manifold manifold;  ///< One point, or none if these are beyond the margin.
  /// Bodies lie face to face: their whole polygon, clipped along the manifold's normal, is the contact.
  bool lying = false;
  double separation = 0.0;  ///< [m]
};
/// Updates the cache's axis.
ClosestContact contact_of_closest_points(const AxisContact& along_axis, const Shape& a, const Shape& b,
                                         const Pose& X_AB, double margin, PairCache& cache);

}  // namespace tumble
