// What the narrow phase says of one pair: a normal and up to eight points, in the frame of shape A, so that a contact
// far from the world's origin keeps every digit.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "math/types.h"

namespace tumble {

/// Clipping two convex faces leaves at most this many points that matter; all of them are kept (a four-point subset
/// costs two to three orders of magnitude of residual motion at rest).
inline constexpr int kMaxManifoldPoints = 8;

struct ManifoldPoint {
  Vec3 p_A;               ///< Middle of the gap, in A's frame [m].
  double separation;      ///< Along the normal [m]; < 0 is overlap.
  std::uint32_t feature;  ///< Stable id of the pair of features that made the point, for warm starting.
};

struct Manifold {
  Manifold() {}  // not defaulted: `{}` would clear points that are not there
  Manifold(const Manifold& other) { *this = other; }
  /// Copies the points that are there.
  Manifold& operator=(const Manifold& other) {
    normal_A = other.normal_A;
    count = other.count;
    for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) points[i] = other.points[i];
    return *this;
  }

  Vec3 normal_A = Vec3::UnitZ();  ///< Unit, from A to B, in A's frame.
  int count = 0;                  ///< 0: no point closer than the margin.
  std::array<ManifoldPoint, kMaxManifoldPoints> points;
};

/// Smallest separation of the manifold's points [m]; infinite if it has none.
inline double least_separation(const Manifold& manifold) {
  double least = kInfinity;
  for (int i = 0; i < manifold.count; ++i)
    least = std::min(least, manifold.points[static_cast<std::size_t>(i)].separation);
  return least;
}

/// Largest overlap of the manifold's points [m], >= 0.
inline double deepest(const Manifold& manifold) {
  return std::max(0.0, -least_separation(manifold));
}

}  // namespace tumble
