// See tumbling.h. Every difference of like quantities that the textbook forms contain is avoided; where one remains (the
// bracket of 1 - m) it is the distance to the separatrix, which is in the data.
#include "dynamics/tumbling.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "math/elliptic.h"
#include "math/four.h"

namespace tumble {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kPiHi = 3.14159265346825122834;  // 33 bits: products with whole numbers below 2^20 are exact
constexpr double kPiLo = 1.21542010130123846498e-10;

/// What a term of a series must exceed to count.
constexpr double kNothing = 1e-18;

/// 1 - m is at least this: nothing underflows later, and a body this near the separatrix stays there for 300 turns.
constexpr double kSmallestM1 = 1e-280;

double sign(double x) {
  return std::signbit(x) ? -1.0 : 1.0;
}

}  // namespace

double Tumbling::compute_A(const Vec3& I, const Vec3& w) {
  return I[0] * std::abs(I[0] - I[2]) * w[0] * w[0] + I[1] * std::abs(I[1] - I[2]) * w[1] * w[1];
}

double Tumbling::compute_C(const Vec3& I, const Vec3& w) {
  return I[1] * std::abs(I[0] - I[1]) * w[1] * w[1] + I[2] * std::abs(I[0] - I[2]) * w[2] * w[2];
}

Tumbling::Invariants Tumbling::compute_invariants(const Vec3& I, const Vec3& w, double L) {
  Invariants c;
  const double d12 = std::abs(I[0] - I[1]), d13 = std::abs(I[0] - I[2]), d23 = std::abs(I[1] - I[2]);
  const double sigma = I[0] > I[2] ? 1.0 : -1.0;
  c.A = compute_A(I, w);
  c.C = compute_C(I, w);
  c.m = std::min(c.A * d12 / (c.C * d23), 1.0);
  c.m1 =
      std::clamp(d13 * (I[2] * d23 * w[2] * w[2] - I[0] * d12 * w[0] * w[0]) / (c.C * d23), kSmallestM1, 1.0);
  const double rate = std::sqrt(c.C * d23 / (I[0] * I[1] * I[2]));
  c.w_p = -sigma * rate;
  c.w_max = {std::sqrt(c.A / (I[0] * d13)), std::sqrt(c.A / (I[1] * d23)), std::sqrt(c.C / (I[2] * d13))};

  const CompleteIntegrals complete = compute_complete_integrals(c.m, c.m1);
  c.K = complete.K;
  c.excess = complete.excess;
  c.K1 = compute_complete_integrals(c.m1, c.m).K;

  double sn = w[1] / c.w_max[1], cn = w[0] / c.w_max[0];
  const double length = std::sqrt(sn * sn + cn * cn);
  sn /= length;
  cn /= length;
  // cn^2 + m1 sn^2 = 1 - m sn^2 = dn^2.
  c.u0 = sn * compute_carlson_integrals(cn * cn, cn * cn + c.m1 * sn * sn).R_F;
  if (cn < 0.0) c.u0 = sign(sn) * 2.0 * c.K - c.u0;

  const double sin2 = d23 * I[0] / (I[1] * d13), cos2 = d12 * I[2] / (I[1] * d13);
  const CarlsonIntegrals incomplete = compute_carlson_integrals(cos2, cos2 + c.m * sin2);
  const double sine = std::sqrt(sin2);
  c.F = sine * incomplete.R_F;
  c.E_v = c.F - (c.m1 / 3.0) * (sin2 * sine) * incomplete.R_D;
  c.precession = L / I[1] + sigma * rate * (c.E_v - c.excess * c.F - 0.5 * kPi / c.K);
  return c;
}

Tumbling::Tumbling(const Vec3& I, const Vec3& w, double L) {
  const Invariants c = compute_invariants(I, w, L);
  const Vec3 l(I[0] * c.w_max[0], I[1] * c.w_max[1], I[2] * c.w_max[2]);
  circular_ = c.m <= 0.5;
  z0_ = 0.5 * kPi * c.u0 / c.K;
  z_rate_ = 0.5 * kPi * c.w_p / c.K;
  half_precession_ = 0.5 * c.precession;
  if (circular_) {
    set_circular(c, l);
  } else {
    set_hyperbolic(c, l);
  }
}

