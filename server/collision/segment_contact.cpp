// Closest points, or the two ends of the common part, of segments; all in A's frame. See segment_contact.h.
#include "collision/segment_contact.h"

#include "collision/feature_name.h"
#include "collision/manifold_builder.h"

namespace tumble {
namespace {

/// sin^2 of the angle below which two segments run side by side: the ends of a 1 m long pair are then within 0.5 mm.
constexpr double kSideBySide = 1e-6;
/// Square of the overlap, in parts of the lengths, that may be rounding.
constexpr double kTouching2 = 1e-26;

}  // namespace

Manifold make_segment_manifold(const RoundedSegment& a, const RoundedSegment& b, const Vec3& normal_A,
                               double margin, double merge, std::uint32_t feature) {
  ManifoldBuilder builder(normal_A, margin, merge);
  const double aa = a.core.reach.squaredNorm(), bb = b.core.reach.squaredNorm();
  const auto add = [&](const Vec3& p_a, const Vec3& p_b, std::uint32_t index) {
    // Apart or touching, two places are as far from each other as they are, whatever the normal thinks of it.
    const double along = normal_A.dot(p_b - p_a);
    const bool apart = along > 0.0 || along * along < kTouching2 * (aa + bb);
    const double gap = apart ? (p_b - p_a).norm() : along;
    const double separation = gap - a.radius - b.radius;
    const Vec3 middle = 0.5 * (p_a + p_b) + (0.5 * (a.radius - b.radius)) * normal_A;
    builder.add(middle, separation, index == 0 ? feature : mix_features(feature, index));
  };
  if (a.core.reach.cross(b.core.reach).squaredNorm() >= kSideBySide * aa * bb) {
    const SegmentPair closest = closest_points(a.core, b.core);
    add(closest.p_A, closest.p_B, 0);
  } else {
    for (const double side : {-1.0, 1.0}) {
      const Vec3 p_a = a.core.at(a.core.closest_parameter(b.core.at(side)));
      add(p_a, b.core.at(b.core.closest_parameter(p_a)), side < 0.0 ? 1 : 2);
    }
  }
  return builder.finish();
}

}  // namespace tumble
