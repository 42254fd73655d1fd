// Two polytopes that are apart, but nearer than the margin, with no face or pair of edges between their closest points:
// corners that look at each other. The best face's separation is then less than the distance, and its normal not the way
// from one to the other.
#pragma once

#include "collision/manifold.h"
#include "collision/pair_cache.h"
#include "collision/shape.h"

namespace tumble {

/// `manifold` was made along an axis that separates by `separation` [m], of bodies whose radii add up to `size` [m].
/// Overlapping, or if its lowest point is that near, this point gets the separation: true. False: the axis is not the
/// whole truth, ask for the closest points.
bool touches_along_axis(Manifold& manifold, double separation, double size);

/// Such a manifold that does not: the contact of the closest points, or none if these are beyond the margin.
/// `face_to_face`: it was clipped with the tolerance for bodies that lie so, and may have missed its lowest point by
/// that; then its polygon stays. Updates the cache's axis.
Manifold contact_of_closest_points(const Manifold& along_axis, double separation, bool face_to_face,
                                   const Shape& a, const Shape& b, const Pose& X_AB, double margin,
                                   PairCache& cache);

}  // namespace tumble
