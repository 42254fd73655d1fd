// What holds things up, read from the contacts of bodies at rest: statics in closed form. Default options.
#include <gtest/gtest.h>

#include <cmath>

#include "support/gravity.h"
#include "support/standing_scenes.h"
#include "world/contact_forces.h"

namespace tumble {
namespace {

using namespace test;

/// Force that pair a, b exchanges, on b [N].
Vec3 force_between(const World& world, BodyId a, BodyId b) {
  Vec3 force = Vec3::Zero();
  for (const ContactForce& contact : read_contact_forces(world, a)) {
    if (contact.a == a && contact.b == b) force += contact.force_W;
    if (contact.a == b && contact.b == a) force -= contact.force_W;
  }
  return force;
}

/// Largest force that is left on a resting body, of the forces that meet in it, and torque, of these at 1 m.
double largest_imbalance(const World& world) {
  double largest = 0.0;
  for (std::uint32_t slot = 0; slot < world.body_capacity(); ++slot) {
    if (!world.resting(slot)) continue;
    const Vec3 weight(0, 0, -kG * world.mass_properties(slot).mass);
    double size = weight.norm();
    for (const ContactForce& contact : read_contact_forces(world, world.id(slot)))
      size += contact.force_W.norm();
    const ContactLoad load = sum_contact_forces(world, world.id(slot));
    largest = std::max({largest, (load.force + weight).norm() / size, load.torque.norm() / size});
  }
  return largest;
}

TEST(Support, EveryFloorOfAStackCarriesWhatIsAboveIt) {
  for (const double top : {1.0, 1e3, 1e6}) {
    std::vector<double> masses(10, 1.0);
    masses.back() = top;
    World world = cube_stack(Options{}, masses);
    run_to_rest(world, 10.0);
    EXPECT_EQ(world.report().bodies_awake, 0u);
    double carried = 0.0;  // [N]
    for (std::uint32_t slot = 10; slot > 0; --slot) {
      carried += kG * world.mass_properties(slot).mass;
      const Vec3 force = force_between(world, world.id(slot - 1), world.id(slot));
      EXPECT_LE((force - Vec3(0, 0, carried)).norm() / carried, 1e-12) << slot << " under " << top;
    }
    EXPECT_LE(largest_imbalance(world), 1e-12) << top;
  }
}

TEST(Support, ADroppedPyramidWeighsWhatItsCubesWeigh) {
  World world = cube_pyramid(Options{}, 6, {.height = 0.01, .gap = 0.01});
  run_to_rest(world, 10.0);
  const ContactLoad on_ground = sum_contact_forces(world, *world.find("ground"));
  const double weight = 21.0 * kG;
  EXPECT_LE((on_ground.force + Vec3(0, 0, weight)).norm() / weight, 1e-12);
  EXPECT_LE(largest_imbalance(world), 1e-12);
}

TEST(Support, ASmoothGrooveHoldsABallByMGOverTwoCos) {
  for (const double slope : {0.2, 0.7853981633974483, 1.2}) {
    const Material smooth{.friction = 0.0};
    World world;
    for (const double side : {-1.0, 1.0}) {
      BodyDefinition wall = body(side < 0 ? "left" : "right", HalfSpace{}, Vec3::Zero(), smooth);
      wall.type = BodyType::fixed;
      wall.X_WL.q = exp_map(Vec3(0, -side * slope, 0));
      world.create_body(wall);
    }
    const double mass = 3.0, radius = 0.4;
    const BodyId ball = world.create_body(
        body_of_mass("ball", Sphere{radius}, mass, Vec3(0, 0, radius / std::cos(slope)), smooth));
    run_to_rest(world, 10.0);
    ASSERT_TRUE(world.resting(ball.index)) << slope;
    const double exact = mass * kG / (2.0 * std::cos(slope));
    for (const char* wall : {"left", "right"}) {
      const double force = force_between(world, *world.find(wall), ball).norm();
      EXPECT_LE(std::abs(force - exact) / exact, 1e-12) << wall << " " << slope;
    }
  }
}

TEST(Support, ABeamOnTwoEdgesSharesItsWeightAndALoadByTheLever) {
  World world;
  for (const double x : {-1.0, 1.5}) {
    BodyDefinition edge = body(x < 0 ? "left" : "right", Capsule{0.1, 0.5}, Vec3(x, 0, 0));
    edge.X_WL.q = exp_map(Vec3(1.5707963267948966, 0, 0));
    edge.type = BodyType::fixed;
    world.create_body(edge);
  }
  const double beam_mass = 2.0, load_mass = 50.0, load_x = 0.8;
  const BodyId beam =
      world.create_body(body_of_mass("beam", Box{Vec3(2, 0.5, 0.1)}, beam_mass, Vec3(0, 0, 0.2)));
  world.create_body(body_of_mass("load", Box{Vec3(0.1, 0.1, 0.1)}, load_mass, Vec3(load_x, 0, 0.4)));
  run_to_rest(world, 10.0);
  ASSERT_TRUE(world.resting(beam.index));
  const double right = kG * (beam_mass * 1.0 + load_mass * (load_x + 1.0)) / 2.5;
  const double left = kG * (beam_mass + load_mass) - right;
  EXPECT_LE(std::abs(force_between(world, *world.find("left"), beam).z() - left) / left, 1e-9);
  EXPECT_LE(std::abs(force_between(world, *world.find("right"), beam).z() - right) / right, 1e-9);
  EXPECT_LE(largest_imbalance(world), 1e-12);
}

/// Wedge of an arch about the y axis, `angle` wide, its middle upwards [m, rad].
HullPointer voussoir(double inner, double outer, double depth, double angle) {
  std::vector<Vec3> corners;
  for (const double r : {inner, outer})
    for (const double side : {-0.5, 0.5})
      for (const double y : {-0.5 * depth, 0.5 * depth})
        corners.push_back(Vec3(r * std::sin(side * angle), y, r * std::cos(side * angle)));
  return std::make_shared<const ConvexHull>(build_convex_hull(corners));
}

TEST(Support, AnArchOfVoussoirsStandsAndEveryStoneOfItIsInBalance) {
  const int count = 9;
  const double span = 2.4, inner = 2.0, outer = 2.6, depth = 0.5;  // span [rad]
  const double angle = span / count;
  const Material rough{.friction = 0.7};
  World world;
  std::vector<BodyId> ids;
  for (int i = -1; i <= count; ++i) {
    BodyDefinition part =
        body("part" + std::to_string(i + 1), voussoir(inner, outer, depth, angle), Vec3::Zero(), rough);
    part.X_WL.q = exp_map(Vec3(0, (i + 0.5) * angle - 0.5 * span, 0));
    if (i < 0 || i == count) part.type = BodyType::fixed;
    ids.push_back(world.create_body(part));
  }
  const World start = world;
  const double time = run_to_rest(world, 10.0);
  EXPECT_LE(time, 0.5);
  run(world, 2400);
  EXPECT_LE(largest_displacement(start, world), 1e-6);
  const double weight = count * kG * world.mass_properties(ids[1].index).mass;
  const Vec3 left = force_between(world, ids.front(), ids[1]);
  const Vec3 right = force_between(world, ids.back(), ids[static_cast<std::size_t>(count)]);
  EXPECT_LE((left + right - Vec3(0, 0, weight)).norm() / weight, 1e-9);
  EXPECT_LE(largest_imbalance(world), 1e-12);
  EXPECT_GE(left.x(), 0.1 * weight);  // the thrust; how large it is statics leaves open: 0.5
}

}  // namespace
}  // namespace tumble
