// Closest points: against every pair of features in 80-bit arithmetic, against closed forms, and as bounds that hold.
#include "collision/distance.h"

#include <gtest/gtest.h>

#include "collision/box_polytope.h"
#include "collision/segment.h"
#include "distance_reference.h"
#include "math/rotation.h"
#include "sample_shapes.h"

namespace tumble::test {
namespace {

struct Errors {
  int overlaps = 0, most_iterations = 0;
  double truth = 0.0, distance = 0.0, bounds = 0.0, points = 0.0, plane = 0.0;  // shares of the size
};

const Polytope& polytope_of(const Shape& shape, const BoxPolytope& box) {
  const HullPointer* hull = std::get_if<HullPointer>(&shape);
  if (hull != nullptr) return **hull;
  return box;
}

void judge(const Shape& a, const Shape& b, const Pose& X_AB, Errors& errors) {
  const Box* box_a = std::get_if<Box>(&a);
  const Box* box_b = std::get_if<Box>(&b);
  const BoxPolytope features_a(box_a != nullptr ? *box_a : Box{Vec3::Ones()});
  const BoxPolytope features_b(box_b != nullptr ? *box_b : Box{Vec3::Ones()});
  const DistanceReference reference(polytope_of(a, features_a), polytope_of(b, features_b), X_AB);
  const double size = bounding_radius(a) + bounding_radius(b);
  const double truth = static_cast<double>(reference.distance());
  const auto worsen = [size](double& error, double by) { error = std::max(error, std::abs(by) / size); };
  const Distance d = compute_distance(a, b, X_AB);
  worsen(errors.truth, static_cast<double>(reference.distance() - reference.dual()));
  worsen(errors.distance, d.upper - truth);
  errors.most_iterations = std::max(errors.most_iterations, d.iterations);
  errors.overlaps += d.overlap;
  if (d.overlap) return;
  EXPECT_LE(d.lower, truth);
  EXPECT_NEAR(d.axis_A.norm(), 1.0, 1e-14);
  worsen(errors.bounds, d.upper - d.lower);
  worsen(errors.points, (d.b_A - d.a_A).norm() - d.upper);
  worsen(errors.plane,
         std::max(0.0, d.lower - separation_along(a, b, rotation_matrix(X_AB.q), X_AB.p, d.axis_A)));
}

void expect_exact(const Errors& errors) {
  EXPECT_LE(errors.truth, 1e-17);     // measured 5e-18: the reference's two bounds meet
  EXPECT_LE(errors.distance, 1e-14);  // measured 5e-15 at a tilt of 1e-9, 7e-16 in all other classes
  EXPECT_LE(errors.bounds, 5e-14);    // measured 3.4e-14: twice the rounding that the lower one deducts
  EXPECT_LE(errors.points, 2e-15);    // measured 7e-16
  EXPECT_EQ(errors.plane, 0.0);
  EXPECT_LE(errors.most_iterations, 20);  // measured 12
  EXPECT_EQ(errors.overlaps, 0);
}

/// Faces, edges and corners, tilted by next to nothing, of very different sizes, thin and flat; gaps of 1e-12..3 m.
TEST(Distance, BoxesAgainstEveryPairOfFeatures) {
  enum Kind { any, face, tilt_9, tilt_6, tilt_3, edge, big, needle, flat, kinds };
  RandomPose random(1);
  for (int kind = any; kind < kinds; ++kind) {
    SCOPED_TRACE(kind);
    Errors errors;
    for (int i = 0; i < 2000; ++i) {
      Box a{random.vector(0.3, 1.0)}, b{random.vector(0.3, 1.0)};
      if (kind == big) a.half_extents *= 1000.0;
      if (kind == needle) b.half_extents.x() *= 1e-3, b.half_extents.y() *= 1e-3;
      if (kind == flat) b.half_extents.x() *= 1e-3, a.half_extents.z() *= 1e-3;
      Quat q = random.rotation();
      Vec3 d = random.direction();
      if (kind >= face && kind <= tilt_3) {
        constexpr double kTilts[] = {0.0, 1e-9, 1e-6, 1e-3};
        q = turn(d, kTilts[kind - face]);
        d = Vec3::Unit(i % 3);
      }
      if (kind == edge) d = Vec3::Unit(i % 3).cross(q * Vec3::Unit(i / 3 % 3)).normalized();
      Pose X_AB = place_apart(a, b, d, q, random.log_uniform(1e-12, 3.0));
      X_AB.p += random.uniform(-0.3, 0.3) * perpendicular_to(d);
      judge(a, b, X_AB, errors);
    }
    expect_exact(errors);
  }
}

TEST(Distance, HullsAgainstEveryPairOfFeatures) {
  RandomPose random(2);
  Errors errors;
  for (const int points : {8, 32}) {
    for (int i = 0; i < 4; ++i) {
      const Vec3 radii_a = random.vector(0.3, 1.0), radii_b = random.vector(0.3, 1.0);
      const HullPointer a = random_hull(random, points, radii_a), b = random_hull(random, points, radii_b);
      for (int k = 0; k < 50; ++k) {
        const Vec3 d = random.direction();
        const Quat q = random.rotation();
        judge(a, b, place_apart(a, b, d, q, random.log_uniform(1e-12, 3.0)), errors);
      }
    }
  }
  expect_exact(errors);
}

TEST(Distance, RoundShapesInClosedForm) {
  RandomPose random(3);
  double error = 0.0;
  for (int i = 0; i < 5000; ++i) {
    const Sphere sphere{random.log_uniform(1e-3, 1.0)};
    const Capsule a{random.log_uniform(1e-3, 1.0), random.log_uniform(1e-3, 1.0)};
    const Capsule b{random.log_uniform(1e-3, 1.0), random.log_uniform(1e-3, 1.0)};
    const Pose X_AB = random.pose(3.0);
    const Segment core_a{Vec3::Zero(), Vec3(0, 0, a.half_length)},
        core_b{X_AB.p, X_AB.q * Vec3(0, 0, b.half_length)};
    const SegmentPair closest = closest_points(core_a, core_b);
    const double between = (closest.p_B - closest.p_A).norm() - a.radius - b.radius;
    const Distance capsules = compute_distance(a, b, X_AB);
    EXPECT_EQ(capsules.overlap, between <= 0.0);
    error = std::max(error, std::abs(capsules.upper - std::max(between, 0.0)));
    const double from_core =
        (X_AB.p - core_a.at(core_a.closest_parameter(X_AB.p))).norm() - a.radius - sphere.radius;
    const Distance ball = compute_distance(a, sphere, X_AB);
    EXPECT_EQ(ball.overlap, from_core <= 0.0);
    error = std::max(error, std::abs(ball.upper - std::max(from_core, 0.0)));
  }
  EXPECT_LE(error, 3e-15);  // measured
}

/// Corners alone and a hull of nothing else: the same supports, the same bits.
TEST(Distance, CornersAreATriangle) {
  RandomPose random(6);
  int overlaps = 0;
  for (int i = 0; i < 200; ++i) {
    const std::array<Vec3, 3> corners = {random.vector(-1, 1), random.vector(-1, 1), random.vector(-1, 1)};
    const auto hull = std::make_shared<const ConvexHull>(
        ConvexHull::Parts{.vertices = {corners.begin(), corners.end()}, .radius = bounding_radius(corners)});
    for (const Shape& a : random_shapes(random)) {
      const Pose X_AB = random.pose(2.0);
      const Distance expected = compute_distance(a, HullPointer(hull), X_AB);
      const Distance distance = compute_distance(a, corners, X_AB);
      EXPECT_EQ(distance.overlap, expected.overlap);
      EXPECT_EQ(distance.lower, expected.lower);
      EXPECT_EQ(distance.upper, expected.upper);
      EXPECT_EQ(distance.a_A, expected.a_A);
      EXPECT_EQ(distance.b_A, expected.b_A);
      overlaps += distance.overlap;
    }
  }
  EXPECT_GT(overlaps, 100);
}

/// Never "apart" when shapes overlap, and a common point of both to show for it.
TEST(Distance, OverlapIsToldWithACommonPoint) {
  RandomPose random(4);
  int overlaps = 0;
  for (int i = 0; i < 200; ++i) {
    const auto as = random_shapes(random), bs = random_shapes(random);
    for (const Shape& a : as) {
      for (const Shape& b : bs) {
        const Vec3 d = random.direction();
        Pose X_AB = place_apart(a, b, d, random.rotation(), 0.0);
        X_AB.p *= random.uniform(0.0, 0.5);
        const Distance distance = compute_distance(a, b, X_AB);
        if (!distance.overlap) {
          const double gap = separation_along(a, b, rotation_matrix(X_AB.q), X_AB.p, distance.axis_A);
          EXPECT_GT(gap, 0.0);
          continue;
        }
        ++overlaps;
        EXPECT_EQ(distance.lower, 0.0);
        EXPECT_EQ(distance.upper, 0.0);
        EXPECT_EQ(distance.a_A, distance.b_A);
        for (int k = 0; k < 20; ++k) {
          const Vec3 n = random.direction(), n_B = X_AB.q.conjugate() * n;
          EXPECT_LE(n.dot(distance.a_A), n.dot(support(a, n)) + 1e-14);
          EXPECT_LE(n_B.dot(X_AB.q.conjugate() * (distance.a_A - X_AB.p)), n_B.dot(support(b, n_B)) + 1e-14);
        }
      }
    }
  }
  EXPECT_GT(overlaps, 2500);
}

/// A warm start, a tolerance and an end beyond some gap save steps and keep the promise of both bounds.
TEST(Distance, EndsEarlyWhenAskedTo) {
  RandomPose random(5);
  int cold = 0, warm = 0, rough = 0, beyond = 0;
  for (int i = 0; i < 500; ++i) {
    const Vec3 radii = random.vector(0.3, 1.0);
    const HullPointer a = random_hull(random, 16, radii), b = random_hull(random, 16, radii);
    const Vec3 d = random.direction();
    const Quat q = random.rotation();
    const Pose X_AB = place_apart(a, b, d, q, 0.1);
    const Distance exact = compute_distance(a, b, X_AB);
    cold += exact.iterations;
    const Distance again = compute_distance(a, b, X_AB, {.start = exact.carriers});
    warm += again.iterations;
    EXPECT_NEAR(again.upper, exact.upper, 1e-15);
    const Distance near = compute_distance(a, b, X_AB, {.tolerance = 0.01});
    rough += near.iterations;
    EXPECT_LE(near.upper - near.lower, 0.01 + 1e-13);
    const Distance far = compute_distance(a, b, X_AB, {.beyond = 0.01});
    beyond += far.iterations;
    EXPECT_GT(far.lower, 0.01);
    for (const Distance& other : {again, near, far}) {
      EXPECT_LE(other.lower, exact.upper);
      EXPECT_GE(other.upper, exact.lower);
    }
    const Distance cut = compute_distance(a, b, X_AB, {.budget = 3});
    EXPECT_LE(cut.iterations, 3);
    EXPECT_GE(cut.upper, exact.lower);
  }
  // measured 3083, 1500, 2465, 1266
  EXPECT_LT(warm, cold / 2);
  EXPECT_LT(rough, cold);
  EXPECT_LT(beyond, rough);
}

}  // namespace
}  // namespace tumble::test
