// Claims about resting islands: they cost nothing, they drift by nothing, and whatever touches them wakes them.
#include <gtest/gtest.h>

#include "support/world_builder.h"
#include "world/world.h"

namespace tumble {
namespace {

using namespace test;

World stack(int boxes, const Options& options = {}) {
  World world(options);
  world.create_body(ground());
  for (int i = 0; i < boxes; ++i) {
    world.create_body(
        body_of_mass("box" + std::to_string(i), Box{Vec3(0.5, 0.5, 0.5)}, 1.0, Vec3(0, 0, 0.5 + i)));
  }
  return world;
}

void run_until_rest(World& world, int limit) {
  for (int i = 0; i < limit && world.report().bodies_awake + (world.step_count() == 0) > 0; ++i) world.step();
}

TEST(Rest, AStackComesToRestAndThenDriftsByExactlyNothing) {
  World world = stack(5);
  run_until_rest(world, 2400);
  ASSERT_EQ(world.report().bodies_awake, 0u);
  const std::uint64_t stepped = world.counters().bodies_stepped;
  const Vec3 top = world.motion(5).x;
  run(world, 2400);
  EXPECT_EQ(world.motion(5).x, top);
  EXPECT_EQ(world.counters().bodies_stepped, stepped) << "a resting body is not stepped";
  EXPECT_EQ(world.counters().bodies_skipped_resting % 5, 0u);
  EXPECT_NEAR(top.z(), 4.5, 1e-6);
}

TEST(Rest, SkippingRestChangesCostAndNotWhereTheStackStands) {
  Options all;
  all.skip_resting = false;
  World skipping = stack(5), stepping = stack(5, all);
  run(skipping, 1200);
  run(stepping, 1200);
  EXPECT_EQ(stepping.counters().bodies_skipped_resting, 0u);
  EXPECT_GT(skipping.counters().bodies_skipped_resting, 0u);
  for (std::uint32_t slot = 1; slot <= 5; ++slot) {
    EXPECT_LE((skipping.motion(slot).x - stepping.motion(slot).x).norm(), 1e-6);
  }
}

TEST(Rest, RemovingTheSupportWakesWhatStoodOnIt) {
  World world = stack(2);
  run_until_rest(world, 2400);
  ASSERT_EQ(world.report().bodies_awake, 0u);
  ASSERT_TRUE(world.destroy_body(*world.find("box0")));
  const double before = world.motion(2).x.z();
  run(world, 24);
  // The upper box falls freely for 0.1 s.
  EXPECT_NEAR(world.motion(2).x.z(), before - 0.5 * 9.81 * 0.01, 1e-12);
}

TEST(Rest, APushWakesItsIslandAndASlidingNeighbourWakesToo) {
  World world = stack(1);
  run_until_rest(world, 2400);
  ASSERT_EQ(world.report().bodies_awake, 0u);
  world.push({.body = *world.find("box0"), .force = Vec3(8, 0, 0), .duration = 0.5});
  run(world, 60);
  // 8 N against mu m g = 4.905 N for 0.25 s.
  EXPECT_NEAR(world.motion(1).v.x(), (8 - 0.5 * 9.81) * 0.25, 1e-6);
}

TEST(Rest, AFallingBodyWakesTheIslandItLandsOn) {
  World world = stack(2);
  run_until_rest(world, 2400);
  ASSERT_EQ(world.report().bodies_awake, 0u);
  world.create_body(body_of_mass("late", Box{Vec3(0.5, 0.5, 0.5)}, 1.0, Vec3(0.3, 0.1, 3.0)));
  run(world, 240);
  EXPECT_GT(world.counters().wakes, 0u);
  EXPECT_NEAR(world.motion(world.find("late")->index).x.z(), 2.5, 1e-4);
}

TEST(Rest, AWeightlessBodyWithoutContactsIsNeverStopped) {
  World world(weightless());
  BodyDefinition drifter = body("drifter", Sphere{0.5}, Vec3::Zero());
  drifter.v_WB = Vec3(5e-7, 0, 0);
  const BodyId id = world.create_body(drifter);
  run(world, 2400);
  EXPECT_NEAR(world.motion(id.index).x.x(), 5e-6, 1e-18);
}

}  // namespace
}  // namespace tumble