/// With the nome nu <= e^-pi: theta_1, 2, 3 by their Fourier series, theta_4(z + iy) as the product of its factor that
/// may vanish, 1 - W e^{-2iz} with W = e^{-pi F/K}, and the series of the rest.
void Tumbling::set_circular(const Invariants& c, const Vec3& l) {
  const double nu = exp_decay(-kPi * c.K1 / c.K);
  Coefficients g{}, e{};  // nu^(n^2), nu^(n(n+1))
  double power = 1.0, sum2 = 0.0, sum3 = -1.0;
  for (int n = 0; n < kTerms; ++n) {
    g[n] = n == 0 ? 1.0 : e[n - 1] * power;
    e[n] = g[n] * power;
    power *= nu;
    sum2 += e[n];
    sum3 += 2.0 * g[n];
    if (g[n] >= kNothing) terms_ = std::min(n + 1, 4);
  }
  const double kappa = std::sqrt(std::sqrt(c.m1)), ratio = sum3 / sum2;
  const double x = kPi * c.F / c.K;
  W_ = exp_decay(-x);
  loss_ = x * mean_decay(x);
  double rest = 0.0;  // sum over k >= n of (-1)^k nu^(k(k+1))
  for (int n = kTerms - 1; n >= 0; --n) {
    const double alternating = n % 2 == 0 ? 1.0 : -1.0;
    rest += alternating * e[n];
    if (n >= terms_) continue;
    const double theta1 = alternating * l[1] * ratio * e[n], theta2 = l[0] * kappa * ratio * e[n];
    series_[n] = {(n == 0 ? 1.0 : 2.0) * l[2] * kappa * g[n], 0.0, theta2, theta1};
    re_[n] = rest;
  }
  double falling = 1.0, rising = 1.0;  // W^n, W^-n
  for (int n = 1; n < terms_; ++n) {
    falling *= W_;
    rising /= W_;
    series_[n][1] = re_[n] * (rising - falling);
    re_[n] *= rising + falling;
  }
}

Tumbling::Thetas Tumbling::circular(double z, double precessed) const {
  const auto [at_z, turned] = sincos(z, precessed);
  const auto [s, c] = at_z;
  const double c2 = (c - s) * (c + s), s2 = 2.0 * s * c;
  const Four cos_2z = four(c2), sin_2z{-s2, s2, -s2, s2};
  Four phase{1.0, 0.0, c, s};  // cosine and sine of 2nz, and of (2n+1)z
  Four sum = four(series_[0]) * phase;
  double re = re_[0];
  for (int n = 1; n < terms_; ++n) {
    phase = phase * cos_2z + shuffled<1, 0, 3, 2>(phase) * sin_2z;
    sum += four(series_[n]) * phase;
    re += re_[n] * phase[0];
  }
  const double im = sum[1];
  const double factor_re = loss_ + 2.0 * W_ * s * s, factor_im = 2.0 * W_ * s * c;
  return {sum[3], sum[2], sum[0], factor_re * re - factor_im * im, factor_re * im + factor_im * re, turned};
}

/// With the nome nu_1 < e^-pi of 1 - m, after Jacobi's imaginary transform: hyperbolic functions of z K/K' by powers of
/// E = e^{-|z| K/K'} for |z| <= pi/2, and the symmetries of the functions beyond.
void Tumbling::set_hyperbolic(const Invariants& c, const Vec3& l) {
  nome1_ = exp_decay(-kPi * c.K / c.K1);
  K_ratio_ = c.K / c.K1;
  shift_ratio_ = 1.0 - c.F / c.K1;
  const double n1 = nome1_, n2 = n1 * n1, n4 = n2 * n2, n6 = n4 * n2;
  // m1^(1/4) nu_1^(-1/4), without the rounding of the exponent.
  const double f = 2.0 * (1.0 + n2 + n6 + n6 * n6) / (1.0 + 2.0 * n1 + 2.0 * n4 + 2.0 * (n4 * n4 * n1));
  const double root = 1.0 / std::sqrt(std::sqrt(c.m));
  const SinCos first = sincos(0.5 * kPi * c.F / c.K1);
  const double c2 = (first.cos - first.sin) * (first.cos + first.sin), s2 = 2.0 * first.sin * first.cos;
  double cosine = first.cos, sine = first.sin;
  double lower = 1.0, power = 1.0, alternating = 1.0;  // nu_1^(n^2 - n), nu_1^n, (-1)^n
  for (int n = 0; n < kTerms; ++n) {
    if (n >= 2 && lower < kNothing) break;
    terms_ = n + 1;
    const double square = lower * power;  // nu_1^(n^2)
    const double theta1 = alternating * l[1] * root * square, theta2 = alternating * l[0] * root * f * lower;
    series_[n] = {l[2] * f * lower, alternating * square * cosine, theta2, theta1};
    re_[n] = alternating * square * sine;
    lower = square * power;
    power *= n1;
    alternating = -alternating;
    const double turned = cosine * c2 - sine * s2;
    sine = sine * c2 + cosine * s2;
    cosine = turned;
  }
}

