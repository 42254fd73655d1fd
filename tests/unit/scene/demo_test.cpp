// The demos show what they say, and none starts with bodies inside each other.
#include "scene/demo.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "math/rotation.h"
#include "scene_text.h"

namespace tumble {
namespace {

Scene demo(std::string_view name) {
  SceneReading reading = read_sdf_text(std::string(demo_text(name)), std::string(name) + ".sdf", "");
  EXPECT_TRUE(reading.warnings.empty()) << reading.warnings.front();
  return reading.scene;
}

Inertia inertia_of(const BodyDefinition& body) {
  if (body.inertia) return *body.inertia;
  std::vector<Inertia> parts;
  for (const GeometryDefinition& g : body.geometries) {
    parts.push_back(transformed(compute_inertia(g.shape, g.material.density), g.X_LS));
  }
  return combined(parts);
}

const BodyDefinition& find(const Scene& scene, const std::string& name) {
  return *std::find_if(scene.bodies.begin(), scene.bodies.end(),
                       [&](const auto& body) { return body.name == name; });
}

TEST(Demo, NamesAreSortedAndEveryTextIsThere) {
  const std::vector<std::string_view> expected = {"cradle",  "incline", "pile",    "pyramid",
                                                  "springs", "terrain", "tumbling"};
  EXPECT_EQ(demo_names(), expected);
  for (const std::string_view name : demo_names()) EXPECT_EQ(demo(name).name, name);
  EXPECT_TRUE(demo_text("nothing").empty());
}

TEST(Demo, TheEmbeddedTextsAreTheFiles) {
  for (const std::string_view name : demo_names()) {
    const Scene file = read_sdf(TUMBLE_SCENES_DIR "/" + std::string(name) + ".sdf").scene;
    EXPECT_EQ(write_sdf(file), write_sdf(demo(name)));
  }
}

TEST(Demo, PileIsAThousandBodiesOfFourKindsFurtherApartThanTheyAreLarge) {
  const Scene scene = demo("pile");
  ASSERT_EQ(scene.bodies.size(), 1002u);  // ground and walls
  std::vector<std::pair<Vec3, double>> balls;
  int kinds[kShapeTypes] = {};
  for (const BodyDefinition& body : scene.bodies) {
    if (body.type != BodyType::dynamic) continue;
    ++kinds[body.geometries[0].shape.index()];
    balls.emplace_back(body.X_WL.p, bounding_radius(body.geometries[0].shape));
  }
  for (const std::size_t kind : {1, 2, 3, 4}) EXPECT_EQ(kinds[kind], 250);
  double nearest = 1.0;
  for (std::size_t i = 0; i < balls.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      nearest =
          std::min(nearest, (balls[i].first - balls[j].first).norm() - balls[i].second - balls[j].second);
    }
    EXPECT_GT(balls[i].first.z() - balls[i].second, 0.5);                              // above the plane
    EXPECT_LT(balls[i].first.head<2>().cwiseAbs().maxCoeff() + balls[i].second, 3.0);  // between the walls
  }
  EXPECT_GT(nearest, 0.0);  // 0.016 m measured
}

TEST(Demo, PyramidRowsTouchAndDoNotOverlap) {
  const Scene scene = demo("pyramid");
  ASSERT_EQ(scene.bodies.size(), 211u);
  for (std::size_t i = 2; i < scene.bodies.size(); ++i) {
    const Vec3 step = scene.bodies[i].X_WL.p - scene.bodies[i - 1].X_WL.p;
    if (step.z() != 0.0) {
      EXPECT_EQ(step.z(), 1.0);
    } else {
      EXPECT_NEAR(step.x(), 1.05, 1e-12);
    }
    EXPECT_EQ(step.y(), 0.0);
  }
}

TEST(Demo, TumblingBodiesSpinAboutTheirIntermediateAxis) {
  const Scene scene = demo("tumbling");
  EXPECT_EQ(scene.options.gravity, Vec3(0, 0, 0));
  for (const BodyDefinition& body : scene.bodies) {
    const MassProperties mass = compute_mass_properties(inertia_of(body));
    const Vec3 w_P = mass.q_BP.conjugate() * body.w_WB;
    Eigen::Index axis = 0;
    w_P.cwiseAbs().maxCoeff(&axis);
    const double I = mass.I[axis];
    const int smaller = static_cast<int>(
        std::count_if(mass.I.begin(), mass.I.end(), [&](double other) { return other < 0.98 * I; }));
    EXPECT_EQ(smaller, body.name == "wheel" ? 2 : 1) << body.name << " " << mass.I.transpose();
    EXPECT_GT(std::abs(w_P[axis]), 0.99 * w_P.norm());
    EXPECT_LT(std::abs(w_P[axis]), w_P.norm());
  }
}

TEST(Demo, InclineHasTheFrictionAngleBetweenItsBoxes) {
  const Scene scene = demo("incline");
  const double slope = 25.0 * 3.14159265358979323846 / 180.0;
  const double tangent = sincos(slope).sin / sincos(slope).cos;  // 0.4663
  for (int i = 1; i <= 9; ++i) {
    const BodyDefinition& box = find(scene, "box_" + std::to_string(i));
    const BodyDefinition& ramp = find(scene, "ramp_" + std::to_string(i));
    EXPECT_DOUBLE_EQ(box.geometries[0].material.friction, 0.1 * i);
    EXPECT_EQ(box.geometries[0].material.friction, ramp.geometries[0].material.friction);
    EXPECT_EQ(box.geometries[0].material.friction > tangent, i >= 5);
    // The box lies on its ramp: half heights 0.2 and 0.15 m. 2e-16 measured
    const Vec3 n = ramp.X_WL.q * Vec3::UnitZ();
    EXPECT_NEAR(n.dot(box.X_WL.p - ramp.X_WL.p), 0.35, 1e-15);
    EXPECT_NEAR(n.z(), sincos(slope).cos, 1e-15);
  }
}

TEST(Demo, CradleRopesAreTautAndBallsApart) {
  const Scene scene = demo("cradle");
  ASSERT_EQ(scene.bodies.size(), 5u);
  ASSERT_EQ(scene.ropes.size(), 10u);
  for (const SceneRope& rope : scene.ropes) {
    const double distance = (find(scene, rope.b.body).X_WL * rope.b.p - rope.a.p).norm();
    EXPECT_NEAR(distance, rope.rope.length, 1e-15);  // 2e-16 m measured
  }
  for (std::size_t i = 2; i < 5; ++i) {
    EXPECT_NEAR(scene.bodies[i].X_WL.p.x() - scene.bodies[i - 1].X_WL.p.x(), 0.2 + 1e-9, 1e-15);
  }
}

TEST(Demo, SpringsHoldDynamicBodiesApart) {
  const Scene scene = demo("springs");
  EXPECT_EQ(scene.springs.size(), 8u);
  EXPECT_EQ(scene.ropes.size(), 2u);
  const BodyDefinition& weight = find(scene, "weight");
  const Vec3 top = weight.X_WL * Vec3(0, 0, 0.1);
  EXPECT_NEAR((scene.springs[0].a.p - top).norm(), 1.3, 1e-15);
  EXPECT_GT(top.z() - 0.2 - 2.0 * (0.3 - 2.0 * 9.81 / 200.0),
            0.0);  // stays above the ground when it swings through
}

}  // namespace
}  // namespace tumble
