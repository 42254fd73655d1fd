// Elliptic integrals against 128-bit arithmetic over the whole range of the parameter, 1e-250 from both ends.
#include "math/elliptic.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace tumble {
namespace {

__extension__ using Quad = __float128;

/// Newton's root in quad, from the double's.
Quad root(Quad x) {
  if (x == 0) return 0;
  Quad r = std::sqrt(static_cast<double>(x));
  for (int i = 0; i < 3; ++i) r = (r + x / r) / 2;
  return r;
}

constexpr Quad kPi = static_cast<Quad>(3.14159265358979311600) + 1.22464679914735317720e-16;

struct QuadIntegrals {
  Quad K, excess;
};

QuadIntegrals reference_complete(Quad m, Quad m1) {
  Quad a = 1, b = root(m1), excess = m / 2, weight = 1;
  for (int i = 0; i < 16; ++i) {
    const Quad c = (a - b) / 2, mean = (a + b) / 2;
    b = root(a * b);
    a = mean;
    excess += weight * c * c;
    weight *= 2;
  }
  return {kPi / (2 * a), excess};
}

/// Duplication until the arguments agree to 1e-12, then the leading terms of the series: an error of 1e-36.
void reference_carlson(Quad x, Quad y, Quad& R_F, Quad& R_D) {
  Quad z = 1, sum = 0, f = 1;
  for (int i = 0; i < 600; ++i) {
    const Quad rx = root(x), ry = root(y), rz = root(z), lambda = rx * ry + rx * rz + ry * rz;
    sum += f / (rz * (z + lambda));
    f /= 4;
    x = (x + lambda) / 4;
    y = (y + lambda) / 4;
    z = (z + lambda) / 4;
    const double spread =
        std::abs(static_cast<double>((x - z) / z)) + std::abs(static_cast<double>((y - z) / z));
    if (spread < 1e-9) break;
  }
  const Quad mean = (x + y + z) / 3, X = (mean - x) / mean, Y = (mean - y) / mean, Z = (mean - z) / mean;
  R_F = (1 - (X * Y - Z * Z) / 10 + X * Y * Z / 14) / root(mean);
  const Quad mu = (x + y + 3 * z) / 5, A = (mu - x) / mu, B = (mu - y) / mu, C = (mu - z) / mu;
  const Quad d = A * B - 6 * C * C, e = d + 2 * (A * B - C * C);
  R_D = 3 * sum + f / (mu * root(mu)) * (1 - 3 * d / 14 + C * e / 6);
}

double relative(double found, Quad exact) {
  return std::abs(static_cast<double>((found - exact) / exact));
}

/// Parameters from 1e-250 to 1 - 1e-250, given with their complements.
std::vector<std::pair<double, double>> parameters() {
  std::vector<std::pair<double, double>> all;
  for (int i = 1; i < 200; ++i) all.push_back({i / 200.0, 1.0 - i / 200.0});
  for (double tiny = 1e-3; tiny > 1e-250; tiny *= 0.03) {
    all.push_back({tiny, 1.0 - tiny});
    all.push_back({1.0 - tiny, tiny});
  }
  return all;
}

TEST(Elliptic, CompleteIntegralsAreAccurateUpToTheEnds) {
  double worst_K = 0, worst_excess = 0;
  for (const auto& [m, m1] : parameters()) {
    const CompleteIntegrals found = compute_complete_integrals(m, m1);
    const QuadIntegrals exact = reference_complete(m, m1);
    worst_K = std::max(worst_K, relative(found.K, exact.K));
    worst_excess = std::max(worst_excess, relative(found.excess, exact.excess));
  }
  EXPECT_LT(worst_K, 1e-15);
  EXPECT_LT(worst_excess, 1e-15);
}

TEST(Elliptic, CompleteIntegralsHaveKnownValues) {
  EXPECT_DOUBLE_EQ(compute_complete_integrals(0.0, 1.0).K, 1.57079632679489661923);
  EXPECT_DOUBLE_EQ(compute_complete_integrals(0.5, 0.5).K,
                   1.85407467730137191843);  // Gamma(1/4)^2 / (4 sqrt pi)
  EXPECT_DOUBLE_EQ(compute_complete_integrals(0.5, 0.5).excess,
                   1.0 - 1.35064388104767550253 / 1.85407467730137191843);
}

TEST(Elliptic, CarlsonsFormsAreAccurate) {
  double worst_F = 0, worst_D = 0;
  const auto all = parameters();
  for (std::size_t i = 0; i < all.size(); i += 11) {
    for (std::size_t j = 0; j < all.size(); j += 13) {
      const double a = all[i].first, b = all[j].first;
      const CarlsonIntegrals found = compute_carlson_integrals(a, b);
      Quad R_F, R_D;
      reference_carlson(a, b, R_F, R_D);
      worst_F = std::max(worst_F, relative(found.R_F, R_F));
      worst_D = std::max(worst_D, relative(found.R_D, R_D));
    }
  }
  EXPECT_LT(worst_F, 1e-15);  // 4.5e-16
  EXPECT_LT(worst_D, 1e-15);  // 5.0e-16
  EXPECT_NEAR(compute_carlson_integrals(1.0, 1.0).R_F, 1.0, 1e-16);
  // R_F(0, y, 1) = K(1 - y)
  EXPECT_NEAR(compute_carlson_integrals(0.0, 0.5).R_F, compute_complete_integrals(0.5, 0.5).K, 1e-15);
}

}  // namespace
}  // namespace tumble
