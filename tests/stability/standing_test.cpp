// What must stand, stands; what is dropped, comes to rest; nothing becomes non-finite. Scenes of tests/scenes.
#include <gtest/gtest.h>

#include "scene/sdf.h"
#include "support/world_builder.h"

namespace tumble {
namespace {

using namespace test;

World load(const std::string& name) {
  return build_world(read_sdf(std::string(TUMBLE_SCENES_DIR) + "/" + name + ".sdf").scene);
}

TEST(Standing, AStackOfTenStandsForTenSecondsAndComesToRest) {
  const World start = load("stack");
  World world = start;
  run(world, 2400);
  // Measured: at rest after the first step, nothing moved.
  EXPECT_LE(largest_displacement(start, world), 1e-9);
  EXPECT_EQ(world.report().bodies_awake, 0u);
  EXPECT_LE(world.report().deepest_penetration, 1e-9);
}

TEST(Standing, TheWallPyramidOf210BoxesStandsForTenSeconds) {
  const World start = load("pyramid");
  World world = start;
  run(world, 2400);
  // 210 bodies are stepped softly: measured 2.7 cm at the top and 2.9 mm of overlap.
  EXPECT_LE(largest_displacement(start, world), 4e-2);
  EXPECT_LE(world.report().deepest_penetration, 4e-3);
}

TEST(Standing, ThePileOf1000MixedBodiesFallsWithoutLosingABody) {
  World world = load("pile");
  const std::uint32_t bodies = world.body_count();
  run(world, 720);
  EXPECT_EQ(world.body_count(), bodies);
  EXPECT_EQ(world.counters().non_finite_contained, 0u);
  for (std::uint32_t slot = 0; slot < world.body_capacity(); ++slot) {
    ASSERT_TRUE(world.motion(slot).x.allFinite());
    EXPECT_GT(world.motion(slot).x.z(), -0.5) << world.body(slot).definition.name;
  }
}

}  // namespace
}  // namespace tumble
