// Moved shapes: closed forms, and for all pairs of types that nothing is touched before the hit and nothing missed.
#include "collision/shape_cast.h"

#include <gtest/gtest.h>

#include "collision/distance.h"
#include "sample_shapes.h"

namespace tumble::test {
namespace {

TEST(ShapeCast, SphereOnSphereInClosedForm) {
  RandomPose random(21);
  double error = 0.0, normal_error = 0.0, point_error = 0.0;
  int hits = 0, misses = 0;
  for (int i = 0; i < 10000; ++i) {
    const double ra = random.log_uniform(1e-3, 1.0), rb = random.log_uniform(1e-3, 1.0), reach = ra + rb;
    const Vec3 p = random.uniform(1.1, 20.0) * reach * random.direction();
    const Vec3 way = 2.0 * (p + 1.2 * reach * random.direction());
    const auto hit = cast_shape(Sphere{ra}, Sphere{rb}, {Quat::Identity(), p}, way);
    const Vec3 d = way.normalized();
    const double middle = d.dot(p), off = (p - middle * d).norm();
    const double first = (middle - std::sqrt((reach - off) * (reach + off))) / way.norm();
    const bool meets = off < reach && first >= 0.0 && first <= 1.0;
    ASSERT_EQ(hit.has_value(), meets) << off / reach;
    (hit ? hits : misses)++;
    if (!hit) continue;
    const Vec3 normal = (first * way - p) / reach;
    error = std::max(error, std::abs(hit->fraction - first) * -normal.dot(way) / reach);
    normal_error = std::max(normal_error, -normal.dot(d) * (hit->normal_A - normal).norm());
    point_error = std::max(point_error, -normal.dot(d) * (hit->p_A - (p + rb * normal)).norm() / reach);
  }
  EXPECT_GT(hits, 2000);
  EXPECT_GT(misses, 500);
  EXPECT_LE(error, 1e-13);         // measured 2e-14
  EXPECT_LE(normal_error, 3e-12);  // measured 1e-12: the last step, 1e-13 of 20 radii, weighs thus
  EXPECT_LE(point_error, 3e-12);   // measured 1e-12
}

/// Free up to the hit, touching there; without a hit free all the way. Checked by distances along the way.
TEST(ShapeCast, NothingIsTouchedBeforeAndNothingIsMissed) {
  RandomPose random(22);
  int hits = 0, misses = 0, most_steps = 0;
  double gap_at_hit = 0.0, curved_gap_at_hit = 0.0;
  for (int i = 0; i < 12; ++i) {
    const auto as = random_shapes(random), bs = random_shapes(random);
    for (const Shape& a : as) {
      for (const Shape& b : bs) {
        for (int k = 0; k < 8; ++k) {
          const Vec3 d = random.direction(), aside = random.vector(-3.0, 3.0);
          const Quat q = random.rotation();
          const double gap = random.log_uniform(1e-6, 10.0), size = bounding_radius(a) + bounding_radius(b);
          const Pose X_AB = place_apart(a, b, d, q, gap);
          const Vec3 way = 1.5 * X_AB.p + aside;
          const auto hit = cast_shape(a, b, X_AB, way);
          (hit ? hits : misses)++;
          const double end = hit ? hit->fraction : 1.0;
          if (hit) most_steps = std::max(most_steps, hit->iterations);
          for (int s = 0; s <= 50; ++s) {
            const double at = end * s / 50.0;
            const Distance distance = compute_distance(a, b, {q, X_AB.p - at * way});
            if (hit && s == 50) {
              double& worst = is_curved(a) || is_curved(b) ? curved_gap_at_hit : gap_at_hit;
              worst = std::max(worst, distance.upper / size);
              // Touched from outside, and moved on it would overlap: the normal is against the way.
              EXPECT_LE(hit->normal_A.dot(way), 0.0);
              EXPECT_NEAR(hit->normal_A.norm(), 1.0, 1e-14);
            } else if (!hit || s < 50) {
              EXPECT_FALSE(distance.overlap) << shape_name(a) << ' ' << shape_name(b) << ' ' << s;
            }
          }
        }
      }
    }
  }
  EXPECT_GT(hits, 500);
  EXPECT_GT(misses, 200);
  EXPECT_LE(gap_at_hit, 5e-14);        // measured 1.5e-14
  EXPECT_LE(curved_gap_at_hit, 1e-9);  // measured 9.2e-11
  EXPECT_LE(most_steps, 20);           // measured 9
}

TEST(ShapeCast, ThinPlateIsNeverPassed) {
  RandomPose random(23);
  const Box plate{Vec3(1.0, 1.0, 1e-7)};
  for (int i = 0; i < 1000; ++i) {
    for (const Shape& bullet : random_shapes(random, 1e-3, 1e-2)) {
      const Quat q = random.rotation();
      const double far = random.log_uniform(1.0, 1e4);
      const Vec3 aim = random.vector(-0.9, 0.9).cwiseProduct(Vec3(1, 1, 0));
      const Vec3 start = aim + far * (random.direction() + Vec3(0, 0, 2.0));
      const Quat q_SW = q.conjugate();
      const auto hit = cast_shape(bullet, plate, {q_SW, q_SW * -start}, q_SW * (2.0 * (aim - start)));
      ASSERT_TRUE(hit.has_value());
      EXPECT_NEAR(hit->fraction * 2.0 * (aim - start).norm(), (aim - start).norm(), 0.2);
      EXPECT_GT((q * hit->normal_A).z(), 0.99);
    }
  }
}

TEST(ShapeCast, HalfSpace) {
  const Pose below{Quat::Identity(), Vec3(0, 0, -3)};
  const auto hit = cast_shape(Box{Vec3::Ones()}, HalfSpace{}, below, Vec3(5, 0, -4));
  ASSERT_TRUE(hit.has_value());
  EXPECT_EQ(hit->fraction, 0.5);
  EXPECT_EQ(hit->normal_A, Vec3::UnitZ());
  EXPECT_EQ(hit->p_A.z(), -3.0);
  EXPECT_FALSE(cast_shape(Box{Vec3::Ones()}, HalfSpace{}, below, Vec3(5, 0, 4)).has_value());
  EXPECT_FALSE(cast_shape(Box{Vec3::Ones()}, HalfSpace{}, below, Vec3(5, 0, -1.999)).has_value());
  EXPECT_TRUE(cast_shape(Box{Vec3::Ones()}, HalfSpace{}, {}, Vec3(5, 0, 4))->inside);
}

TEST(ShapeCast, WhatItTouchesOrOverlapsAtTheStart) {
  const Box box{Vec3::Ones()};
  const Pose on_top{Quat::Identity(), Vec3(0, 0, -2)};
  EXPECT_FALSE(cast_shape(box, box, on_top, Vec3(1, 0, 0)).has_value());  // slides
  EXPECT_FALSE(cast_shape(box, box, on_top, Vec3(0, 0, 1)).has_value());  // leaves
  const auto into = cast_shape(box, box, on_top, Vec3(0, 0, -1));
  ASSERT_TRUE(into.has_value());
  EXPECT_EQ(into->fraction, 0.0);
  EXPECT_FALSE(into->inside);
  EXPECT_EQ(into->normal_A, Vec3::UnitZ());
  const Pose sunk{Quat::Identity(), Vec3(0, 0, -1.9)};
  const auto inside = cast_shape(box, box, sunk, Vec3(0, 0, 1));
  ASSERT_TRUE(inside.has_value());
  EXPECT_TRUE(inside->inside);
  EXPECT_EQ(inside->fraction, 0.0);
  EXPECT_EQ(inside->normal_A, Vec3::UnitZ());
}

}  // namespace
}  // namespace tumble::test
