// Every tag of the subset means what scene/README.md says, and what is not in it is reported, not lost.
#include "scene/sdf.h"

#include <gtest/gtest.h>

#include <locale>

#include "scene/sdf_element.h"
#include "scene_text.h"

namespace tumble {
namespace {

BodyDefinition read_body(const std::string& text) {
  const SceneReading reading = read(text);
  EXPECT_TRUE(reading.warnings.empty()) << reading.warnings.front();
  return reading.scene.bodies.at(0);
}

GeometryDefinition read_geometry(const std::string& text) {
  return read_body(in_geometry(text)).geometries.at(0);
}

TEST(Sdf, EmptyWorldHasTheEnginesDefaultsAndSdfsGravity) {
  const Scene scene = read(in_world("")).scene;
  EXPECT_EQ(scene.name, "test");
  EXPECT_TRUE(scene.bodies.empty());
  EXPECT_EQ(scene.options.gravity, Vec3(0, 0, -9.8));
  EXPECT_EQ(scene.options.time_step, Options{}.time_step);
  EXPECT_EQ(scene.options.solver, Options{}.solver);
}

TEST(Sdf, PhysicsTags) {
  const SceneReading reading =
      read(in_world("<gravity>1 -2 3e-1</gravity><physics name='p' type='tumble' "
                    "default='true'><max_step_size>0.002</max_step_size>"
                    "<real_time_factor>1</real_time_factor><real_time_update_rate>500</real_time_update_rate>"
                    "<tumble:integrator>rk4</tumble:integrator><tumble:solver>soft_step</tumble:solver>"
                    "<tumble:sub_steps>7</tumble:sub_steps><tumble:restitution_threshold>0.25</"
                    "tumble:restitution_threshold>"
                    "<tumble:warm_start>false</tumble:warm_start></physics>"));
  EXPECT_TRUE(reading.warnings.empty());
  const Options& options = reading.scene.options;
  EXPECT_EQ(options.gravity, Vec3(1, -2, 0.3));
  EXPECT_EQ(options.time_step, 0.002);
  EXPECT_EQ(options.integrator, Integrator::rk4);
  EXPECT_EQ(options.solver, Solver::soft_step);
  EXPECT_EQ(options.solver_settings.sub_steps, 7);
  EXPECT_EQ(options.restitution_threshold, 0.25);
  EXPECT_FALSE(options.warm_start);
}

TEST(Sdf, AccuracySetsALevelAndSingleOptionsOverrideIt) {
  Options fast;
  set_accuracy(fast, Accuracy::fast);
  const Scene level = read(in_world("<physics><tumble:accuracy>fast</tumble:accuracy></physics>")).scene;
  EXPECT_EQ(level.options.solver_settings.max_sweeps, fast.solver_settings.max_sweeps);
  EXPECT_EQ(level.options.solver_settings.tolerance, fast.solver_settings.tolerance);
  const Scene both = read(in_world("<physics><tumble:max_sweeps>99</tumble:max_sweeps>"
                                   "<tumble:accuracy>fast</tumble:accuracy></physics>"))
                         .scene;
  EXPECT_EQ(both.options.solver_settings.max_sweeps, 99);
  EXPECT_EQ(both.options.solver_settings.tolerance, fast.solver_settings.tolerance);
}

TEST(Sdf, OldFilesHaveGravityInPhysics) {
  EXPECT_EQ(read(in_world("<physics><gravity>0 0 -1</gravity></physics>")).scene.options.gravity,
            Vec3(0, 0, -1));
}

TEST(Sdf, Shapes) {
  EXPECT_EQ(std::get<Sphere>(read_geometry("<sphere><radius>0.25</radius></sphere>").shape).radius, 0.25);
  EXPECT_EQ(std::get<Box>(read_geometry("<box><size>2 4 6</size></box>").shape).half_extents, Vec3(1, 2, 3));
  const Shape capsule = read_geometry("<capsule><radius>0.1</radius><length>3</length></capsule>").shape;
  EXPECT_EQ(std::get<Capsule>(capsule).radius, 0.1);
  EXPECT_EQ(std::get<Capsule>(capsule).half_length, 1.5);
  const Shape cylinder = read_geometry("<cylinder><radius>0.1</radius><length>3</length></cylinder>").shape;
  EXPECT_EQ(std::get<Cylinder>(cylinder).radius, 0.1);
  EXPECT_EQ(std::get<Cylinder>(cylinder).half_length, 1.5);
  const Shape cone = read_geometry("<cone><radius>0.1</radius><length>3</length></cone>").shape;
  EXPECT_EQ(std::get<Cone>(cone).radius, 0.1);
  EXPECT_EQ(std::get<Cone>(cone).half_length, 1.5);
  const Shape ellipsoid = read_geometry("<ellipsoid><radii>1 2 3</radii></ellipsoid>").shape;
  EXPECT_EQ(std::get<Ellipsoid>(ellipsoid).half_axes, Vec3(1, 2, 3));
  const GeometryDefinition tetrahedron = read_geometry(
      "<tumble:convex_hull><tumble:points>0 0 0 1 0 0 0 1 0 0 0 1</tumble:points></tumble:convex_hull>");
  const HullPointer* pointer = std::get_if<HullPointer>(&tetrahedron.shape);
  ASSERT_TRUE(pointer && *pointer);
  EXPECT_EQ((*pointer)->vertices.size(), 4u);
}

TEST(Sdf, MeshesBecomeScaledHulls) {
  for (const char* file : {"meshes/tetrahedron.obj", "meshes/tetrahedron.stl"}) {
    const Shape shape =
        read_geometry("<mesh><uri>" + std::string(file) + "</uri><scale>2 1 0.5</scale></mesh>").shape;
    const ConvexHull& hull = *std::get<HullPointer>(shape);
    EXPECT_EQ(hull.vertices.size(), 4u);
    EXPECT_EQ(hull.faces.size(), 4u);
    EXPECT_EQ(hull.radius, 2.0);
  }
}

TEST(Sdf, PlaneNormalBecomesTheFramesZ) {
  for (const Vec3& n : {Vec3(0, 0, 1), Vec3(1, 0, 0), Vec3(0, -3, 4), Vec3(0, 0, -2), Vec3(1e-9, 0, -1)}) {
    const std::string text =
        to_shortest_text(n.x()) + " " + to_shortest_text(n.y()) + " " + to_shortest_text(n.z());
    const SceneReading reading = read(in_world(
        "<model name='m'><static>true</static><link name='l'><collision name='c'><geometry><plane><normal>" +
        text + "</normal></plane></geometry></collision></link></model>"));
    const GeometryDefinition& geometry = reading.scene.bodies[0].geometries[0];
    EXPECT_TRUE(std::holds_alternative<HalfSpace>(geometry.shape));
    // 2e-16 measured
    EXPECT_LT((geometry.X_LS.q * Vec3::UnitZ() - n.normalized()).norm(), 1e-15) << text;
  }
}

TEST(Sdf, PoseIsRollPitchYawAboutFixedAxes) {
  const Pose X = read_body(beside_ball("<pose>1 2 3 0.1 -0.2 0.3</pose>")).X_WL;
  EXPECT_EQ(X.p, Vec3(1, 2, 3));
  const Mat3 expected = (Eigen::AngleAxisd(0.3, Vec3::UnitZ()) * Eigen::AngleAxisd(-0.2, Vec3::UnitY()) *
                         Eigen::AngleAxisd(0.1, Vec3::UnitX()))
                            .toRotationMatrix();
  EXPECT_LT((X.q.toRotationMatrix() - expected).norm(), 1e-15);  // 1.7e-16 measured
}

TEST(Sdf, PoseFormats) {
  const Pose degrees = read_body(beside_ball("<pose degrees='true'>0 0 0 0 0 90</pose>")).X_WL;
  EXPECT_LT((degrees.q * Vec3::UnitX() - Vec3::UnitY()).norm(), 1e-15);
  const Pose quaternion =
      read_body(beside_ball("<pose rotation_format='quat_xyzw'>0 0 0 0 0 2 2</pose>")).X_WL;
  EXPECT_LT((quaternion.q * Vec3::UnitX() - Vec3::UnitY()).norm(), 1e-15);
  EXPECT_NEAR(quaternion.q.norm(), 1.0, 1e-15);
}

TEST(Sdf, PosesChainFromModelToLinkAndByRelativeTo) {
  const Scene scene = read(in_world(ball_model("a", "<pose>1 0 0 0 0 1.5707963267948966</pose>") +
                                    ball_model("b", "<pose relative_to='a'>2 0 0 0 0 0</pose>") +
                                    "<model name='c'><pose>0 0 5 0 0 0</pose>"
                                    "<link name='x'><pose>1 0 0 0 0 "
                                    "0</pose><inertial><mass>1</mass><inertia><ixx>1</ixx><iyy>1</"
                                    "iyy><izz>1</izz></inertia></inertial></link>"
                                    "<link name='y'><pose relative_to='x'>0 1 0 0 0 "
                                    "0</pose><inertial><mass>1</mass><inertia><ixx>1</ixx><iyy>1</"
                                    "iyy><izz>1</izz></inertia></inertial></link>"
                                    "</model>"))
                          .scene;
  ASSERT_EQ(scene.bodies.size(), 4u);
  EXPECT_LT((scene.bodies[1].X_WL.p - Vec3(1, 2, 0)).norm(), 1e-15);
  EXPECT_EQ(scene.bodies[2].name, "c::x");
  EXPECT_EQ(scene.bodies[3].name, "c::y");
  EXPECT_EQ(scene.bodies[3].X_WL.p, Vec3(1, 1, 5));
}

TEST(Sdf, LinkTags) {
  const BodyDefinition body = read_body(beside_ball(
      "<gravity>false</gravity><velocity_decay><linear>0.5</linear><angular>0.25</angular></velocity_decay>"
      "<tumble:linear_velocity>1 2 3</tumble:linear_velocity><tumble:angular_velocity>4 5 "
      "6</tumble:angular_velocity>"));
  EXPECT_EQ(body.name, "m");
  EXPECT_EQ(body.type, BodyType::dynamic);
  EXPECT_FALSE(body.gravity);
  EXPECT_EQ(body.linear_damping, 0.5);
  EXPECT_EQ(body.angular_damping, 0.25);
  EXPECT_EQ(body.v_WB, Vec3(1, 2, 3));
  EXPECT_EQ(body.w_WB, Vec3(4, 5, 6));
  EXPECT_FALSE(body.inertia);
  EXPECT_EQ(read_body(beside_ball("<kinematic>1</kinematic>")).type, BodyType::kinematic);
  EXPECT_EQ(read(in_world(ball_model("s", "<static>true</static>"))).scene.bodies[0].type, BodyType::fixed);
}

TEST(Sdf, InertialIsTurnedIntoTheLinkFrame) {
  const BodyDefinition body =
      read_body(in_link("<inertial><pose>0.1 0.2 0.3 0 0 "
                        "1.5707963267948966</pose><mass>4</mass><inertia><ixx>1</ixx><iyy>2</iyy>"
                        "<izz>2.5</izz><ixy>0.125</ixy></inertia></inertial>"));
  ASSERT_TRUE(body.inertia);
  EXPECT_EQ(body.inertia->mass, 4.0);
  EXPECT_EQ(body.inertia->center, Vec3(0.1, 0.2, 0.3));
  Mat3 expected;
  expected << 2, -0.125, 0, -0.125, 1, 0, 0, 0, 2.5;
  EXPECT_LT((body.inertia->moments - expected).norm(), 1e-15);  // 4e-16 measured
  EXPECT_EQ(body.inertia->moments, body.inertia->moments.transpose());
}

TEST(Sdf, MassAloneScalesTheShapesInertia) {
  const BodyDefinition body = read_body(beside_ball("<inertial><mass>3</mass></inertial>"));
  ASSERT_TRUE(body.inertia);
  EXPECT_EQ(body.inertia->mass, 3.0);
  EXPECT_NEAR(body.inertia->moments(0, 0), 0.4 * 3.0 * 0.25, 1e-15);  // course: 2/5 m r^2
}

TEST(Sdf, SurfaceDensityAndColour) {
  const BodyDefinition body = read_body(in_link(
      "<collision name='c'><pose>0 0 1 0 0 "
      "0</pose><geometry><sphere><radius>1</radius></sphere></geometry><density>250</density>"
      "<surface><friction><ode><mu>0.25</mu><mu2>0.25</mu2></ode></friction>"
      "<bounce><restitution_coefficient>0.75</restitution_coefficient></bounce></surface></collision>"
      "<collision name='d'><geometry><sphere><radius>1</radius></sphere></geometry></collision>"
      "<visual name='c'><pose>0 0 1 0 0 0</pose><geometry><sphere><radius>1</radius></sphere></geometry>"
      "<material><diffuse>0.5 0.25 0.125 1</diffuse></material></visual>"));
  const GeometryDefinition& c = body.geometries.at(0);
  EXPECT_EQ(c.X_LS.p, Vec3(0, 0, 1));
  EXPECT_EQ(c.material.friction, 0.25);
  EXPECT_EQ(c.material.restitution, 0.75);
  EXPECT_EQ(c.material.density, 250.0);
  EXPECT_EQ(c.color, (std::array<float, 4>{0.5f, 0.25f, 0.125f, 1.0f}));
  const GeometryDefinition& d = body.geometries.at(1);
  EXPECT_EQ(d.material.friction, 1.0);  // SDF's default of mu
  EXPECT_EQ(d.material.restitution, 0.0);
  EXPECT_EQ(d.material.density, 1000.0);
  EXPECT_EQ(d.color, GeometryDefinition{}.color);
}

TEST(Sdf, FrictionAgainstTurning) {
  const auto material = [](const std::string& friction) {
    return read_body(
               in_link("<collision name='c'><geometry><sphere><radius>1</radius></sphere></geometry><surface>"
                       "<friction>" +
                       friction + "</friction></surface></collision>"))
        .geometries.at(0)
        .material;
  };
  const Material own = material(
      "<tumble:torsional_friction>0.25</tumble:torsional_friction>"
      "<tumble:rolling_friction>0.5</tumble:rolling_friction>");
  EXPECT_EQ(own.torsional_friction, 0.25);
  EXPECT_EQ(own.rolling_friction, 0.5);
  const Material gazebo =
      material("<torsional><coefficient>0.5</coefficient><patch_radius>0.1</patch_radius></torsional>");
  EXPECT_NEAR(gazebo.torsional_friction, 3.0 * 3.14159265358979 / 16.0 * 0.05, 1e-15);
  EXPECT_EQ(gazebo.rolling_friction, 0.0);
  EXPECT_EQ(material("<torsional><coefficient>2</coefficient></torsional>").torsional_friction, 0.0);
  EXPECT_EQ(material("<ode><mu>0.5</mu></ode>").torsional_friction, 0.0);
}

TEST(Sdf, SpringsAndRopesJoinAnchors) {
  const SceneReading reading = read(in_world(
      ball_model("a") + ball_model("b", "<pose>0 3 0 0 0 0</pose>") +
      "<tumble:spring name='s'><tumble:a body='a'>0 0.5 0</tumble:a><tumble:b body='b'>0 -0.5 0</tumble:b>"
      "<tumble:stiffness>100</tumble:stiffness><tumble:damping>2</tumble:damping></tumble:spring>"
      "<tumble:rope name='r'><tumble:a>0 3 4</tumble:a><tumble:b body='b'>0 0 0</tumble:b>"
      "<tumble:length>5</tumble:length><tumble:restitution>0.5</tumble:restitution></tumble:rope>"));
  EXPECT_TRUE(reading.warnings.empty());
  const SceneSpring& spring = reading.scene.springs.at(0);
  EXPECT_EQ(spring.a.body, "a");
  EXPECT_EQ(spring.b.p, Vec3(0, -0.5, 0));
  EXPECT_EQ(spring.spring.rest_length, 2.0);  // the distance at the start
  EXPECT_EQ(spring.spring.stiffness, 100.0);
  EXPECT_EQ(spring.spring.damping, 2.0);
  const SceneRope& rope = reading.scene.ropes.at(0);
  EXPECT_TRUE(rope.a.body.empty());
  EXPECT_EQ(rope.a.p, Vec3(0, 3, 4));
  EXPECT_EQ(rope.rope.length, 5.0);
  EXPECT_EQ(rope.rope.restitution, 0.5);
}

TEST(Sdf, StateReplacesPosesAndVelocities) {
  // The velocity of a state is that of the link's origin; the centre of mass is 1 m off along x, so w adds w x r.
  const SceneReading reading =
      read(in_world(ball_model("a") + "<model name='m'><link name='l'><inertial><pose>1 0 0 0 0 "
                                      "0</pose><mass>1</mass><inertia><ixx>1</ixx><iyy>1</iyy><izz>1</izz>"
                                      "</inertia></inertial></link></model>"
                                      "<state world_name='test'><model name='m'><link name='l'><pose>0 0 7 0 "
                                      "0 0</pose><velocity>1 2 3 0 0 2</velocity></link>"
                                      "</model></state>"));
  EXPECT_TRUE(reading.warnings.empty());
  const BodyDefinition& body = reading.scene.bodies.at(1);
  EXPECT_EQ(body.X_WL.p, Vec3(0, 0, 7));
  EXPECT_EQ(body.w_WB, Vec3(0, 0, 2));
  EXPECT_EQ(body.v_WB, Vec3(1, 4, 3));
}

TEST(Sdf, IgnoredTagsAndAttributesAreWarningsWithTheirLine) {
  const std::vector<std::pair<std::string, std::string>> cases = {
      {in_world("\n<light name='sun'/>"),
       "s.sdf:4: <light> is ignored: not in the subset of SDF that is read"},
      {in_world("<physics type='ode'/>"), "s.sdf:3: <physics type> is ignored: the engine is Tumble (ode)"},
      {in_world("<physics><real_time_factor>2</real_time_factor></physics>"),
       "s.sdf:3: <real_time_factor> is ignored: the server's --rate or --fast decides (2)"},
      {beside_ball("<self_collide>1</self_collide>"),
       "s.sdf:6: <self_collide> is ignored: not in the subset of SDF that is read"},
      {beside_ball("<pose foo='1'>0 0 0 0 0 0</pose>"),
       "s.sdf:6: <pose foo> is ignored: not in the subset of SDF that is read (1)"},
      {beside_ball("stray"), "s.sdf:4: <link> has a text that is ignored: only tags belong here (stray)"},
      {in_link("<collision "
               "name='c'><geometry><sphere><radius>1</radius></sphere></"
               "geometry><surface><friction><ode><mu>1</mu>\n"
               "<mu2>0.5</mu2></ode></friction></surface></collision>"),
       "s.sdf:6: <mu2> is ignored: friction is the same in all directions, <mu> is used (0.5)"},
      {beside_ball("<visual name='c'>\n<geometry><box><size>1 1 1</size></box></geometry></visual>"),
       "s.sdf:7: <geometry> is ignored: viewers draw the collision's shape"},
  };
  for (const auto& [text, expected] : cases) {
    const SceneReading reading = read(text);
    ASSERT_EQ(reading.warnings.size(), 1u) << expected;
    EXPECT_EQ(reading.warnings[0], expected);
  }
}

TEST(Sdf, NoPlaceSwallowsAnUnknownTag) {
  // A tag that is unknown everywhere, put behind every opening tag of a scene that uses the whole subset: each time it
  // is either warned about or, inside a plain value, an error.
  const std::string text = in_world(
      "<gravity>0 0 -1</gravity><physics><max_step_size>0.01</max_step_size></physics>"
      "<model name='g'><static>true</static><link name='l'><collision name='c'><geometry><plane><normal>0 0 "
      "1</normal></plane>"
      "</geometry></collision></link></model>"
      "<model name='m'><pose>0 0 9 0 0 0</pose><link name='l'><pose>0 0 0 0 0 "
      "0</pose><inertial><mass>1</mass><inertia><ixx>1</ixx>"
      "<iyy>1</iyy><izz>1</izz></inertia></inertial><collision name='c'><geometry><box><size>1 1 "
      "1</size></box></geometry>"
      "<surface><friction><ode><mu>1</mu></ode></friction><bounce><restitution_coefficient>0</"
      "restitution_coefficient></bounce>"
      "</surface></collision><collision "
      "name='k'><geometry><capsule><radius>1</radius><length>1</length></capsule></geometry></collision>"
      "<collision name='h'><geometry><tumble:convex_hull><tumble:points>0 0 0 1 0 0 0 1 0 0 0 "
      "1</tumble:points></tumble:convex_hull>"
      "</geometry></collision><collision "
      "name='o'><geometry><mesh><uri>meshes/tetrahedron.obj</uri></mesh></geometry></collision>"
      "<velocity_decay><linear>0</linear></velocity_decay><visual name='c'><material><diffuse>1 1 1 "
      "1</diffuse></material></visual>"
      "</link></model><population name='p'>" +
      ball_model("b") +
      "<model_count>1</model_count><box><size>1 1 1</size></box>"
      "<distribution><type>random</type></distribution></population><population name='q'>" +
      ball_model("d") +
      "<model_count>1</model_count><cylinder><radius>1</radius><length>1</length></cylinder>"
      "<distribution><type>uniform</type></distribution></population><state world_name='test'><model "
      "name='m'><link name='l'>"
      "<velocity>0 0 0 0 0 0</velocity></link></model></state><tumble:rope name='r'><tumble:a>0 0 "
      "1</tumble:a>"
      "<tumble:b body='m'>0 0 0</tumble:b></tumble:rope>");
  ASSERT_TRUE(read(text).warnings.empty()) << read(text).warnings[0];
  int places = 0;
  for (std::size_t end = text.find('>'); end != std::string::npos; end = text.find('>', end + 1)) {
    const std::size_t begin = text.rfind('<', end);
    if (text[begin + 1] == '/') continue;
    std::string changed = text;
    changed.insert(end + 1, "<nonsense/>");
    ++places;
    try {
      const SceneReading reading = read(changed);
      ASSERT_EQ(reading.warnings.size(), 1u) << text.substr(begin, end - begin + 1);
      EXPECT_NE(reading.warnings[0].find("<nonsense> is ignored"), std::string::npos);
    } catch (const SceneError& error) {
      EXPECT_NE(std::string(error.what()).find("(nonsense)"), std::string::npos) << error.what();
    }
  }
  EXPECT_GT(places, 80);
}

struct DecimalComma : std::numpunct<char> {
  char do_decimal_point() const override { return ','; }
};

TEST(Sdf, NumbersDoNotDependOnTheLocale) {
  const std::locale before = std::locale::global(std::locale(std::locale(), new DecimalComma));
  const Scene scene = read(in_world("<gravity>0 0 -1.5</gravity>")).scene;
  const std::string written = write_sdf(scene);
  std::locale::global(before);
  EXPECT_EQ(scene.options.gravity.z(), -1.5);
  EXPECT_NE(written.find("<gravity>0 0 -1.5</gravity>"), std::string::npos);
}

}  // namespace
}  // namespace tumble
