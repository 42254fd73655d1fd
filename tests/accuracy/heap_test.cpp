// Heaps: boxes, and bodies of mixed shapes, dropped on each other without order. They stay finite, come to rest, and
// then nothing creeps. 1000 bodies take minutes: ./run stress --full --case bin_boxes --case bin_mixed.
#include <gtest/gtest.h>

#include "support/heap_scenes.h"

namespace tumble {
namespace {

using namespace test;

void expect_rest(World world, double limit, double creep_time, const char* name) {
  const double time = run_to_rest(world, limit);
  EXPECT_LE(time, limit - 0.1) << name;  // 30 boxes: 1.3 s, mixed: 3.2 s
  EXPECT_EQ(world.counters().non_finite_contained, 0u) << name;
  EXPECT_LE(world.report().deepest_penetration, 1e-3) << name;  // 30 boxes: 2e-9 m, mixed: 1.2e-6 m
  const World rested = world;
  run(world, static_cast<int>(creep_time / world.options().time_step));
  EXPECT_LE(largest_displacement(rested, world), 0.0) << name;
  for (std::uint32_t slot = 5; slot < world.body_capacity(); ++slot) {
    ASSERT_TRUE(world.motion(slot).x.allFinite()) << name;
    ASSERT_GT(world.motion(slot).x.z(), 0.0) << name;
  }
}

TEST(Heap, OfThirtyBodiesComesToRestAndStays) {
  expect_rest(heap({}, 30, 3, false), 10.0, 600.0, "boxes");
  expect_rest(heap({}, 30, 3, true), 10.0, 600.0, "mixed");
}

}  // namespace
}  // namespace tumble
