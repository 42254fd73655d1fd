// A scene becomes a world: everything in its order, and errors that name what could not be made.
#include "scene/scene.h"

#include <gtest/gtest.h>

#include "scene/demo.h"
#include "scene_text.h"

namespace tumble {
namespace {

std::string build_error_of(const Scene& scene) {
  try {
    build_world(scene);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(Scene, BodiesAreCreatedInTheOrderOfTheFile) {
  const Scene scene = read(in_world(ball_model("b", "<pose>1 2 3 0 0 0</pose>") + ball_model("a"))).scene;
  const World world = build_world(scene);
  EXPECT_EQ(world.body_count(), 2u);
  ASSERT_TRUE(world.find("b") && world.find("a"));
  EXPECT_EQ(world.find("b")->index, 0u);
  EXPECT_EQ(world.find("a")->index, 1u);
  EXPECT_EQ(world.motion(0).x, Vec3(1, 2, 3));
  EXPECT_EQ(world.options().gravity, scene.options.gravity);
}

TEST(Scene, ErrorsNameTheBodySpringOrRope) {
  Scene scene = read(in_world(ball_model("a") + ball_model("b", "<pose>2 0 0 0 0 0</pose>"))).scene;
  scene.bodies[1].linear_damping = -1.0;
  EXPECT_EQ(build_error_of(scene).find("body 'b': "), 0u) << build_error_of(scene);
  EXPECT_NE(build_error_of(scene).find("-1"), std::string::npos) << build_error_of(scene);
  scene.bodies[1].linear_damping = 0.0;
  scene.ropes.push_back({"r", {"a", Vec3::Zero()}, {"nobody", Vec3::Zero()}, {1.0, 0.0}});
  EXPECT_EQ(build_error_of(scene), "rope 'r': b: unknown body (nobody)");
  scene.ropes[0].b.body = "b";
  scene.springs.push_back({"s", {"a", Vec3::Zero()}, {"", Vec3::Zero()}, {1.0, -5.0, 0.0}});
  EXPECT_EQ(build_error_of(scene).find("spring 's': "), 0u) << build_error_of(scene);
  scene.springs.clear();
  EXPECT_EQ(build_error_of(scene), "");
}

TEST(Scene, AWrittenSceneMovesToTheSameBits) {
  for (const std::string_view name : demo_names()) {
    const Scene scene = read_sdf_text(std::string(demo_text(name)), std::string(name), "").scene;
    World first = build_world(scene);
    World second = build_world(read_sdf_text(write_sdf(scene), "written", "").scene);
    EXPECT_EQ(first.body_count(), scene.bodies.size());
    EXPECT_EQ(first.state_hash(), second.state_hash()) << name;
    for (int i = 0; i < 5; ++i) {
      first.step();
      second.step();
    }
    EXPECT_EQ(first.state_hash(), second.state_hash()) << name;
  }
}

TEST(Scene, NoDemoStartsWithOverlap) {
  for (const std::string_view name : demo_names()) {
    World world = build_world(read_sdf_text(std::string(demo_text(name)), std::string(name), "").scene);
    world.step();
    // Contacts of the first step are found at the initial poses. 9e-16 m measured (incline)
    EXPECT_LT(world.report().deepest_penetration, 1e-12) << name;
    EXPECT_TRUE(world.contained().empty()) << name;
  }
}

}  // namespace
}  // namespace tumble
