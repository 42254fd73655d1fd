// Heaps: boxes, and bodies of mixed shapes, dropped on each other without order. They stay finite, come to rest, and
// then nothing creeps. 1000 bodies take minutes: test_accuracy --gtest_also_run_disabled_tests --gtest_filter='*Thousand*'.
#include <gtest/gtest.h>

#include <cmath>

#include "support/standing_scenes.h"

namespace tumble {
namespace {

using namespace test;

Shape heap_shape(std::size_t i, bool mixed) {
  switch (mixed ? i % 4 : 0) {
    case 1:
      return Sphere{0.15};
    case 2:
      return Capsule{0.1, 0.1};
    case 3:
      return Cylinder{0.15, 0.15};
    default:
      return Box{Vec3(0.2, 0.15, 0.12)};
  }
}

/// Layers of `width` x `width` bodies, 0.5 m apart, tilted, in a bin that is a little wider.
World heap(std::size_t count, std::size_t width, bool mixed) {
  World world;
  world.create_body(ground());
  const double half = 0.25 * static_cast<double>(width) + 0.1;
  for (int side = 0; side < 4; ++side) {
    const double angle = 1.5707963267948966 * side;
    BodyDefinition wall = body("wall" + std::to_string(side), HalfSpace{},
                               Vec3(-half * std::cos(angle), -half * std::sin(angle), 0));
    wall.type = BodyType::fixed;
    wall.X_WL.q = Quat::FromTwoVectors(Vec3::UnitZ(), Vec3(std::cos(angle), std::sin(angle), 0));
    world.create_body(wall);
  }
  for (std::size_t i = 0; i < count; ++i) {
    const double x = 0.5 * static_cast<double>(i % width) - half + 0.35;
    const double y = 0.5 * static_cast<double>(i / width % width) - half + 0.35;
    const double z = 0.5 * static_cast<double>(i / (width * width)) + 0.4;
    // Without friction against turning a ball or cylinder on the flat rolls and spins for ever.
    const double turning = mixed ? 2e-3 : 0.0;
    const Material material{.rolling_friction = turning, .torsional_friction = turning};
    BodyDefinition definition =
        body("body" + std::to_string(i), heap_shape(i, mixed), Vec3(x, y, z), material);
    definition.X_WL.q = tilted(i, 0.7);
    world.create_body(definition);
  }
  return world;
}

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
  expect_rest(heap(30, 3, false), 10.0, 600.0, "boxes");
  expect_rest(heap(30, 3, true), 10.0, 600.0, "mixed");
}

TEST(Heap, DISABLED_OfAThousandBodiesComesToRestAndStaysForTenMinutes) {
  expect_rest(heap(1000, 8, false), 60.0, 600.0, "boxes");
  expect_rest(heap(1000, 8, true), 60.0, 600.0, "mixed");
}

}  // namespace
}  // namespace tumble
