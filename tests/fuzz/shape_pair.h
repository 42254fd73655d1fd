// Bytes -> two shapes at two poses and a margin. Every string of bytes means something, and the awkward is as likely as
// the ordinary: needles and plates, exact touch, coincident centres, quarter turns, tilts of nothing, far from the origin.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "collision/shape.h"

namespace tumble::test {

struct ShapePair {
  Shape a, b;
  Pose X_WA, X_WB;
  double margin = 0.0;  ///< [m]
};

/// None if the bytes name points that span no hull.
std::optional<ShapePair> decode_shape_pair(std::span<const std::uint8_t> bytes);

}  // namespace tumble::test
