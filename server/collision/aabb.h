// Axis-aligned bounding box in world axes [m]. Closed: boxes that only touch overlap.
#pragma once

#include <algorithm>
#include <limits>

#include "math/pose.h"
#include "math/rotation.h"

namespace tumble {

struct Aabb {
  Vec3 lower = Vec3::Constant(kInfinity);
  Vec3 upper = Vec3::Constant(-kInfinity);

  bool overlaps(const Aabb& other) const {
    return (lower.array() <= other.upper.array()).all() && (other.lower.array() <= upper.array()).all();
  }
  bool contains(const Aabb& other) const {
    return (lower.array() <= other.lower.array()).all() && (other.upper.array() <= upper.array()).all();
  }
  Aabb united(const Aabb& other) const { return {lower.cwiseMin(other.lower), upper.cwiseMax(other.upper)}; }
  Aabb grown(double margin) const { return {lower.array() - margin, upper.array() + margin}; }
  /// The bounds in A of this box, which is given in B; finite boxes only.
  Aabb transformed(const Pose& X_AB) const {
    const Vec3 middle = X_AB * Vec3(0.5 * (lower + upper));
    const Vec3 reach = rotation_matrix(X_AB.q).cwiseAbs() * (0.5 * (upper - lower));
    return {middle - reach, middle + reach};
  }
  /// The bounds of everything this box touches while it moves by `displacement` [m].
  Aabb swept(const Vec3& displacement) const {
    return {lower + displacement.cwiseMin(0.0), upper + displacement.cwiseMax(0.0)};
  }
  /// When a box that is at `start` and moves with `velocity` first touches this one; infinity: never; 0: at once. With a
  /// box of no size and a unit velocity: where a ray enters. Rounded so that no contact of the insides is missed.
  double meets_at(const Aabb& start, const Vec3& velocity) const {
    double enter = 0.0, leave = kInfinity;
    for (int i = 0; i < 3; ++i) {
      const double ahead = lower[i] - start.upper[i], behind = upper[i] - start.lower[i];
      if (velocity[i] == 0.0) {
        if (ahead > 0.0 || behind < 0.0) return kInfinity;
      } else {
        const double from = ahead / velocity[i], to = behind / velocity[i];
        enter = std::max(enter, std::min(from, to));
        leave = std::min(leave, std::max(from, to));
      }
    }
    // The products and differences above are off by two roundings each.
    constexpr double kSlack = 4.0 * std::numeric_limits<double>::epsilon();
    enter *= 1.0 - kSlack;
    return enter <= leave * (1.0 + kSlack) ? enter : kInfinity;
  }
  /// Half the surface area [m^2]: the cost measure of the tree. Extents are cut at 1e100 m: half-spaces have infinite
  /// boxes, and differences of infinite areas would be NaN. The boxes themselves, and so all answers, stay exact.
  double half_area() const {
    const Vec3 d = (upper - lower).cwiseMin(1e100);
    return d.x() * d.y() + d.y() * d.z() + d.z() * d.x();
  }
};

}  // namespace tumble
