// See from_message.h.
#include "from_message.h"

#include <fmt/format.h>

#include <stdexcept>

#include "math/rotation.h"
#include "tumble/catalog_t.hpp"

namespace tumble {

Quat to_quaternion(const double (&q)[4]) {
  return normalized(Quat(q[0], q[1], q[2], q[3]));
}

Shape make_shape(std::int8_t type, const double (&size)[3]) {
  switch (type) {
    case catalog_t::SHAPE_HALF_SPACE:
      return HalfSpace{};
    case catalog_t::SHAPE_SPHERE:
      return Sphere{size[0]};
    case catalog_t::SHAPE_CAPSULE:
      return Capsule{size[0], 0.5 * size[1]};
    case catalog_t::SHAPE_CYLINDER:
      return Cylinder{size[0], 0.5 * size[1]};
    case catalog_t::SHAPE_CONE:
      return Cone{size[0], 0.5 * size[1]};
    case catalog_t::SHAPE_ELLIPSOID:
      return Ellipsoid{to_vector(size)};
    case catalog_t::SHAPE_BOX:
      return Box{0.5 * to_vector(size)};
    default:
      throw std::invalid_argument(fmt::format("shape_type: {} is not one that a message can describe", type));
  }
}

}  // namespace tumble
