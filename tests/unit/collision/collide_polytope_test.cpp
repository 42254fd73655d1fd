// Hulls that move: the memory of the step before only saves work. (Their accuracy: contact_accuracy_test.cpp.)
#include "collision/collide_polytope.h"

#include <gtest/gtest.h>

#include "collision/narrow_phase.h"
#include "collision/triangle_polytope.h"
#include "first_query.h"
#include "sample_hulls.h"
#include "support/core_truth.h"

namespace tumble::test {
namespace {

HullPointer flat_triangle(const std::array<Vec3, 3>& corners, const Vec3& normal) {
  const TrianglePolytope flat(corners, normal);
  ConvexHull::Parts hull;
  hull.vertices.assign(flat.vertices.begin(), flat.vertices.end());
  hull.loops.assign(flat.loops.begin(), flat.loops.end());
  hull.sides.assign(flat.sides.begin(), flat.sides.end());
  hull.faces.assign(flat.faces.begin(), flat.faces.end());
  hull.edges.assign(flat.edges.begin(), flat.edges.end());
  hull.neighbour_offsets.assign(flat.neighbour_offsets.begin(), flat.neighbour_offsets.end());
  hull.neighbours.assign(flat.neighbours.begin(), flat.neighbours.end());
  hull.edges_around.assign(flat.edges_around.begin(), flat.edges_around.end());
  hull.centre = flat.centre;
  hull.radius = flat.radius;
  return std::make_shared<const ConvexHull>(std::move(hull));
}

/// The two normals at an edge look opposite ways: their sum says nothing of where out is.
TEST(FlatHull, IsTouchedAtItsEdges) {
  const Shape flat = flat_triangle({Vec3(-0.5, -0.4, 0), Vec3(0.6, -0.3, 0), Vec3(0, 0.7, 0)}, Vec3::UnitZ());
  RandomPose random(17);
  int contacts = 0;
  for (int i = 0; i < 3000; ++i) {
    const Shape body = i % 3 == 0   ? Shape(Capsule{random.uniform(0.02, 0.3), random.uniform(0.1, 0.6)})
                       : i % 3 == 1 ? Shape(Box{random.vector(0.1, 0.5)})
                                    : Shape(random_hull(random, 10, Vec3(0.4, 0.3, 0.5)));
    const Pose X_WB = random.pose(0.6);
    const Manifold m = query(body, X_WB, flat, Pose{}, 0.0);
    const CoreTruth truth(body, X_WB, flat, Pose{}, true);
    const double separation = static_cast<double>(truth.separation());
    if (std::abs(separation) < 1e-14) continue;
    ASSERT_EQ(m.count > 0, separation < 0.0) << i << " " << separation;
    if (m.count == 0) continue;
    ++contacts;
    EXPECT_NEAR(least_separation(m), separation, 1e-14) << i;  // measured 7e-16
  }
  EXPECT_GT(contacts, 1000);
}

TEST(HullHull, MemoryOfThePastChangesNothing) {
  RandomPose random(5);
  NarrowPhaseCounters warm_counters;
  int different = 0;
  for (int i = 0; i < 30; ++i) {
    const HullPointer a = random_hull(random, 20, Vec3(0.8, 0.6, 0.7)),
                      b = random_hull(random, 16, Vec3(0.5, 0.6, 0.4));
    PairCache warm;
    const bool resting = i % 2 == 0;
    Pose X_AB{random.rotation(), 0.9 * random.direction()};
    if (resting) {  // a vertex of B in the middle of a face of A
      const Polytope::Face& face = a->faces[static_cast<std::size_t>(i)];
      Vec3 middle = Vec3::Zero();
      for (std::uint32_t k = 0; k < face.count; ++k)
        middle += a->vertices[a->loops[face.first + k]] / face.count;
      X_AB.p = middle - X_AB.q * support(b, X_AB.q.conjugate() * -face.normal) - 1e-4 * face.normal;
    }
    for (int step = 0; step < 60; ++step) {
      const double pace = resting ? 1e-6 : step < 30 ? 2e-2 : 1e-9;
      const Vec3 axis = random.direction(), drift = random.direction();
      X_AB.q = (turn(axis, pace) * X_AB.q).normalized();
      X_AB.p += pace * (resting ? drift : Vec3(drift - 0.5 * X_AB.p));
      PairCache cold;
      NarrowPhaseCounters counters;
      const Manifold m = collide(a, {}, b, X_AB, 0.0, {}, warm, warm_counters);
      const Manifold fresh = collide(a, {}, b, X_AB, 0.0, {}, cold, counters);
      different += m.count != fresh.count || m.normal_A != fresh.normal_A;
      for (std::size_t k = 0; k < static_cast<std::size_t>(std::min(m.count, fresh.count)); ++k) {
        different += m.points[k].p_A != fresh.points[k].p_A ||
                     m.points[k].separation != fresh.points[k].separation ||
                     m.points[k].feature != fresh.points[k].feature;
      }
    }
  }
  EXPECT_EQ(different, 0);
  EXPECT_GT(warm_counters.facet_kept, 300u);  // of 900 at rest; deep overlap has no certificate
}

}  // namespace
}  // namespace tumble::test
