// A flight against the closed forms of its translation, and against small steps where it is damped.
#include "dynamics/flight.h"

#include <gtest/gtest.h>

#include "dynamics/integrator.h"
#include "support/rotation_cases.h"

namespace tumble {
namespace {

TEST(Flight, FollowsItsParabola) {
  Motion start = start_of(kGeneric);
  start.x = Vec3(1, 2, 3);
  start.v = Vec3(3, -1, 12);
  const Vec3 g(0, 0, -9.81);
  const Flight flight(principal_body(kGeneric.I), start, g);
  const double t = 10.0;
  const Motion end = flight.at(t);
  EXPECT_LT((end.x - (start.x + start.v * t + 0.5 * t * t * g)).norm(), 1e-13);
  EXPECT_LT((end.v - (start.v + t * g)).norm(), 1e-14);
  EXPECT_EQ(end.L, start.L);
  EXPECT_LT(angle_between(end.q, kGeneric.q), 5e-14);
  EXPECT_EQ(end.x, flight.position(t));
  EXPECT_EQ(end.v, flight.velocity(t));
}

/// (x - 1 + e^-x) / x^2; by its series where that would cancel.
long double mean_loss_by_series(long double x) {
  if (x > 1.0L) return (x + std::expm1(-x)) / (x * x);
  long double term = 0.5L, sum = 0.5L;
  for (int n = 3; n < 25; ++n) sum += term *= -x / n;
  return sum;
}

TEST(Flight, DampedFallNearsItsFinalSpeed) {
  // v = a/c + (v0 - a/c) e^-ct, in 80 bits, for strong and for hardly any damping.
  Motion start;
  start.v = Vec3(4, -2, 7);
  const Vec3 a(0, 0, -9.81);
  for (const double c : {1e-9, 1e-3, 0.03, 0.3, 3.0, 300.0}) {
    const Flight flight(principal_body(Vec3(1, 2, 3)), start,
                        FlightLoad{.acceleration = a, .linear_damping = c});
    for (const double t : {1e-3, 0.1, 1.0, 10.0}) {
      const long double ct = static_cast<long double>(c) * t, loss = -std::expm1(-ct);
      for (int i = 0; i < 3; ++i) {
        const long double v = start.v[i] * (1.0L - loss) + a[i] * loss / c;
        const long double x = start.v[i] * loss / c + a[i] * (t * t * mean_loss_by_series(ct));
        const double scale = std::abs(start.v[i] * t) + std::abs(a[i]) * t * t;
        EXPECT_NEAR(flight.velocity(t)[i], static_cast<double>(v),
                    1e-14 * (std::abs(start.v[i]) + std::abs(a[i]) * t));
        EXPECT_NEAR(flight.position(t)[i], static_cast<double>(x), 1e-14 * scale) << c << " " << t;
      }
    }
  }
}

TEST(Flight, DampedTumblingIsFreeTumblingByASlowingClock) {
  const double c = 0.2;
  const MassProperties mass = principal_body(kPlate.I);
  const Flight flight(mass, start_of(kPlate), FlightLoad{.angular_damping = c});
  // The same by small steps: L e^-ct is nearly linear over one, to third order in it.
  const auto stepped = [&](int steps) {
    Motion body = start_of(kPlate);
    const double h = 2.0 / steps;
    for (int i = 0; i < steps; ++i) {
      const Vec3 L1 = exp_decay(-c * h * (i + 1)) * kPlate.I.cwiseProduct(kPlate.w0);
      integrate_taylor8(mass, {Vec3::Zero(), Vec3::Zero(), body.L, L1}, h, body);
    }
    return body;
  };
  const Motion end = flight.at(2.0);
  const double coarse = angle_between(end.q, stepped(500).q), fine = angle_between(end.q, stepped(2000).q);
  EXPECT_LT(fine, 1e-6);
  EXPECT_NEAR(coarse / fine, 16.0, 0.5);  // to what the steps converge with their order
  EXPECT_LT((end.w - angular_velocity(mass, end.q, end.L)).norm(), 1e-14);
  EXPECT_LT((end.L - std::exp(-0.4) * start_of(kPlate).L).norm(), 1e-14);
}

}  // namespace
}  // namespace tumble
