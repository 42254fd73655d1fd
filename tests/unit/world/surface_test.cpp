// Bodies on static surfaces of triangles: seams inside a plane must not be felt, ridges and grooves must bear.
#include <gtest/gtest.h>

#include "math/rotation.h"
#include "support/surface_meshes.h"
#include "support/world_builder.h"

namespace tumble::test {
namespace {

BodyDefinition fixed(const Shape& shape, const Material& material = {}) {
  BodyDefinition definition = body("ground", shape, Vec3::Zero(), material);
  definition.type = BodyType::fixed;
  return definition;
}

Options exact_options() {
  Options options;
  set_accuracy(options, Accuracy::exact);
  return options;
}

HeightFieldPointer flat_field(std::uint32_t n, double spacing) {
  return std::make_shared<const HeightField>(n, n, spacing, spacing,
                                             std::vector<double>(std::size_t{n} * n, 0.0));
}

struct Slider {
  const char* name;
  Shape shape;
  double height;
  Quat q;
};

std::vector<Slider> sliders() {
  RandomPose random(5);
  std::vector<Vec3> points;
  for (int i = 0; i < 30; ++i) {
    const Vec3 d = random.direction();
    points.push_back(d.cwiseProduct(Vec3(0.5, 0.4, 0.3)));
  }
  const auto hull = std::make_shared<const ConvexHull>(build_convex_hull(points));
  const Quat lying(std::sqrt(0.5), 0, std::sqrt(0.5), 0);
  return {{"box", Box{Vec3(0.4, 0.3, 0.2)}, 0.2, Quat::Identity()},
          {"sphere", Sphere{0.3}, 0.3, Quat::Identity()},
          {"capsule", Capsule{0.2, 0.4}, 0.2, lying},
          {"hull", hull, 0.35, Quat::Identity()}};
}

BodyDefinition launched(const Slider& slider, double friction) {
  BodyDefinition definition =
      body("slider", slider.shape, Vec3(-8, -3, slider.height), {.friction = friction});
  definition.X_WL.q = normalized(slider.q);
  definition.v_WB = Vec3(5, 1.7, 0);
  return definition;
}

// Friction 0: the box, the ball, the capsule and the hull (which falls 9 cm and tumbles) cross some 60 triangles each and
// move as on the half-space, with no kick upwards or sideways.
TEST(Surface, SlidingOverFlatTrianglesIsSlidingOnThePlane) {
  const std::vector<Shape> grounds = {flat_mesh(100, 0.25, false), flat_mesh(100, 0.25, true),
                                      flat_field(101, 0.25)};
  for (const Slider& slider : sliders()) {
    World plane(exact_options());
    plane.create_body(fixed(HalfSpace{}, {.friction = 0.0}));
    plane.create_body(launched(slider, 0.0));
    std::vector<World> worlds;
    for (const Shape& shape : grounds) {
      World& world = worlds.emplace_back(exact_options());
      world.create_body(fixed(shape, {.friction = 0.0}));
      world.create_body(launched(slider, 0.0));
    }
    for (int step = 0; step < 480; ++step) {
      plane.step();
      for (World& world : worlds) {
        world.step();
        const Motion &expected = plane.motion(1), &motion = world.motion(1);
        ASSERT_LE((motion.x - expected.x).norm(), 1e-9) << slider.name << " " << step;  // measured 1.6e-11
        // The speed along the ground is kept to the last digits.
        ASSERT_LE((motion.v - Vec3(5, 1.7, motion.v.z())).norm(), 5e-12) << slider.name << " " << step;
        // Within 0.1 mm of a seam a point belongs to both triangles, but counts once.
        ASSERT_LE(world.report().contacts, plane.report().contacts) << slider.name << " " << step;
      }
    }
  }
}

TEST(Surface, ABallRollsOverFlatTrianglesAsOnThePlane) {
  const Slider ball = sliders()[1];
  World plane(exact_options()), mesh(exact_options());
  plane.create_body(fixed(HalfSpace{}));
  mesh.create_body(fixed(flat_mesh(100, 0.25, true)));
  for (World* world : {&plane, &mesh}) world->create_body(launched(ball, 0.5));
  for (int step = 0; step < 480; ++step) {
    plane.step();
    mesh.step();
    ASSERT_LE((mesh.motion(1).x - plane.motion(1).x).norm(), 1e-9);  // measured 1.4e-11
    ASSERT_LE((mesh.motion(1).w - plane.motion(1).w).norm(), 1e-6);
  }
  // It rolls: 5/7 of the speed of sliding, whatever the friction.
  EXPECT_NEAR(mesh.motion(1).v.x(), 5.0 * 5.0 / 7.0, 1e-6);
}

/// Runs to rest and returns the sum of the impulses of the last step on the body, over the step [N].
Vec3 support_force(World& world, int steps) {
  run(world, steps);
  Vec3 impulse = Vec3::Zero();
  for (const Contact& contact : world.contacts()) {
    const double sign = contact.body_b == 1 ? 1.0 : -1.0;
    for (int i = 0; i < contact.manifold.count; ++i)
      impulse += sign * contact.impulse[static_cast<std::size_t>(i)];
  }
  return impulse / world.options().time_step;
}

TEST(Surface, ABallRestsInAGroove) {
  World world(exact_options());
  world.create_body(fixed(fold_mesh(1.0, 3.0), {.friction = 0.0}));  // 45 degrees
  world.create_body(body_of_mass("ball", Sphere{0.5}, 2.0, Vec3(0.1, 0.2, 0.9), {.friction = 0.0}));
  const Vec3 force = support_force(world, 1200);
  EXPECT_LE((force - Vec3(0, 0, 2.0 * 9.81)).norm(), 1e-5);
  EXPECT_NEAR(world.motion(1).x.z(), 0.5 * std::sqrt(2.0), 1e-6);
  EXPECT_NEAR(world.motion(1).x.x(), 0.0, 1e-6);
  int points = 0;
  for (const Contact& contact : world.contacts()) {
    points += contact.manifold.count;
    // Both walls push at 45 degrees with m g / sqrt(2).
    if (contact.manifold.count == 0) continue;
    EXPECT_NEAR(std::abs(contact.normal_W.z()), std::sqrt(0.5), 1e-9);
  }
  EXPECT_GE(points, 2);
}

TEST(Surface, ABallBalancesOnARidge) {
  World world(exact_options());
  world.create_body(fixed(fold_mesh(-0.5, 3.0)));
  world.create_body(body_of_mass("ball", Sphere{0.5}, 2.0, Vec3(0.0, 0.2, 0.5)));
  const Vec3 force = support_force(world, 240);
  EXPECT_LE((force - Vec3(0, 0, 2.0 * 9.81)).norm(), 1e-5);
  EXPECT_NEAR(world.motion(1).x.z(), 0.5, 1e-6);
  EXPECT_NEAR(world.motion(1).x.x(), 0.0, 1e-9);
}

TEST(Surface, ABoxStandsOnARidgeOfTriangles) {
  // Upright on the flat top of a pedestal narrower than itself: the pedestal's rim bears it.
  World world(exact_options());
  world.create_body(fixed(box_mesh(Vec3(0.3, 0.3, 0.5), 3)));
  world.create_body(body_of_mass("box", Box{Vec3(0.5, 0.5, 0.2)}, 3.0, Vec3(0, 0, 0.705)));
  const Vec3 force = support_force(world, 480);
  EXPECT_LE((force - Vec3(0, 0, 3.0 * 9.81)).norm(), 1e-5);
  EXPECT_NEAR(world.motion(1).x.z(), 0.7, 1e-6);
  EXPECT_TRUE(world.resting(1));
}

// 60 m/s is 25 cm a step, five times the thickness of the plate and half the ball's diameter.
TEST(Surface, AFastBodyDoesNotPassAThinPlate) {
  const std::vector<Shape> bodies = {Sphere{0.25}, Box{Vec3(0.2, 0.2, 0.2)}};
  for (const Shape& shape : bodies) {
    World world;
    world.create_body(fixed(box_mesh(Vec3(2, 2, 0.025), 4)));
    BodyDefinition bullet = body("bullet", shape, Vec3(0.13, 0.21, 5));
    bullet.v_WB = Vec3(0, 0, -60);
    world.create_body(bullet);
    run(world, 480);
    EXPECT_GT(world.motion(1).x.z(), 0.0);
  }
}

TEST(Surface, AMillionTrianglesWithNothingNearCostNothing) {
  World world;
  world.create_body(fixed(flat_field(708, 0.1)));  // 999 698 triangles
  world.create_body(body("high", Sphere{0.5}, Vec3(0, 0, 50)));
  run(world, 10);
  EXPECT_EQ(world.counters().narrow_phase.triangles, 0u);
  EXPECT_EQ(world.report().pairs, 0u);
}

TEST(Surface, BelongsToAStaticBody) {
  World world;
  for (const Shape& shape : {Shape(flat_mesh(2, 1.0, false)), Shape(flat_field(3, 1.0))}) {
    BodyDefinition definition = body("flying carpet", shape, Vec3::Zero());
    EXPECT_THROW(world.create_body(definition), std::invalid_argument);
    definition.inertia = Inertia{1.0, Vec3::Zero(), Mat3::Identity()};
    EXPECT_THROW(world.create_body(definition), std::invalid_argument);
  }
}

}  // namespace
}  // namespace tumble::test
