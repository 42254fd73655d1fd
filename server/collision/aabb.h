// Axis-aligned bounding box in world axes [m]. Closed: boxes that only touch overlap.
#pragma once

#include <limits>

#include "math/types.h"

namespace tumble {

struct Aabb {
  Vec3 lower = Vec3::Constant(std::numeric_limits<double>::infinity());
  Vec3 upper = Vec3::Constant(-std::numeric_limits<double>::infinity());

  bool overlaps(const Aabb& other) const {
    return (lower.array() <= other.upper.array()).all() && (other.lower.array() <= upper.array()).all();
  }
  bool contains(const Aabb& other) const {
    return (lower.array() <= other.lower.array()).all() && (other.upper.array() <= upper.array()).all();
  }
  Aabb united(const Aabb& other) const { return {lower.cwiseMin(other.lower), upper.cwiseMax(other.upper)}; }
  Aabb grown(double margin) const { return {lower.array() - margin, upper.array() + margin}; }
  /// The bounds of everything this box touches while it moves by `displacement` [m].
  Aabb swept(const Vec3& displacement) const {
    return {lower + displacement.cwiseMin(0.0), upper + displacement.cwiseMax(0.0)};
  }
  /// Half the surface area [m^2]: the cost measure of the tree. Extents are cut at 1e100 m: half-spaces have infinite
  /// boxes, and differences of infinite areas would be NaN. The boxes themselves, and so all answers, stay exact.
  double half_area() const {
    const Vec3 d = (upper - lower).cwiseMin(1e100);
    return d.x() * d.y() + d.y() * d.z() + d.z() * d.x();
  }
};

}  // namespace tumble
