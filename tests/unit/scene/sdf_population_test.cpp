// Populations: where the copies stand, and that chance is reproducible.
#include <gtest/gtest.h>

#include <array>

#include "scene/sdf_element.h"
#include "scene_bits.h"
#include "scene_text.h"

namespace tumble {
namespace {

std::string population(const std::string& name, const std::string& rest) {
  return "<population name='" + name + "'>" + ball_model(name) + rest + "</population>";
}

std::vector<BodyDefinition> bodies_of(const std::string& rest) {
  return read(in_world(population("p", rest))).scene.bodies;
}

TEST(SdfPopulation, GridIsCentredAndCountsColumnsRowsLayers) {
  const auto bodies = bodies_of(
      "<pose>10 20 30 0 0 0</pose><model_count>12</model_count><distribution><type>grid</type><rows>2</rows>"
      "<cols>3</cols><tumble:layers>2</tumble:layers><step>1 2 4</step></distribution>");
  ASSERT_EQ(bodies.size(), 12u);
  EXPECT_EQ(bodies[0].name, "p_0");
  EXPECT_EQ(bodies[0].X_WL.p, Vec3(9, 19, 28));
  EXPECT_EQ(bodies[1].X_WL.p, Vec3(10, 19, 28));
  EXPECT_EQ(bodies[3].X_WL.p, Vec3(9, 21, 28));
  EXPECT_EQ(bodies[6].X_WL.p, Vec3(9, 19, 32));
  EXPECT_EQ(bodies[11].name, "p_11");
  EXPECT_EQ(bodies[11].X_WL.p, Vec3(11, 21, 32));
}

TEST(SdfPopulation, LinesFillTheRegion) {
  const std::array<const char*, 3> types = {"linear-x", "linear-y", "linear-z"};
  for (int axis = 0; axis < 3; ++axis) {
    const auto bodies =
        bodies_of("<model_count>4</model_count><box><size>8 8 8</size></box><distribution><type>" +
                  std::string(types[static_cast<std::size_t>(axis)]) + "</type></distribution>");
    ASSERT_EQ(bodies.size(), 4u);
    for (int i = 0; i < 4; ++i)
      EXPECT_EQ(bodies[static_cast<std::size_t>(i)].X_WL.p, Vec3((2.0 * i - 3.0) * Vec3::Unit(axis)));
  }
}

TEST(SdfPopulation, UniformKeepsADistance) {
  const auto bodies = bodies_of(
      "<model_count>27</model_count><box><size>3 3 3</size></box>"
      "<distribution><type>uniform</type></distribution>");
  ASSERT_EQ(bodies.size(), 27u);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) EXPECT_GE((bodies[i].X_WL.p - bodies[j].X_WL.p).norm(), 1.0 - 1e-15);
  }
}

TEST(SdfPopulation, RegionsHoldTheirModels) {
  for (const char* type : {"random", "uniform"}) {
    const auto bodies = bodies_of(
        "<model_count>200</model_count><cylinder><radius>2</radius><length>6</length></cylinder>"
        "<distribution><type>" +
        std::string(type) + "</type></distribution>");
    ASSERT_EQ(bodies.size(), 200u);
    double highest = 0.0, widest = 0.0;
    for (const BodyDefinition& body : bodies) {
      highest = std::max(highest, std::abs(body.X_WL.p.z()));
      widest = std::max(widest, body.X_WL.p.head<2>().norm());
    }
    EXPECT_LE(highest, 3.0);
    EXPECT_LE(widest, 2.0);
    EXPECT_GT(highest, 2.5) << type;  // 2.99 and 2.63 measured
    EXPECT_GT(widest, 1.7) << type;   // 2.00 and 1.89 measured
  }
}

TEST(SdfPopulation, SameSeedSameBitsWhateverElseIsThere) {
  const std::string random =
      population("p",
                 "<model_count>50</model_count><box><size>9 9 9</size></box><distribution>"
                 "<type>random</type><tumble:random_rotation>true</tumble:random_rotation></distribution>");
  const std::string other =
      population("o",
                 "<model_count>9</model_count><box><size>9 9 9</size></box><distribution>"
                 "<type>random</type></distribution>");
  const auto text = [&](int seed, const std::string& more) {
    return in_world("<tumble:seed>" + std::to_string(seed) + "</tumble:seed>" + more + random);
  };
  const Scene first = read(text(1, "")).scene;
  EXPECT_TRUE(SceneBits(first) == SceneBits(read(text(1, "")).scene));
  EXPECT_FALSE(SceneBits(first) == SceneBits(read(text(2, "")).scene));
  Scene with_other = read(text(1, other)).scene;
  with_other.bodies.erase(with_other.bodies.begin(), with_other.bodies.begin() + 9);
  EXPECT_TRUE(SceneBits(first) == SceneBits(with_other));
  // The very bits: a change of the generator or of its order of use would change everybody's scenes.
  EXPECT_EQ(to_shortest_text(first.bodies[0].X_WL.p.x()), "-3.6694685751768814");
}

TEST(SdfPopulation, JitterStaysInItsBoxAndTurnsAreUnit) {
  const auto bodies = bodies_of(
      "<model_count>1000</model_count><distribution><type>grid</type><cols>1000</cols><step>0 0 0</step>"
      "<tumble:jitter>0.1 0.2 0</tumble:jitter><tumble:random_rotation>true</tumble:random_rotation>"
      "</distribution>");
  Vec3 largest = Vec3::Zero();
  Mat3 mean = Mat3::Zero();
  for (const BodyDefinition& body : bodies) {
    largest = largest.cwiseMax(body.X_WL.p.cwiseAbs());
    EXPECT_NEAR(body.X_WL.q.squaredNorm(), 1.0, 1e-14);
    mean += body.X_WL.q.toRotationMatrix() / 1000.0;
  }
  EXPECT_LE(largest.x(), 0.1);
  EXPECT_LE(largest.y(), 0.2);
  EXPECT_EQ(largest.z(), 0.0);
  EXPECT_GT(largest.y(), 0.19);
  // Uniform turns average to zero: each entry has a standard deviation of sqrt(1/3 / 1000) = 0.018.
  EXPECT_LT(mean.cwiseAbs().maxCoeff(), 0.073);  // 4 sigma
}

TEST(SdfPopulation, ModelsOfSeveralLinksMoveAsOne) {
  const Scene scene =
      read(in_world(
               "<population name='p'><model name='m'><pose>0 0 1 0 0 0</pose><link "
               "name='x'><inertial><mass>1</mass><inertia><ixx>1</ixx><iyy>1</iyy>"
               "<izz>1</izz></inertia></inertial></link><link name='y'><pose>0 3 0 0 0 "
               "0</pose><inertial><mass>1</mass><inertia><ixx>1</ixx>"
               "<iyy>1</iyy><izz>1</izz></inertia></inertial></link></model><pose>0 0 0 0 0 "
               "1.5707963267948966</pose><model_count>2</model_count>"
               "<distribution><type>grid</type><cols>2</cols><step>4 0 0</step></distribution></population>"))
          .scene;
  ASSERT_EQ(scene.bodies.size(), 4u);
  EXPECT_EQ(scene.bodies[3].name, "m_1::y");
  EXPECT_LT((scene.bodies[3].X_WL.p - Vec3(-3, 2, 1)).norm(), 1e-15);
}

}  // namespace
}  // namespace tumble
