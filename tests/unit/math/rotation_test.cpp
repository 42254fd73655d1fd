// Our elementary functions against the C library in 80-bit precision (allowed in tests), and exact where they can be.
#include "math/rotation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace tumble {
namespace {

double sincos_error(double x) {
  const SinCos sc = sincos(x);
  return static_cast<double>(std::max(std::abs(sc.sin - sinl(static_cast<long double>(x))),
                                      std::abs(sc.cos - cosl(static_cast<long double>(x)))));
}

TEST(Sincos, IsWithinItsErrorOverItsRange) {
  std::mt19937_64 random(1);
  double worst = 0.0;
  for (const double range : {1e-8, 0.1, 1.0, 10.0, 1e3, 1.6e6}) {
    std::uniform_real_distribution<double> uniform(-range, range);
    for (int i = 0; i < 50000; ++i) worst = std::max(worst, sincos_error(uniform(random)));
  }
  EXPECT_LE(worst, 1.2e-16);  // 1.16e-16
}

TEST(Sincos, StaysWithinTheRoundingOfAnArgumentBeyondItsRange) {
  std::mt19937_64 random(2);
  for (const double range : {1e7, 1e10, 1e14}) {
    std::uniform_real_distribution<double> uniform(-range, range);
    for (int i = 0; i < 1000; ++i) {
      const double x = uniform(random);
      ASSERT_LE(sincos_error(x), 1.2e-16 + 4e-17 * std::abs(x)) << x;
    }
  }
  const SinCos huge = sincos(1e300);
  EXPECT_NEAR(huge.sin * huge.sin + huge.cos * huge.cos, 1.0, 3e-16);
  EXPECT_TRUE(std::isnan(sincos(std::numeric_limits<double>::infinity()).sin));
  EXPECT_TRUE(std::isnan(sincos(std::nan("")).cos));
}

TEST(Sincos, OfTwoHasTheBitsOfEach) {
  std::mt19937_64 random(7);
  for (const double range : {1e-8, 1.0, 1e3, 1e9}) {
    std::uniform_real_distribution<double> uniform(-range, range);
    for (int i = 0; i < 1000; ++i) {
      const double x = uniform(random), y = uniform(random);
      const auto [of_x, of_y] = sincos(x, y);
      ASSERT_EQ(of_x.sin, sincos(x).sin);
      ASSERT_EQ(of_x.cos, sincos(x).cos);
      ASSERT_EQ(of_y.sin, sincos(y).sin);
      ASSERT_EQ(of_y.cos, sincos(y).cos);
    }
  }
}

TEST(Sincos, IsExactAtZeroAndOddAndEven) {
  EXPECT_EQ(sincos(0.0).sin, 0.0);
  EXPECT_EQ(sincos(0.0).cos, 1.0);
  for (const double x : {0.3, 1.0, 2.0, 77.7, 12345.6}) {
    EXPECT_EQ(sincos(-x).sin, -sincos(x).sin);
    EXPECT_EQ(sincos(-x).cos, sincos(x).cos);
  }
}

TEST(ExpDecay, IsWithinOneUnitInTheLastPlace) {
  std::mt19937_64 random(3);
  double worst = 0.0;
  for (const double range : {1e-6, 0.3, 1.0, 30.0, 700.0}) {
    std::uniform_real_distribution<double> uniform(-range, 0.0);
    for (int i = 0; i < 50000; ++i) {
      const double x = uniform(random), e = exp_decay(x);
      const long double exact = expl(static_cast<long double>(x));
      const double ulp = std::nextafter(e, 2.0) - e;
      worst = std::max(worst, static_cast<double>(std::abs(e - exact) / ulp));
    }
  }
  EXPECT_LE(worst, 1.0);  // 0.96
  EXPECT_EQ(exp_decay(0.0), 1.0);
  EXPECT_EQ(exp_decay(-709.0), 0.0);
}

TEST(MeanDecay, DoesNotCancel) {
  std::mt19937_64 random(4);
  EXPECT_EQ(mean_decay(0.0), 1.0);
  double worst = 0.0;
  for (const double range : {1e-15, 1e-8, 1e-3, 0.34, 1.0, 100.0}) {
    std::uniform_real_distribution<double> uniform(0.0, range);
    for (int i = 0; i < 20000; ++i) {
      const double x = uniform(random);
      const long double lx = x, exact = -expm1l(-lx) / lx;
      worst = std::max(worst, static_cast<double>(std::abs(mean_decay(x) - exact) / exact));
    }
  }
  EXPECT_LE(worst, 5e-16);  // 3.7e-16
}

TEST(MeanLoss, DoesNotCancel) {
  std::mt19937_64 random(6);
  EXPECT_EQ(mean_loss(0.0), 0.5);
  double worst = 0.0;
  for (const double range : {1e-15, 1e-8, 1e-3, 0.34, 1.0, 100.0}) {
    std::uniform_real_distribution<double> uniform(0.0, range);
    for (int i = 0; i < 20000; ++i) {
      const double x = uniform(random);
      const long double lx = x;
      long double term = 0.5L,
                  exact = 0.5L;  // the series; beyond 0.1 the closed form loses two of its 19 digits
      for (int n = 3; n < 20; ++n) exact += term *= -lx / n;
      if (x > 0.1) exact = (lx + expm1l(-lx)) / (lx * lx);
      worst = std::max(worst, static_cast<double>(std::abs(mean_loss(x) - exact) / exact));
    }
  }
  EXPECT_LE(worst, 3e-15);  // 1.9e-15
}

TEST(ExpMap, IsTheRotationByItsVector) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  double worst = 0.0, worst_norm = 0.0;
  for (const double size : {1e-9, 1e-3, 0.1, 0.2, 0.3, 1.0, 3.0, 100.0}) {
    for (int i = 0; i < 5000; ++i) {
      Vec3 r;
      for (int k = 0; k < 3; ++k) r[k] = size * uniform(random);
      const Quat q = exp_map(r);
      const long double x = r.x(), y = r.y(), z = r.z(), angle = sqrtl(x * x + y * y + z * z);
      const long double s = sinl(angle / 2) / angle;
      const double error =
          static_cast<double>(std::max({std::abs(q.w() - cosl(angle / 2)), std::abs(q.x() - s * x),
                                        std::abs(q.y() - s * y), std::abs(q.z() - s * z)}));
      worst = std::max(worst, error / (1.0 + 0.25 * r.norm()));  // an angle of 100 rad is itself rounded
      worst_norm = std::max(worst_norm, std::abs(q.norm() - 1.0));
    }
  }
  EXPECT_LE(worst, 4e-16);       // 3.5e-16
  EXPECT_LE(worst_norm, 5e-16);  // 3.3e-16
}

