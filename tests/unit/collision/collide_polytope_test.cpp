// Hulls and boxes against hulls: against every facet of the Minkowski difference in 80-bit arithmetic, cold and with
// the memory of the step before.
#include "collision/collide_polytope.h"

#include <gtest/gtest.h>

#include "collision/axis_preference.h"
#include "collision/narrow_phase.h"
#include "polytope_reference.h"
#include "sample_hulls.h"

namespace tumble::test {
namespace {

struct Errors {
  int missed = 0, invented = 0, contacts = 0, worse_than_preference = 0;
  double depth = 0.0, deepest = 0.0, normal = 0.0;
};

Polytope view_of_shape(const Shape& shape, const BoxFeatures& box) {
  const HullPointer* hull = std::get_if<HullPointer>(&shape);
  return hull != nullptr ? view_of(**hull) : box.view();
}

void judge(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB, PairCache& cache,
           Errors& errors) {
  const Box* box = std::get_if<Box>(&a);
  const BoxFeatures features(box != nullptr ? *box : Box{Vec3::Ones()});
  const PolytopeReference truth(view_of_shape(a, features), X_WA, view_of_shape(b, features), X_WB);
  NarrowPhaseCounters counters;
  const Manifold m = collide(a, X_WA, b, X_WB, 0.0, {}, cache, counters);
  const double size = bounding_radius(a) + bounding_radius(b), round_off = 1e-13 * size;
  if (m.count == 0) {
    errors.missed += truth.separation() < -round_off;
    return;
  }
  ++errors.contacts;
  errors.invented += truth.separation() > round_off;
  const double along = static_cast<double>(truth.separation_along(m.normal_A.cast<long double>()));
  errors.normal = std::max(errors.normal, truth.angle_to_axis(m.normal_A));
  const double behind = truth.separation() - along;
  if (behind > round_off) {
    errors.worse_than_preference +=
        behind > AxisPreference::of(std::min(bounding_radius(a), bounding_radius(b))).edge;
  } else {
    errors.depth = std::max(errors.depth, std::abs(truth.separation() - along) / size);
    errors.deepest = std::max(errors.deepest, std::abs(truth.separation() + deepest(m)) / size);
  }
}

void expect_exact(const Errors& errors) {
  EXPECT_GT(errors.contacts, 0);
  EXPECT_EQ(errors.missed, 0);
  EXPECT_EQ(errors.invented, 0);
  EXPECT_EQ(errors.worse_than_preference, 0);
  EXPECT_LE(errors.depth,
            1e-13);  // measured 4e-14 at most, where 1e-9 rad of tilt make a tie of face and edges
  EXPECT_LE(errors.deepest, 1e-13);  // measured 8e-16 at most
  EXPECT_LE(errors.normal, 1e-12);   // measured 2e-15 at most
}

TEST(HullHull, AgreesWithEveryFacetHoweverDeep) {
  RandomPose random(2);
  Errors errors;
  for (int i = 0; i < 40; ++i) {
    const Vec3 radii_a = random.vector(0.3, 1.0), radii_b = random.vector(0.3, 1.0);
    const HullPointer a = random_hull(random, 20, radii_a), b = random_hull(random, 16, radii_b);
    for (int k = 0; k < 50; ++k) {
      PairCache cache;
      const Pose X_WA = random.pose(5.0), X_AB = random.pose(0.9);
      judge(a, X_WA, b, X_WA * X_AB, cache, errors);
    }
  }
  expect_exact(errors);
}

TEST(HullHull, AgreesWithEveryFacetWhenShallow) {
  RandomPose random(3);
  Errors errors;
  for (int i = 0; i < 40; ++i) {
    const Vec3 radii_a = random.vector(0.3, 1.0), radii_b = random.vector(0.3, 1.0);
    const HullPointer a = random_hull(random, 20, radii_a), b = random_hull(random, 16, radii_b);
    for (int k = 0; k < 50; ++k) {
      PairCache cache;
      const Vec3 n = random.direction();
      const Quat q = random.rotation();
      const double depth = random.log_uniform(1e-6, 1e-2);
      const Vec3 p = support(a, n) - q * support(b, q.conjugate() * -n) - depth * n;
      judge(a, {}, b, {q, p}, cache, errors);
    }
  }
  expect_exact(errors);
}

TEST(HullHull, BoxesAsHullsAgreeToo) {
  RandomPose random(4);
  Errors errors;
  for (int i = 0; i < 2000; ++i) {
    const Box box_a{random.vector(0.3, 1.0)}, box_b{random.vector(0.3, 1.0)};
    PairCache cache;
    const double yaw = random.uniform(-3.0, 3.0), tilt = random.log_uniform(1e-9, 1e-1);
    const Quat q = turn(random.direction(), tilt) * turn(Vec3::UnitZ(), yaw);
    const Vec3 p(0.2, 0.1, 0.95 * (box_a.half_extents.z() + box_b.half_extents.z()));
    judge(box_a, {}, box_hull(box_b), {q, p}, cache, errors);
    PairCache other;
    judge(box_hull(box_a), {}, box_hull(box_b), {q, p}, other, errors);
  }
  expect_exact(errors);
}

TEST(HullHull, MemoryOfThePastChangesNothing) {
  RandomPose random(5);
  Errors errors;
  NarrowPhaseCounters warm_counters;
  int different = 0;
  for (int i = 0; i < 30; ++i) {
    const HullPointer a = random_hull(random, 20, Vec3(0.8, 0.6, 0.7)),
                      b = random_hull(random, 16, Vec3(0.5, 0.6, 0.4));
    PairCache warm;
    Pose X_AB{random.rotation(), 0.9 * random.direction()};
    for (int step = 0; step < 60; ++step) {
      const double pace = step < 30 ? 2e-2 : 1e-9;
      const Vec3 axis = random.direction(), drift = random.direction();
      X_AB.q = (turn(axis, pace) * X_AB.q).normalized();
      X_AB.p += pace * (drift - 0.5 * X_AB.p);
      judge(a, {}, b, X_AB, warm, errors);
      PairCache cold, again = warm;
      NarrowPhaseCounters counters;
      const Manifold m = collide(a, {}, b, X_AB, 0.0, {}, again, warm_counters);
      const Manifold fresh = collide(a, {}, b, X_AB, 0.0, {}, cold, counters);
      different += m.count != fresh.count || m.normal_A != fresh.normal_A;
      for (std::size_t k = 0; k < static_cast<std::size_t>(std::min(m.count, fresh.count)); ++k) {
        different += m.points[k].p_A != fresh.points[k].p_A ||
                     m.points[k].separation != fresh.points[k].separation ||
                     m.points[k].feature != fresh.points[k].feature;
      }
    }
  }
  expect_exact(errors);
  EXPECT_EQ(different, 0);
  EXPECT_GT(warm_counters.facet_kept, 20u);  // measured 50: most overlap too deeply for a certificate
}

}  // namespace
}  // namespace tumble::test
