// Restitution through the whole engine: a ball on the ground, Newton's cradle, the end of bouncing.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "support/world_builder.h"
#include "world/world.h"

namespace tumble {
namespace {

using namespace test;

TEST(Bounce, ADroppedBallReachesRestitutionSquaredTimesItsHeight) {
  for (const double restitution : {1.0, 0.8, 0.5}) {
    Options options;
    options.time_step = 1e-3;
    const Material material{.friction = 0.0, .restitution = restitution};
    World world(options);
    world.create_body(ground(material));
    const BodyId ball = world.create_body(body("ball", Sphere{0.1}, Vec3(0, 0, 1.1), material));
    const double fall = std::sqrt(2.0 / 9.81);
    // The apex after the first bounce is due at fall (1 + restitution).
    run(world, static_cast<int>(std::lround(fall * (1 + restitution) / options.time_step)));
    const double apex = world.motion(ball.index).x.z() - 0.1;
    EXPECT_NEAR(apex, restitution * restitution, 1e-2) << restitution;
  }
}

TEST(Bounce, WithoutRestitutionTheBallStaysWhereItLands) {
  World world;
  world.create_body(ground());
  const BodyId ball = world.create_body(body("ball", Sphere{0.1}, Vec3(0, 0, 1.1)));
  double highest_after_landing = 0.0;
  for (int i = 0; i < 480; ++i) {
    world.step();
    if (i > 120) highest_after_landing = std::max(highest_after_landing, world.motion(ball.index).x.z());
  }
  EXPECT_LE(std::abs(highest_after_landing - 0.1), 1e-9);
}

TEST(Bounce, MicrocollisionsDoNotJitter) {
  // A ball of high restitution lying on the ground gains g h each step before the contact takes it away; that closing
  // speed comes from one step of acceleration and must not bounce.
  const Material material{.friction = 0.5, .restitution = 0.9};
  Options options;
  options.time_step = 1.0 / 60.0;
  options.skip_resting = false;
  World world(options);
  world.create_body(ground(material));
  const BodyId ball = world.create_body(body("ball", Sphere{0.1}, Vec3(0, 0, 0.1), material));
  double largest = 0.0;
  for (int i = 0; i < 600; ++i) {
    world.step();
    largest = std::max(largest, std::abs(world.motion(ball.index).v.z()));
  }
  EXPECT_LE(largest, 1e-12);
}

TEST(Bounce, InACradleAsManyBallsLeaveAsArrived) {
  const Material material{.friction = 0.0, .restitution = 1.0};
  for (int arriving = 1; arriving <= 4; ++arriving) {
    World world(weightless());
    for (int i = 0; i < 5; ++i) {
      const double gap = i < arriving ? -0.5 : 0.0;
      BodyDefinition ball =
          body_of_mass("ball" + std::to_string(i), Sphere{0.5}, 1.0, Vec3(i + gap, 0, 0), material);
      if (i < arriving) ball.v_WB = Vec3(1, 0, 0);
      world.create_body(ball);
    }
    run(world, 240);
    for (int i = 0; i < 5; ++i) {
      EXPECT_NEAR(world.motion(static_cast<std::uint32_t>(i)).v.x(), i < 5 - arriving ? 0.0 : 1.0, 1e-12)
          << arriving << " in, ball " << i;
    }
  }
}

TEST(Bounce, KineticEnergyNeverRises) {
  const Material material{.friction = 0.4, .restitution = 0.9};
  World world(weightless());
  for (int i = 0; i < 27; ++i) {
    const int x = i % 3, y = i / 3 % 3, z = i / 9;
    BodyDefinition box = body("box" + std::to_string(i), Box{Vec3(0.3, 0.25, 0.2)}, Vec3(x, y, z), material);
    box.v_WB = -Vec3(x - 1, y - 1, z - 1) + 0.1 * Vec3(y, z, x);
    box.w_WB = Vec3(z, x, y);
    world.create_body(box);
  }
  double energy = world.compute_conserved().kinetic_energy;
  const Vec3 momentum = world.compute_conserved().momentum;
  for (int i = 0; i < 480; ++i) {
    world.step();
    const double now = world.compute_conserved().kinetic_energy;
    EXPECT_LE(now, energy * (1 + 1e-12)) << "step " << i;
    energy = now;
  }
  EXPECT_GT(world.counters().impacts, 0u);
  EXPECT_LE((world.compute_conserved().momentum - momentum).norm(), 1e-9);
}

}  // namespace
}  // namespace tumble
