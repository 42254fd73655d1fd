// Single blows with known outcome, through the whole engine: stacked balls, a break, spin, walls.
#include <gtest/gtest.h>

#include <cmath>

#include "support/impact_scenes.h"

namespace tumble {
namespace {

using namespace test;

TEST(Blow, ASuperballOnAHeavyBallLeavesWithTheClosedForm) {
  // M = 100 m falls with m on top, `gap` behind it, both elastic: M turns round, then m meets it and both are reflected
  // about their mean velocity.
  const Material elastic{.friction = 0.0, .restitution = 1.0};
  for (const double h : kStepLengths) {
    for (const double gap : {0.0, 1e-9}) {
      World world(with_step(h));
      world.create_body(ground(elastic));
      const BodyId heavy =
          world.create_body(body_of_mass("heavy", Sphere{0.2}, 100.0, Vec3(0, 0, 1.2), elastic));
      const BodyId light =
          world.create_body(body_of_mass("light", Sphere{0.05}, 1.0, Vec3(0, 0, 1.45 + gap), elastic));
      const double g = 9.81, fall = std::sqrt(2.0 / g), v = g * fall, meet = 0.5 * gap / v;
      const double up = v - g * meet, down = v + g * meet, mean = (100.0 * up - down) / 101.0;
      const double energy = total_energy(world);
      while (world.time() < fall + meet) world.step();
      const double late = g * (world.time() - fall - meet);
      EXPECT_NEAR(world.motion(light.index).v.z(), 2.0 * mean + down - late, 1e-12) << h << gap;
      EXPECT_NEAR(world.motion(heavy.index).v.z(), 2.0 * mean - up - late, 1e-12) << h << gap;
      EXPECT_NEAR(total_energy(world) / energy, 1.0, 1e-13);
    }
  }
}

TEST(Blow, ABreakOfFifteenBallsIsSymmetricAndKeepsMomentumAndEnergy) {
  for (const double h : kStepLengths) {
    World world = billiard_break(with_step(h), 0.0);
    const Conserved before = world.compute_conserved();
    while (world.time() < 0.3) world.step();
    const Conserved after = world.compute_conserved();
    EXPECT_GE(world.counters().impacts, 1u);
    EXPECT_LE((after.momentum - before.momentum).norm(), 1e-14);
    EXPECT_NEAR(after.kinetic_energy / before.kinetic_energy, 1.0, 1e-13);
    std::uint32_t first = 1;
    for (int row = 0; row < 5; ++row) {
      for (int i = 0; i <= row; ++i) {
        const Vec3 v = world.motion(first + static_cast<std::uint32_t>(i)).v;
        const Vec3 mirrored = world.motion(first + static_cast<std::uint32_t>(row - i)).v;
        EXPECT_NEAR(v.x(), mirrored.x(), 1e-12) << row << " " << i;
        EXPECT_NEAR(v.y(), -mirrored.y(), 1e-12) << row << " " << i;
      }
      first += static_cast<std::uint32_t>(row) + 1;
    }
    EXPECT_GT(world.motion(11).v.norm(), 0.1);  // the corner of the last row leaves
  }
}

TEST(Blow, TheCueBallFollowsOrComesBackWithTwoSeventhsOfItsSpin) {
  // Head-on against an equal ball the cue ball keeps its spin and loses its speed; the cloth turns the spin into
  // v = 2 r w / 7, since the angular momentum about the point of contact stays.
  const double r = 0.0286;
  for (const double h : kStepLengths) {
    for (const double spin : {200.0, -150.0}) {
      Options options = with_step(h);
      options.solver_settings.tolerance = 1e-14;  // what is left of a speed adds up to depth, a lever of spin
      World world(options);
      world.create_body(ground({.friction = 0.2, .restitution = 0.5}));
      BodyDefinition cue =
          body_of_mass("cue", Sphere{r}, 0.17, Vec3(0, 0, r), {.friction = 0.2, .restitution = 1.0});
      cue.w_WB = Vec3(0, spin, 0);
      cue.v_WB = Vec3(2, 0, 0);
      const BodyId id = world.create_body(cue);
      const BodyId object = world.create_body(body_of_mass(
          "object", Sphere{r}, 0.17, Vec3(2.0 * r + 1e-4, 0, r), {.friction = 0.0, .restitution = 1.0}));
      // What the cloth adds on the way to the object ball, 1e-4 m, goes by the same law: L about the contact stays.
      const double L = 2.0 + 0.4 * r * spin;
      run(world, static_cast<int>(std::lround(3.0 / h)));
      const double given = world.motion(object.index).v.x();
      EXPECT_NEAR(given, 2.0, 0.05);
      EXPECT_NEAR(world.motion(id.index).v.x(), (L - given) * 5.0 / 7.0, 1e-12) << h << " " << spin;
      EXPECT_NEAR(world.motion(id.index).w.y() * r, world.motion(id.index).v.x(), 1e-12);
    }
  }
}

TEST(Blow, AnObliqueSphereSticksOrSlidesAsTheClosedFormSays) {
  // Solid sphere, e, mu, approach v_n, slip s = v_t - r w: it slides if mu (1 + e) v_n < 2 s / 7, else it rolls off.
  for (const double h : kStepLengths) {
    for (const double mu : {0.05, 0.1, 0.3, 1.0}) {
      const double e = 0.7, r = 0.1, vn = 3.0, vt = 2.0, w = -10.0;
      World world(weightless(h));
      world.create_body(ground({.friction = mu, .restitution = e}));
      BodyDefinition ball = body("ball", Sphere{r}, Vec3(0, 0, 0.4), {.friction = mu, .restitution = e});
      ball.v_WB = Vec3(vt, 0, -vn);
      ball.w_WB = Vec3(0, w, 0);
      const BodyId id = world.create_body(ball);
      while (world.time() < 0.15) world.step();
      const double slip = vt - r * w, change = std::min(mu * (1.0 + e) * vn, 2.0 / 7.0 * slip);
      const Motion motion = world.motion(id.index);
      EXPECT_NEAR(motion.v.z(), e * vn, 1e-12);
      EXPECT_NEAR(motion.v.x(), vt - change, 1e-12) << mu;
      EXPECT_NEAR(motion.w.y(), w + 2.5 * change / r, 1e-11) << mu;
    }
  }
}

TEST(Blow, NothingTunnels) {
  // 1 km/s against a wall of 1 mm: at 1/60 s the way of one step is 17000 times its thickness.
  for (const double h : kStepLengths) {
    for (const double restitution : {0.0, 1.0}) {
      for (const Shape& shape : {Shape(Sphere{0.01}), Shape(Box{Vec3(0.01, 0.02, 0.03)})}) {
        const Material material{.friction = 0.0, .restitution = restitution};
        World world(weightless(h));
        BodyDefinition wall = body("wall", Box{Vec3(0.0005, 1, 1)}, Vec3(20.0, 0, 0), material);
        wall.type = BodyType::fixed;
        world.create_body(wall);
        BodyDefinition bullet = body("bullet", shape, Vec3(0, 0, 0), material);
        bullet.v_WB = Vec3(1000, 0, 0);
        if (std::holds_alternative<Box>(shape)) bullet.w_WB = Vec3(10, 200, 30);
        const BodyId id = world.create_body(bullet);
        for (int i = 0; i < static_cast<int>(std::lround(0.1 / h)); ++i) {
          world.step();
          ASSERT_LT(world.motion(id.index).x.x(), 20.0) << h << " " << restitution;
        }
        EXPECT_LE(world.report().deepest_penetration, 1e-9);
        if (restitution == 1.0 && std::holds_alternative<Sphere>(shape)) {
          EXPECT_NEAR(world.motion(id.index).v.x(), -1000.0, 1e-9);
        }
        EXPECT_GE(world.counters().impacts, 1u);
      }
    }
  }
}

TEST(Blow, AFastBodyPassesBesideAWall) {
  // A bound along the line of nearest approach would stop it in the air.
  for (const double h : kStepLengths) {
    World world(weightless(h));
    BodyDefinition wall = body("wall", Box{Vec3(0.0005, 1, 1)}, Vec3(20.0, 0, 0));
    wall.type = BodyType::fixed;
    world.create_body(wall);
    BodyDefinition bullet = body("bullet", Sphere{0.01}, Vec3(0, 1.02, 0));
    bullet.v_WB = Vec3(1000, 0, 0);
    const BodyId id = world.create_body(bullet);
    while (world.time() < 0.05) world.step();
    EXPECT_NEAR(world.motion(id.index).x.x(), 1000.0 * world.time(), 1e-9);
  }
}

}  // namespace
}  // namespace tumble
