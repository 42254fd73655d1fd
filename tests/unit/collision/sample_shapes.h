// A random shape of every type, for claims that hold for all of them.
#pragma once

#include <vector>

#include "sample_hulls.h"

namespace tumble::test {

/// One of each convex type with ends, between `low` and `high` [m] across.
inline std::vector<Shape> random_shapes(RandomPose& random, double low = 0.3, double high = 1.0) {
  std::vector<Shape> shapes;
  const Vec3 size = random.vector(low, high), hull_size = random.vector(low, high);
  const double radius = random.uniform(low, high), half_length = random.uniform(low, high);
  shapes.push_back(Sphere{radius});
  shapes.push_back(Capsule{radius, half_length});
  shapes.push_back(Box{size});
  shapes.push_back(random_hull(random, 16, hull_size));
  shapes.push_back(Cylinder{radius, half_length});
  shapes.push_back(Cone{radius, half_length});
  shapes.push_back(Ellipsoid{size});
  return shapes;
}

/// Type 0 to 6: sphere, capsule, box, hull, cylinder, cone, ellipsoid; each size between `least` and 1 times `unit` [m].
inline Shape random_shape(RandomPose& random, std::size_t type, double least, double unit = 1.0) {
  Vec3 size;
  for (int i = 0; i < 3; ++i) size[i] = unit * random.log_uniform(least, 1.0);
  switch (type) {
    case 0:
      return Sphere{size.x()};
    case 1:
      return Capsule{size.x(), size.y()};
    case 2:
      return Box{size};
    case 3:
      return random_hull(random, 12, size);
    case 4:
      return Cylinder{size.x(), size.y()};
    case 5:
      return Cone{size.x(), size.y()};
    default:
      return Ellipsoid{size};
  }
}

/// Their distances converge from both sides and stop at a hair, where those of flat and round shapes are known to rounding.
inline bool is_curved(const Shape& shape) {
  return std::holds_alternative<Cylinder>(shape) || std::holds_alternative<Cone>(shape) ||
         std::holds_alternative<Ellipsoid>(shape);
}

/// B moved along d from A until the plane pair square to d is `gap` [m] apart: they are at least that far apart.
inline Pose place_apart(const Shape& a, const Shape& b, const Vec3& d, const Quat& q_AB, double gap) {
  const double at_origin = separation_along(a, b, q_AB.toRotationMatrix(), Vec3::Zero(), d);
  return {q_AB, (gap - at_origin) * d};
}

}  // namespace tumble::test
