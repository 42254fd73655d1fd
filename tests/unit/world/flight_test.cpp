// Free bodies in the world: nobody steps them, reading them changes nothing, and they come back when something happens.
#include <gtest/gtest.h>

#include <cmath>

#include "support/world_builder.h"
#include "world/world.h"

namespace tumble {
namespace {

using namespace test;

/// A layer of n x n tumbling boxes far apart, thrown alike.
World layer(int n, const Options& options = {}) {
  World world(options);
  for (int i = 0; i < n * n; ++i) {
    BodyDefinition box =
        body("box" + std::to_string(i), Box{Vec3(0.1, 0.2, 0.3)}, Vec3(3.0 * (i % n), 3.0 * (i / n), 0));
    box.v_WB = Vec3(0, 0, 20);
    box.w_WB = Vec3(0.1 * (i % 7), 5.0, 0.3 * (i % 5));
    world.create_body(box);
  }
  return world;
}

TEST(FreeFlight, BodiesNobodyReadsAreNotStepped) {
  World world = layer(20);
  run(world, 100);
  const Counters before = world.counters();
  run(world, 1000);
  const Counters& after = world.counters();
  EXPECT_EQ(after.bodies_stepped, before.bodies_stepped);
  EXPECT_EQ(after.bodies_skipped_flying - before.bodies_skipped_flying, 400u * 1000u);
  // A box of 256 to 512 steps gives way to one of 16000 to 32000.
  EXPECT_LE(after.boxes_renewed - before.boxes_renewed, 400u);
  EXPECT_EQ(world.report().bodies_awake, 400u);
}

TEST(FreeFlight, TheOffSwitchChangesNoBit) {
  Options visiting;
  visiting.skip_flying = false;
  World a = layer(4), b = layer(4, visiting);
  for (int i = 0; i < 500; ++i) {
    a.step();
    b.step();
    ASSERT_EQ(a.state_hash(), b.state_hash()) << i;
  }
  EXPECT_GT(a.counters().bodies_skipped_flying, 0u);
  EXPECT_EQ(b.counters().bodies_skipped_flying, 0u);
}

TEST(FreeFlight, ASwarmThatMeetsMovesTheSameWhetherVisitedOrNot) {
  // Bodies from all sides meet about the middle and part again; nobody may miss a meeting.
  Options visiting = weightless();
  visiting.skip_flying = false;
  World a(weightless()), b(visiting);
  for (int i = 0; i < 60; ++i) {
    const double turn = 0.7 * i, height = 0.05 * (i % 11) - 0.25;
    const Vec3 side(std::cos(turn), std::sin(turn), height);
    const Material material{.friction = 0.3, .restitution = 0.5};
    const Shape shape = i % 2 == 0 ? Shape(Sphere{0.3}) : Shape(Box{Vec3(0.2, 0.3, 0.25)});
    BodyDefinition definition = body("body" + std::to_string(i), shape, (10.0 + i) * side, material);
    definition.v_WB = -5.0 * side;
    definition.w_WB = Vec3(0.1 * i, 1, -1);
    for (World* world : {&a, &b}) world->create_body(definition);
  }
  for (int i = 0; i < 4000; ++i) {
    a.step();
    b.step();
    // To the bit up to step 3182; then pairs that met earlier or later remember other separating axes (4e-16 m/s).
    for (std::uint32_t slot = 0; slot < 60; ++slot) {
      ASSERT_LE((a.motion(slot).x - b.motion(slot).x).norm(), 1e-10) << i;
    }
  }
  EXPECT_GT(a.counters().impacts, 10u);
  EXPECT_GT(a.counters().bodies_skipped_flying, 60u * 2000u);
}

TEST(FreeFlight, ReadingAndCopyingChangeNothing) {
  World read = layer(4), unread = layer(4);
  for (int i = 0; i < 300; ++i) {
    read.step();
    unread.step();
    for (std::uint32_t slot = 0; slot < read.body_capacity(); ++slot) (void)read.motion(slot);
    (void)read.compute_conserved();
    if (i == 150) {
      World copy = read;
      read = copy;
    }
  }
  EXPECT_EQ(read.state_hash(), unread.state_hash());
}

TEST(FreeFlight, EvaluatedAtAnyTimeItIsTheFlightFromTheStart) {
  World world = layer(3);
  const Motion start = world.motion(4);
  run(world, 2400);
  const Flight flight(world.mass_properties(4), start, world.options().gravity);
  const Motion end = flight.at(2400 * world.options().time_step);
  EXPECT_EQ(world.motion(4).x, end.x);
  EXPECT_EQ(world.motion(4).q.coeffs(), end.q.coeffs());
}

TEST(FreeFlight, ABodyAloftMeetsWhatCrossesItsWay) {
  // Both far apart and aloft for a second; then the first falls onto the ground, where the other has been put.
  World world;
  world.create_body(ground());
  const BodyId falling = world.create_body(body("falling", Sphere{0.1}, Vec3(0, 0, 100)));
  const BodyId passing = world.create_body(body("passing", Sphere{0.1}, Vec3(-50, 0, 60)));
  run(world, 240);
  EXPECT_GT(world.counters().bodies_skipped_flying, 200u);
  Pose place;
  place.p = world.motion(falling.index).x - Vec3(0, 0, 0.15);
  world.set_motion(passing, place, Vec3(0, 0, 0), Vec3::Zero());
  run(world, 10);
  EXPECT_LT(world.motion(passing.index).v.z(), -4.0);  // hit from above: half of 10 m/s
  run(world, 3000);
  EXPECT_NEAR(world.motion(falling.index).x.z(), 0.1, 0.21);
  EXPECT_NEAR(world.motion(passing.index).x.z(), 0.1, 0.21);
}

TEST(FreeFlight, APushInFlightActsAndEnds) {
  World world(weightless());
  const BodyId ball = world.create_body(body_of_mass("ball", Sphere{0.5}, 2.0, Vec3(0, 0, 10)));
  run(world, 100);
  world.push({.body = ball, .force = Vec3(2, 0, 0), .duration = 1.0});
  run(world, 480);
  const Motion& motion = world.motion(ball.index);
  EXPECT_NEAR(motion.v.x(), 1.0, 1e-14);
  EXPECT_NEAR(motion.x.x(), 0.5 + 1.0, 1e-13);
}

TEST(FreeFlight, ABodyRemovedWhileAloftLeavesTheOthers) {
  World world = layer(3);
  run(world, 100);
  const Vec3 w = world.motion(5).w;
  EXPECT_TRUE(world.destroy_body(world.id(4)));
  BodyDefinition again = body("again", Sphere{0.1}, Vec3(100, 100, 100));
  const BodyId id = world.create_body(again);
  EXPECT_EQ(id.index, 4u);
  EXPECT_TRUE(world.motion(4).v.isZero(0.0));
  run(world, 1);
  EXPECT_EQ(world.motion(4).v, Vec3(world.options().time_step * world.options().gravity));
  EXPECT_NEAR(world.motion(5).w.norm(), w.norm(), 0.2);
  run(world, 500);
  EXPECT_EQ(world.report().bodies_awake, 9u);
}

TEST(FreeFlight, AVeryFastSpinIsStartedAnewBeforeItsPhasesLoseDigits) {
  World world(weightless(0.1));
  BodyDefinition top = body_of_mass("top", Box{Vec3(0.1, 0.1, 0.2)}, 1.0, Vec3::Zero());
  top.w_WB = Vec3(1e5, 0, 5e4);
  const BodyId id = world.create_body(top);
  const double energy = world.compute_conserved().kinetic_energy;
  run(world, 1000);  // 1e7 rad
  EXPECT_NEAR(world.compute_conserved().kinetic_energy / energy, 1.0, 1e-13);
  EXPECT_NEAR(world.motion(id.index).q.norm(), 1.0, 1e-14);
}

TEST(FreeFlight, QueriesFindABodyWhereItIs) {
  World world = layer(3);
  run(world, 200);
  for (std::uint32_t slot = 0; slot < 9; ++slot) {
    const Vec3 x = world.motion(slot).x;
    std::vector<std::uint32_t> found;
    world.broad_phase().query(Aabb{x, x}, found);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_EQ(world.geometries()[found[0]].body, slot);
  }
}

}  // namespace
}  // namespace tumble
