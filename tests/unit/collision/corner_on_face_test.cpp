// A corner that stands alone on a face: what the two conditions promise, and that the contact is the one clipping finds.
#include "collision/corner_on_face.h"

#include <gtest/gtest.h>

#include "collision/box_polytope.h"
#include "collision/narrow_phase.h"
#include "sample_hulls.h"

namespace tumble::test {
namespace {

// Below the gap there is only the cone over the places where the lines to all other vertices reach it.
TEST(CornerOnFace, AllThatIsWithinTheGapLiesInTheDisc) {
  RandomPose random(1);
  int steep = 0;
  for (int i = 0; i < 2000; ++i) {
    const HullPointer hull = random_hull(random, 12, random.vector(0.2, 1.0));
    const Vec3 up = random.direction();
    const StandingCorner corner{*hull, descend(*hull, up, 0, -kInfinity).vertex, up};
    const double gap = random.uniform(0.0, 0.1), slope2 = least_slope2(corner, gap);
    const Vec3& foot = hull->vertices[corner.vertex];
    double furthest = 0.0, lowest = kInfinity;
    for (std::uint32_t v = 0; v < hull->vertices.size(); ++v) {
      if (v == corner.vertex) continue;
      const Vec3 along = hull->vertices[v] - foot;
      const double rise = up.dot(along);
      lowest = std::min(lowest, rise);
      furthest = std::max(furthest, gap / rise * along.norm());
    }
    ASSERT_EQ(slope2 > 0.0, lowest > gap);
    if (slope2 == 0.0) continue;
    ++steep;
    EXPECT_NEAR(furthest * std::sqrt(slope2), gap, 1e-15);  // measured 2.8e-17
  }
  EXPECT_GT(steep, 1000);
}

TEST(CornerOnFace, TheDiscIsMeasuredToEverySide) {
  RandomPose random(2);
  int held = 0;
  for (int i = 0; i < 4000; ++i) {
    const BoxPolytope box(Box{random.vector(0.2, 1.0)});
    const auto face = static_cast<std::uint32_t>(i % 6);
    const Vec3 p = random.vector(-1.0, 1.0);
    const double gap = random.uniform(0.0, 0.2), slope = random.uniform(0.2, 1.0);
    double inside = kInfinity;
    for (int k = 0; k < 3; ++k) {
      if (k != i % 6 / 2) inside = std::min(inside, box.vertices[7][k] - std::abs(p[k]));
    }
    if (std::abs(inside - gap / slope) < 1e-12) continue;
    const bool holds = holds_disc(box, face, p, gap, slope * slope);
    EXPECT_EQ(holds, inside > gap / slope);
    held += holds;
  }
  EXPECT_GT(held, 500);
}

/// A corner of B, 1 mm deep in the middle of a face of A.
Pose stand_on(const Polytope& a, const Polytope::Face& face, const Shape& b, const Quat& q) {
  Vec3 middle = Vec3::Zero();
  for (const std::uint32_t vertex : a.loop(face)) middle += a.vertices[vertex] / face.count;
  return {q, middle - q * support(b, q.conjugate() * -face.normal) - 1e-3 * face.normal};
}

// Asked for all that is within 0.2 m, other corners are within the gap too: the face is clipped, and its deepest point is the
// contact that was found without.
TEST(CornerOnFace, ClippingFindsTheSame) {
  RandomPose random(3);
  int clipped = 0;
  double apart = 0.0;
  for (int i = 0; i < 3000; ++i) {
    const Box box{random.vector(0.3, 1.0)};
    const HullPointer hull = random_hull(random, 14, Vec3(0.6, 0.5, 0.7)),
                      b = random_hull(random, 14, Vec3(0.5, 0.6, 0.4));
    const BoxPolytope box_polytope(box);
    const Polytope& polytope = i % 2 == 0 ? static_cast<const Polytope&>(*hull) : box_polytope;
    const Shape a = i % 2 == 0 ? Shape(hull) : Shape(box);
    const auto face = static_cast<std::size_t>(i) % polytope.faces.size();
    const Pose X_AB = stand_on(polytope, polytope.faces[face], b, random.rotation());
    const auto ask = [&](double margin) {
      PairCache cache;
      NarrowPhaseCounters counters;
      // Of two hulls each stands on the other one in turn.
      return i % 4 == 0 ? collide(b, X_AB, a, {}, margin, {}, cache, counters)
                        : collide(a, {}, b, X_AB, margin, {}, cache, counters);
    };
    const Manifold near = ask(0.0), wide = ask(0.2);
    if (near.count != 1 || wide.count == 1) continue;
    ++clipped;
    ASSERT_EQ(wide.normal_A, near.normal_A);
    std::size_t deepest = 0;
    for (std::size_t k = 1; k < static_cast<std::size_t>(wide.count); ++k) {
      if (wide.points[k].separation < wide.points[deepest].separation) deepest = k;
    }
    const ManifoldPoint &point = near.points[0], &same = wide.points[deepest];
    EXPECT_EQ(same.separation, point.separation);
    EXPECT_EQ(same.feature, point.feature);
    apart = std::max(apart, (same.p_A - point.p_A).norm());
  }
  EXPECT_LE(apart, 1e-15);  // measured 3.5e-16
  EXPECT_GT(clipped, 2500);
}

}  // namespace
}  // namespace tumble::test
