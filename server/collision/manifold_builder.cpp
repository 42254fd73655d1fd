// Contact points in A's frame -> manifold. Points arrive in the order of the features that make them, so which of two
// merged points stays does not depend on rounding.
#include "collision/manifold_builder.h"

#include <utility>

namespace tumble {

void ManifoldBuilder::reduce() {
  std::array<double, kCapacity> distance2;
  distance2.fill(kInfinity);
  std::size_t next = 0;
  const std::size_t total = static_cast<std::size_t>(count_);
  for (std::size_t i = 1; i < total; ++i) {
    if (points_[i].separation < points_[next].separation) next = i;
  }
  for (std::size_t kept = 0; kept < kMaxManifoldPoints; ++kept) {
    std::swap(points_[kept], points_[next]);
    std::swap(distance2[kept], distance2[next]);
    next = kept + 1;
    for (std::size_t i = kept + 1; i < total; ++i) {
      distance2[i] = std::min(distance2[i], (points_[i].p_A - points_[kept].p_A).squaredNorm());
      if (distance2[i] > distance2[next]) next = i;
    }
  }
  count_ = kMaxManifoldPoints;
}

Manifold ManifoldBuilder::finish() {
  if (count_ > kMaxManifoldPoints) reduce();
  Manifold manifold;
  manifold.normal_A = normal_A_;
  manifold.count = count_;
  for (std::size_t i = 0; i < static_cast<std::size_t>(count_); ++i) manifold.points[i] = points_[i];
  return manifold;
}

void set_deepest(Manifold& manifold, double separation) {
  if (manifold.count == 0) return;
  std::size_t lowest = 0;
  double least = kInfinity;
  for (std::size_t i = 0; i < static_cast<std::size_t>(manifold.count); ++i) {
    double& of_point = manifold.points[i].separation;
    if (of_point < least) lowest = i, least = of_point;
    of_point = std::max(of_point, separation);
  }
  manifold.points[lowest].separation = separation;
}

}  // namespace tumble
