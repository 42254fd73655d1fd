// Rays: against a point that is moved until it touches (another algorithm), against closed forms, and the rules for rays
// that start on or in a shape.
#include "collision/ray_cast.h"

#include <gtest/gtest.h>

#include "collision/shape_cast.h"
#include "sample_shapes.h"

namespace tumble::test {
namespace {

TEST(RayCast, MeetsWhatAMovedPointMeets) {
  RandomPose random(11);
  int hits = 0, misses = 0, disagree = 0;
  double distance_error = 0.0, normal_error = 0.0;
  for (int i = 0; i < 300; ++i) {
    for (const Shape& shape : random_shapes(random)) {
      for (int k = 0; k < 10; ++k) {
        const Vec3 target = random.vector(-0.8, 0.8), from = 4.0 * random.direction();
        const Ray ray{from, (target - from).normalized(), 10.0};
        const auto hit = cast_ray(shape, ray);
        const auto truth = cast_shape(Sphere{0.0}, shape, {Quat::Identity(), -from}, 10.0 * ray.direction);
        (hit ? hits : misses)++;
        disagree += hit.has_value() != truth.has_value();
        if (!hit || !truth) continue;
        // A grazing ray meets the surface at an angle that multiplies every rounding.
        const double steepness = -hit->normal.dot(ray.direction);
        EXPECT_GE(steepness, 0.0);
        EXPECT_NEAR(hit->normal.norm(), 1.0, 1e-14);
        EXPECT_FALSE(hit->inside);
        distance_error =
            std::max(distance_error, steepness * std::abs(hit->distance - 10.0 * truth->fraction));
        const double edge_or_face = std::abs(
            separation_along(shape, Sphere{0.0}, Mat3::Identity(), ray.at(hit->distance), hit->normal));
        normal_error = std::max(normal_error, edge_or_face);
      }
    }
  }
  EXPECT_GT(hits, 5000);
  EXPECT_GT(misses, 1000);
  EXPECT_EQ(disagree, 0);
  EXPECT_LE(distance_error, 2e-13);  // measured 6e-14
  EXPECT_LE(normal_error,
            1e-14);  // measured 9e-16: the plane through the hit, square to the normal, carries the shape
}

TEST(RayCast, SphereInLongDouble) {
  RandomPose random(12);
  double error = 0.0;
  for (int i = 0; i < 20000; ++i) {
    const double far = random.log_uniform(1.0, 1e6);
    const Vec3 from = far * random.direction(), to = random.vector(-0.5, 0.5);
    const Ray ray{from, (to - from).normalized(), kInfinity};
    const auto hit = cast_ray(Sphere{1.0}, ray);
    ASSERT_TRUE(hit.has_value());
    using Vec3L = Eigen::Matrix<long double, 3, 1>;
    const Vec3L d = ray.direction.cast<long double>().normalized(), o = from.cast<long double>();
    const long double middle = -d.dot(o), off = (o + middle * d).norm();
    const long double truth = middle - std::sqrt((1.0L - off) * (1.0L + off));
    error = std::max(error, static_cast<double>(std::abs(hit->distance - truth)) / (1.0 + far));
  }
  EXPECT_LE(error, 6e-16);  // measured 3.4e-16
}

TEST(RayCast, StartsInsideOnAndOutside) {
  const Vec3 x = Vec3::UnitX();
  RandomPose random(13);
  std::vector<Shape> shapes = {Sphere{1.0}, Capsule{1.0, 0.5}, Box{Vec3::Ones()}, box_hull({Vec3::Ones()})};
  for (const Shape& shape : shapes) {
    SCOPED_TRACE(shape_name(shape));
    const auto inside = cast_ray(shape, {0.5 * x, x});
    ASSERT_TRUE(inside.has_value());
    EXPECT_TRUE(inside->inside);
    EXPECT_EQ(inside->distance, 0.0);
    EXPECT_EQ(inside->normal, -x);
    const auto inwards = cast_ray(shape, {x, -x});
    ASSERT_TRUE(inwards.has_value());
    EXPECT_FALSE(inwards->inside);
    EXPECT_EQ(inwards->distance, 0.0);
    EXPECT_EQ(inwards->normal, x);
    EXPECT_FALSE(cast_ray(shape, {x, x}).has_value());
    EXPECT_FALSE(cast_ray(shape, {2.0 * x, x}).has_value());
    EXPECT_FALSE(cast_ray(shape, {3.0 * x, -x, 1.999}).has_value());
    const auto just = cast_ray(shape, {3.0 * x, -x, 2.0});
    ASSERT_TRUE(just.has_value());
    EXPECT_EQ(just->distance, 2.0);
  }
  EXPECT_TRUE(cast_ray(HalfSpace{}, {-Vec3::UnitZ(), x})->inside);
  EXPECT_FALSE(cast_ray(HalfSpace{}, {Vec3::UnitZ(), x}).has_value());
  EXPECT_FALSE(cast_ray(HalfSpace{}, {Vec3::Zero(), x}).has_value());
  EXPECT_EQ(cast_ray(HalfSpace{}, {3.0 * Vec3::UnitZ(), -Vec3::UnitZ()})->distance, 3.0);
}

/// No component of the direction may divide by zero.
TEST(RayCast, AlongTheAxes) {
  for (const Shape& shape : std::vector<Shape>{Capsule{0.5, 1.0}, Box{Vec3(0.5, 0.5, 1.5)}}) {
    for (int axis = 0; axis < 3; ++axis) {
      for (const double side : {-1.0, 1.0}) {
        const Vec3 d = side * Vec3::Unit(axis);
        const Vec3 off = 0.25 * Vec3::Unit((axis + 1) % 3);
        const auto hit = cast_ray(shape, {off - 4.0 * d, d});
        ASSERT_TRUE(hit.has_value());
        EXPECT_NEAR(hit->distance, 4.0 + support(shape, -d).dot(d), axis == 2 ? 0.1 : 0.07);
        EXPECT_FALSE(cast_ray(shape, {8.0 * off - 4.0 * d, d}).has_value());
      }
    }
  }
}

/// Two triangles with a common edge: a ray through any point of it meets one of them or both.
TEST(RayCast, TrianglesLeaveNoGap) {
  RandomPose random(14);
  int gaps = 0, wrong = 0;
  for (int i = 0; i < 100000; ++i) {
    const Vec3 p = random.vector(-1, 1), q = random.vector(-1, 1);
    // The other corners on either side of the plane of the edge and the ray.
    const Vec3 d = random.direction(), side = (q - p).cross(d).normalized();
    const double a = random.uniform(0.1, 1.0), b = random.uniform(0.1, 1.0),
                 share = random.uniform(0.05, 0.95);
    const Vec3 r = 0.5 * (p + q) + a * side, s = 0.5 * (p + q) - b * side;
    const Vec3 target = p + share * (q - p);
    const Ray ray{target - 3.0 * d, d, 10.0};
    const auto one = cast_ray_on_triangle(p, q, r, ray), two = cast_ray_on_triangle(q, p, s, ray);
    gaps += !one && !two;
    for (const auto& hit : {one, two}) {
      if (hit) wrong += std::abs(hit->distance - 3.0) > 1e-12 || hit->normal.dot(d) > 0.0;
    }
  }
  EXPECT_EQ(gaps, 0);
  EXPECT_EQ(wrong, 0);
}

TEST(RayCast, TriangleSidesAndBorders) {
  const Vec3 a(0, 0, 0), b(1, 0, 0), c(0, 1, 0), z = Vec3::UnitZ();
  const auto front = cast_ray_on_triangle(a, b, c, {Vec3(0.2, 0.2, 1.0), -z});
  ASSERT_TRUE(front.has_value());
  EXPECT_EQ(front->distance, 1.0);
  EXPECT_EQ(front->normal, z);
  EXPECT_EQ(front->feature, 0u);
  const auto back = cast_ray_on_triangle(a, b, c, {Vec3(0.2, 0.2, -2.0), z});
  ASSERT_TRUE(back.has_value());
  EXPECT_EQ(back->normal, -z);
  EXPECT_EQ(back->feature, 1u);
  EXPECT_FALSE(cast_ray_on_triangle(a, b, c, {Vec3(0.6, 0.6, 1.0), -z}).has_value());
  EXPECT_FALSE(cast_ray_on_triangle(a, b, c, {Vec3(0.2, 0.2, 1.0), z}).has_value());
  EXPECT_FALSE(
      cast_ray_on_triangle(a, b, c, {Vec3(-1.0, 0.2, 0.0), Vec3::UnitX()}).has_value());  // in its plane
}

}  // namespace
}  // namespace tumble::test
