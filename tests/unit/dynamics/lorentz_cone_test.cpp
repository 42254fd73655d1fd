// The algebra on the Lorentz cone against its defining identities, at random points up to 1e-8 of the boundary.
#include <gtest/gtest.h>

#include <random>

#include "dynamics/lorentz_cone.h"

namespace tumble {
namespace {

class RandomCone {
 public:
  double uniform(double low, double high) {
    return low + (high - low) * (static_cast<double>(generator_()) / 4294967296.0);
  }
  Vec3 vector() {
    const double x = uniform(-2, 2), y = uniform(-2, 2), z = uniform(-2, 2);
    return {x, y, z};
  }
  /// Inside by at least `depth` of its length.
  Vec3 inside(double depth) {
    Vec3 x = vector();
    const double tail = x.tail<2>().norm();
    x.x() = tail + (depth + uniform(0.0, 1.0)) * (tail + 0.1);
    return x;
  }

 private:
  std::mt19937 generator_{1};
};

TEST(LorentzCone, DivisionUndoesTheProduct) {
  RandomCone random;
  for (int i = 0; i < 1000; ++i) {
    const Vec3 l = random.inside(0.01), r = random.vector();
    EXPECT_LE((cone_product(l, cone_divide(r, l)) - r).norm(), 1e-12);  // measured 1e-13
  }
}

TEST(LorentzCone, TheStepEndsOnTheBoundary) {
  RandomCone random;
  int bounded = 0;
  for (int i = 0; i < 1000; ++i) {
    const Vec3 x = random.inside(1e-3), d = random.vector();
    const double step = cone_step(x, d);
    ASSERT_GT(step, 0.0);
    if (!std::isfinite(step)) {
      EXPECT_GE(d.x(), d.tail<2>().norm());
      continue;
    }
    ++bounded;
    const Vec3 end = x + step * d, before = x + 0.999 * step * d;
    EXPECT_LE(std::abs(end.x() - end.tail<2>().norm()), 1e-10 * (1.0 + end.norm()));
    EXPECT_GT(before.x(), before.tail<2>().norm());
  }
  EXPECT_GT(bounded, 700);
}

TEST(LorentzCone, AHalfLineIsTheConeWithoutATail) {
  EXPECT_DOUBLE_EQ(cone_step(Vec3(2, 0, 0), Vec3(-4, 0, 0)), 0.5);
  EXPECT_TRUE(std::isinf(cone_step(Vec3(2, 0, 0), Vec3(1, 0, 0))));
  const ConeScaling scaling = make_cone_scaling(Vec3(4, 0, 0), Vec3(9, 0, 0));
  EXPECT_NEAR(scaling.l.x(), 6.0, 1e-14);  // sqrt(s z)
  EXPECT_NEAR(scaling.inverse_square(0, 0), 9.0 / 4.0, 1e-14);
}

TEST(LorentzCone, TheScalingMapsBothPointsToOne) {
  RandomCone random;
  for (int i = 0; i < 1000; ++i) {
    const Vec3 s = random.inside(1e-6), z = random.inside(1e-6);
    const ConeScaling scaling = make_cone_scaling(s, z);
    const Mat3 identity = scaling.inverse_square * scaling.W * scaling.W;
    // measured 3e-9: the scaling of points 1e-6 from the boundary has a condition number of 1e6.
    EXPECT_LE((identity - Mat3::Identity()).norm(), 1e-7);
    EXPECT_LE((scaling.W * scaling.l - s).norm(), 1e-9 * (1.0 + s.norm()));
    EXPECT_NEAR(scaling.l.squaredNorm(), s.dot(z), 1e-9 * s.dot(z));
  }
}

TEST(LorentzCone, TheDeterminantKeepsItsDigitsAtTheBoundary) {
  // x0 - |tail| = 2^-40 exactly; a difference of squares would keep four digits of it.
  const double above = 1.0 / 1099511627776.0;
  EXPECT_NEAR(cone_determinant(Vec3(5.0 + above, 3.0, 4.0)) / (above * (10.0 + above)), 1.0, 1e-15);
}

}  // namespace
}  // namespace tumble
