// A world as bytes: what is read back goes on with the same bits, whatever was going on.
#include <gtest/gtest.h>

#include <string>

#include "scene/demo.h"
#include "scene/sdf.h"
#include "world/archive.h"

namespace tumble {
namespace {

std::string bytes_of(const World& world, const World& start) {
  std::string bytes;
  write_world(world, start, bytes);
  return bytes;
}

World world_of(const std::string& bytes, const World& start) {
  return read_world(start, bytes);
}

/// Reads `world` back and steps both; every step has the same hash, and at the end every cached number is the same.
void expect_same_future(World world, const World& start, int steps) {
  World other = world_of(bytes_of(world, start), start);
  ASSERT_EQ(bytes_of(other, start), bytes_of(world, start));
  for (int i = 0; i < steps; ++i) {
    world.step();
    other.step();
    ASSERT_EQ(other.state_hash(), world.state_hash()) << "step " << i + 1;
  }
  EXPECT_EQ(bytes_of(other, start), bytes_of(world, start));
}

BodyId nth_dynamic(const World& world, std::uint32_t n) {
  for (std::uint32_t slot = 0;; ++slot) {
    if (world.body(slot).type == BodyType::dynamic && n-- == 0) return world.id(slot);
  }
}

/// By file, in tests/scenes.
class ArchivedScene : public testing::TestWithParam<const char*> {};

TEST_P(ArchivedScene, GoesOnWithTheSameBits) {
  const std::string name = GetParam();
  const World start = build_world(read_sdf(TUMBLE_SCENES_DIR "/" + name + ".sdf").scene);
  World world = start;
  expect_same_future(world, start, 10);
  for (int i = 0; i < 40; ++i) world.step();
  const BodyId body = nth_dynamic(world, 0);
  const Vec3 force = 5.0 * world.mass_properties(body.index).mass * Vec3(1.0, 0.5, 2.0);
  world.push({.body = body, .force = force, .point_B = Vec3(0.01, 0.0, 0.0), .duration = 0.05});
  world.push({.body = nth_dynamic(world, 1), .frame = Push::Frame::body, .force = force, .duration = 2.0});
  expect_same_future(world, start, 60);  // pushed while it was written
  for (int i = 0; i < 60; ++i) world.step();
  const bool slow = name == "pile" || name == "pyramid";
  expect_same_future(world, start, slow ? 20 : 500);
}

INSTANTIATE_TEST_SUITE_P(Archive, ArchivedScene,
                         testing::Values("cradle", "incline", "joints", "pile", "pyramid", "springs",
                                         "terrain", "tumbling"),
                         [](const auto& info) { return std::string(info.param); });

TEST(Archive, HoldsBodiesAloftAndThoseThatCameAndWent) {
  const World start;
  World world = start;
  GeometryDefinition box;
  box.shape = Box{Vec3(0.1, 0.2, 0.3)};
  const auto create = [&](const std::string& name, int i) {
    BodyDefinition body;
    body.name = name;
    body.X_WL.p = Vec3(3.0 * i, 0.0, 5.0);
    body.v_WB = Vec3(0.1, 0.0, 3.0);
    body.w_WB = Vec3(1e-3, 5.0, 1e-3 * i);
    body.geometries = {box};
    body.linear_damping = i == 3 ? 0.1 : 0.0;
    return world.create_body(body);
  };
  std::vector<BodyId> ids;
  for (int i = 0; i < 6; ++i) ids.push_back(create("b" + std::to_string(i), i));
  for (int i = 0; i < 50; ++i) world.step();
  world.destroy_body(ids[2]);
  world.destroy_body(ids[4]);
  create("late", 7);
  world.step();
  ASSERT_GT(world.counters().bodies_skipped_flying, 0u);
  expect_same_future(world, start, 500);
  world.set_time_step(1e-3);
  World other = world_of(bytes_of(world, start), start);
  EXPECT_EQ(other.time(), world.time());
  EXPECT_EQ(other.options().time_step, 1e-3);
  EXPECT_EQ(other.find("late"), world.find("late"));
  EXPECT_FALSE(other.is_valid(ids[4]));
}

TEST(Archive, NamesHullsAndSurfacesInsteadOfWritingThem) {
  const World start = build_world(read_sdf_text(std::string(demo_text("terrain")), "demo", ".").scene);
  const World other = world_of(bytes_of(start, start), start);
  int shared = 0;
  for (std::size_t i = 0; i < start.geometries().size(); ++i) {
    std::visit(
        [&](const auto& shape) {
          if constexpr (requires { shape.get(); }) {
            EXPECT_EQ(std::get<std::decay_t<decltype(shape)>>(other.geometries()[i].shape), shape);
            ++shared;
          }
        },
        start.geometries()[i].shape);
  }
  EXPECT_GT(shared, 0);
}

TEST(Archive, RefusesBytesThatAreNoWorld) {
  const World start = build_world(read_sdf_text(std::string(demo_text("cradle")), "demo", ".").scene);
  const std::string bytes = bytes_of(start, start);
  EXPECT_THROW(world_of(bytes.substr(0, bytes.size() / 2), start), std::runtime_error);
  EXPECT_THROW(world_of("", start), std::runtime_error);
  EXPECT_THROW(world_of(std::string(400, '\xff'), start), std::runtime_error);
}

}  // namespace
}  // namespace tumble
