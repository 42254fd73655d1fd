// A corner of one polytope that stands on a face of another one, alone: nothing else of its body comes as near, so that
// there is nothing to clip. Lengths in [m].
#pragma once

#include "collision/polytope.h"

namespace tumble {

/// A body's corner, its lowest point along `up` (unit, in its frame, out of the face below it).
struct StandingCorner {
  const Polytope& body;
  std::uint32_t vertex;
  Vec3 up;
};

/// How steeply the flattest edge of the corner rises, 0 to 1: its rise over its length, squared; 0 if the end of one is not
/// more than `gap` >= 0 above the corner. All of the body that is within the gap lies within gap / slope about the corner.
double least_slope2(const StandingCorner& corner, double gap);

/// Whether the disc about the foot of p on the plane of a face lies inside the face. Its radius is gap / slope.
bool holds_disc(const Polytope& polytope, std::uint32_t face, const Vec3& p, double gap, double slope2);

}  // namespace tumble
