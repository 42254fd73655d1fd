// Curved bodies come to rest, and where they rest they stay.
#include <gtest/gtest.h>

#include <cmath>

#include "support/world_builder.h"

namespace tumble {
namespace {

using namespace test;

constexpr double kQuarter = 1.5707963267948966;

/// Dropped by 1 cm, after three seconds.
struct Fall {
  Vec3 drift;    ///< From above the place where it fell [m].
  double speed;  ///< Of its fastest point, about [m/s].
};

Fall drop(const Shape& shape, const Quat& q_WB, bool on_box) {
  World world(Options{});
  if (on_box) {
    BodyDefinition table = body_of_mass("table", Box{Vec3(2, 2, 0.5)}, 1.0, Vec3(0, 0, -0.5));
    table.type = BodyType::fixed;
    world.create_body(table);
  } else {
    world.create_body(ground());
  }
  const double height = -(q_WB * support(shape, q_WB.conjugate() * -Vec3::UnitZ())).z();
  BodyDefinition body = body_of_mass("body", shape, 1.0, Vec3(0, 0, height + 0.01));
  body.X_WL.q = q_WB;
  const BodyId id = world.create_body(body);
  const Vec3 from = world.motion(id.index).x;
  const int steps = static_cast<int>(3.0 / world.options().time_step);
  for (int i = 0; i < steps; ++i) world.step();
  const auto& motion = world.motion(id.index);
  return {motion.x - from, motion.v.norm() + motion.w.norm()};
}

class Curved : public ::testing::TestWithParam<bool> {};

TEST_P(Curved, AnUprightCylinderStandsAndDoesNotDrift) {
  const Fall fall = drop(Cylinder{0.3, 0.5}, Quat::Identity(), GetParam());
  EXPECT_LT(fall.drift.head<2>().norm(), 1e-9);
  EXPECT_NEAR(fall.drift.z(), -0.01, 1e-4);
  EXPECT_LT(fall.speed, 1e-9);
}

TEST_P(Curved, ALyingCylinderComesToRest) {
  const Fall fall =
      drop(Cylinder{0.3, 0.5}, Quat(std::cos(0.5 * kQuarter), std::sin(0.5 * kQuarter), 0, 0), GetParam());
  EXPECT_LT(fall.drift.head<2>().norm(), 1e-6);
  EXPECT_NEAR(fall.drift.z(), -0.01, 1e-4);
  EXPECT_LT(fall.speed, 1e-6);
}

TEST_P(Curved, AConeStandsOnItsBase) {
  const Fall fall = drop(Cone{0.3, 0.4}, Quat::Identity(), GetParam());
  EXPECT_LT(fall.drift.head<2>().norm(), 1e-9);
  EXPECT_NEAR(fall.drift.z(), -0.01, 1e-4);
  EXPECT_LT(fall.speed, 1e-9);
}

TEST_P(Curved, AnEllipsoidRestsOnItsFlatSide) {
  const Fall fall = drop(Ellipsoid{Vec3(0.5, 0.4, 0.2)}, Quat::Identity(), GetParam());
  EXPECT_LT(fall.drift.head<2>().norm(), 1e-6);
  EXPECT_NEAR(fall.drift.z(), -0.01, 1e-4);
  EXPECT_LT(fall.speed, 1e-6);
}

INSTANTIATE_TEST_SUITE_P(OnPlaneAndBox, Curved, ::testing::Bool());

}  // namespace
}  // namespace tumble
