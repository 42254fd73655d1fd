// Claims about the world as a container: handles, checks before changes, commands between steps, copies as snapshots.
#include "world/world.h"

#include <gtest/gtest.h>

#include <limits>

#include "support/world_builder.h"

namespace tumble {
namespace {

using namespace test;

/// The message of the refusal, empty if there was none.
template <typename Call>
std::string refusal(Call call) {
  try {
    call();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return {};
}

TEST(World, AWrongFieldIsNamedWithItsValueAndNothingIsCreated) {
  World world;
  const BodyDefinition good = body("ball", Sphere{0.5}, Vec3(0, 0, 1));
  BodyDefinition bad = good;
  bad.X_WL.p.z() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(refusal([&] { world.create_body(bad); }), "pose: must be finite (0 0 nan)");
  bad = good;
  bad.geometries[0].material.restitution = 1.5;
  EXPECT_EQ(refusal([&] { world.create_body(bad); }), "restitution: must be 0..1 (1.5)");
  bad = good;
  bad.name = "";
  EXPECT_EQ(refusal([&] { world.create_body(bad); }), "name: must have 1..63 characters ('')");
  bad = good;
  bad.geometries.clear();
  EXPECT_EQ(refusal([&] { world.create_body(bad); }),
            "inertia: a body that moves needs an inertia or a geometry");
  bad = good;
  bad.X_WL.q = Quat(2, 0, 0, 0);
  EXPECT_EQ(refusal([&] { world.create_body(bad); }),
            "pose: quaternion must have length 1 (squared length 4)");
  bad = good;
  bad.geometries[0].shape = HalfSpace{};
  EXPECT_EQ(refusal([&] { world.create_body(bad); }),
            "geometry 'collision': a half_space belongs to a static body only");
  EXPECT_EQ(world.body_count(), 0u);
  EXPECT_EQ(world.model_epoch(), 0u);
}

TEST(World, OptionsOutOfRangeAreRefusedByName) {
  Options options;
  options.time_step = 0.0;
  EXPECT_EQ(refusal([&] { World world(options); }), "time step: must be 1e-06..0.1 (0)");
}

TEST(World, NamesAreUniqueAndFindTheirBody) {
  World world;
  const BodyId ball = world.create_body(body("ball", Sphere{0.5}, Vec3(0, 0, 1)));
  EXPECT_EQ(refusal([&] { world.create_body(body("ball", Sphere{0.5}, Vec3(0, 0, 3))); }),
            "name: already taken ('ball')");
  EXPECT_EQ(world.find("ball"), ball);
  EXPECT_FALSE(world.find("box"));
}

TEST(World, AStaleHandleNeverReachesTheSuccessorInItsSlot) {
  World world;
  const BodyId first = world.create_body(body("first", Sphere{0.5}, Vec3(0, 0, 1)));
  ASSERT_TRUE(world.destroy_body(first));
  const BodyId second = world.create_body(body("second", Sphere{0.5}, Vec3(0, 0, 1)));
  EXPECT_EQ(second.index, first.index);
  EXPECT_NE(second.generation, first.generation);
  EXPECT_FALSE(world.destroy_body(first));
  EXPECT_EQ(refusal([&] { world.push({.body = first}); }), "body: no such body (index 0, generation 1)");
  EXPECT_TRUE(world.is_valid(second));
}

TEST(World, APushIsRefusedWhenNonFiniteHugeOrOnAStaticBody) {
  World world(weightless());
  const BodyId ball = world.create_body(body("ball", Sphere{0.5}, Vec3(0, 0, 5)));
  const BodyId floor = world.create_body(ground());
  EXPECT_EQ(refusal([&] { world.push({.body = ball, .force = Vec3(0, INFINITY, 0)}); }),
            "force: must be finite (0 inf 0)");
  EXPECT_EQ(refusal([&] { world.push({.body = ball, .torque = Vec3(1e16, 0, 0)}); }),
            "torque: must be 0..1000000000000000 (1e+16)");
  EXPECT_EQ(refusal([&] { world.push({.body = floor}); }),
            "body: only a dynamic body can be pushed ('ground')");
  world.step();
  EXPECT_TRUE(world.motion(ball.index).v.isZero(0.0));
}

TEST(World, APushOfForceFForTimeTChangesMomentumByFT) {
  for (const double seconds : {0.5, 1.0 / 3.0, 0.001, 0.7}) {
    World world(weightless());
    const BodyId ball = world.create_body(body_of_mass("ball", Sphere{0.5}, 2.0, Vec3(0, 0, 10)));
    world.push({.body = ball, .force = Vec3(3, -4, 50), .duration = seconds});
    run(world, 240);
    const Vec3 momentum = world.compute_conserved().momentum;
    // Measured relative error: 0.7e-15 at most.
    EXPECT_LE((momentum - seconds * Vec3(3, -4, 50)).norm(), 1e-12 * seconds * 50) << seconds;
  }
}

TEST(World, AZeroDurationActsForExactlyOneStep) {
  World world(weightless(0.01));
  const BodyId ball = world.create_body(body_of_mass("ball", Sphere{0.5}, 2.0, Vec3::Zero()));
  world.push({.body = ball, .force = Vec3(10, 0, 0)});
  run(world, 3);
  EXPECT_DOUBLE_EQ(world.motion(ball.index).v.x(), 10 * 0.01 / 2.0);
}

TEST(World, TheTorqueOfAPushIsItsLeverArmTimesItsForce) {
  World world(weightless());
  const BodyId box = world.create_body(body("box", Box{Vec3(0.1, 0.2, 0.3)}, Vec3(5, 5, 5)));
  const Vec3 force(1, 2, 3), arm(0.1, -0.2, 0.3), torque(0.5, 0, -0.5);
  world.push({.body = box, .force = force, .torque = torque, .point_B = arm});
  world.step();
  const Vec3 expected = world.options().time_step * (arm.cross(force) + torque);
  EXPECT_LE((world.motion(box.index).L - expected).norm(),
            1e-8);  // 2.9e-9 of 0.01: the arm turns within the step
}

TEST(World, ABodyFramePushTurnsWithTheBody) {
  World world(weightless());
  BodyDefinition definition = body("ball", Sphere{0.5}, Vec3::Zero());
  definition.X_WL.q = Quat(std::sqrt(0.5), 0, 0, std::sqrt(0.5));  // a quarter turn about z
  const BodyId ball = world.create_body(definition);
  world.push({.body = ball, .frame = Push::Frame::body, .force = Vec3(1, 0, 0)});
  world.step();
  const Vec3 v = world.motion(ball.index).v;
  EXPECT_GT(v.y(), 0.0);
  EXPECT_LE(std::abs(v.x()), 1e-15 * v.y() + 1e-30);
}

TEST(World, FreeFallIsExactAtAnyStep) {
  for (const double h : {1.0 / 60.0, 1.0 / 240.0, 1e-3}) {
    Options options;
    options.time_step = h;
    World world(options);
    BodyDefinition definition = body("box", Box{Vec3(0.1, 0.2, 0.3)}, Vec3(0, 0, 1000));
    definition.v_WB = Vec3(1, 2, 3);
    const BodyId box = world.create_body(definition);
    const int steps = static_cast<int>(std::lround(10.0 / h));
    run(world, steps);
    const double t = steps * h;
    const Vec3 exact = Vec3(0, 0, 1000) + t * definition.v_WB + 0.5 * t * t * options.gravity;
    // Measured: 2.6e-11 m after 10 000 steps of rounding at |x| = 1000 m.
    EXPECT_LE((world.motion(box.index).x - exact).norm(), 1e-10) << h;
  }
}

TEST(World, LinearAndAngularDampingAreExactExponentials) {
  World world(weightless());
  BodyDefinition definition = body("ball", Sphere{0.5}, Vec3::Zero());
  definition.v_WB = Vec3(1, 0, 0);
  definition.w_WB = Vec3(0, 2, 0);
  definition.linear_damping = 0.7;
  definition.angular_damping = 1.3;
  const BodyId ball = world.create_body(definition);
  run(world, 240);
  // Measured: 240 roundings, 1e-15 relative.
  EXPECT_NEAR(world.motion(ball.index).v.x(), std::exp(-0.7), 1e-14);
  EXPECT_NEAR(world.motion(ball.index).w.y(), 2 * std::exp(-1.3), 1e-14);
}

TEST(World, TheCentreOfMassNotTheLinkOriginFliesTheParabola) {
  World world;
  BodyDefinition hammer = body("hammer", Sphere{0.1}, Vec3(0, 0, 50));
  GeometryDefinition handle = geometry(Capsule{0.05, 0.5});
  handle.X_LS.p = Vec3(0, 0, 0.5);
  hammer.geometries.push_back(handle);
  hammer.w_WB = Vec3(3, 0, 0);
  const BodyId id = world.create_body(hammer);
  const Vec3 start = world.motion(id.index).x;
  EXPECT_GT((start - Vec3(0, 0, 50)).norm(), 0.1);
  EXPECT_LE((world.link_pose(id.index).p - Vec3(0, 0, 50)).norm(), 1e-14);
  run(world, 240);
  EXPECT_LE((world.motion(id.index).x - (start + Vec3(0, 0, -0.5 * 9.81))).norm(), 1e-11);
}

TEST(World, ACopyIsASnapshotThatGoesOnWithTheSameBits) {
  World world;
  world.create_body(ground());
  for (int i = 0; i < 5; ++i) {
    world.create_body(
        body("box" + std::to_string(i), Box{Vec3(0.5, 0.5, 0.5)}, Vec3(0.02 * i, 0, 0.55 + 1.05 * i)));
  }
  run(world, 60);
  World snapshot = world;
  run(world, 100);
  run(snapshot, 100);
  EXPECT_EQ(world.state_hash(), snapshot.state_hash());
}

TEST(World, ABodyThatWouldBecomeNonFiniteIsHeldAndReportedAndTheRestGoesOn) {
  World world(weightless());
  BodyDefinition speck = body("speck", Sphere{1e-6}, Vec3(0, 0, 1));
  speck.inertia = Inertia{1e-300, Vec3::Zero(), Vec3(1e-300, 2e-300, 2.5e-300).asDiagonal()};
  const BodyId doomed = world.create_body(speck);
  const BodyId other = world.create_body(body_of_mass("other", Sphere{0.5}, 1.0, Vec3(10, 0, 0)));
  world.push({.body = doomed, .force = Vec3(5e14, 0, 0), .duration = 1.0});
  world.push({.body = other, .force = Vec3(1, 0, 0), .duration = 1.0});
  run(world, 5);
  EXPECT_GT(world.counters().non_finite_contained, 0u);
  ASSERT_EQ(world.contained().size(), 1u);
  EXPECT_EQ(world.contained()[0], doomed);
  EXPECT_TRUE(world.motion(doomed.index).x.allFinite());
  EXPECT_EQ(world.motion(doomed.index).x, Vec3(0, 0, 1));
  EXPECT_NEAR(world.motion(other.index).v.x(), 5.0 / 240.0, 1e-15);
}

TEST(World, APushBeyondAllNumbersMovesNothingAtAll) {
  World world{Options{}};
  world.create_body(ground());
  const BodyId table =
      world.create_body(body_of_mass("table", Box{Vec3(0.5, 0.5, 0.5)}, 1.0, Vec3(0, 0, 0.5)));
  BodyDefinition speck = body("speck", Sphere{0.05}, Vec3(2, 0, 0.05));
  speck.inertia = Inertia{1e-100, Vec3::Zero(), 1e-103 * Mat3::Identity()};
  const BodyId doomed = world.create_body(speck);
  run(world, 10);
  const Vec3 before = world.motion(doomed.index).x;
  world.push({.body = doomed, .force = Vec3(7e14, 0, -7e14), .duration = 1.0});
  run(world, 120);
  EXPECT_EQ(world.motion(doomed.index).x, before);
  EXPECT_EQ(world.counters().non_finite_contained, 120u);
  EXPECT_LE((world.motion(table.index).x - Vec3(0, 0, 0.5)).norm(), 1e-9);
}

TEST(World, AStepOfAnotherLengthGoesOnWhereTheLastEnded) {
  Options options;
  options.time_step = 1.0 / 64.0;
  World world(options);
  BodyDefinition stone = body("stone", Box{Vec3(0.3, 0.2, 0.1)}, Vec3(0, 0, 100));
  stone.w_WB = Vec3(1, 5, 0.1);
  const BodyId thrown = world.create_body(stone);
  const BodyId pushed = world.create_body(body_of_mass("pushed", Sphere{0.5}, 2.0, Vec3(50, 0, 100)));
  world.push({.body = pushed, .force = Vec3(8, 0, 0), .duration = 1.0});
  World steady = world;
  run(steady, 128);
  run(world, 32);
  world.set_time_step(1.0 / 1024.0);
  run(world, 1024);
  world.set_time_step(1.0 / 64.0);
  run(world, 32);
  EXPECT_EQ(world.time(), 2.0);
  EXPECT_LE((world.motion(thrown.index).x - steady.motion(thrown.index).x).norm(), 1e-12);
  EXPECT_LE(world.motion(thrown.index).q.angularDistance(steady.motion(thrown.index).q), 1e-12);
  EXPECT_NEAR(world.motion(pushed.index).v.x(), 4.0, 1e-12) << "the push kept its second";
  EXPECT_THROW(world.set_time_step(0.2), std::invalid_argument);
  EXPECT_EQ(world.options().time_step, 1.0 / 64.0);
}

}  // namespace
}  // namespace tumble
