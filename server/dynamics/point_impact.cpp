// Compression: sticking if that impulse lies in the friction cone, else the root over p_n of u_n = 0 with the friction
// disc solved exactly for each p_n; a root exists for every geometry, also the jamming ones. Restitution: Poisson's
// hypothesis (Routh; Glocker, Pfeiffer 1995) with the energy clamp of Chatterjee and Ruina's kind: the expansion is
// shortened until p.u + p.K p / 2 <= 0.
#include "dynamics/point_impact.h"

#include <algorithm>
#include <cmath>

namespace tumble {
namespace {

using Vec2 = Eigen::Vector2d;
using Mat2 = Eigen::Matrix2d;

double energy_change(const Mat3& K, const Vec3& u, const Vec3& p) {
  return p.dot(u) + 0.5 * p.dot(K * p);
}

/// p_t for a given p_n >= 0.
Vec2 friction_of(const Mat3& K, const Vec3& u, double friction, double p_n) {
  return solve_friction_disc(K.bottomRightCorner<2, 2>(), u.tail<2>() + K.block<2, 1>(1, 0) * p_n,
                             friction * p_n);
}

}  // namespace

Eigen::Vector2d solve_friction_disc(const Mat2& K, const Vec2& u, double radius) {
  if (!(radius > 0.0)) return Vec2::Zero();
  // Principal axes of K: rotation (c, s) from the half angle, by square roots only.
  const double half = 0.5 * (K(0, 0) - K(1, 1)), mean = 0.5 * (K(0, 0) + K(1, 1));
  const double r = std::sqrt(half * half + K(0, 1) * K(0, 1));
  const double k_max = mean + r, k_min = std::max(mean - r, (K(0, 0) * K(1, 1) - K(0, 1) * K(0, 1)) / k_max);
  double c = 1.0, s = 0.0;
  if (r > 0.0) {
    const double cos2 = half / r;
    c = std::sqrt(std::max(0.0, 0.5 * (1.0 + cos2)));
    s = std::sqrt(std::max(0.0, 0.5 * (1.0 - cos2)));
    if (K(0, 1) < 0.0) s = -s;
  }
  const Vec2 g(c * u.x() + s * u.y(), c * u.y() - s * u.x());
  Vec2 p(-g.x() / k_max, -g.y() / k_min);
  if (p.squaredNorm() > radius * radius) {
    // |(K + nu)^-1 g| = radius. 1/|.| is concave and nearly linear in nu, so Newton on it from 0 rises to the root.
    double nu = 0.0;
    for (int i = 0; i < 20; ++i) {
      const double length = std::sqrt(p.squaredNorm());
      const double slope = (p.x() * p.x() / (k_max + nu) + p.y() * p.y() / (k_min + nu)) / (length * length);
      const double step = (length / radius - 1.0) / slope;
      nu = std::max(0.0, nu + step);
      p = Vec2(-g.x() / (k_max + nu), -g.y() / (k_min + nu));
      if (std::abs(step) <= 1e-15 * (k_max + nu)) break;
    }
    p *= radius / std::sqrt(p.squaredNorm());
  }
  return {c * p.x() - s * p.y(), s * p.x() + c * p.y()};
}

Vec3 solve_compression(const Mat3& K, const Vec3& u, double friction) {
  if (friction <= 0.0) return {-u.x() / K(0, 0), 0.0, 0.0};
  const Vec3 stick = -(K.inverse() * u);
  const double stick_t = std::sqrt(stick.y() * stick.y() + stick.z() * stick.z());
  if (stick.x() > 0.0 && stick_t <= friction * stick.x()) return stick;

  const auto approach = [&](double p_n, Vec2& p_t) {
    p_t = friction_of(K, u, friction, p_n);
    return u.x() + K(0, 0) * p_n + K(0, 1) * p_t.x() + K(0, 2) * p_t.y();
  };
  // Bracket the root: still closing at `low`, no longer at `high`. The friction disc opens with p_n, so for large p_n
  // the contact sticks and u_n grows with the positive Schur complement of K.
  Vec2 p_t;
  double low = 0.0, u_low = u.x(), high = -u.x() / K(0, 0), u_high = approach(high, p_t);
  for (int i = 0; i < 200 && u_high < 0.0; ++i) {
    low = high;
    u_low = u_high;
    high *= 2.0;
    u_high = approach(high, p_t);
  }
  // Regula falsi, halving the weight of an end that stays (Illinois).
  int side = 0;
  for (int i = 0; i < 100 && high - low > 1e-15 * high && u_high > 0.0; ++i) {
    const double p_n = std::clamp((low * u_high - high * u_low) / (u_high - u_low), low, high);
    const double u_n = approach(p_n, p_t);
    if (u_n < 0.0) {
      low = p_n;
      u_low = u_n;
      if (side < 0) u_high *= 0.5;
      side = -1;
    } else {
      high = p_n;
      u_high = u_n;
      if (side > 0) u_low *= 0.5;
      side = 1;
      if (u_n <= 1e-15 * -u.x()) break;
    }
  }
  p_t = friction_of(K, u, friction, high);
  return {high, p_t.x(), p_t.y()};
}

Vec3 solve_point_impact(const Mat3& K, const Vec3& u, double friction, double restitution) {
  const Vec3 compression = solve_compression(K, u, friction);
  const Vec3 u_c = u + K * compression;
  const double p_n = restitution * compression.x();
  const Vec2 p_t = friction_of(K, u_c, friction, p_n);
  const Vec3 expansion(p_n, p_t.x(), p_t.y());
  const Vec3 whole = compression + expansion;
  if (energy_change(K, u, whole) <= 0.0) return whole;
  // Largest share s of the expansion with energy_change(compression + s expansion) <= 0: a s^2 + b s + c = 0, c <= 0.
  const double a = 0.5 * expansion.dot(K * expansion), b = expansion.dot(u_c);
  const double c = std::min(0.0, energy_change(K, u, compression));
  const double share = std::clamp((-b + std::sqrt(std::max(0.0, b * b - 4.0 * a * c))) / (2.0 * a), 0.0, 1.0);
  return compression + share * expansion;
}

}  // namespace tumble
