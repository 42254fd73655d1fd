// Contact of two rounded segments whose normal is known: edges of boxes and hulls (radius 0), cores of capsules. One
// point where they cross, two where they run side by side.
#pragma once

#include "collision/manifold.h"
#include "collision/segment.h"

namespace tumble {

struct RoundedSegment {
  Segment core;   ///< [m], in A's frame.
  double radius;  ///< [m]
};

/// normal_A: unit, from A to B. Points closer than `merge` [m] become one.
Manifold make_segment_manifold(const RoundedSegment& a, const RoundedSegment& b, const Vec3& normal_A,
                               double margin, double merge, std::uint32_t feature);

}  // namespace tumble
