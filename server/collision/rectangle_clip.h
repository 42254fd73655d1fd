// A parallelogram over a rectangle -> the corners of what they have in common. All edges at once, as by Liang and Barsky
// (A new concept and method for line clipping, 1984), and without branches: which corners are left can't be foreseen.
#pragma once

#include <array>

#include "math/four.h"
#include "math/types.h"

namespace tumble {

/// Over a plane, z the height over it [m]: middle and half edges. Corners 0 to 3, counter-clockwise, are m - e1 - e2,
/// m + e1 - e2, m + e1 + e2, m - e1 + e2; edge i runs from corner i to the next. Nowhere steeper than a cosine of 1 / sqrt(3).
struct Parallelogram {
  Vec3 m, e1, e2;
};

/// The rectangle is |x| <= h1, |y| <= h2 [m]. Its parts 0 to 3 are the sides +x, +y, -x, -y, 4 to 7 the corners between side
/// i and the next, 8 is its inside.
struct RectangleClip {
  /// A corner of the parallelogram that is no further than `tolerance` [m] beside the rectangle lies over it, and a corner
  /// of the rectangle no further from one that is left already is the same.
  RectangleClip(const Parallelogram& parallelogram, double h1, double h2, double tolerance);

  /// A set of corners: bit i stands for place i % 4 of kind i / 4.
  using Set = std::uint32_t;
  /// Those that are left, no higher than this [m].
  Set corners_below(double height) const;

  enum Kind : std::size_t { corner, entry, exit, rectangle_corner };
  static constexpr std::size_t kKinds = 4;
  /// Lane i of each kind: corner i; where edge i comes over the rectangle; where it leaves it; the rectangle's corner i.
  std::array<FourVectors, kKinds> places;
  std::array<FourFlags, kKinds> is_left;  ///< Of the same places: whether it is one.
  std::array<FourFlags, kKinds> on;       ///< On which part of the rectangle it lies.
};

}  // namespace tumble
