// A press closes on a box further than there is room: no velocities keep all the conditions. What holds: everything stays
// finite and slow, the world says that it found no solution, and when the press opens the box is let go gently.
#include <gtest/gtest.h>

#include "support/world_builder.h"

namespace tumble {
namespace {

using namespace test;

class Press : public ::testing::TestWithParam<const char*> {};

TEST_P(Press, StaysFiniteSaysSoAndLetsGoGently) {
  Options options;
  options.solver = *solver_from_name(GetParam());
  World world(options);
  world.create_body(ground());
  const BodyId box = world.create_body(body("box", Box{Vec3(0.1, 0.1, 0.1)}, Vec3(0, 0, 0.1)));
  BodyDefinition plate = body("plate", Box{Vec3(0.5, 0.5, 0.05)}, Vec3(0, 0, 0.26));
  plate.type = BodyType::kinematic;
  plate.v_WB = Vec3(0, 0, -0.2);
  const BodyId press = world.create_body(plate);
  double fastest = 0.0, worst = 0.0;
  const auto watch = [&](int steps) {
    for (int i = 0; i < steps; ++i) {
      world.step();
      ASSERT_TRUE(world.motion(box.index).x.allFinite());
      fastest = std::max(fastest, world.motion(box.index).v.norm() + 0.1 * world.motion(box.index).w.norm());
      worst = std::max(worst, world.report().max_residual);
    }
  };
  watch(60);  // 5 cm down, 4 of them into the box
  EXPECT_GT(worst, 1e-2) << "the residual tells that the conditions were not kept";
  EXPECT_LE(fastest, 1.0);
  world.set_motion(press, world.link_pose(press.index), Vec3(0, 0, 0.2), Vec3::Zero());
  fastest = 0.0;
  watch(240);
  EXPECT_LE(fastest, 1.0);
  EXPECT_LE(world.motion(box.index).x.z(), 0.15);
  EXPECT_EQ(world.counters().non_finite_contained, 0u);
  EXPECT_LE(world.report().max_residual, 1e-2);
  EXPECT_NEAR(world.motion(box.index).x.z(), 0.1, 5e-3);
}

INSTANTIATE_TEST_SUITE_P(Solvers, Press, ::testing::Values("automatic", "exact", "soft_step"));

}  // namespace
}  // namespace tumble
