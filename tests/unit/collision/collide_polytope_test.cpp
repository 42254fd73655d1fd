// Hulls that move: the memory of the step before only saves work. (Their accuracy: contact_accuracy_test.cpp.)
#include "collision/collide_polytope.h"

#include <gtest/gtest.h>

#include "collision/narrow_phase.h"
#include "sample_hulls.h"

namespace tumble::test {
namespace {

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
      const ConvexHull::Face& face = a->faces[static_cast<std::size_t>(i)];
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
