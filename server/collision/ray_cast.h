// Where a ray first meets a shape, in closed form. A solid shape is met from outside only where the ray enters it.
#pragma once

#include <cstdint>
#include <optional>

#include "collision/shape.h"

namespace tumble {

struct Ray {
  Vec3 origin;
  Vec3 direction;             ///< Unit.
  double length = kInfinity;  ///< [m]
  Vec3 at(double distance) const { return origin + distance * direction; }
};

struct RayHit {
  double distance = 0.0;       ///< From the origin [m], 0..length.
  Vec3 normal = Vec3::Zero();  ///< Unit, out of the shape; against the ray if it starts inside.
  std::uint32_t feature = 0;   ///< Face of a box or hull, side 0 or cap 1.. of a round shape.
  bool inside = false;         ///< The ray starts inside, which is met at distance 0.
};

/// Everything in the shape's frame. A ray that starts on the surface meets it if it leads in, not if it leads out or
/// along. Accurate to round-off of the shape's size and the origin's distance.
std::optional<RayHit> cast_ray(const Shape& shape, const Ray& ray);

/// The same for the front and back of a triangle; the normal faces the ray, feature 0 is the side from which the corners
/// run counter-clockwise. Neighbours leave no gap: a ray through a common edge meets at least one of them (Woop,
/// Benthin and Wald, "Watertight ray/triangle intersection", 2013).
std::optional<RayHit> cast_ray_on_triangle(const Vec3& a, const Vec3& b, const Vec3& c, const Ray& ray);

}  // namespace tumble
