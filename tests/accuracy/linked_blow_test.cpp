// Blows on bodies that hang on joints and ropes, through the whole engine: struck and striking ones leave as if what
// holds them had been there all the time.
#include <gtest/gtest.h>

#include <cmath>

#include "support/impact_scenes.h"

namespace tumble {
namespace {

using namespace test;

TEST(LinkedBlow, ABallMeetsARodThatHangsOnABallJoint) {
  const double ball_mass = 0.5, rod_mass = 2.0, half = 0.5, thick = 0.02, speed = 3.0, e = 0.8;
  for (const double h : kStepLengths) {
    for (const double depth : {0.3, 2.0 / 3.0, 0.9}) {
      World world(weightless(h));
      const Material material{.friction = 0.0, .restitution = e};
      const BodyId rod = world.create_body(
          body_of_mass("rod", Box{Vec3(thick, thick, half)}, rod_mass, Vec3(0, 0, -half), material));
      world.create_joint({"hinge", JointKind::ball, {std::nullopt, Vec3::Zero()}, {rod, Vec3(0, 0, half)}});
      BodyDefinition striker =
          body_of_mass("striker", Sphere{0.1}, ball_mass, Vec3(-0.5, 0, -depth), material);
      striker.v_WB = Vec3(speed, 0, 0);
      const BodyId ball = world.create_body(striker);
      while (world.counters().impacts == 0 && world.time() < 0.3) world.step();
      const double about_hinge = rod_mass * ((half * half + thick * thick) / 3.0 + half * half);
      const double impulse = (1.0 + e) * speed / (1.0 / ball_mass + depth * depth / about_hinge);
      EXPECT_NEAR(world.motion(ball.index).v.x(), speed - impulse / ball_mass, 1e-12) << h << " " << depth;
      // For the rest of the step the joint holds as ever, to the third order of the turn.
      EXPECT_NEAR(world.motion(rod.index).w.y(), -impulse * depth / about_hinge, 1e-3) << h << " " << depth;
    }
  }
}

TEST(LinkedBlow, ABallOnATautRopeIsAWallToABlowAlongTheRope) {
  for (const double h : kStepLengths) {
    for (const double gravity : {0.0, 9.81}) {
      Options options = weightless(h);
      options.gravity.z() = -gravity;
      World world(options);
      const Material elastic{.friction = 0.0, .restitution = 1.0};
      const BodyId hung = world.create_body(body_of_mass("hung", Sphere{0.1}, 1.0, Vec3(0, 0, 0), elastic));
      world.create_rope({"rope", {std::nullopt, Vec3(0, 0, 1)}, {hung, Vec3::Zero()}, {.length = 1.0}});
      BodyDefinition falling = body_of_mass("falling", Sphere{0.1}, 3.0, Vec3(0, 0, 0.5), elastic);
      falling.v_WB = Vec3(0, 0, -2);
      falling.gravity = false;
      const BodyId ball = world.create_body(falling);
      while (world.counters().impacts == 0 && world.time() < 0.3) world.step();
      EXPECT_EQ(world.counters().impacts, 1u);
      EXPECT_NEAR(world.motion(ball.index).v.z(), 2.0, 1e-12) << h;
      EXPECT_LE(world.motion(hung.index).v.norm(), 1e-8) << h;
    }
  }
}

}  // namespace
}  // namespace tumble
