// Elementary functions of rotation, our own: the C library picks code by CPU features, so one binary would give
// different bits on different machines. Only + - * / and sqrt are used here, which every IEEE machine rounds alike.
// Reductions and coefficients: fdlibm's minimax polynomials (Sun Microsystems 1993) on a two-part pi/2 and ln 2.
#pragma once

#include <array>

#include "math/types.h"

namespace tumble {

struct SinCos {
  double sin, cos;
};

/// sin and cos of x [rad]; absolute error <= 1.2e-16 for |x| < 1.6e6, beyond that 4e-17 |x|, which is less than the
/// rounding of x itself. NaN if x is not finite.
SinCos sincos(double x);

/// Of both, to the bit as one by one, in little more than the time of one.
std::array<SinCos, 2> sincos(double x, double y);

/// e^x for x <= 0 (decays), <= 1 ulp; exactly 0 below -708.
double exp_decay(double x);

/// (1 - e^-x) / x for x >= 0, the mean of a decay over its interval; 1 at x = 0, no cancellation.
double mean_decay(double x);

/// (x - 1 + e^-x) / x^2 for x >= 0, what a decay has lost on average; 1/2 at x = 0, no cancellation.
double mean_loss(double x);

/// Quaternion of the rotation vector r [rad]: (cos |r|/2, sin(|r|/2) r/|r|). Unit to round-off, exact at r = 0.
Quat exp_map(const Vec3& r);

/// Rotation that turns z to the unit vector n the shortest way (about x where n = -z).
Quat rotation_to_normal(const Vec3& n);

/// Rotation matrix R from its unit quaternion, orthonormal to round-off for a unit q.
inline Mat3 rotation_matrix(const Quat& q) {
  return q.toRotationMatrix();
}

/// q / |q|. A no-op to round-off for unit q; callers use it after every product that accumulates.
inline Quat normalized(const Quat& q) {
  const double n = 1.0 / std::sqrt(q.w() * q.w() + q.x() * q.x() + q.y() * q.y() + q.z() * q.z());
  return Quat(q.w() * n, q.x() * n, q.y() * n, q.z() * n);
}

/// Matrix of the cross product: cross_matrix(a) * b = a x b.
inline Mat3 cross_matrix(const Vec3& a) {
  Mat3 m;
  m << 0, -a.z(), a.y(), a.z(), 0, -a.x(), -a.y(), a.x(), 0;
  return m;
}

}  // namespace tumble
