// <joint> in a model and <tumble:joint> between bodies: where the ends are, and what is refused.
#include <gtest/gtest.h>

#include "scene_bits.h"
#include "scene_text.h"

namespace tumble {
namespace {

const std::string kBall =
    "<collision name='c'><geometry><sphere><radius>0.5</radius></sphere></geometry></collision>";

std::string link(const std::string& name, const std::string& pose) {
  return "<link name='" + name + "'><pose>" + pose + "</pose>" + kBall + "</link>";
}

std::string two_links(const std::string& joint) {
  return in_world("<model name='arm'><pose>10 0 0 0 0 0</pose>" + link("upper", "0 0 1 0 0 0") +
                  link("lower", "0 0 -1 0 0 1.5707963267948966") + "\n" + joint + "</model>");
}

TEST(SdfJoint, MeetsWhereTheChildIs) {
  const Scene scene =
      read(two_links("<joint name='elbow' type='ball'><parent>upper</parent><child>lower</child></joint>"))
          .scene;
  ASSERT_EQ(scene.joints.size(), 1u);
  const SceneJoint& joint = scene.joints.front();
  EXPECT_EQ(joint.name, "arm::elbow");
  EXPECT_EQ(joint.kind, JointKind::ball);
  EXPECT_EQ(joint.a.body, "arm::upper");
  EXPECT_EQ(joint.b.body, "arm::lower");
  EXPECT_EQ(joint.a.p, Vec3(0.0, 0.0, -2.0));
  EXPECT_EQ(joint.b.p, Vec3::Zero());
}

TEST(SdfJoint, ItsPoseIsRelativeToTheChildOrToWhatItSays) {
  const auto ends = [](const std::string& pose, const std::string& parent) {
    return read(two_links("<joint name='j' type='fixed'>" + pose + "<parent>" + parent +
                          "</parent><child>lower</child></joint>"))
        .scene.joints.front();
  };
  const SceneJoint of_child = ends("<pose>1 0 0.5 0 0 0</pose>", "upper");
  EXPECT_LT((of_child.b.p - Vec3(1.0, 0.0, 0.5)).norm(), 1e-15);
  EXPECT_LT((of_child.a.p - Vec3(0.0, 1.0, -1.5)).norm(), 1e-15);  // the child is turned by 90 degrees
  const SceneJoint of_model = ends("<pose relative_to='__model__'>0 2 -1 0 0 0</pose>", "upper");
  EXPECT_LT((of_model.b.p - Vec3(2.0, 0.0, 0.0)).norm(), 1e-15);
  const SceneJoint of_world = ends("", "world");
  EXPECT_EQ(of_world.a.body, "");
  EXPECT_LT((of_world.a.p - Vec3(10.0, 0.0, -1.0)).norm(), 1e-15);
}

TEST(SdfJoint, EveryCopyOfAPopulationHasItsOwn) {
  const Scene scene = read(in_world("<population name='p'><model name='m'>" + link("a", "0 0 0 0 0 0") +
                                    link("b", "0 0 2 0 0 0") +
                                    "<joint name='j' type='ball'><parent>a</parent><child>b</child></joint>"
                                    "</model><model_count>3</model_count><distribution><type>grid</type>"
                                    "<cols>3</cols><step>5 5 5</step></distribution></population>"))
                          .scene;
  ASSERT_EQ(scene.joints.size(), 3u);
  EXPECT_EQ(scene.joints[2].name, "m_2::j");
  EXPECT_EQ(scene.joints[2].b.body, "m_2::b");
  EXPECT_NO_THROW(build_world(scene));
}

TEST(SdfJoint, WhatIsWrittenReadsBackToTheBit) {
  const Scene scene =
      read(two_links("<joint name='j' type='fixed'><pose>0.1 0.2 0.3 0 0 0</pose><parent>upper</parent>"
                     "<child>lower</child></joint><joint name='k' type='ball'><parent>world</parent>"
                     "<child>upper</child></joint>"))
          .scene;
  const Scene again = read_sdf_text(write_sdf(scene), "written.sdf", "").scene;
  EXPECT_EQ(again.joints.size(), 2u);
  EXPECT_TRUE(SceneBits(again) == SceneBits(scene));
}

TEST(SdfJoint, WhatCannotBeHeldIsAnErrorWithItsLine) {
  const auto error = [](const std::string& joint) { return error_of(two_links(joint)); };
  const auto joint = [](const std::string& type, const std::string& parent, const std::string& child) {
    return "<joint name='j' type='" + type + "'><parent>" + parent + "</parent><child>" + child +
           "</child></joint>";
  };
  EXPECT_EQ(error(joint("revolute", "upper", "lower")),
            "s.sdf:4: <joint type>: must be ball or fixed (revolute)");
  EXPECT_EQ(error(joint("ball", "hand", "lower")),
            "s.sdf:4: <parent>: unknown: must be a link of this model or world (hand)");
  EXPECT_EQ(error(joint("ball", "lower", "lower")), "s.sdf:4: <joint>: both ends are the same (j)");
  EXPECT_EQ(error(joint("ball", "upper", "lower") + joint("ball", "upper", "lower")),
            "s.sdf:4: <joint name>: is empty or used twice in this model (j)");
}

}  // namespace
}  // namespace tumble