Tumbling::Thetas Tumbling::hyperbolic(double z, double precessed) const {
  // Beyond, z itself is rounded to 1e-10 or worse, as in sincos.
  if (!(std::abs(z) < 1.6e6)) z = std::remainder(z, 2.0 * kPi);
  const double k = std::nearbyint(z * (1.0 / kPi));
  const double z_rest = (z - k * kPiHi) - k * kPiLo;
  const double E = exp_decay(-std::abs(z_rest) * K_ratio_);
  const double E2 = E * E, E4 = E2 * E2, p = nome1_ / E2;
  Four sum = four(series_[0]) * Four{1.0, 1.0 - E2, 1.0, 1.0 - E2};
  double re = re_[0] * (1.0 + E2);
  double p_n = 1.0, E_4n = 1.0;
  for (int n = 1; n < terms_; ++n) {
    p_n *= p;
    E_4n *= E4;
    const double E_odd = E_4n * E2;
    sum += four(series_[n]) * p_n * (1.0 + Four{E_4n, -E_odd, E_4n, -E_odd});
    re += re_[n] * p_n * (1.0 + E_odd);
  }
  double T1 = sum[3], T2 = sum[2] * E, im = sum[1];
  if (z_rest < 0.0) {
    T1 = -T1;
    im = -im;
  }
  if (static_cast<std::int64_t>(k) & 1) {
    T1 = -T1;
    T2 = -T2;
  }
  return {T1, T2, sum[0] * E, re, im, sincos(precessed - 0.5 * z_rest * shift_ratio_)};
}

Tumbling::State Tumbling::at(double t) const {
  const double z = z0_ + z_rate_ * t, precessed = half_precession_ * t;
  const Thetas theta = circular_ ? circular(z, precessed) : hyperbolic(z, precessed);
  const double across2 = theta.T1 * theta.T1 + theta.T2 * theta.T2;
  const Four lengths =
      root(Four{across2, across2 + theta.T3 * theta.T3, theta.re * theta.re + theta.im * theta.im, 1.0});
  const double L = lengths[1], X = lengths[2], N = 1.0 / L;
  State state;
  state.L_hat = N * Vec3(theta.T2, theta.T1, theta.T3);

  // Half the polar angles of L, then half the precession: no arc tangent. Half the angle of (a, b) of length r, a >= 0, is
  // that of (r + a, b), whose length sqrt(2 r (r + a)) is taken off at the end.
  const bool along_3 = across2 == 0.0;  // then any angle phi will do
  const double across = along_3 ? 1.0 : lengths[0], cos_phi = along_3 ? 1.0 : theta.T2;
  const SinCos polar{lengths[0], L + theta.T3}, xi{theta.im, X + theta.re}, h = theta.precessed;
  SinCos phi{theta.T1, across + std::abs(cos_phi)};
  // Two roots, as their product may underflow.
  const double scale = 0.5 / (std::sqrt(2.0 * (L * polar.cos) * (X * xi.cos)) * std::sqrt(across * phi.cos));
  if (cos_phi < 0.0) {
    const double j = sign(phi.sin);
    phi = {j * phi.cos, j * phi.sin};
  }
  const double c_psi = h.cos * xi.cos - h.sin * xi.sin, s_psi = h.sin * xi.cos + h.cos * xi.sin;
  const double even_c = c_psi * phi.cos, even_s = s_psi * phi.sin;
  const double odd_c = s_psi * phi.cos, odd_s = c_psi * phi.sin;
  const double along = scale * polar.cos, across_f = scale * polar.sin;
  state.f = Quat(along * (even_c + even_s), across_f * (odd_c + odd_s), across_f * (even_s - even_c),
                 along * (odd_c - odd_s));
  return state;
}

double Tumbling::phase_rate() const {
  return std::max(std::abs(z_rate_), std::abs(half_precession_));
}

}  // namespace tumble
