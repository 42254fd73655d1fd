// See free_rotation.h.
#include "dynamics/free_rotation.h"

#include <algorithm>
#include <cmath>

#include "math/four.h"

namespace tumble {
namespace {

/// Two moments nearer than this, relative to the largest, are equal: their difference is rounding. A looser limit would
/// cost accuracy, since the generic formulas hold up to here.
constexpr double kEqualMoments = 4e-16;

/// Below this the motion across axis 3 is nothing, and its square underflows.
constexpr double kNothingAcross = 1e-280;

/// Angular velocity in P, each component from w or from L, whichever rounds it less.
Vec3 principal_velocity(const MassProperties& mass, const Motion& start) {
  const Quat to_P = (start.q * mass.q_BP).conjugate();
  const Vec3 by_w = to_P * start.w, L_P = to_P * start.L;
  const double L = start.L.norm(), w = start.w.norm();
  Vec3 w_P;
  for (int i = 0; i < 3; ++i) w_P[i] = mass.I[i] * w < L ? by_w[i] : mass.inv_I[i] * L_P[i];
  return w_P;
}

/// p q with its four parts side by side: Eigen's product, to the bit.
Quat times(const Quat& p, const Quat& q) {
  const Four b{q.x(), q.y(), q.z(), q.w()}, a{p.x(), p.y(), p.z(), p.w()};
  constexpr Four kSigns{1.0, 1.0, 1.0, -1.0};
  const Four c = p.w() * b + kSigns * shuffled<0, 1, 2, 0>(a) * shuffled<3, 3, 3, 0>(b) +
                 kSigns * shuffled<1, 2, 0, 1>(a) * shuffled<2, 0, 1, 1>(b) -
                 shuffled<2, 0, 1, 2>(a) * shuffled<1, 2, 0, 2>(b);
  return Quat(c[3], c[0], c[1], c[2]);
}

}  // namespace

FreeRotation::FreeRotation(const MassProperties& mass, const Motion& start) : start_(start.q) {
  classify(mass, start);
}

void FreeRotation::classify(const MassProperties& mass, const Motion& start) {
  const Vec3 w_P = principal_velocity(mass, start);
  const Vec3& I = mass.I;
  const double smallest_gap = kEqualMoments * I.maxCoeff();
  for (int a = 0; a < 3; ++a) {
    const int b = (a + 1) % 3, c = (a + 2) % 3;
    if (std::abs(I[b] - I[c]) > smallest_gap) continue;
    Vec3 spin_P = Vec3::Zero();
    if (std::abs(I[a] - I[b]) > smallest_gap) spin_P[a] = w_P[a] * (I[b] - I[a]) / I[b];
    return set_steady(start.L / I[b], mass.q_BP * spin_P);
  }

  std::array<int, 3> axes = {0, 1, 2};
  std::sort(axes.begin(), axes.end(), [&](int i, int j) { return I[i] < I[j]; });
  const auto [low, middle, high] = axes;
  if (w_P[low] == 0.0 && w_P[high] == 0.0) return set_steady(start.L / I[middle], Vec3::Zero());
  const double e_low = I[low] * (I[middle] - I[low]) * w_P[low] * w_P[low];
  const double e_high = I[high] * (I[high] - I[middle]) * w_P[high] * w_P[high];
  if (e_low >= e_high) std::swap(axes[0], axes[2]);

  const Vec3 I_S(I[axes[0]], I[axes[1]], I[axes[2]]), w_S(w_P[axes[0]], w_P[axes[1]], w_P[axes[2]]);
  const double A = Tumbling::compute_A(I_S, w_S);
  const double C = Tumbling::compute_C(I_S, w_S);
  const double d12 = std::abs(I_S[0] - I_S[1]), d23 = std::abs(I_S[1] - I_S[2]);
  if (!(A > kNothingAcross) || !(A * d12 > kNothingAcross * C * d23)) {
    return set_steady(start.L / I_S[2], Vec3::Zero());
  }
  set_tumbling(mass, w_P, axes, start.L.norm());
}

void FreeRotation::set_steady(const Vec3& rate_W, const Vec3& spin_B) {
  steady_ = true;
  about_L_ = Turn(rate_W);
  about_body_ = Turn(spin_B);
}

void FreeRotation::set_tumbling(const MassProperties& mass, const Vec3& w_P, const std::array<int, 3>& axes,
                                double L) {
  steady_ = false;
  const bool cyclic = (axes[0] + 1) % 3 == axes[1];
  const double sign3 = w_P[axes[2]] < 0.0 ? -1.0 : 1.0;
  const Vec3 sign(1.0, cyclic ? sign3 : -sign3, sign3);
  Mat3 R_SP = Mat3::Zero();
  Vec3 I_S, w_S;
  for (int i = 0; i < 3; ++i) {
    const int axis = axes[static_cast<std::size_t>(i)];
    R_SP(i, axis) = sign[i];
    I_S[i] = mass.I[axis];
    w_S[i] = sign[i] * w_P[axis];
    L_over_I_[i] = L * mass.inv_I[axis];
  }
  tumbling_ = Tumbling(I_S, w_S, L);
  q_SB_ = normalized(Quat(R_SP)) * mass.q_BP.conjugate();
  start_ = normalized(start_ * (tumbling_.at(0.0).f * q_SB_).conjugate());
}

FreeRotation::Turn::Turn(const Vec3& rate) : rate_(rate), half_speed_(0.5 * rate.norm()) {
  if (half_speed_ > 0.0) axis_ = rate / rate.norm();
}

Quat FreeRotation::Turn::after(double t) const {
  const auto [s, c] = sincos(t * half_speed_);
  return Quat(c, s * axis_.x(), s * axis_.y(), s * axis_.z());
}

FreeRotation::State FreeRotation::at(double t) const {
  if (steady_) {
    Quat q = about_L_.after(t) * start_;
    if (about_body_.speed() == 0.0) return {q, about_L_.rate()};
    q = q * about_body_.after(t);
    return {q, about_L_.rate() + q * about_body_.rate()};
  }
  // w is formed along the sorted axes and then turned: a thin axis keeps its own digits.
  const Tumbling::State now = tumbling_.at(t);
  const Quat q_WS = times(start_, now.f);
  return {times(q_WS, q_SB_), q_WS * Vec3(L_over_I_.cwiseProduct(now.L_hat))};
}

double FreeRotation::phase_rate() const {
  return steady_ ? std::max(about_L_.speed(), about_body_.speed()) : tumbling_.phase_rate();
}

}  // namespace tumble
