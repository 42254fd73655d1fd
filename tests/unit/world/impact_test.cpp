// Events within a step: bounds, ends of bouncing, thresholds, partners that do not move or are driven, the off switch.
#include <gtest/gtest.h>

#include <cmath>

#include "support/impact_scenes.h"

namespace tumble {
namespace {

using namespace test;

TEST(ImpactStep, ABodyThatRattlesInASlotReachesItsBoundAndStaysInside) {
  const Material elastic{.friction = 0.0, .restitution = 1.0};
  Options options = weightless(1.0 / 60.0);
  options.max_impacts = 16;
  World world(options);
  for (const double side : {-1.0, 1.0}) {
    BodyDefinition wall = ground(elastic);
    wall.name = side < 0.0 ? "left" : "right";
    wall.X_WL = {rotation_to_normal(Vec3(-side, 0, 0)), Vec3(side * 0.1001, 0, 0)};
    world.create_body(wall);
  }
  BodyDefinition ball = body("ball", Sphere{0.1}, Vec3::Zero(), elastic);
  ball.v_WB = Vec3(1, 0, 0);  // 83 impacts a step
  const BodyId id = world.create_body(ball);
  for (int i = 0; i < 60; ++i) {
    const double energy = world.compute_conserved().kinetic_energy;
    world.step();
    EXPECT_LE(std::abs(world.motion(id.index).x.x()), 0.0001 + 1e-9);
    EXPECT_LE(world.compute_conserved().kinetic_energy, energy * (1.0 + 1e-14));
  }
  EXPECT_GE(world.counters().impacts_capped, 1u);
  EXPECT_LE(world.counters().impacts, 60u * 18u);
}

TEST(ImpactStep, BouncingThatEndsWithinAStepIsRestFromThereOn) {
  const Material material{.friction = 0.3, .restitution = 0.5};
  World world(with_step(0.1));
  world.create_body(ground(material));
  const BodyId ball = world.create_body(body("ball", Sphere{0.1}, Vec3(0, 0, 0.101), material));
  world.step();  // falls for 14 ms; all bounces end after 43 ms
  EXPECT_EQ(world.counters().impacts_ended, 1u);
  EXPECT_LE(world.counters().impacts, 3u);
  EXPECT_NEAR(world.motion(ball.index).x.z(), 0.1, 1e-15);
  EXPECT_LE(world.motion(ball.index).v.norm(), 1e-15);
}

TEST(ImpactStep, WhatIsSlowerThanTheThresholdDoesNotBounce) {
  for (const bool by_material : {false, true}) {
    Material material{.friction = 0.0, .restitution = 1.0};
    Options options = weightless();
    if (by_material) {
      material.restitution_threshold = 0.1;
    } else {
      options.restitution_threshold = 0.1;
    }
    for (const double speed : {0.09, 0.11}) {
      World world(options);
      world.create_body(ground(material));
      BodyDefinition ball = body("ball", Sphere{0.1}, Vec3(0, 0, 0.11), material);
      ball.v_WB = Vec3(0, 0, -speed);
      const BodyId id = world.create_body(ball);
      run(world, 60);
      EXPECT_NEAR(world.motion(id.index).v.z(), speed > 0.1 ? speed : 0.0, 1e-12) << by_material;
    }
  }
}

TEST(ImpactStep, TheLargerThresholdOfAPairHolds) {
  Material ball_material{.friction = 0.0, .restitution = 1.0};
  ball_material.restitution_threshold = 0.0;
  Material ground_material = ball_material;
  ground_material.restitution_threshold = 1.0;
  World world(weightless());
  world.create_body(ground(ground_material));
  BodyDefinition ball = body("ball", Sphere{0.1}, Vec3(0, 0, 0.11), ball_material);
  ball.v_WB = Vec3(0, 0, -0.5);
  const BodyId id = world.create_body(ball);
  run(world, 60);
  EXPECT_NEAR(world.motion(id.index).v.norm(), 0.0, 1e-12);
}

TEST(ImpactStep, ABallOnADrivenPistonLeavesWithTwiceItsSpeed) {
  const Material elastic{.friction = 0.0, .restitution = 1.0};
  World world(weightless(1.0 / 60.0));
  BodyDefinition piston = body("piston", Box{Vec3(1, 1, 0.1)}, Vec3::Zero(), elastic);
  piston.type = BodyType::kinematic;
  piston.v_WB = Vec3(0, 0, 2);
  world.create_body(piston);
  const BodyId ball = world.create_body(body("ball", Sphere{0.1}, Vec3(0, 0, 1.0), elastic));
  run(world, 60);
  EXPECT_NEAR(world.motion(ball.index).v.z(), 4.0, 1e-12);
  EXPECT_NEAR(world.motion(0).x.z(), 2.0, 1e-12);
  // They met at 0.4 s, 0.8 m over the start: from then on it flies.
  EXPECT_NEAR(world.motion(ball.index).x.z(), 1.0 + 4.0 * 0.6, 1e-12);
}

TEST(ImpactStep, DifferentRestitutionsInOneImpactNeverGainEnergy) {
  // A box falls flat across two slabs of different restitution, beside a third.
  for (const double friction : {0.0, 0.6}) {
    World world(with_step(1.0 / 60.0));
    for (int i = 0; i < 2; ++i) {
      BodyDefinition slab = body("slab" + std::to_string(i), Box{Vec3(0.5, 1, 0.1)}, Vec3(i - 0.5, 0, -0.1),
                                 {.friction = friction, .restitution = i == 0 ? 0.2 : 1.0});
      slab.type = BodyType::fixed;
      world.create_body(slab);
    }
    BodyDefinition box =
        body("box", Box{Vec3(0.3, 0.2, 0.1)}, Vec3(0, 0, 1.1), {.friction = friction, .restitution = 0.0});
    world.create_body(box);
    double fastest_turn = 0.0;
    for (int i = 0; i < 120; ++i) {
      world.step();
      fastest_turn = std::max(fastest_turn, world.motion(2).w.norm());
    }
    EXPECT_EQ(world.counters().impacts_gained, 0u);
    EXPECT_GT(world.counters().impacts, 3u);
    EXPECT_GT(fastest_turn, 1.0) << "the livelier side rises";
  }
}

TEST(ImpactStep, SpinningHullsAndCompoundsKeepTheirEnergy) {
  const Material elastic{.friction = 0.0, .restitution = 1.0};
  World world(with_step(1.0 / 60.0));
  world.create_body(ground(elastic));
  const std::vector<Vec3> corners = {
      {0.3, 0, -0.1}, {-0.2, 0.3, -0.1}, {-0.2, -0.2, -0.1}, {0, 0, 0.4}, {0.1, 0.2, 0.2}};
  BodyDefinition hull = body("hull", HullPointer(std::make_shared<ConvexHull>(build_convex_hull(corners))),
                             Vec3(0, 0, 1.0), elastic);
  hull.w_WB = Vec3(5, -7, 20);
  world.create_body(hull);
  BodyDefinition dumbbell = body("dumbbell", Sphere{0.2}, Vec3(0.15, 0.05, 2.5), elastic);
  dumbbell.geometries.push_back(geometry(Sphere{0.1}, elastic));
  dumbbell.geometries.back().name = "other";
  dumbbell.geometries.back().X_LS.p = Vec3(0.5, 0, 0);
  dumbbell.w_WB = Vec3(0, 9, 2);
  world.create_body(dumbbell);
  const EnergyError error = measure_energy(world, 5.0);
  EXPECT_LE(error.drift, 1e-11);
  EXPECT_LE(error.overlap, 1e-9);
  EXPECT_GT(world.counters().impacts, 10u);
  EXPECT_EQ(world.counters().impact_searches_bounded, 0u);
}

TEST(ImpactStep, ABlowOnAStackAtRestGoesThroughToTheGround) {
  const Material material{.friction = 0.5, .restitution = 0.4};
  World world(with_step(1.0 / 240.0));
  world.create_body(ground(material));
  for (int i = 0; i < 3; ++i) {
    world.create_body(
        body("box" + std::to_string(i), Box{Vec3(0.5, 0.5, 0.5)}, Vec3(0, 0, 0.5 + i), material));
  }
  run(world, 60);
  EXPECT_TRUE(world.resting(3));
  BodyDefinition ball = body("ball", Sphere{0.2}, Vec3(0.1, 0.05, 4.0), material);
  world.create_body(ball);
  run(world, 1200);
  EXPECT_GT(world.counters().impacts, 5u);
  EXPECT_EQ(world.counters().impacts_gained, 0u);
  for (std::uint32_t slot = 1; slot <= 3; ++slot) {
    EXPECT_NEAR(world.motion(slot).x.z(), slot - 0.5, 1e-6);
    EXPECT_TRUE(world.resting(slot));
  }
}

TEST(ImpactStep, WithoutRestitutionNothingIsSearched) {
  World world;
  world.create_body(ground());
  for (int i = 0; i < 5; ++i) {
    world.create_body(body("box" + std::to_string(i), Box{Vec3(0.5, 0.5, 0.5)}, Vec3(0, 0, 0.6 + 1.2 * i)));
  }
  run(world, 240);
  EXPECT_EQ(world.counters().impact_searches, 0u);
  EXPECT_EQ(world.counters().impacts, 0u);
}

TEST(ImpactStep, SwitchedOffRestitutionActsAtTheStartOfAStep) {
  Options options = with_step(1e-3);
  options.impact_events = false;
  const Material material{.friction = 0.0, .restitution = 0.8};
  World world(options);
  world.create_body(ground(material));
  const BodyId ball = world.create_body(body("ball", Sphere{0.1}, Vec3(0, 0, 1.1), material));
  double height = 0.0;
  while (world.time() < 1.5) {
    world.step();
    height =
        std::max(height, std::abs(world.motion(ball.index).x.z() - 0.1 - bouncing_height(0.8, world.time())));
  }
  EXPECT_EQ(world.counters().impact_searches, 0u);
  EXPECT_GT(height, 1e-4);  // velocities alone: of first order in the step
  EXPECT_LT(height, 2e-2);
}

TEST(ImpactStep, ACopyGoesOnWithTheSameBits) {
  World world = gas(3, with_step(1.0 / 60.0));
  run(world, 20);
  World copy = world;
  run(world, 20);
  run(copy, 20);
  EXPECT_EQ(world.state_hash(), copy.state_hash());
}

TEST(ImpactStep, ABodyMetInTheMiddleOfAStepIsMet) {
  // The first ball is turned towards the third by the second, which no box of the step's start foresees.
  const Material elastic{.friction = 0.0, .restitution = 1.0};
  World world(weightless(0.1));
  BodyDefinition first = body_of_mass("first", Sphere{0.1}, 1.0, Vec3(0, 0, 0), elastic);
  first.v_WB = Vec3(30, 0, 0);
  world.create_body(first);
  BodyDefinition wall = body("wall", Box{Vec3(0.1, 3, 3)}, Vec3(0, 0, 0), elastic);
  wall.type = BodyType::fixed;
  const double turn = std::sqrt(0.5);
  wall.X_WL = {Quat(std::sqrt((1.0 + turn) / 2.0), 0, 0, std::sqrt((1.0 - turn) / 2.0)), Vec3(1.5, 0, 0)};
  world.create_body(wall);
  BodyDefinition third = body_of_mass("third", Sphere{0.1}, 1.0, Vec3(0, 0, 0), elastic);
  const double x = 1.5 - 0.2 / turn;
  third.X_WL.p = Vec3(x, -1.0, 0);
  world.create_body(third);
  world.step();
  EXPECT_EQ(world.counters().impacts, 2u);
  EXPECT_NEAR(world.motion(2).v.y(), -30.0, 1e-9);
  EXPECT_NEAR(world.motion(0).v.norm(), 0.0, 1e-9);
}

TEST(ImpactStep, PairsThatTheirFlightsKeepApartAreNotLookedAtAndMoveTheSame) {
  Options options = test::with_step(1e-3);
  World skipping = test::elastic_666(3, 1e-3);
  options.skip_flying = false;
  World looking(options);
  for (std::uint32_t slot = 0; slot < skipping.body_capacity(); ++slot)
    looking.create_body(skipping.body(slot).definition);
  for (int i = 0; i < 1000; ++i) {
    skipping.step();
    looking.step();
  }
  EXPECT_EQ(looking.counters().pairs_skipped_clear, 0u);
  EXPECT_GE(skipping.counters().pairs_skipped_clear, 50000u);  // measured: 152503
  EXPECT_GE(skipping.counters().impacts, 50u);
  EXPECT_EQ(skipping.counters().impacts, looking.counters().impacts);
  EXPECT_LE(test::largest_displacement(skipping, looking), 1e-11);  // measured: 0
}

TEST(ImpactStep, BallsThatFallTogetherAreAloftThoughTheirBoxesOverlap) {
  World world = test::elastic_666(3, 1e-3);
  for (int i = 0; i < 400; ++i) world.step();  // the first meets the ground after 0.45 s
  EXPECT_EQ(world.counters().impacts, 0u);
  EXPECT_GE(world.report().pairs, 50u);
  EXPECT_EQ(world.contacts().size(), 0u);
  EXPECT_LE(world.counters().bodies_stepped, 27u * 3u);  // measured: 54
}

/// A pendulum, a coin that rolls and a block that slides to its stop; `bouncing` says whether a ball bounces far away.
World quiet_corner(double h, bool bouncing) {
  Options options;
  options.time_step = h;
  World world(options);
  world.create_body(ground({.friction = 0.5}));
  const BodyId rod = world.create_body(body("rod", Box{Vec3(0.3, 0.02, 0.02)}, Vec3(0.3, 0, 2)));
  world.create_joint({"hinge", JointKind::ball, {std::nullopt, Vec3(0, 0, 2)}, {rod, Vec3(-0.3, 0, 0)}});
  BodyDefinition coin = body("coin", Cylinder{0.2, 0.02}, Vec3(3, 0, 0.2));
  coin.X_WL.q = exp_map(Vec3(0, 1.5707963267948966, 0));
  coin.v_WB = Vec3(0, 1, 0);
  coin.w_WB = Vec3(-5, 0, 0.3);
  world.create_body(coin);
  BodyDefinition block = body("block", Box{Vec3(0.1, 0.2, 0.1)}, Vec3(-3, 0, 0.1));
  block.v_WB = Vec3(1, 0.5, 0);
  block.w_WB = Vec3(0, 0, 2);
  world.create_body(block);
  if (bouncing) world.create_body(body("ball", Sphere{0.1}, Vec3(50, 0, 0.3), {.restitution = 1.0}));
  return world;
}

TEST(ImpactStep, ChangesNoBitOfWhatMovesElsewhere) {
  for (const double h : kStepLengths) {
    World alone = quiet_corner(h, false), beside = quiet_corner(h, true);
    while (alone.time() < 1.0) {
      alone.step();
      beside.step();
    }
    EXPECT_GE(beside.counters().impacts, 2u);
    for (std::uint32_t slot = 0; slot < alone.body_capacity(); ++slot) {
      const Motion a = alone.motion(slot), b = beside.motion(slot);
      EXPECT_EQ(a.x, b.x) << slot;
      EXPECT_EQ(a.q.coeffs(), b.q.coeffs()) << slot;
      EXPECT_EQ(a.v, b.v) << slot;
      EXPECT_EQ(a.L, b.L) << slot;
    }
  }
}

}  // namespace
}  // namespace tumble
