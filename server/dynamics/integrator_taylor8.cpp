// Taylor series of order 8 in time for the body's momentum and orientation, with the world momentum running linearly:
//   L_{k+1} = (tau_k + sum L_i x w_{k-i}) / (k+1),   tau_{k+1} = (sum tau_i x w_{k-i}) / (k+1),
//   p_{k+1} = (sum p_i (0; w_{k-i})) / (2 (k+1)),    w_k = I^-1 L_k,
// from L_0 = q* L q, tau_0 = q* tau q (a constant world torque seen from the turning body), p_0 = 1; the step is
// q <- q sum p_k h^k. The series of L is not evaluated at the end: L(t) is known. Frame P: principal axes.
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "dynamics/integrator.h"
#include "math/four.h"

namespace tumble {
namespace {

constexpr int kOrder = 8;

/// Angle per sub-step [rad]. Just below it 10 s of free flight end within 3e-12 rad in the worst case of the tests, at
/// half of it within rounding.
constexpr double kAngle = 0.1;

/// At most this many sub-steps a step. Up to 25 rad a step (6000 rad/s at 240 Hz) nothing is lost, from there on the
/// sub-steps grow.
constexpr int kMaxSubSteps = 256;

/// Beyond this angle per sub-step [rad] (60000 rad/s at 240 Hz) the series stops converging and the body is turned
/// about its momentary axis, so that the orientation stays finite; the momentum is exact all the same.
constexpr double kLargestSubTurn = 1.0;

/// The series of one turn of h [s], in time counted in h, from the momentum and torque in P at its start. Vectors are
/// lanes (x, y, z, 0), quaternions (w, x, y, z). Momentum and torque are scaled by h and h^2: a scaled I^-1 would be off by
/// the same rounding at every step.
class Turn {
 public:
  Turn(const Vec3& inv_I, const Vec3& L_P, const Vec3& tau_P, double h)
      : inv_I_{inv_I.x(), inv_I.y(), inv_I.z(), 0.0},
        gap_{inv_I.z() - inv_I.y(), inv_I.x() - inv_I.z(), inv_I.y() - inv_I.x(), 0.0} {
    const Four L = h * Four{L_P.x(), L_P.y(), L_P.z(), 0.0};
    if (tau_P.isZero(0.0)) {
      extend<false>(L, Four{}, std::make_index_sequence<kOrder>());
    } else {
      extend<true>(L, h * h * Four{tau_P.x(), tau_P.y(), tau_P.z(), 0.0}, std::make_index_sequence<kOrder>());
    }
  }

  /// The quaternion of the turn, unit up to the cut-off of the series.
  Quat whole() const { return Quat(sum_[0], sum_[1], sum_[2], sum_[3]); }

 private:
  using Series = std::array<Four, kOrder>;

  static Four yzx(const Four& v) { return rotated_three<1>(v); }
  static Four zxy(const Four& v) { return rotated_three<2>(v); }

  /// Coefficient k of the product of two series; what the newest coefficients make comes last, since all else can be
  /// summed before they are known. k is a template argument so that every loop unrolls.
  template <std::size_t k>
  static Four product(const Series& a, const Series& b) {
    if constexpr (k == 0) {
      return a[0] * b[0];
    } else {
      Four ends = a[0] * b[k] + a[k] * b[0];
      if constexpr (k > 1) ends += inner<k>(a, b, std::make_index_sequence<k - 1>());
      return ends;
    }
  }
  template <std::size_t k, std::size_t... i>
  static Four inner(const Series& a, const Series& b, std::index_sequence<i...>) {
    return (... + (a[i + 1] * b[k - 1 - i]));
  }

  template <bool with_torque, std::size_t... k>
  void extend(Four L, Four tau, std::index_sequence<k...>) {
    std::array<Four, kOrder + 1> p;
    p[0] = Four{1.0, 0.0, 0.0, 0.0};
    ((p[k + 1] = next<with_torque, k>(L, tau, p[k])), ...);
    sum_ = p[kOrder];
    for (std::size_t i = kOrder; i-- > 0;) sum_ += p[i];  // the smallest first
  }