TEST(ExpMap, OfNothingIsExactlyTheIdentity) {
  const Quat q = exp_map(Vec3::Zero());
  EXPECT_EQ(q.w(), 1.0);
  EXPECT_EQ(q.vec(), Vec3::Zero());
}

TEST(ExpMap, TurnsCounterClockwiseAboutItsVector) {
  const double half_pi = 1.5707963267948966;
  EXPECT_LT((exp_map(Vec3(0, 0, half_pi)) * Vec3::UnitX() - Vec3::UnitY()).norm(), 3e-16);
  EXPECT_LT((exp_map(Vec3(half_pi, 0, 0)) * Vec3::UnitY() - Vec3::UnitZ()).norm(), 3e-16);
}

TEST(RotationMatrix, TurnsAsItsQuaternion) {
  const Quat q = exp_map(Vec3(0.3, -1.2, 2.0));
  const Vec3 v(1.0, -2.0, 0.5);
  const Mat3 R = rotation_matrix(q);
  EXPECT_LT((R * v - q * v).norm(), 1e-15);
  EXPECT_LT((R.transpose() * R - Mat3::Identity()).norm(), 5e-15);
  EXPECT_EQ(rotation_matrix(Quat::Identity()), Mat3::Identity());
}

TEST(CrossMatrix, IsTheCrossProduct) {
  const Vec3 a(1, 2, 3), b(-4, 5, 0.5);
  EXPECT_EQ(cross_matrix(a) * b, a.cross(b));
}

TEST(Normalized, GivesUnitLength) {
  EXPECT_NEAR(normalized(Quat(3, -4, 12, 0.1)).norm(), 1.0, 3e-16);
  EXPECT_EQ(normalized(Quat::Identity()).coeffs(), Quat::Identity().coeffs());
}

}  // namespace
}  // namespace tumble
