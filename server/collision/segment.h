// Closest points of two straight segments, and directions across a line: shared by capsules and by edge contacts.
#pragma once

#include <algorithm>
#include <cmath>

#include "math/types.h"

namespace tumble {

/// sin^2 of the angle between two lines below which their common normal is noise.
inline constexpr double kParallel = 1e-24;

/// Points centre + s * reach with s in [-1, 1].
struct Segment {
  Vec3 centre, reach;
  Vec3 at(double s) const { return centre + s * reach; }
  double closest_parameter(const Vec3& p) const {
    const double length2 = reach.squaredNorm();
    return length2 > 0.0 ? std::clamp(reach.dot(p - centre) / length2, -1.0, 1.0) : 0.0;
  }
};

struct SegmentPair {
  double s_A, s_B;
  Vec3 p_A, p_B;
};

/// Closest points by clamping one parameter after the other (Ericson, Real-Time Collision Detection, 5.1.9). On
/// parallel segments the middle of the part that lies side by side.
inline SegmentPair closest_points(const Segment& a, const Segment& b) {
  const double aa = a.reach.squaredNorm(), bb = b.reach.squaredNorm(), ab = a.reach.dot(b.reach);
  const Vec3 d = a.centre - b.centre;
  const double cross = a.reach.cross(b.reach).squaredNorm();
  double s = 0.0;
  if (cross > kParallel * aa * bb) {
    s = std::clamp((ab * b.reach.dot(d) - bb * a.reach.dot(d)) / cross, -1.0, 1.0);
  } else if (aa > 0.0) {
    const double centre = -a.reach.dot(d) / aa, half = std::abs(ab) / aa;
    const double low = std::clamp(centre - half, -1.0, 1.0), high = std::clamp(centre + half, -1.0, 1.0);
    s = 0.5 * (low + high);
  }
  const double t = b.closest_parameter(a.at(s));
  s = a.closest_parameter(b.at(t));
  return {s, t, a.at(s), b.at(t)};
}

inline double distance_between(const Segment& a, const Segment& b) {
  const SegmentPair closest = closest_points(a, b);
  return (closest.p_B - closest.p_A).norm();
}

/// The direction between the closest points of two segments that are apart, `apart` from one to the other. Rounding has
/// turned it by as much as it is short: it is taken at right angles to each segment that has its point between its ends.
inline Vec3 direction_between(const Segment& a, const Segment& b, const SegmentPair& closest,
                              const Vec3& apart) {
  const bool inside_a = std::abs(closest.s_A) < 1.0, inside_b = std::abs(closest.s_B) < 1.0;
  const auto across = [](const Vec3& d, const Segment& s) -> Vec3 {
    return d - s.reach * (s.reach.dot(d) / s.reach.squaredNorm());
  };
  Vec3 direction = apart;
  if (inside_a && inside_b) {
    const Vec3 common = a.reach.cross(b.reach);
    constexpr double kCrossing = 1e-6;  // sin^2
    if (common.squaredNorm() > kCrossing * a.reach.squaredNorm() * b.reach.squaredNorm())
      return common * (std::copysign(1.0, common.dot(apart)) / common.norm());
  }
  if (inside_a && a.reach.squaredNorm() > 0.0) direction = across(direction, a);
  if (inside_b && b.reach.squaredNorm() > 0.0) direction = across(direction, b);
  const double length = direction.norm();
  return length > 0.0 ? Vec3(direction / length) : Vec3(apart.normalized());
}

/// Some unit vector at right angles to d; +x if d is zero.
inline Vec3 perpendicular_to(const Vec3& d) {
  int least = 0;
  for (int i = 1; i < 3; ++i) {
    if (std::abs(d[i]) < std::abs(d[least])) least = i;
  }
  const Vec3 side = d.cross(Vec3::Unit(least));
  const double length = side.norm();
  return length > 0.0 ? Vec3(side / length) : Vec3::UnitX();
}

/// d / |d|, or `otherwise` (unit) if d is zero.
inline Vec3 direction_or(const Vec3& d, const Vec3& otherwise) {
  const double length = d.norm();
  return length > 0.0 ? Vec3(d / length) : otherwise;
}

}  // namespace tumble
