// See nearest_surface.h.
#include "collision/nearest_surface.h"

#include <algorithm>
#include <cmath>

namespace tumble {
namespace {

/// Climbing to an ellipsoid's root; 4 to 12 are used.
constexpr int kNewtonRounds = 100;

/// A solid of revolution about z: the half-plane (distance from the axis, z) of a point, and its way back to S.
struct Meridian {
  explicit Meridian(const Vec3& p_S) : rho(std::sqrt(p_S.x() * p_S.x() + p_S.y() * p_S.y())), z(p_S.z()) {
    if (rho > 0.0) cosine = p_S.x() / rho, sine = p_S.y() / rho;
  }
  Vec3 lift(double out, double up) const { return {out * cosine, out * sine, up}; }

  double rho, z, cosine = 1.0, sine = 0.0;
};

}  // namespace

NearestSurface nearest_surface(const Cylinder& c, const Vec3& p_S) {
  const Meridian m(p_S);
  const double beside = m.rho - c.radius, above = std::abs(m.z) - c.half_length;
  const double up = std::copysign(1.0, m.z);
  if (beside <= 0.0 && above <= 0.0) {
    return above >= beside ? NearestSurface{above, {0, 0, up}} : NearestSurface{beside, m.lift(1.0, 0.0)};
  }
  const double out = std::max(beside, 0.0), over = std::max(above, 0.0);
  const double distance = std::sqrt(out * out + over * over);
  return {distance, m.lift(out / distance, up * over / distance)};
}

NearestSurface nearest_surface(const Cone& c, const Vec3& p_S) {
  const Meridian m(p_S);
  const double length = std::sqrt(c.radius * c.radius + 4.0 * c.half_length * c.half_length);
  // The side runs from the rim to the apex along (-nz, nr); (nr, nz) is its normal.
  const double nr = 2.0 * c.half_length / length, nz = c.radius / length;
  const double from_rim = m.rho - c.radius, over_base = m.z + c.half_length;
  const double above_side = nr * from_rim + nz * over_base;
  const double along = nr * over_base - nz * from_rim;
  if (above_side <= 0.0 && over_base >= 0.0) {
    return -over_base >= above_side ? NearestSurface{-over_base, {0, 0, -1}}
                                    : NearestSurface{above_side, m.lift(nr, nz)};
  }
  if (over_base < 0.0 && from_rim <= 0.0) return {-over_base, {0, 0, -1}};
  if (along >= 0.0 && along <= length) return {above_side, m.lift(nr, nz)};
  const double out = along > length ? m.rho : from_rim, up = along > length ? m.z - c.half_length : over_base;
  const double distance = std::sqrt(out * out + up * up);
  return distance > 0.0 ? NearestSurface{distance, m.lift(out / distance, up / distance)}
                        : NearestSurface{0.0, m.lift(nr, nz)};
}

/// The nearest point is x_i = a_i^2 p_i / (t + a_i^2) for the largest root t of sum (x_i / a_i)^2 = 1, and t > -min a^2
/// (Eberly, Distance from a Point to an Ellipse, 2013). Left of it lies a pole where the sum is infinite, or, for a
/// point in the plane across the shortest axis near the middle, an x along that axis that makes up what is missing.
NearestSurface nearest_surface(const Ellipsoid& e, const Vec3& p_S) {
  const double scale = e.half_axes.maxCoeff();
  const Vec3 a = e.half_axes / scale, y = p_S.cwiseAbs() / scale;
  int least = 0;
  const double a_min = a.minCoeff(&least);
  // With s = t + a_min^2 the denominators are s + gap_i. Each term alone bounds the root from below, and from there
  // Newton's method climbs to it, since the sum falls and is convex.
  const Vec3 gap = (a.array() - a_min) * (a.array() + a_min);
  const Vec3 ay = a.cwiseProduct(y);
  double s = std::max(0.0, (ay - gap).maxCoeff());
  Vec3 x;
  for (int round = 0; round < kNewtonRounds; ++round) {
    double excess = -1.0, slope = 0.0;
    for (int i = 0; i < 3; ++i) {
      const double term = ay[i] > 0.0 ? ay[i] / (s + gap[i]) : 0.0;
      excess += term * term;
      slope += term > 0.0 ? term * term / (s + gap[i]) : 0.0;
    }
    const double next = excess > 0.0 ? s + 0.5 * excess / slope : s;
    if (!(next > s)) break;
    s = next;
  }
  if (s > 0.0) {
    for (int i = 0; i < 3; ++i) x[i] = a[i] * (ay[i] / (s + gap[i]));
  } else {
    double missing = 1.0;
    for (int i = 0; i < 3; ++i) {
      x[i] = gap[i] > 0.0 ? a[i] * (ay[i] / gap[i]) : 0.0;
      missing -= (x[i] / a[i]) * (x[i] / a[i]);
    }
    x[least] = a[least] * std::sqrt(std::max(0.0, missing));
  }
  for (int i = 0; i < 3; ++i) x[i] = std::copysign(x[i], p_S[i]);
  const Vec3 outward = x.cwiseQuotient(a.cwiseAbs2()).normalized();
  return {scale * outward.dot(p_S / scale - x), outward};
}

}  // namespace tumble
