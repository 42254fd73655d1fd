// Collects contact points into a manifold: leaves out those beyond the margin, merges near-duplicates, and keeps eight.
#pragma once

#include <array>
#include <cmath>

#include "collision/manifold.h"

namespace tumble {

/// Lengths [m] below which clipping calls two places the same.
struct ContactTolerance {
  double inside;  ///< A vertex this far outside a face still counts as inside and is not moved.
  double merge;   ///< Points closer than this are one.

  /// On bodies that lie face to face 0.1 mm and 1 mm (coincident edges otherwise let points jump along the edge: a warm
  /// start's residual was 1e-3 instead of 1e-8), but never more than these fractions of the narrower face, `width` [m]
  /// across. Faces that meet at an angle have no edges to confuse: there a vertex outside is outside.
  static ContactTolerance of(double width, bool face_to_face = true) {
    return {face_to_face ? std::min(1e-4, 1e-3 * width) : 0.0, std::min(1e-3, 1e-2 * width)};
  }
  /// Signed distances closer than this [m] have no crossing worth computing.
  static constexpr double kNoCrossing = 1e-12;
  /// Cosine of the angle between the contact normal and both faces of bodies that lie face to face: 0.01 rad.
  static constexpr double kFaceToFace = 1.0 - 5e-5;
  /// Cosine of 0.1 rad. Edges that cross under a face as flat as this to their axis lie in a contact of that face: it keeps
  /// the whole polygon of points (an edge across the face, or a capsule: both ends), only measured along the edges\' axis.
  static constexpr double kFlat = 0.995;
};

/// Puts a point behind the first `count` and returns their new number, unless it is one with any of them. Of two merged
/// points the deeper gives its place and depth, the first its name. It also keeps its place while the other is no deeper
/// than a thousandth of their distance, so that rounding can't move it.
inline int add_or_merge(ManifoldPoint* points, int count, double merge, const ManifoldPoint& point) {
  constexpr double kDeeper = 1e-3;
  for (int i = 0; i < count; ++i) {
    ManifoldPoint& kept = points[i];
    const Vec3 apart = kept.p_A - point.p_A;
    if (std::abs(apart.x()) >= merge || std::abs(apart.y()) >= merge) continue;  // most
    if (apart.squaredNorm() >= merge * merge) continue;
    if (point.separation < kept.separation - kDeeper * merge) kept.p_A = point.p_A;
    kept.separation = std::min(kept.separation, point.separation);
    return count;
  }
  points[count] = point;
  return count + 1;
}

class ManifoldBuilder {
 public:
  ManifoldBuilder(const Vec3& normal_A, double margin, double merge)
      : normal_A_(normal_A), margin_(margin), merge_(merge) {}

  void add(const Vec3& p_A, double separation, std::uint32_t feature) {
    if (!(separation <= margin_)) return;
    if (count_ == kCapacity) reduce();
    count_ = add_or_merge(points_.data(), count_, merge_, {p_A, separation, feature});
  }
  int count() const { return count_; }
  /// At most eight points: the deepest, then always the one furthest from those kept.
  Manifold finish();

 private:
  static constexpr int kCapacity = 64;
  void reduce();

  Vec3 normal_A_;
  double margin_, merge_;
  int count_ = 0;
  std::array<ManifoldPoint, kCapacity> points_;
};

/// A manifold of one point, or none if it is further than the margin.
inline Manifold single_point(const Vec3& normal_A, const Vec3& p_A, double separation, double margin,
                             std::uint32_t feature) {
  Manifold manifold;
  manifold.normal_A = normal_A;
  if (separation <= margin) {
    manifold.count = 1;
    manifold.points[0] = {p_A, separation, feature};
  }
  return manifold;
}

/// Gives the lowest point this separation [m], that of the axis, and no other one less: clipping knows it only up to its
/// tolerances.
void set_deepest(Manifold& manifold, double separation);

}  // namespace tumble
