// See elliptic.h. The order of every sum is fixed: another order is another function to the last bit.
#include "math/elliptic.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tumble {

CompleteIntegrals compute_complete_integrals(double m, double m1) {
  double a = 1.0, b = std::sqrt(m1), excess = 0.5 * m, weight = 1.0;
  // Each round doubles the digits: 4 at m = 1/2, 12 at m1 = 1e-280.
  for (int round = 0; round < 20 && std::abs(a - b) > 2e-16 * a; ++round) {
    const double c = 0.5 * (a - b), mean = 0.5 * (a + b);
    b = std::sqrt(a * b);
    a = mean;
    excess += weight * (c * c);
    weight *= 2.0;
  }
  return {0.5 * std::numbers::pi / a, excess};
}

CarlsonIntegrals compute_carlson_integrals(double x, double y) {
  // Duplication halves the spread of the arguments until the series below have nothing left to add.
  constexpr double kSpread = 8e-3;
  double z = 1.0, sum = 0.0, f = 1.0;
  double mu = 0.2 * (x + y + 3.0 * z);
  const auto is_spread = [&] {
    return std::max({std::abs(mu - x), std::abs(mu - y), std::abs(mu - z)}) >= kSpread * mu;
  };
  while (is_spread()) {
    const double rx = std::sqrt(x), ry = std::sqrt(y), rz = std::sqrt(z);
    const double lambda = rx * ry + rx * rz + ry * rz;
    sum += f / (rz * (z + lambda));
    f *= 0.25;
    x = 0.25 * (x + lambda);
    y = 0.25 * (y + lambda);
    z = 0.25 * (z + lambda);
    mu = 0.2 * (x + y + 3.0 * z);
  }
  CarlsonIntegrals result;
  {
    const double inverse = 1.0 / mu, X = (mu - x) * inverse, Y = (mu - y) * inverse, Z = (mu - z) * inverse;
    const double a = X * Y, b = Z * Z;
    const double E2 = a - 6.0 * b, E3 = (3.0 * a - 8.0 * b) * Z, E4 = 3.0 * (a - b) * b, E5 = a * b * Z;
    const double series = 1.0 + E2 * (-3.0 / 14.0 + E2 * (9.0 / 88.0 - E2 / 16.0)) +
                          E3 * (1.0 / 6.0 - E2 * (9.0 / 52.0 - E2 * (45.0 / 272.0)) + E3 * (3.0 / 40.0)) +
                          E4 * (-3.0 / 22.0 + E2 * (3.0 / 20.0) - E3 * (9.0 / 68.0)) +
                          E5 * (3.0 / 26.0 - E2 * (9.0 / 68.0));
    result.R_D = 3.0 * sum + f * series / (mu * std::sqrt(mu));
  }
  {
    const double mean = (x + y + z) / 3.0;
    const double inverse = 1.0 / mean;
    const double X = (mean - x) * inverse, Y = (mean - y) * inverse, Z = (mean - z) * inverse;
    const double E2 = X * Y - Z * Z, E3 = X * Y * Z;
    result.R_F = (1.0 + E2 * (-1.0 / 10.0 + E2 * (1.0 / 24.0 - E2 * (5.0 / 208.0)) + E3 * (E2 / 16.0)) +
                  E3 * (1.0 / 14.0 - E2 * (3.0 / 44.0) + E3 * (3.0 / 104.0))) /
                 std::sqrt(mean);
  }
  return result;
}

}  // namespace tumble
