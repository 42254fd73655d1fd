// The free rotation of a rigid body by Taylor series of order 24 in a longer arithmetic than the engine's: the truth for
// every case that has no table. It checks itself: two step sizes must agree. Axes of the body are principal.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "math/types.h"

namespace tumble::test {

template <typename Real = long double>
class RotationReference {
 public:
  using Vector = std::array<Real, 3>;
  using Quaternion = std::array<Real, 4>;  // w, x, y, z

  /// At the identity.
  RotationReference(const Vec3& I, const Vec3& w_B) {
    for (std::size_t i = 0; i < 3; ++i) {
      I_[i] = static_cast<Real>(I[static_cast<int>(i)]);
      L_[i] = I_[i] * static_cast<Real>(w_B[static_cast<int>(i)]);
    }
  }

  /// Goes on by t [s] in steps of about `angle` [rad] of the speed of now, which changes by at most its own square.
  void advance(Real t, Real angle) {
    while (t > 0) {
      const Real w = speed();
      const Real h = w * t <= angle ? t : angle / w;
      step(h);
      t -= h;
    }
  }

  const Quaternion& q() const { return q_; }
  Quat orientation() const {
    const auto component = [&](std::size_t i) { return static_cast<double>(q_[i]); };
    return Quat(component(0), component(1), component(2), component(3));
  }

 private:
  static constexpr std::size_t kOrder = 24;

  Real speed() const {
    Real squared = 0;
    for (std::size_t i = 0; i < 3; ++i) squared += (L_[i] / I_[i]) * (L_[i] / I_[i]);
    return static_cast<Real>(std::sqrt(static_cast<double>(squared)));
  }

  void step(Real h) {
    std::array<Vector, kOrder + 1> L, w;
    std::array<Quaternion, kOrder + 1> q;
    L[0] = L_;
    q[0] = q_;
    for (std::size_t i = 0; i < 3; ++i) w[0][i] = L[0][i] / I_[i];
    for (std::size_t k = 0; k < kOrder; ++k) {
      Vector dL{};
      Quaternion dq{};
      for (std::size_t i = 0; i <= k; ++i) {
        const Vector &l = L[i], &u = w[k - i];
        const Quaternion& p = q[i];
        dL[0] += l[1] * u[2] - l[2] * u[1];
        dL[1] += l[2] * u[0] - l[0] * u[2];
        dL[2] += l[0] * u[1] - l[1] * u[0];
        dq[0] -= p[1] * u[0] + p[2] * u[1] + p[3] * u[2];
        dq[1] += p[0] * u[0] + p[2] * u[2] - p[3] * u[1];
        dq[2] += p[0] * u[1] + p[3] * u[0] - p[1] * u[2];
        dq[3] += p[0] * u[2] + p[1] * u[1] - p[2] * u[0];
      }
      const Real n = static_cast<Real>(k + 1);
      for (std::size_t i = 0; i < 3; ++i) {
        L[k + 1][i] = dL[i] / n;
        w[k + 1][i] = L[k + 1][i] / I_[i];
      }
      for (std::size_t i = 0; i < 4; ++i) q[k + 1][i] = dq[i] / (2 * n);
    }
    L_ = L[kOrder];
    q_ = q[kOrder];
    for (std::size_t k = kOrder; k-- > 0;) {
      for (std::size_t i = 0; i < 3; ++i) L_[i] = L[k][i] + h * L_[i];
      for (std::size_t i = 0; i < 4; ++i) q_[i] = q[k][i] + h * q_[i];
    }
    Real squared = 0;
    for (const Real c : q_) squared += c * c;
    for (Real& c : q_) c *= (3 - squared) / 2;  // 1/|q| so near to 1
  }

  Vector I_, L_;
  Quaternion q_{1, 0, 0, 0};
};

/// The orientation after t [s], and by how much two step sizes disagree [rad].
struct Truth {
  Quat q;
  double doubt;
};

template <typename Real = long double>
Truth true_rotation(const Vec3& I, const Vec3& w_B, double t) {
  RotationReference<Real> coarse(I, w_B), fine(I, w_B);
  coarse.advance(static_cast<Real>(t), static_cast<Real>(0.3));
  fine.advance(static_cast<Real>(t), static_cast<Real>(0.2));
  const auto &a = coarse.q(), &b = fine.q();  // vector part of a* b:
  const Real x = a[0] * b[1] - a[1] * b[0] - a[2] * b[3] + a[3] * b[2];
  const Real y = a[0] * b[2] - a[2] * b[0] - a[3] * b[1] + a[1] * b[3];
  const Real z = a[0] * b[3] - a[3] * b[0] - a[1] * b[2] + a[2] * b[1];
  return {fine.orientation(), 2.0 * std::sqrt(static_cast<double>(x * x + y * y + z * z))};
}

}  // namespace tumble::test
