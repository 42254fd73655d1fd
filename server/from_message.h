// Values of the world from the fields of messages whose ranges were checked.
#pragma once

#include <cstdint>

#include "collision/shape.h"
#include "math/types.h"

namespace tumble {

inline Vec3 to_vector(const double (&values)[3]) {
  return {values[0], values[1], values[2]};
}

/// (w, x, y, z) of about unit length, made unit.
Quat to_quaternion(const double (&q)[4]);

/// catalog_t.SHAPE_* and size_*. Throws std::invalid_argument for a shape that a message can't describe.
Shape make_shape(std::int8_t type, const double (&size)[3]);

}  // namespace tumble
