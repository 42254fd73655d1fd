// Box against box over twelve classes of poses, against every axis in 80-bit arithmetic.
#include "collision/collide_box_box.h"

#include <gtest/gtest.h>

#include "collision/axis_preference.h"
#include "collision/narrow_phase.h"
#include "math/rotation.h"
#include "polytope_reference.h"
#include "random_pose.h"

namespace tumble::test {
namespace {

constexpr int kPoses = 20000;

struct Case {
  Box a{Vec3::Ones()}, b{Vec3::Ones()};
  Pose X_WA, X_WB;
  double size() const { return a.half_extents.norm() + b.half_extents.norm(); }
};

Box random_box(RandomPose& random, double scale) {
  return {scale * random.vector(0.3, 1.0)};
}

/// B's lowest part along A's +z, when B is turned by q_AB, touches A's top at a random place and sinks in by depth.
Case rest_on_top(RandomPose& random, double scale_a, double scale_b, const Quat& q_AB, double depth) {
  Case c;
  c.a = random_box(random, scale_a);
  c.b = random_box(random, scale_b);
  const double height = rotation_matrix(q_AB).row(2).cwiseAbs().dot(c.b.half_extents.transpose());
  const double x = random.uniform(-0.6, 0.6), y = random.uniform(-0.6, 0.6);
  const Pose X_AB{
      q_AB, Vec3(x * c.a.half_extents.x(), y * c.a.half_extents.y(), c.a.half_extents.z() + height - depth)};
  c.X_WA = random.pose(10.0);
  c.X_WB = c.X_WA * X_AB;
  return c;
}

Case face_on_face(RandomPose& random, double tilt, double scale = 1.0) {
  const double yaw = random.uniform(-3.0, 3.0), depth = scale * random.log_uniform(1e-6, 1e-2);
  const Vec3 axis = random.direction();
  return rest_on_top(random, scale, scale, turn(axis, tilt) * turn(Vec3::UnitZ(), yaw), depth);
}

Case random_overlap(RandomPose& random, double reach) {
  Case c;
  c.a = random_box(random, 1.0);
  c.b = random_box(random, 1.0);
  c.X_WA = random.pose(10.0);
  const Pose X_AB = random.pose(reach);
  c.X_WB = c.X_WA * X_AB;
  return c;
}

Case aligned_stack(RandomPose& random) {
  Case c;
  const Vec3 h = random.vector(0.3, 1.0);
  c.a = c.b = {h};
  const double depth = random.log_uniform(1e-6, 1e-2);
  c.X_WA.p = random.vector(-10.0, 10.0);
  c.X_WB = {Quat::Identity(), c.X_WA.p + Vec3(0, 0, 2.0 * h.z() - depth)};
  return c;
}

/// Two edges that cross under 90 degrees, each the roof of its box turned by about 45 degrees.
Case edge_on_edge(RandomPose& random) {
  Case c;
  c.a = random_box(random, 1.0);
  c.b = random_box(random, 1.0);
  const double roll_a = random.uniform(0.5, 1.0), roll_b = random.uniform(0.5, 1.0),
               yaw = random.uniform(0.4, 2.7);
  const double depth = random.log_uniform(1e-6, 1e-2);
  const Quat q_A = turn(Vec3::UnitX(), roll_a);
  const Quat q_B = turn(Vec3::UnitZ(), yaw) * turn(Vec3::UnitX(), roll_b);
  const Vec3 roof_a = q_A * Vec3(0, c.a.half_extents.y(), c.a.half_extents.z());
  const Vec3 floor_b = q_B * Vec3(0, -c.b.half_extents.y(), -c.b.half_extents.z());
  const Pose X_W = random.pose(10.0);
  c.X_WA = X_W * Pose{q_A, -roof_a};
  c.X_WB = X_W * Pose{q_B, -floor_b - Vec3(0, 0, depth)};
  return c;
}

Case vertex_on_face(RandomPose& random) {
  const Quat q_AB = random.rotation();
  const double depth = random.log_uniform(1e-6, 1e-2);
  return rest_on_top(random, 3.0, 1.0, q_AB, depth);
}

Case one_to_thousand(RandomPose& random) {
  const Quat q_AB = random.rotation();
  const double depth = random.log_uniform(1e-6, 1e-2);
  return rest_on_top(random, 1000.0, 1.0, q_AB, depth);
}

Case touching(RandomPose& random) {
  const Quat q_AB = random.rotation();
  return rest_on_top(random, 2.0, 1.0, q_AB, 0.0);
}

struct Class {
  const char* name;
  Case (*make)(RandomPose&);
};

class BoxBox : public testing::TestWithParam<Class> {};

/// Largest errors of one class, as parts of the size where they are lengths.
struct Errors {
  int missed = 0, invented = 0, contacts = 0, worse_than_preference = 0;
  double depth = 0.0, deepest = 0.0, normal = 0.0;
};

void judge(const Case& c, Errors& errors) {
  const BoxFeatures a(c.a), b(c.b);
  const PolytopeReference truth(a.view(), c.X_WA, b.view(), c.X_WB);
  PairCache cache;
  NarrowPhaseCounters counters;
  const Manifold m = collide(Shape(c.a), c.X_WA, Shape(c.b), c.X_WB, 0.0, {}, cache, counters);
  const double round_off = 1e-13 * c.size();
  if (m.count == 0) {
    errors.missed += truth.separation() < -round_off;
    return;
  }
  ++errors.contacts;
  errors.invented += truth.separation() > round_off;
  const double along = static_cast<double>(truth.separation_along(m.normal_A.cast<long double>()));
  const double radius = std::min(c.a.half_extents.norm(), c.b.half_extents.norm());
  const double behind = truth.separation() - along;
  errors.normal = std::max(errors.normal, truth.angle_to_axis(m.normal_A));
  // Behind the best axis only by what AxisPreference allows; then the depth is that of the preferred one.
  if (behind > round_off) {
    errors.worse_than_preference += behind > AxisPreference::of(radius).edge;
  } else {
    errors.depth = std::max(errors.depth, std::abs(truth.separation() - along) / c.size());
    errors.deepest = std::max(errors.deepest, std::abs(truth.separation() + deepest(m)) / c.size());
  }
}

TEST_P(BoxBox, AgreesWithEveryAxisInLongDouble) {
  RandomPose random(1);
  Errors errors;
  for (int i = 0; i < kPoses; ++i) judge(GetParam().make(random), errors);
  EXPECT_EQ(errors.missed, 0);
  EXPECT_EQ(errors.invented, 0);
  EXPECT_EQ(errors.worse_than_preference, 0);
  EXPECT_GT(errors.contacts, kPoses / 3);
  EXPECT_LE(errors.depth, 1e-13);    // measured 1.3e-15 at most
  EXPECT_LE(errors.deepest, 1e-13);  // measured 1.7e-15 at most
  EXPECT_LE(errors.normal, 1e-12);   // measured 2.7e-15 at most
}

INSTANTIATE_TEST_SUITE_P(
    Classes, BoxBox,
    testing::Values(Class{"random_deep", [](RandomPose& r) { return random_overlap(r, 0.5); }},
                    Class{"random_any", [](RandomPose& r) { return random_overlap(r, 1.2); }},
                    Class{"tilt_0", [](RandomPose& r) { return face_on_face(r, 0.0); }},
                    Class{"tilt_1e9", [](RandomPose& r) { return face_on_face(r, 1e-9); }},
                    Class{"tilt_1e6", [](RandomPose& r) { return face_on_face(r, 1e-6); }},
                    Class{"tilt_1e3", [](RandomPose& r) { return face_on_face(r, 1e-3); }},
                    Class{"aligned_stack", aligned_stack}, Class{"edge_on_edge", edge_on_edge},
                    Class{"vertex_on_face", vertex_on_face}, Class{"one_to_thousand", one_to_thousand},
                    Class{"millimetres", [](RandomPose& r) { return face_on_face(r, 1e-3, 1e-3); }},
                    Class{"touching", touching}),
    [](const auto& test) { return std::string(test.param.name); });

}  // namespace
}  // namespace tumble::test
