// What the writer prints reads back as the same scene, to the bit.
#include <gtest/gtest.h>

#include <limits>

#include "scene/demo.h"
#include "scene/random.h"
#include "scene_bits.h"
#include "scene_text.h"

namespace tumble {
namespace {

void expect_round_trip(const Scene& scene) {
  const std::string text = write_sdf(scene);
  const SceneReading again = read_sdf_text(text, "written.sdf", "");
  EXPECT_TRUE(again.warnings.empty()) << again.warnings.front();
  EXPECT_TRUE(SceneBits(again.scene) == SceneBits(scene)) << scene.name;
  EXPECT_EQ(write_sdf(again.scene), text);
}

TEST(SdfRoundTrip, Demos) {
  for (const std::string_view name : demo_names()) {
    expect_round_trip(read_sdf_text(std::string(demo_text(name)), std::string(name), "").scene);
  }
}

TEST(SdfRoundTrip, TestScenes) {
  for (const char* name : {"ball", "stack", "free"}) {
    expect_round_trip(read_sdf(TUMBLE_SCENES_DIR "/" + std::string(name) + ".sdf").scene);
  }
}

TEST(SdfRoundTrip, MeshesAndTurnedInertia) {
  expect_round_trip(
      read(in_link(
               "<pose>1 2 3 0.4 0.5 0.6</pose><inertial><pose>0.1 0 0 0.3 0.2 "
               "0.1</pose><mass>3</mass><inertia><ixx>1</ixx><iyy>2</iyy>"
               "<izz>2.5</izz></inertia></inertial><collision name='c'><pose>0 0 0 1 1 "
               "1</pose><geometry><mesh>"
               "<uri>meshes/tetrahedron.obj</uri><scale>0.1 0.3 0.7</scale></mesh></geometry></collision>"))
          .scene);
}

TEST(SdfRoundTrip, NoOptionIsLost) {
  Scene scene;
  scene.name = "options & <quotes> \"'";
  scene.options.time_step = 1.0 / 3.0e4;
  scene.options.integrator = Integrator::course;
  scene.options.solver = Solver::course_impulse;
  // Every option away from its default, still in its range: flags turned, numbers a little larger.
  for_each_option(scene.options, [](const char*, auto& field) {
    if constexpr (std::is_same_v<decltype(field), bool&>) {
      field = !field;
    } else if constexpr (std::is_same_v<decltype(field), int&>) {
      field += 1;
    } else {
      field = field * (1.0 + 1e-15) + 1e-9;
    }
  });
  ASSERT_EQ(check_options(scene.options), "");
  expect_round_trip(scene);
}

TEST(SdfRoundTrip, RandomScenes) {
  Random random(3);
  for (int i = 0; i < 200; ++i) {
    Scene scene;
    scene.name = "random";
    BodyDefinition body;
    body.name = "a::b c";
    body.type = i % 2 == 0 ? BodyType::kinematic : BodyType::dynamic;
    body.X_WL = {random.rotation(), random.in_box(Vec3(1e-9, 1.0, 1e9))};
    body.v_WB = random.in_box(Vec3(1e-300, 1e3, 1e9));
    body.w_WB = Vec3(-0.0, 0.0, random.symmetric());
    body.linear_damping = std::numeric_limits<double>::min() * (1 + i);
    body.gravity = i % 3 == 0;
    GeometryDefinition geometry;
    geometry.name = "g";
    geometry.X_LS = {random.rotation(), random.in_box(Vec3::Ones())};
    const double radius = 1.0 + random.symmetric(), half_length = 1.0 + random.symmetric();
    const std::array<Shape, 4> shapes = {Capsule{radius, half_length}, Cylinder{radius, half_length},
                                         Cone{radius, half_length},
                                         Ellipsoid{Vec3(radius, half_length, 0.1)}};
    geometry.shape = shapes[static_cast<std::size_t>(i) % shapes.size()];
    geometry.material = {0.5 + 0.1 * random.symmetric(), 0.5 + 0.1 * random.symmetric(),
                         1000.0 + random.symmetric()};
    for (float& channel : geometry.color) channel = static_cast<float>(0.5 + 0.5 * random.symmetric());
    body.geometries.push_back(geometry);
    scene.bodies.push_back(body);
    expect_round_trip(scene);
  }
}

}  // namespace
}  // namespace tumble
