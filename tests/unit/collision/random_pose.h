// Random shapes and poses with a fixed seed. Every number has its own statement: the order of calls inside an argument
// list is up to the compiler.
#pragma once

#include <cmath>
#include <random>

#include "math/pose.h"

namespace tumble::test {

class RandomPose {
 public:
  explicit RandomPose(unsigned seed) : engine_(seed) {}

  double uniform(double low, double high) {
    return low + (high - low) * (static_cast<double>(engine_()) / 4294967296.0);
  }
  /// Evenly spread over the exponents between low and high.
  double log_uniform(double low, double high) { return std::exp(uniform(std::log(low), std::log(high))); }
  Vec3 vector(double low, double high) {
    Vec3 v;
    for (int i = 0; i < 3; ++i) v[i] = uniform(low, high);
    return v;
  }
  Vec3 direction() {
    for (;;) {
      const Vec3 v = vector(-1.0, 1.0);
      const double length = v.norm();
      if (length > 0.1 && length < 1.0) return v / length;
    }
  }
  Quat rotation() {
    for (;;) {
      Quat q;
      for (int i = 0; i < 4; ++i) q.coeffs()[i] = uniform(-1.0, 1.0);
      const double length = q.norm();
      if (length > 0.1 && length < 1.0) return Quat(q.coeffs() / length);
    }
  }
  Pose pose(double reach) {
    const Quat q = rotation();
    const Vec3 p = vector(-reach, reach);
    return {q, p};
  }

 private:
  std::mt19937 engine_;
};

/// Rotation by `angle` [rad] about `axis` (unit).
inline Quat turn(const Vec3& axis, double angle) {
  const double s = std::sin(0.5 * angle);
  return Quat(std::cos(0.5 * angle), s * axis.x(), s * axis.y(), s * axis.z());
}

}  // namespace tumble::test
