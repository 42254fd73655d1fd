// See rotation.h. The order of every sum is fixed: another order is another function to the last bit.
#include "math/rotation.h"

#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "math/four.h"

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

/// Sine's and cosine's series in lanes that take turns: their coefficients in p.
template <typename Lanes, typename Repeat>
Lanes sincos_series(const Lanes& x, const Repeat& repeat) {
  const Lanes x2 = x * x;
  return (repeat(kSeries[0]) + x * repeat(kSeries[1])) + x2 * (repeat(kSeries[2]) + x * repeat(kSeries[3])) +
         (x2 * x2) * (repeat(kSeries[4]) + x * repeat(kSeries[5]));
}

/// x less the nearest multiple k of pi/2, and k.
struct Reduced {
  double r;
  std::uint64_t quadrant;
};
Reduced reduce(double x) {
  if (!(std::abs(x) < 1.6e6)) {
    // Here x itself is rounded to 1e-10 or worse. The remainder is exact by IEEE 754, alike in every C library.
    x = std::remainder(x, 2.0 * std::numbers::pi);
    if (!std::isfinite(x)) return {x, 0};
  }
  const double k = std::nearbyint(x * kTwoOverPi);
  return {(x - k * kHalfPiHi) - k * kHalfPiLo, static_cast<std::uint64_t>(static_cast<std::int64_t>(k))};
}

/// From the series' values.
SinCos finish(const Reduced& x, double sine, double cosine) {
  const double r = x.r, r2 = r * r, y = 0.5 * r2, w = 1.0 - y;
  const double s = r + r * (r2 * sine), c = w + (((1.0 - w) - y) + r2 * r2 * cosine);
  // By quadrant {s, c}, {c, -s}, {-s, -c}, {-c, s}; without branches, which no processor could predict.
  const auto signed_by = [](double value, std::uint64_t bit) {
    return std::bit_cast<double>(std::bit_cast<std::uint64_t>(value) ^ (bit & 2) << 62);
  };
  const bool odd = x.quadrant & 1;
  return {signed_by(odd ? c : s, x.quadrant), signed_by(odd ? s : c, x.quadrant + 1)};
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

/// c_0 + c_1 x + c_2 x^2 + ..., by pairs of neighbours (Estrin 1960): half as long a wait as Horner's rule.
template <std::size_t count>
double sum_powers(const std::array<double, count>& c, double x) {
  std::array<double, (count + 1) / 2> pairs;
  for (std::size_t k = 0; k < count / 2; ++k) pairs[k] = c[2 * k] + x * c[2 * k + 1];
  if constexpr (count % 2 == 1) pairs[count / 2] = c[count - 1];
  if constexpr (pairs.size() == 1) {
    return pairs[0];
  } else {
    return sum_powers(pairs, x * x);
  }
}

/// e^r - 1 for |r| <= 0.35 by its Taylor series to r^13 (remainder < 5e-18).
double expm1_reduced(double r) {
  return r + r * r * sum_powers(kExp, r);
}

}  // namespace

SinCos sincos(double x) {
  const Reduced reduced = reduce(x);
  const double r2 = reduced.r * reduced.r;
  const Pair p = sincos_series(Pair{r2, r2}, [](const Pair& c) { return c; });
  return finish(reduced, p[0], p[1]);
}

std::array<SinCos, 2> sincos(double x, double y) {
  const Reduced first = reduce(x), second = reduce(y);
  const double a = first.r * first.r, b = second.r * second.r;
  const Four p = sincos_series(Four{a, a, b, b}, [](const Pair& c) { return Four{c[0], c[1], c[0], c[1]}; });
  return {finish(first, p[0], p[1]), finish(second, p[2], p[3])};
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
  if (x < 0.34) return sum_powers(kExp, -x);  // e^-x = 1 - x + x^2 (1/2 - x (1/3! - ...))
  return (1.0 - mean_decay(x)) / x;
}

Quat exp_map(const Vec3& r) {
  const double x2 = 0.25 * r.squaredNorm();  // half angle, squared
  if (x2 < 0.04) {
    // Taylor series of cos x and sin x / x: no square root, no division by a tiny angle (remainder < 1e-21).
    const double c = 1.0 - x2 * sum_powers(kCos, -x2);
    const Vec3 v = (0.5 - 0.5 * (x2 * sum_powers(kSinc, -x2))) * r;
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
