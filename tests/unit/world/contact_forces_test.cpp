// Forces of contacts as the world tells them.
#include "world/contact_forces.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/gravity.h"
#include "support/world_builder.h"

namespace tumble {
namespace {

using namespace test;

TEST(ContactForces, ARestingBodyIsHeldByItsWeightWhoseTorqueIsNone) {
  World world;
  world.create_body(ground());
  const BodyId box = world.create_body(body_of_mass("box", Box{Vec3(0.5, 0.3, 0.2)}, 7.0, Vec3(0, 0, 0.2)));
  run(world, 10);
  ASSERT_TRUE(world.resting(box.index));
  const ContactLoad load = sum_contact_forces(world, box);
  EXPECT_LE((load.force - Vec3(0, 0, 7.0 * kG)).norm(), 1e-12 * 7.0 * kG);  // measured 3e-16 of it
  EXPECT_LE(load.torque.norm(), 1e-12);
  EXPECT_EQ(read_contact_forces(world, box).size(), 4u);
  run(world, 1000);  // nothing is stepped, and nothing forgotten
  EXPECT_EQ(sum_contact_forces(world, box).force, load.force);
}

TEST(ContactForces, EveryPointNamesItsBodiesShapesPlaceAndNormal) {
  World world;
  const BodyId floor = world.create_body(ground());
  BodyDefinition table = body_of_mass("table", Sphere{0.1}, 3.0, Vec3::Zero());
  table.geometries.clear();
  for (const double angle : {0.0, 2.1, 4.2}) {
    GeometryDefinition foot = geometry(Sphere{0.1});
    foot.name = "foot" + std::to_string(table.geometries.size());
    foot.X_LS.p = Vec3(std::cos(angle), std::sin(angle), 0.1);
    table.geometries.push_back(foot);
  }
  const BodyId id = world.create_body(table);
  run(world, 10);
  const std::vector<ContactForce> forces = read_contact_forces(world);
  ASSERT_EQ(forces.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(forces[i].a, floor);
    EXPECT_EQ(forces[i].b, id);
    EXPECT_EQ(forces[i].geometry_a, 0u);
    EXPECT_EQ(forces[i].geometry_b, i);
    const Vec3 foot = table.geometries[i].X_LS.p - Vec3(0, 0, 0.1);
    EXPECT_LE((forces[i].p_W - foot).norm(), 1e-9);
    EXPECT_LE((forces[i].normal_W - Vec3::UnitZ()).norm(), 1e-15);
    EXPECT_LE(std::abs(forces[i].separation), 1e-9);
    EXPECT_GT(forces[i].force_W.z(), 0.0);
  }
}

TEST(ContactForces, ASlidingBoxFeelsMuTimesItsWeightAgainstItsWay) {
  const Material material{.friction = 0.3};
  World world;
  const BodyId floor = world.create_body(ground(material));
  BodyDefinition definition = body_of_mass("box", Box{Vec3(0.5, 0.5, 0.2)}, 2.0, Vec3(0, 0, 0.2), material);
  definition.v_WB = Vec3(5, 0, 0);
  const BodyId box = world.create_body(definition);
  run(world, 100);
  const Vec3 exact = 2.0 * kG * Vec3(-0.3, 0, 1);
  EXPECT_LE((sum_contact_forces(world, box).force - exact).norm(), 1e-6);  // measured 3e-9
  EXPECT_LE((sum_contact_forces(world, floor).force + exact).norm(), 1e-6);
}

TEST(ContactForces, NobodyTouchesABodyThatIsGoneOrAlone) {
  World world;
  world.create_body(ground());
  const BodyId alone = world.create_body(body("alone", Sphere{0.5}, Vec3(0, 0, 100)));
  const BodyId gone = world.create_body(body("gone", Sphere{0.5}, Vec3(0, 0, 0.5)));
  run(world, 10);
  EXPECT_EQ(read_contact_forces(world, gone).size(), 1u);
  world.destroy_body(gone);
  EXPECT_TRUE(read_contact_forces(world, gone).empty());
  EXPECT_TRUE(sum_contact_forces(world, gone).force.isZero(0.0));
  EXPECT_TRUE(read_contact_forces(world, alone).empty());
  EXPECT_TRUE(read_contact_forces(world).empty());
}

}  // namespace
}  // namespace tumble
