// The pair matrix as a whole: closed forms, symmetry, invariance, switches, degenerate poses.
#include "collision/narrow_phase.h"

#include <gtest/gtest.h>

#include "first_query.h"
#include "math/rotation.h"
#include "sample_hulls.h"

namespace tumble::test {
namespace {

std::vector<Shape> one_of_each() {
  RandomPose random(11);
  return {HalfSpace{},
          Sphere{0.4},
          Capsule{0.3, 0.6},
          Box{Vec3(0.5, 0.3, 0.7)},
          random_hull(random, 16, Vec3(0.6, 0.5, 0.7)),
          Cylinder{0.4, 0.5},
          Cone{0.5, 0.4},
          Ellipsoid{Vec3(0.4, 0.6, 0.5)}};
}

/// Distance of p from the shape: 0 inside. Independent of the code under test but for the hull's planes.
double distance_outside(const Shape& shape, const Vec3& p) {
  if (std::holds_alternative<HalfSpace>(shape)) return std::max(0.0, p.z());
  if (const auto* s = std::get_if<Sphere>(&shape)) return std::max(0.0, p.norm() - s->radius);
  if (const auto* c = std::get_if<Capsule>(&shape)) {
    const Vec3 core(0, 0, std::clamp(p.z(), -c->half_length, c->half_length));
    return std::max(0.0, (p - core).norm() - c->radius);
  }
  if (const auto* b = std::get_if<Box>(&shape)) return (p.cwiseAbs() - b->half_extents).cwiseMax(0.0).norm();
  const double across = std::sqrt(p.x() * p.x() + p.y() * p.y());
  if (const auto* c = std::get_if<Cylinder>(&shape)) {
    return Vec3(std::max(0.0, across - c->radius), std::max(0.0, std::abs(p.z()) - c->half_length), 0.0)
        .norm();
  }
  if (const auto* c = std::get_if<Cone>(&shape)) {  // over the higher of base and side: a lower bound
    const double l = c->half_length, side = 2.0 * l * (across - c->radius) + c->radius * (p.z() + l);
    return std::max({0.0, -p.z() - l, side / std::sqrt(4.0 * l * l + c->radius * c->radius)});
  }
  if (const auto* e = std::get_if<Ellipsoid>(&shape)) {  // a lower bound
    return std::max(0.0, (p.cwiseQuotient(e->half_axes).norm() - 1.0) * e->half_axes.minCoeff());
  }
  double height = 0.0;  // over the highest plane: a lower bound of the distance
  for (const auto& face : (*std::get_if<HullPointer>(&shape))->faces) {
    height = std::max(height, face.normal.dot(p) - face.offset);
  }
  return height;
}

// Closed forms ------------------------------------------------------------------------------------------------------

TEST(ClosedForm, SphereSphere) {
  RandomPose random(21);
  for (int i = 0; i < 2000; ++i) {
    const double ra = random.uniform(0.1, 1.0), rb = random.uniform(0.1, 1.0);
    const Pose X_WA = random.pose(1.0), X_WB = random.pose(1.0);
    const Vec3 d = X_WB.p - X_WA.p;
    const double separation = d.norm() - ra - rb;
    const Manifold m = query(Sphere{ra}, X_WA, Sphere{rb}, X_WB, 0.1);
    ASSERT_EQ(m.count, separation <= 0.1 ? 1 : 0);
    if (m.count == 0) continue;
    EXPECT_NEAR(m.points[0].separation, separation, 2e-15);  // measured 7e-16
    EXPECT_LE((X_WA.q * m.normal_A - d.normalized()).norm(), 2e-15);
    EXPECT_LE((X_WA * m.points[0].p_A - (X_WA.p + d.normalized() * (ra + 0.5 * separation))).norm(), 4e-15);
  }
}

TEST(ClosedForm, SphereBoxIsTheDistanceOfTheCentre) {
  RandomPose random(22);
  for (int i = 0; i < 2000; ++i) {
    const Box box{random.vector(0.2, 1.0)};
    const double radius = random.uniform(0.1, 0.8);
    const Pose X_WA = random.pose(1.2), X_WB = random.pose(1.2);
    const Vec3 c = X_WB.inverse() * X_WA.p;
    const Vec3 excess = c.cwiseAbs() - box.half_extents;
    const double outside = excess.cwiseMax(0.0).norm();
    const double separation = (outside > 0.0 ? outside : excess.maxCoeff()) - radius;
    const Manifold m = query(Sphere{radius}, X_WA, box, X_WB, 0.1);
    ASSERT_EQ(m.count, separation <= 0.1 ? 1 : 0);
    if (m.count == 0) continue;
    EXPECT_NEAR(m.points[0].separation, separation, 4e-15);
    EXPECT_NEAR(m.normal_A.norm(), 1.0, 1e-15);
  }
}

TEST(ClosedForm, HalfSpaceMeetsTheLowestPointOfEverything) {
  RandomPose random(23);
  const std::vector<Shape> shapes = one_of_each();
  for (int i = 0; i < 4000; ++i) {
    const Shape& b = shapes[static_cast<std::size_t>(1 + i % 7)];
    const Pose X_WA = random.pose(3.0);
    const Pose X_AB = random.pose(1.0);
    const Vec3 down_B = X_AB.q.conjugate() * -Vec3::UnitZ();
    const double lowest = (X_AB * support(b, down_B)).z();
    const Manifold m = query(HalfSpace{}, X_WA, b, X_WA * X_AB, 0.05);
    ASSERT_EQ(m.count > 0, lowest <= 0.05);
    if (m.count > 0) {
      EXPECT_NEAR(least_separation(m), lowest, 4e-15);
    }
  }
}

/// Least distance of two segments by a fine grid and then thirds around its best cell.
double segment_distance(const Vec3& a0, const Vec3& a1, const Vec3& b0, const Vec3& b1) {
  const auto from_a = [&](double s) {
    const Vec3 p = a0 + s * (a1 - a0), d = b1 - b0;
    return (p - b0 - std::clamp(d.dot(p - b0) / d.squaredNorm(), 0.0, 1.0) * d).norm();
  };
  double low = 0.0, high = 1.0;  // the distance from a convex set is convex along a segment
  for (int i = 0; i < 200; ++i) {
    const double third = (high - low) / 3.0;
    (from_a(low + third) < from_a(high - third) ? high : low) =
        from_a(low + third) < from_a(high - third) ? high - third : low + third;
  }
  return std::min({from_a(0.5 * (low + high)), from_a(0.0), from_a(1.0)});
}

TEST(ClosedForm, CapsulesMeetAtTheDistanceOfTheirCores) {
  RandomPose random(24);
  for (int i = 0; i < 1000; ++i) {
    const Capsule a{random.uniform(0.1, 0.4), random.uniform(0.2, 1.0)};
    const Capsule b{random.uniform(0.1, 0.4), random.uniform(0.2, 1.0)};
    const Pose X_WA = random.pose(0.8), X_WB = random.pose(0.8);
    const Vec3 reach_a = X_WA.q * Vec3(0, 0, a.half_length), reach_b = X_WB.q * Vec3(0, 0, b.half_length);
    const double separation =
        segment_distance(X_WA.p - reach_a, X_WA.p + reach_a, X_WB.p - reach_b, X_WB.p + reach_b) - a.radius -
        b.radius;
    const Manifold m = query(a, X_WA, b, X_WB, 0.1);
    ASSERT_EQ(m.count > 0, separation <= 0.1);
    if (m.count > 0) {
      EXPECT_NEAR(least_separation(m), separation, 1e-14);
    }
    const Manifold s = query(Sphere{a.radius}, X_WA, b, X_WB, 0.1);
    const double alone =
        segment_distance(X_WA.p, X_WA.p, X_WB.p - reach_b, X_WB.p + reach_b) - a.radius - b.radius;
    ASSERT_EQ(s.count > 0, alone <= 0.1);
    if (s.count > 0) {
      EXPECT_NEAR(least_separation(s), alone, 1e-14);
    }
  }
}

TEST(ClosedForm, ParallelCapsulesTouchInTwoPoints) {
  const Manifold m =
      query(Capsule{0.5, 1.0}, {}, Capsule{0.25, 1.0}, {Quat::Identity(), Vec3(0.75, 0, 0.4)}, 0.01);
  ASSERT_EQ(m.count, 2);
  EXPECT_EQ(m.normal_A, Vec3::UnitX());
  EXPECT_EQ(m.points[0].p_A, Vec3(0.5, 0, -0.6));
  EXPECT_EQ(m.points[1].p_A, Vec3(0.5, 0, 1.0));
}

/// Distance of a core from a box, over a grid of starts refined by thirds: convex along the core.
TEST(CapsuleBox, OutsideTheSeparationIsTheDistanceOfTheCore) {
  RandomPose random(25);
  int contacts = 0;
  for (int i = 0; i < 3000; ++i) {
    const Capsule a{random.uniform(0.1, 0.3), random.uniform(0.2, 1.0)};
    const Box b{random.vector(0.2, 0.8)};
    const Pose X_WA = random.pose(1.0), X_WB = random.pose(1.0);
    const Pose X_BA = X_WB.inverse() * X_WA;
    const Vec3 reach = X_BA.q * Vec3(0, 0, a.half_length);
    const auto distance_at = [&](double s) { return distance_outside(b, X_BA.p + s * reach); };
    double low = -1.0, high = 1.0;
    for (int k = 0; k < 100; ++k) {
      const double third = (high - low) / 3.0;
      if (distance_at(low + third) < distance_at(high - third))
        high -= third;
      else
        low += third;
    }
    const double core = distance_at(0.5 * (low + high));
    const Manifold m = query(a, X_WA, b, X_WB, 0.05);
    if (core > 1e-3) {
      // The core of a capsule lying within 1e-3 rad of a face is judged along the face's normal: 5e-7 of the height.
      ASSERT_EQ(m.count > 0, core - a.radius <= 0.05);
      if (m.count > 0) {
        EXPECT_NEAR(least_separation(m), core - a.radius, 1e-9);
      }
      contacts += m.count > 0;
    } else {
      ASSERT_GT(m.count, 0);
      EXPECT_LE(least_separation(m), -a.radius + 1e-3);
    }
  }
  EXPECT_GT(contacts, 500);
}

// Properties of every pair ------------------------------------------------------------------------------------------

TEST(EveryPair, PointsLieInBothShapesGrownByTheMargin) {
  RandomPose random(31);
  const std::vector<Shape> shapes = one_of_each();
  for (int i = 0; i < 6000; ++i) {
    const Shape& a = shapes[static_cast<std::size_t>(i % 8)];
    const Shape& b = shapes[static_cast<std::size_t>(1 + i / 8 % 7)];
    const Pose X_WA = random.pose(0.7), X_WB = random.pose(0.7);
    const double margin = 0.02,
                 tolerance = 2e-4;  // inside tolerance and merging move a point by 1e-4 at most
    const Manifold m = query(a, X_WA, b, X_WB, margin);
    ASSERT_NEAR(m.normal_A.norm(), 1.0, 1e-14);
    for (int k = 0; k < m.count; ++k) {
      const ManifoldPoint& point = m.points[static_cast<std::size_t>(k)];
      const double depth = std::max(0.0, -0.5 * point.separation);
      const Vec3 p_B = X_WB.inverse() * (X_WA * point.p_A);
      ASSERT_LE(point.separation, margin);
      EXPECT_LE(distance_outside(a, point.p_A), margin + depth + tolerance)
          << shape_name(a) << ' ' << shape_name(b);
      EXPECT_LE(distance_outside(b, p_B), margin + depth + tolerance)
          << shape_name(a) << ' ' << shape_name(b);
    }
  }
}

bool same_to_the_bit(const Manifold& m, const Manifold& other) {
  if (m.count != other.count || (m.count > 0 && m.normal_A != other.normal_A)) return false;
  for (std::size_t k = 0; k < static_cast<std::size_t>(m.count); ++k) {
    if (m.points[k].p_A != other.points[k].p_A || m.points[k].separation != other.points[k].separation ||
        m.points[k].feature != other.points[k].feature) {
      return false;
    }
  }
  return true;
}

/// Both calls are one computation, and one of them turns its result round.
TEST(EveryPair, SwappedShapesSayTheSameToTheBit) {
  RandomPose random(32);
  const std::vector<Shape> shapes = one_of_each();
  const int n = static_cast<int>(shapes.size());
  for (int i = 0, contacts = 0; i < 6000; ++i) {
    const Shape& a = shapes[static_cast<std::size_t>(i % n)];
    const Shape& b = shapes[static_cast<std::size_t>(i / n % n)];
    const Pose X_WA = random.pose(0.7), X_WB = random.pose(0.7);
    const Manifold m = query(a, X_WA, b, X_WB, 0.02), other = query(b, X_WB, a, X_WA, 0.02);
    Manifold m_swapped = m, other_swapped = other;
    swap_shapes(m_swapped, relative_pose(X_WA, X_WB));
    swap_shapes(other_swapped, relative_pose(X_WB, X_WA));
    ASSERT_TRUE(same_to_the_bit(m_swapped, other) || same_to_the_bit(other_swapped, m))
        << shape_name(a) << ' ' << shape_name(b);
    contacts += m.count > 0;
    ASSERT_TRUE(i < 5999 || contacts > 2000);
  }
}

/// Two equal bodies that turn round each other do not change roles on the way.
TEST(EveryPair, EqualShapesKeepTheirOrder) {
  const Shape box = Box{Vec3(0.5, 0.5, 0.5)};
  PairCache forth, back;
  NarrowPhaseCounters counters;
  for (int step = 0; step < 400; ++step) {
    const Quat q = turn(Vec3(0.6, 0, 0.8), 0.05 * step);
    const Pose X_WA{q, q * Vec3(0.3, 0, -0.499)}, X_WB{q, q * Vec3(-0.3, 0, 0.499)};
    Manifold m = collide(box, X_WA, box, X_WB, 0.01, {}, forth, counters);
    const Manifold other = collide(box, X_WB, box, X_WA, 0.01, {}, back, counters);
    ASSERT_EQ(m.count, 4);
    for (std::size_t k = 0; k < 4; ++k) {
      ASSERT_EQ(m.points[k].feature, other.points[k].feature);
      ASSERT_EQ(m.points[k].separation, other.points[k].separation);
    }
  }
}

TEST(EveryPair, MovesWithTheWorld) {
  RandomPose random(33);
  const std::vector<Shape> shapes = one_of_each();
  for (int i = 0; i < 3000; ++i) {
    const Shape& a = shapes[static_cast<std::size_t>(i % 8)];
    const Shape& b = shapes[static_cast<std::size_t>(1 + i / 8 % 7)];
    const Pose X_WA = random.pose(0.7), X_WB = random.pose(0.7), X = random.pose(2.0);
    const Manifold m = query(a, X_WA, b, X_WB, 0.02), moved = query(a, X * X_WA, b, X * X_WB, 0.02);
    ASSERT_EQ(m.count, moved.count);
    if (m.count == 0) continue;
    EXPECT_NEAR(least_separation(m), least_separation(moved), 2e-14) << shape_name(a) << ' ' << shape_name(b);
    const bool curved =
        a.index() > 4 || b.index() > 4;  // there the normal moves along with the contact's place
    EXPECT_LE((m.normal_A - moved.normal_A).norm(), curved ? 1e-9 : 1e-12)
        << shape_name(a) << ' ' << shape_name(b);
  }
}

TEST(EveryPair, IsFiniteInDegeneratePoses) {
  const std::vector<Shape> shapes = one_of_each();
  const std::vector<Vec3> places = {Vec3::Zero(),    Vec3(0, 0, 1e-300),  Vec3(1e-18, 0, 0), Vec3(0, 0, 0.3),
                                    Vec3(1.0, 0, 0), Vec3(0.5, 0.3, 0.7), Vec3(1e12, 0, 0)};
  const std::vector<Quat> turns = {Quat::Identity(), Quat(0, 1, 0, 0),
                                   Quat(std::sqrt(0.5), std::sqrt(0.5), 0, 0)};
  for (const Shape& a : shapes) {
    for (const Shape& b : shapes) {
      for (const Vec3& p : places) {
        for (const Quat& q : turns) {
          const Manifold m = query(a, {}, b, {q, p}, 0.01);
          ASSERT_NEAR(m.normal_A.norm(), 1.0, 1e-14) << shape_name(a) << ' ' << shape_name(b);
          for (std::size_t k = 0; k < static_cast<std::size_t>(m.count); ++k) {
            ASSERT_TRUE(m.points[k].p_A.allFinite() && std::isfinite(m.points[k].separation));
          }
        }
      }
    }
  }
}

/// Plates, needles and grains of one to a thousandth of the others' size, coinciding, aligned, touching or inside.
TEST(EveryPair, IsFiniteAndRepeatableForFlatAndNeedleShapes) {
  RandomPose random(34);
  std::vector<Shape> shapes = one_of_each();
  for (const Vec3& h :
       {Vec3(1, 1, 1e-6), Vec3(1, 1e-6, 1e-6), Vec3(1e-3, 1e-3, 1e-3), Vec3(1e3, 1e3, 1e-2)}) {
    shapes.push_back(Box{h});
    shapes.push_back(box_hull(Box{h}));
  }
  shapes.push_back(Capsule{1e-6, 1.0});
  const std::vector<Quat> turns = {Quat::Identity(), Quat(0, 1, 0, 0),
                                   Quat(std::sqrt(0.5), 0, std::sqrt(0.5), 0)};
  for (int i = 0; i < 20000; ++i) {
    const Shape& a =
        shapes[static_cast<std::size_t>(random.uniform(0.0, static_cast<double>(shapes.size())))];
    const Shape& b =
        shapes[static_cast<std::size_t>(random.uniform(0.0, static_cast<double>(shapes.size())))];
    Pose X_AB;
    if (i % 2 == 0) X_AB.q = random.rotation();
    if (i % 2 == 1) X_AB.q = turns[static_cast<std::size_t>(i / 2 % 3)];
    if (i % 3 == 1) X_AB.p = random.vector(-1e-9, 1e-9);
    if (i % 3 == 2 && !std::holds_alternative<HalfSpace>(a) && !std::holds_alternative<HalfSpace>(b)) {
      X_AB.p = support(a, Vec3::UnitX()) - X_AB.q * support(b, X_AB.q.conjugate() * -Vec3::UnitX());
    }
    const Manifold m = query(a, {}, b, X_AB, 0.01);
    ASSERT_NEAR(m.normal_A.norm(), 1.0, 1e-14) << shape_name(a) << ' ' << shape_name(b);
    for (std::size_t k = 0; k < static_cast<std::size_t>(m.count); ++k) {
      ASSERT_TRUE(m.points[k].p_A.allFinite() && std::isfinite(m.points[k].separation));
    }
    ASSERT_TRUE(same_to_the_bit(m, query(a, {}, b, X_AB, 0.01)));
  }
}

// The pipeline ------------------------------------------------------------------------------------------------------

/// Pairs drift past each other and now and then stand still; every switch setting sees the same poses with a memory of
/// its own.
TEST(Pipeline, SwitchesChangeCostNotContacts) {
  RandomPose random(41);
  const std::vector<Shape> shapes = one_of_each();
  constexpr std::size_t kSettings = 6;
  std::array<NarrowPhaseOptions, kSettings> options;
  options[1].use_motion_bound = false;
  options[2].use_cached_axis = false;
  options[3].use_gjk = false;
  options[4].use_cached_facet = false;
  options[5].use_kept_manifold = false;
  std::array<NarrowPhaseCounters, kSettings> counters;
  int contacts = 0;
  for (int i = 0; i < 288; ++i) {
    const Shape& a = shapes[static_cast<std::size_t>(2 + i % 6)];
    const Shape& b = shapes[static_cast<std::size_t>(2 + i / 6 % 6)];
    std::array<PairCache, kSettings> caches;
    std::array<Manifold, kSettings> m;
    Pose X_WA = random.pose(0.2), X_WB = random.pose(1.4);
    for (int step = 0; step < 60; ++step) {
      const double pace = i / 36 % 2 == 0 ? 1e-9 : 0.02;
      const Vec3 axis = random.direction(), drift = random.direction();
      if (step % 4 > 0) {
        X_WB.q = (turn(axis, pace) * X_WB.q).normalized();
        X_WB.p += pace * (drift - X_WB.p);
      }
      for (std::size_t k = 0; k < kSettings; ++k)
        update_manifold(a, X_WA, b, X_WB, 0.0, options[k], caches[k], counters[k], m[k]);
      contacts += m[0].count > 0;
      for (std::size_t k = 1; k < kSettings; ++k) ASSERT_TRUE(same_to_the_bit(m[k], m[0]));
    }
  }
  EXPECT_GT(contacts, 1000);
  for (const NarrowPhaseCounters& c : counters) {
    EXPECT_EQ(c.unmoved + c.motion_bound + c.cached_axis + c.gjk + c.exact + c.closed_form, c.queries);
    EXPECT_EQ(c.gjk_budget_hit, 0u);
  }
  EXPECT_GT(counters[0].motion_bound, 500u);
  EXPECT_GT(counters[0].cached_axis, 0u);
  EXPECT_GT(counters[0].facet_kept, 0u);
  EXPECT_EQ(counters[1].motion_bound, 0u);
  EXPECT_GT(counters[1].cached_axis, counters[0].cached_axis);
  EXPECT_EQ(counters[2].cached_axis, 0u);
  EXPECT_GT(counters[2].gjk, counters[0].gjk);
  EXPECT_EQ(counters[3].gjk, 0u);
  EXPECT_GT(counters[3].exact, counters[0].exact);
  EXPECT_EQ(counters[4].facet_kept, 0u);
  EXPECT_GT(counters[0].unmoved, 500u);
  EXPECT_EQ(counters[5].unmoved, 0u);
}

/// Nothing but the same bits of pose and margin is the same question.
TEST(Pipeline, AKeptManifoldAnswersOnlyItsOwnQuestion) {
  const Shape box = Box{Vec3::Constant(0.5)};
  PairCache cache;
  NarrowPhaseCounters counters;
  Manifold m;
  const auto ask = [&](const Vec3& p, double margin) {
    update_manifold(box, {}, box, {Quat::Identity(), p}, margin, {}, cache, counters, m);
    return counters.unmoved;
  };
  EXPECT_EQ(ask(Vec3(0, 0, 0.99), 0.01), 0u);
  EXPECT_EQ(ask(Vec3(0, 0, 0.99), 0.01), 1u);
  EXPECT_EQ(m.count, 4);
  EXPECT_EQ(ask(Vec3(1e-300, 0, 0.99), 0.01), 1u);
  EXPECT_EQ(ask(Vec3(1e-300, 0, 0.99), -0.02), 1u);
  EXPECT_EQ(m.count, 0);
  EXPECT_EQ(ask(Vec3(1e-300, 0, 2.0), 0.01), 1u);
  EXPECT_EQ(ask(Vec3(1e-300, 0, 0.99), 0.01), 1u);
  EXPECT_EQ(m.count, 4);
}

TEST(Boxes, StackedEqualOnesMeetInFourPointsWithTheExactGap) {
  RandomPose random(51);
  for (const double gap : {-1e-3, -1e-9, 0.0, 1e-9, 1e-3}) {
    const Vec3 h(0.5, 0.4, 0.3);
    const Pose X_WA{Quat::Identity(), Vec3(1, 2, 3)}, X_WB{Quat::Identity(), Vec3(1, 2, 3 + 0.6 + gap)};
    const Manifold m = query(Box{h}, X_WA, Box{h}, X_WB, 0.01);
    ASSERT_EQ(m.count, 4);
    EXPECT_EQ(m.normal_A, Vec3::UnitZ());
    for (std::size_t k = 0; k < 4; ++k)
      EXPECT_NEAR(m.points[k].separation, X_WB.p.z() - X_WA.p.z() - 0.6, 1e-15);
  }
}

TEST(Boxes, FeatureIdsSurviveSmallMotion) {
  const Box box{Vec3(0.5, 0.4, 0.3)};
  const Manifold m = query(box, {}, box, {turn(Vec3::UnitZ(), 0.3), Vec3(0.01, 0.005, 0.6)}, 0.01);
  ASSERT_EQ(m.count, 8);
  RandomPose random(52);
  for (int i = 0; i < 200; ++i) {
    const Vec3 axis = random.direction(), shift = random.direction();
    const Pose X{turn(axis, 1e-6) * turn(Vec3::UnitZ(), 0.3), Vec3(0.01, 0.005, 0.6) + 1e-6 * shift};
    const Manifold moved = query(box, {}, box, X, 0.01);
    ASSERT_EQ(moved.count, m.count);
    for (std::size_t k = 0; k < 8; ++k) {
      EXPECT_EQ(moved.points[k].feature, m.points[k].feature);
      EXPECT_LE((moved.points[k].p_A - m.points[k].p_A).norm(), 1e-5);
    }
  }
}

/// libccd's issue 25 (NaN from its penetration query), and 1 mm cubes, all of which it calls apart.
TEST(Boxes, WhereLibccdFails) {
  const Box cube{Vec3::Ones()}, grain{Vec3::Constant(5e-4)};
  const Manifold m = query(cube, {}, cube, {Quat::Identity(), Vec3(0, 0, 1.9)}, 0.0);
  ASSERT_EQ(m.count, 4);
  EXPECT_NEAR(least_separation(m), -0.1, 2e-16);
  RandomPose random(53);
  for (int i = 0; i < 1000; ++i) {
    const Pose X_WA = random.pose(1.0);
    const Pose X_AB{random.rotation(), 5e-4 * random.direction()};
    EXPECT_GT(query(grain, X_WA, grain, X_WA * X_AB, 0.0).count, 0);
  }
}

TEST(Boxes, FarFromTheOriginNothingIsLost) {
  const Box box{Vec3::Constant(0.5)};
  const Vec3 far(1048576.0, -2097152.0, 524288.0);
  const Quat q = turn(Vec3(0.6, 0, 0.8), 0.7);
  const Manifold near = query(box, {q, Vec3::Zero()}, box, {q, Vec3(0.125, 0.25, 0.75)}, 0.0);
  const Manifold there = query(box, {q, far}, box, {q, far + Vec3(0.125, 0.25, 0.75)}, 0.0);
  ASSERT_EQ(near.count, there.count);
  for (std::size_t k = 0; k < static_cast<std::size_t>(near.count); ++k) {
    EXPECT_EQ(near.points[k].separation, there.points[k].separation);
  }
}

}  // namespace
}  // namespace tumble::test
