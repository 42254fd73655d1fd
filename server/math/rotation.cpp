// See rotation.h. The Horner order is fixed: a different order is a different function to the last bit.
#include "math/rotation.h"

#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <numbers>

namespace tumble {
namespace {

constexpr double kTwoOverPi = 6.36619772367581382433e-01;
constexpr double kHalfPiHi = 1.57079632673412561417;  // 33 bits: k * kHalfPiHi is exact for |k| < 2^20
constexpr double kHalfPiLo = 6.07710050650619224932e-11;
constexpr double kLn2Hi = 6.93147180369123816490e-01;
constexpr double kLn2Lo = 1.90821492927058770002e-10;
constexpr double kLog2E = 1.44269504088896338700;

/// Side by side: sine, cosine. Each lane has the bits that it would have alone.
using Pair = double __attribute__((vector_size(2 * sizeof(double))));
constexpr Pair kSeries[] = {{-1.66666666666666324348e-01, 4.16666666666666019037e-02},
                            {8.33333333332248946124e-03, -1.38888888888741095749e-03},
                            {-1.98412698298579493134e-04, 2.48015872894767294178e-05},
                            {2.75573137070700676789e-06, -2.75573143513906633035e-07},
                            {-2.50507602534068634195e-08, 2.08757232129817482790e-09},
                            {1.58969099521155010221e-10, -1.13596475577881948265e-11}};

/// For |r| <= pi/4.
SinCos sincos_reduced(double r) {
  const double r2 = r * r;
  Pair p = kSeries[5];
  for (int i = 4; i >= 0; --i) p = kSeries[i] + r2 * p;
  const double y = 0.5 * r2;
  const double w = 1.0 - y;
  return {r + r * (r2 * p[0]), w + (((1.0 - w) - y) + r2 * r2 * p[1])};
}

/// 1/first!, 1/(first + stride)!, ...
template <std::size_t count>
constexpr std::array<double, count> inverse_factorials(int first, int stride) {
  std::array<double, count> inverse{};
  double factorial = 1.0;  // exact up to 22!
  int n = 1;
  for (std::size_t k = 0; k < count; ++k) {
    for (; n <= first + stride * static_cast<int>(k); ++n) factorial *= n;
    inverse[k] = 1.0 / factorial;
  }
  return inverse;
}
constexpr auto kExp = inverse_factorials<12>(2, 1);
constexpr auto kCos = inverse_factorials<7>(2, 2);
constexpr auto kSinc = inverse_factorials<7>(3, 2);

/// c_0 + x (c_1 + x (c_2 + ...)).
template <std::size_t count>
double horner(const std::array<double, count>& c, double x) {
  double sum = c[count - 1];
  for (std::size_t k = count - 1; k-- > 0;) sum = c[k] + x * sum;
  return sum;
}

/// e^r - 1 for |r| <= 0.35 by its Taylor series to r^13 (remainder < 5e-18).
double expm1_reduced(double r) {
  return r + r * r * horner(kExp, r);
}

}  // namespace

SinCos sincos(double x) {
  if (!(std::abs(x) < 1.6e6)) {
    // Here x itself is rounded to 1e-10 or worse. The remainder is exact by IEEE 754, alike in every C library.
    x = std::remainder(x, 2.0 * std::numbers::pi);
    if (!std::isfinite(x)) return {x, x};
  }
  const double k = std::nearbyint(x * kTwoOverPi);
  const double r = (x - k * kHalfPiHi) - k * kHalfPiLo;
  const auto [s, c] = sincos_reduced(r);
  // By quadrant {s, c}, {c, -s}, {-s, -c}, {-c, s}; without branches, which no processor could predict.
  const auto quadrant = static_cast<std::uint64_t>(static_cast<std::int64_t>(k));
  const auto signed_by = [](double value, std::uint64_t bit) {
    return std::bit_cast<double>(std::bit_cast<std::uint64_t>(value) ^ (bit & 2) << 62);
  };
  const bool odd = quadrant & 1;
  return {signed_by(odd ? c : s, quadrant), signed_by(odd ? s : c, quadrant + 1)};
}

double exp_decay(double x) {
  assert(x <= 0.0);
  if (x < -708.0) return 0.0;
  const double k = std::nearbyint(x * kLog2E);
  const double r = (x - k * kLn2Hi) - k * kLn2Lo;
  const auto exponent = static_cast<std::uint64_t>(static_cast<std::int64_t>(k) + 1023) << 52;
  return (1.0 + expm1_reduced(r)) * std::bit_cast<double>(exponent);
}

double mean_decay(double x) {
  assert(x >= 0.0);
  if (x == 0.0) return 1.0;
  return (x < 0.34 ? -expm1_reduced(-x) : 1.0 - exp_decay(-x)) / x;
}

double mean_loss(double x) {
  assert(x >= 0.0);
  if (x < 0.34) return horner(kExp, -x);  // e^-x = 1 - x + x^2 (1/2 - x (1/3! - ...))
  return (1.0 - mean_decay(x)) / x;
}

Quat exp_map(const Vec3& r) {
  const double x2 = 0.25 * r.squaredNorm();  // half angle, squared
  if (x2 < 0.04) {
    // Taylor series of cos x and sin x / x: no square root, no division by a tiny angle (remainder < 1e-21).
    const double c = 1.0 - x2 * horner(kCos, -x2);
    const Vec3 v = (0.5 - 0.5 * (x2 * horner(kSinc, -x2))) * r;
    return Quat(c, v.x(), v.y(), v.z());
  }
  const double x = std::sqrt(x2);
  const SinCos sc = sincos(x);
  const Vec3 v = (0.5 * sc.sin / x) * r;
  return Quat(sc.cos, v.x(), v.y(), v.z());
}

Quat rotation_to_normal(const Vec3& n) {
  const double across2 = n.x() * n.x() + n.y() * n.y();
  if (n.z() < 0.0 && across2 < 1e-32) return Quat(0.0, 1.0, 0.0, 0.0);
  const double w = n.z() < 0.0 ? across2 / (1.0 - n.z()) : 1.0 + n.z();  // 1 + n_z without its cancellation
  return normalized(Quat(w, -n.y(), n.x(), 0.0));
}

}  // namespace tumble
