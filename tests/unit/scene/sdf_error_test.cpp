// Every wrong value is refused with file, line, tag, reason and value.
#include <gtest/gtest.h>

#include "scene_text.h"

namespace tumble {
namespace {

struct Case {
  std::string text, error;
};

void check(const std::vector<Case>& cases) {
  for (const Case& c : cases) EXPECT_EQ(error_of(c.text), c.error) << c.text;
}

std::string with_moments(const std::string& values) {
  return in_link("<inertial><mass>1</mass>\n<inertia>" + values + "</inertia></inertial>");
}

std::string population(const std::string& rest) {
  return in_world("<population name='p'>" + ball_model("b") + "\n" + rest + "</population>");
}

std::string two_balls(const std::string& rest) {
  return in_world(ball_model("a") + ball_model("b", "<pose>2 0 0 0 0 0</pose>") + "\n" + rest);
}

TEST(SdfError, TheFileItself) {
  check({{"", "s.sdf:1: <sdf>: not well-formed XML (XML_ERROR_EMPTY_DOCUMENT)"},
         {"<sdf version='1.9'>\n<world name='a'>\n</sdf>",
          "s.sdf:2: <sdf>: not well-formed XML (XML_ERROR_MISMATCHED_ELEMENT)"},
         {std::string("<sdf>\n\0", 7), "s.sdf:2: <sdf>: the file has a zero byte (not a text)"},
         {"<!-- nothing -->", "s.sdf:1: <sdf>: the file has no tags (an <sdf> is needed)"},
         {"<gazebo version='1.9'/>", "s.sdf:1: <gazebo>: the outermost tag must be <sdf> (gazebo)"},
         {"<sdf><world name='a'/></sdf>", "s.sdf:1: <sdf>: needs an attribute \"version\""},
         {"<sdf version='2.0'><world name='a'/></sdf>", "s.sdf:1: <sdf version>: must be 1.4 to 1.11 (2.0)"},
         {"<sdf version='1.9'/>", "s.sdf:1: <sdf>: needs a <world>"},
         {"<sdf version='1.9'>\n<world/></sdf>", "s.sdf:2: <world>: needs an attribute \"name\""},
         {"<sdf version='1.9'>\n<world name='a'/>\n<world name='b'/></sdf>",
          "s.sdf:3: <world>: may stand only once (first in line 2)"},
         {"<sdf version='1.9'><world name='a'/></sdf>\n<sdf/>",
          "s.sdf:2: <sdf>: stands behind the end of <sdf>"}});
  EXPECT_THROW(read_sdf("no/such/file.sdf"), SceneError);
}

TEST(SdfError, Numbers) {
  const auto radius = [](const std::string& value) {
    return in_geometry("<sphere><radius>" + value + "</radius></sphere>");
  };
  check({{radius("-0.5"), "s.sdf:6: <radius>: must be > 0 (-0.5)"},
         {radius("0"), "s.sdf:6: <radius>: must be > 0 (0)"},
         {radius("nan"), "s.sdf:6: <radius>: must be finite (nan)"},
         {radius("inf"), "s.sdf:6: <radius>: must be finite (inf)"},
         {radius("1e999"), "s.sdf:6: <radius>: is beyond the range of a double (1e999)"},
         {radius("big"), "s.sdf:6: <radius>: is not a number (big)"},
         {radius("1.0m"), "s.sdf:6: <radius>: is not a number (1.0m)"},
         {radius("1,5"), "s.sdf:6: <radius>: is not a number (1,5)"},
         {radius("1 2"), "s.sdf:6: <radius>: must be 1 number, is 2 (1 2)"},
         {radius(""), "s.sdf:6: <radius>: must be 1 number, is 0 ()"},
         {radius("<b>1</b>"), "s.sdf:6: <radius>: must be a plain value, has a tag (b)"},
         {in_world("<gravity>0 0</gravity>"), "s.sdf:3: <gravity>: must be 3 numbers, is 2 (0 0)"},
         {in_world("<tumble:seed>1.5</tumble:seed>"),
          "s.sdf:3: <tumble:seed>: must be an integer in 0..2147483647 (1.5)"},
         {in_world("<tumble:seed>-1</tumble:seed>"),
          "s.sdf:3: <tumble:seed>: must be an integer in 0..2147483647 (-1)"},
         {beside_ball("<gravity>yes</gravity>"), "s.sdf:6: <gravity>: must be true or false (yes)"}});
}

TEST(SdfError, Poses) {
  check({{beside_ball("<pose>0 0 0</pose>"), "s.sdf:6: <pose>: must be 6 numbers, is 3 (0 0 0)"},
         {beside_ball("<pose>0 0 0 0 0 0 1</pose>"),
          "s.sdf:6: <pose>: must be 6 numbers, is 7 (0 0 0 0 0 0 1)"},
         {beside_ball("<pose rotation_format='quat_xyzw'>0 0 0 0 0 0</pose>"),
          "s.sdf:6: <pose>: must be 7 numbers, is 6 (0 0 0 0 0 0)"},
         {beside_ball("<pose rotation_format='quat_xyzw'>1 2 3 0 0 0 0</pose>"),
          "s.sdf:6: <pose>: quaternion has no direction (1 2 3 0 0 0 0)"},
         {beside_ball("<pose rotation_format='axis_angle'>0 0 0 0 0 0</pose>"),
          "s.sdf:6: <pose rotation_format>: must be euler_rpy or quat_xyzw (axis_angle)"},
         {beside_ball("<pose degrees='maybe'>0 0 0 0 0 0</pose>"),
          "s.sdf:6: <pose degrees>: must be true or false (maybe)"},
         {beside_ball("<pose>0 0 0 1e7 0 0</pose>"),
          "s.sdf:6: <pose>: angles must be within +-1e6 rad (1e+07)"},
         {beside_ball("<pose relative_to='z'>0 0 0 0 0 0</pose>"),
          "s.sdf:6: <pose relative_to>: unknown: must be __model__ or a link above (z)"},
         {in_world(ball_model("a", "\n<pose relative_to='z'>0 0 0 0 0 0</pose>")),
          "s.sdf:4: <pose relative_to>: unknown: must be world or a model above (z)"},
         {in_world("<model name='a'><pose>1e308 0 0 0 0 0</pose><link name='l'><pose>1e308 0 0 0 0 "
                   "0</pose><inertial><mass>1</mass>"
                   "<inertia><ixx>1</ixx><iyy>1</iyy><izz>1</izz></inertia></inertial></link></model>"),
          "s.sdf:3: <model>: its position overflows (a)"}});
}

TEST(SdfError, Geometry) {
  check(
      {{in_geometry("<polyline/>"),
        "s.sdf:6: <polyline>: this geometry is not supported: use sphere, box, capsule, cylinder, cone, "
        "ellipsoid, plane, mesh, heightmap or tumble:convex_hull"},
       {in_geometry(""),
        "s.sdf:5: <geometry>: needs one of sphere, box, capsule, cylinder, cone, ellipsoid, plane, mesh, "
        "heightmap, tumble:convex_hull"},
       {in_geometry("<cylinder><radius>1</radius></cylinder>"), "s.sdf:6: <cylinder>: needs a <length>"},
       {in_geometry("<cone><radius>-1</radius><length>1</length></cone>"),
        "s.sdf:6: <radius>: must be > 0 (-1)"},
       {in_geometry("<ellipsoid><radii>1 0 1</radii></ellipsoid>"), "s.sdf:6: <radii>: must be > 0 (1 0 1)"},
       {in_geometry("<sphere><radius>1</radius></sphere>\n<box><size>1 1 1</size></box>"),
        "s.sdf:7: <box>: a geometry has one shape only"},
       {in_geometry("<sphere/>"), "s.sdf:6: <sphere>: needs a <radius>"},
       {in_geometry("<box><size>1 -1 1</size></box>"), "s.sdf:6: <size>: must be > 0 (1 -1 1)"},
       {in_geometry("<plane/>"), "s.sdf:6: <plane>: needs a static model: it has no mass"},
       {in_geometry("<plane><normal>0 0 0</normal></plane>"), "s.sdf:6: <normal>: must not be zero (0 0 0)"},
       {in_geometry("<mesh><uri>model://x.obj</uri></mesh>"),
        "s.sdf:6: <uri>: only paths and file:// are supported (model://x.obj)"},
       {in_geometry("<mesh><uri>x.dae</uri></mesh>"),
        "s.sdf:6: <uri>: " TUMBLE_SCENES_DIR "/x.dae: only .obj and .stl are supported (.dae)"},
       {in_geometry("<mesh><uri>none.obj</uri></mesh>"),
        "s.sdf:6: <uri>: " TUMBLE_SCENES_DIR "/none.obj: cannot be read"},
       {in_geometry("<mesh><uri>meshes/tetrahedron.obj</uri>\n<scale>1 0 1</scale></mesh>"),
        "s.sdf:7: <scale>: must be > 0 (1 0 1)"},
       {in_geometry("<tumble:convex_hull><tumble:points>1 2 3 4</tumble:points></tumble:convex_hull>"),
        "s.sdf:6: <tumble:points>: must be three numbers a point, is (4)"}});
  const std::string flat = error_of(in_geometry(
      "<tumble:convex_hull><tumble:points>0 0 0 1 0 0 0 1 0 1 1 0</tumble:points></tumble:convex_hull>"));
  EXPECT_EQ(flat.find("s.sdf:6: <tumble:points>: "), 0u) << flat;
}

TEST(SdfError, Materials) {
  const auto surface = [](const std::string& text) {
    return in_link("<collision name='c'><geometry><sphere><radius>1</radius></sphere></geometry>\n<surface>" +
                   text + "</surface></collision>");
  };
  check({{surface("<friction><ode><mu>-1</mu></ode></friction>"), "s.sdf:6: <mu>: must be >= 0 (-1)"},
         {surface("<bounce><restitution_coefficient>1.5</restitution_coefficient></bounce>"),
          "s.sdf:6: <restitution_coefficient>: must be in 0..1 (1.5)"},
         {in_link("<collision "
                  "name='c'><geometry><sphere><radius>1</radius></sphere></geometry><density>0</density></"
                  "collision>"),
          "s.sdf:5: <density>: must be > 0 (0)"},
         {beside_ball("<visual name='v'><material><diffuse>2 0 0 1</diffuse></material></visual>"),
          "s.sdf:6: <diffuse>: must be in 0..1 (2)"},
         {beside_ball("<visual name='v'><material><diffuse>1 0</diffuse></material></visual>"),
          "s.sdf:6: <diffuse>: must be 3 or 4 numbers (1 0)"}});
}

TEST(SdfError, Inertia) {
  check(
      {{in_link("<inertial><mass>-2</mass></inertial>"), "s.sdf:5: <mass>: must be > 0 (-2)"},
       {in_link("<inertial><mass>2</mass></inertial>"),
        "s.sdf:5: <inertial>: has a <mass>, but neither <inertia> nor a solid <collision>"},
       {in_link("<inertial><inertia><ixx>1</ixx><iyy>1</iyy><izz>1</izz></inertia></inertial>"),
        "s.sdf:5: <inertial>: has an <inertia>, but no <mass>"},
       {with_moments("<ixx>1</ixx><iyy>1</iyy>"), "s.sdf:6: <inertia>: needs a <izz>"},
       {with_moments("<ixx>1</ixx><iyy>1</iyy><izz>-1</izz>"), "s.sdf:6: <izz>: must be > 0 (-1)"},
       {in_link(""), "s.sdf:4: <link>: needs a <collision> or an <inertial> with mass and inertia"},
       {beside_ball("<inertial auto='maybe'/>"), "s.sdf:6: <inertial auto>: must be true or false (maybe)"}});
  const std::string triangle = error_of(with_moments("<ixx>1</ixx><iyy>1</iyy><izz>2.5</izz>"));
  EXPECT_EQ(triangle.find("s.sdf:6: <inertia>: "), 0u) << triangle;
  EXPECT_NE(triangle.find("2.5"), std::string::npos) << triangle;
  const std::string indefinite = error_of(with_moments("<ixx>1</ixx><iyy>1</iyy><izz>1</izz><ixy>3</ixy>"));
  EXPECT_EQ(indefinite.find("s.sdf:6: <inertia>: "), 0u) << indefinite;
}

TEST(SdfError, ComputedInertiasAreCheckedToo) {
  // The mass overflows, whether the inertia is the collision's own or scaled.
  const std::string huge =
      "<collision "
      "name='c'><geometry><sphere><radius>1e100</radius></sphere></geometry><density>1e300</density></"
      "collision>";
  EXPECT_EQ(error_of(in_link(huge)).find("s.sdf:4: <link>: "), 0u) << error_of(in_link(huge));
  const std::string scaled = in_link(huge + "\n<inertial><mass>1</mass></inertial>");
  EXPECT_EQ(error_of(scaled).find("s.sdf:6: <inertial>: "), 0u) << error_of(scaled);
}

TEST(SdfError, NamesAndReferences) {
  check(
      {{in_world(ball_model("a") + "\n" + ball_model("a")), "s.sdf:4: <model name>: is used twice (a)"},
       {in_world(ball_model("")),
        "s.sdf:3: <model>: a body's name must be 1..63 printable ASCII characters ()"},
       {in_world(ball_model(std::string(64, 'x'))),
        "s.sdf:3: <model>: a body's name must be 1..63 printable ASCII characters (" + std::string(60, 'x') +
            "...)"},
       {in_world(ball_model("world")), "s.sdf:3: <model>: is a reserved name (world)"},
       {in_world("<model name='a'/>"), "s.sdf:3: <model>: needs a <link> (a)"},
       {beside_ball(
            "<collision name='c'><geometry><sphere><radius>1</radius></sphere></geometry></collision>"),
        "s.sdf:6: <collision name>: is used twice in this link (c)"},
       {two_balls("<tumble:rope name='r'><tumble:a body='zz'>0 0 0</tumble:a><tumble:b body='b'>0 0 "
                  "0</tumble:b></tumble:rope>"),
        "s.sdf:4: <tumble:a body>: unknown body (zz)"},
       {two_balls("<tumble:rope name='r'><tumble:a>0 0 0</tumble:a><tumble:b>1 0 0</tumble:b></tumble:rope>"),
        "s.sdf:4: <tumble:rope>: neither end is at a dynamic body (r)"},
       {two_balls("<tumble:rope name='r'><tumble:a body='a'>0 0 0</tumble:a><tumble:b body='a'>1 0 "
                  "0</tumble:b></tumble:rope>"),
        "s.sdf:4: <tumble:rope>: both ends are at the same body (a)"},
       {two_balls("<tumble:rope name='r'><tumble:a>0 0 0</tumble:a><tumble:b body='a'>0 0 "
                  "0</tumble:b></tumble:rope>"),
        "s.sdf:4: <tumble:rope>: its ends coincide: give a <tumble:length> (r)"},
       {two_balls("<tumble:spring name='s'><tumble:a body='a'>0 0 0</tumble:a><tumble:b body='b'>0 0 "
                  "0</tumble:b></tumble:spring>"),
        "s.sdf:4: <tumble:spring>: needs a <tumble:stiffness>"},
       {in_world(ball_model("a") + "\n<state><model name='b'><link name='l'/></model></state>"),
        "s.sdf:4: <link>: no such body (b::l)"},
       {in_world(ball_model("a", "<static>1</static>") +
                 "\n<state><model name='a'><link name='l'>\n<velocity>1 0 0 0 0 0</velocity>"
                 "</link></model></state>"),
        "s.sdf:5: <velocity>: a static body has no velocity (a)"}});
}

TEST(SdfError, WhatWouldChangeTheMotionIsRefused) {
  check({{in_world("<joint name='j' type='fixed'/>"),
          "s.sdf:3: <joint>: stands within a <model>; bodies of two models are joined by <tumble:joint>"},
         {in_world("<include><uri>x</uri></include>"),
          "s.sdf:3: <include>: only meshes can be included, by <mesh><uri>"},
         {in_world("<model name='a'>\n<model name='b'/></model>"),
          "s.sdf:4: <model>: nested models are not supported: write them side by side"},
         {in_world("<model name='a' placement_frame='l'/>"),
          "s.sdf:3: <model placement_frame>: is not supported: place the model's own frame (l)"},
         {in_world("<state>\n<deletions/></state>"),
          "s.sdf:4: <deletions>: is not supported: take the models out of the world"}});
}

TEST(SdfError, OwnTagsAreNeverIgnored) {
  check(
      {{in_world("<tumble:sprng name='s'/>"), "s.sdf:3: <tumble:sprng>: unknown here (inside <world>)"},
       {beside_ball("<visual name='v' tumble:x='1'/>"), "s.sdf:6: <visual tumble:x>: unknown attribute (1)"},
       {in_world("<physics>\n<tumble:solver>magic</tumble:solver></physics>"),
        "s.sdf:4: <tumble:solver>: unknown name (magic)"},
       {in_world("<physics>\n<tumble:integrator>euler</tumble:integrator></physics>"),
        "s.sdf:4: <tumble:integrator>: unknown name (euler)"},
       {in_world("<physics>\n<tumble:accuracy>super</tumble:accuracy></physics>"),
        "s.sdf:4: <tumble:accuracy>: unknown name (super)"}});
}

TEST(SdfError, OptionsOutOfRangeNameTheirLine) {
  for (const char* tag :
       {"max_step_size", "tumble:contact_margin", "tumble:push_fraction", "tumble:restitution_threshold"}) {
    const std::string error =
        error_of(in_world("<physics>\n<" + std::string(tag) + ">-3</" + tag + "></physics>"));
    EXPECT_EQ(error.find("s.sdf:4: <" + std::string(tag) + ">: "), 0u) << error;
    EXPECT_NE(error.find("-3"), std::string::npos) << error;
  }
}

TEST(SdfError, Populations) {
  check({{population("<distribution><type>random</type></distribution>"),
          "s.sdf:3: <population>: needs a <model_count>"},
         {population("<model_count>0</model_count>"),
          "s.sdf:4: <model_count>: must be an integer in 1..1000000 (0)"},
         {population("<model_count>5</model_count>\n<distribution><type>random</type></distribution>"),
          "s.sdf:5: <distribution>: needs a <box> or <cylinder> of the population to fill (random)"},
         {population("<model_count>5</model_count>\n<distribution><type>heap</type></distribution>"),
          "s.sdf:5: <type>: must be random, uniform, grid, linear-x, linear-y or linear-z (heap)"},
         {population("<model_count>5</model_count>\n<distribution><type>grid</type><rows>2</rows><cols>2</"
                     "cols><step>1 1 1</step>"
                     "</distribution>"),
          "s.sdf:5: <distribution>: the grid has fewer places than models (4)"},
         {population("<model_count>5</model_count><box>\n<size>-1 1 1</size></box>"),
          "s.sdf:5: <size>: must be >= 0 (-1 1 1)"},
         {in_world(ball_model("b_1") + "\n<population name='p'>" + ball_model("b") +
                   "<model_count>2</model_count><box><size>9 9 "
                   "9</size></box><distribution><type>linear-x</type></distribution></population>"),
          "s.sdf:4: <population name>: is used twice (b_1)"}});
}

}  // namespace
}  // namespace tumble