  /// Coefficient k + 1 of p; L and tau become their coefficients k + 1.
  template <bool with_torque, std::size_t k>
  Four next(Four& L, Four& tau, Four p) {
    constexpr double inverse = 1.0 / (k + 1), half = 0.5 / (k + 1);
    const Four w = inv_I_ * L;
    wx_[k] = shuffled<0, 0, 0, 0>(w);
    wy_[k] = shuffled<1, 1, 1, 1>(w);
    wz_[k] = shuffled<2, 2, 2, 2>(w);
    // What w_x, w_y, w_z multiply in the product p (0; w).
    p_x_[k] = shuffled<1, 0, 3, 2>(p) * Four{-1.0, 1.0, 1.0, -1.0};
    p_y_[k] = shuffled<2, 3, 0, 1>(p) * Four{-1.0, -1.0, 1.0, 1.0};
    p_z_[k] = shuffled<3, 2, 1, 0>(p) * Four{-1.0, 1.0, -1.0, 1.0};
    // L x w has one product per component: (L x w)_x = L_y L_z (1/I_z - 1/I_y).
    L_yzx_[k] = yzx(L);
    L_zxy_[k] = zxy(L);
    L = inverse * (gap_ * product<k>(L_yzx_, L_zxy_));
    if constexpr (with_torque) {
      L += inverse * tau;
      w_yzx_[k] = yzx(w);
      w_zxy_[k] = zxy(w);
      tau_yzx_[k] = yzx(tau);
      tau_zxy_[k] = zxy(tau);
      tau = inverse * (product<k>(tau_yzx_, w_zxy_) - product<k>(tau_zxy_, w_yzx_));
    }
    return half * (product<k>(p_x_, wx_) + product<k>(p_y_, wy_) + product<k>(p_z_, wz_));
  }

  Four inv_I_, gap_, sum_;
  Series wx_, wy_, wz_, p_x_, p_y_, p_z_, L_yzx_, L_zxy_;
  Series w_yzx_, w_zxy_, tau_yzx_, tau_zxy_;
};

/// A ball whose axis stays: exact whatever the angle. A wandering axis adds a term of h^2 |w0 x w1| / 12 (Magnus), which
/// is nothing if it is below round-off, or comes from the rounding of two parallel vectors.
bool turns_about_fixed_axis(const Vec3& inv_I, const Vec3& w0, const Vec3& w1, double h) {
  const bool ball = inv_I.x() == inv_I.y() && inv_I.y() == inv_I.z();
  return ball && h * h * w0.cross(w1).norm() <= 1e-16 + 4e-16 * (h * h * w0.norm() * w1.norm());
}

/// q_WP after h [s], unit up to rounding times the number of sub-steps. Their number follows from the speeds before each of
/// them, with the momentum of now and of the end; while it turns, a free body's |w| changes by at most |w|^2 per second (the
/// moments obey the triangle inequality).
Quat turned(const MassProperties& mass, const VelocityPath& path, double h, Quat q) {
  const bool has_torque = path.L0 != path.L1;
  const Vec3 tau = has_torque ? Vec3((path.L1 - path.L0) / h) : Vec3(Vec3::Zero());
  double t = 0.0;
  for (int left = kMaxSubSteps;; --left) {
    const Quat to_P = q.conjugate();
    const Vec3 L_P = to_P * Vec3(path.L0 + t * tau);
    const Vec3 w_P = mass.inv_I.cwiseProduct(L_P);
    const Vec3 w1_P = has_torque ? Vec3(mass.inv_I.cwiseProduct(to_P * path.L1)) : w_P;
    const double angle = (h - t) * std::sqrt(std::max(w_P.squaredNorm(), w1_P.squaredNorm()));
    double parts = 1.0, step = h - t;
    if (angle > kAngle && left > 1) {
      parts = std::min(std::ceil(angle / kAngle), static_cast<double>(left));
      step /= parts;
    }
    q = q * (angle > kLargestSubTurn * parts
                 ? exp_map(step * w_P)
                 : Turn(mass.inv_I, L_P, has_torque ? Vec3(to_P * tau) : tau, step).whole());
    if (parts == 1.0) return q;
    q = normalized(q);
    t += step;
  }
}

}  // namespace

void integrate_taylor8(const MassProperties& mass, const VelocityPath& path, double h, Motion& body) {
  body.x += (0.5 * h) * (path.v0 + path.v1);
  const Vec3 w0 = mass.inv_I.x() * path.L0;
  const Vec3 w1 = mass.inv_I.x() * path.L1;
  if (turns_about_fixed_axis(mass.inv_I, w0, w1, h)) {
    set_end_of_step(mass, path, exp_map((0.5 * h) * (w0 + w1)) * body.q, body);
  } else {
    const bool aligned = mass.q_BP.vec().isZero(0.0);
    const Quat q_WP = turned(mass, path, h, aligned ? body.q : body.q * mass.q_BP);
    set_end_of_step(mass, path, aligned ? q_WP : q_WP * mass.q_BP.conjugate(), body);
  }
}

}  // namespace tumble
