// The corners that clipping leaves -> contact points: everything up to the margin, merged.
#pragma once

#include <algorithm>
#include <array>

#include "collision/manifold_builder.h"
#include "math/four.h"

namespace tumble {

/// Where the edge from p to q crosses a side that they are `outside` and `next_outside` of [m]; false if they lie on one
/// side, or as good as on it.
inline bool cross_side(const Four& p, const Four& q, double outside, double next_outside, Four& crossing) {
  const double rise = next_outside - outside;
  crossing = p + (outside / -rise) * (q - p);
  return outside * next_outside < 0.0 && std::abs(rise) > ContactTolerance::kNoCrossing;
}

/// What a manifold needs to know beside its corners.
struct Lying {
  Vec3 normal_A;
  bool overlap;
  double margin;
  ContactTolerance tolerance;
};

/// Points of a manifold as they lie in the reference plane; those that are not there lie far from all.
struct PointsInPlane {
  std::array<Four, 2> x = {Four{1e200, 2e200, 3e200, 4e200}, Four{5e200, 6e200, 7e200, 8e200}}, y{};

  void set(std::size_t i, double of_x, double of_y) {
    x[i / 4][i % 4] = of_x;
    y[i / 4][i % 4] = of_y;
  }

  /// The least of all distances between two of them, along x or y whichever is more.
  double closest() const {
    Four nearest = four(kInfinity);
    const auto compare = [&](const Four& xa, const Four& ya, const Four& xb, const Four& yb) {
      nearest = smaller(larger(absolute(xa - xb), absolute(ya - yb)), nearest);
    };
    compare(x[0], y[0], x[1], y[1]);
    compare(x[0], y[0], rotated<1>(x[0]), rotated<1>(y[0]));
    compare(x[0], y[0], rotated<2>(x[0]), rotated<2>(y[0]));
    compare(x[0], y[0], rotated<1>(x[1]), rotated<1>(y[1]));
    compare(x[0], y[0], rotated<2>(x[1]), rotated<2>(y[1]));
    compare(x[0], y[0], rotated<3>(x[1]), rotated<3>(y[1]));
    compare(x[1], y[1], rotated<1>(x[1]), rotated<1>(y[1]));
    compare(x[1], y[1], rotated<2>(x[1]), rotated<2>(y[1]));
    return std::min({nearest[0], nearest[1], nearest[2], nearest[3]});
  }
};

/// Everything up to the margin. If that is nothing although the bodies overlap, by rounding, the lowest corner of what is
/// left speaks for it. `put_middle_A(p, middle)` makes `middle` the point in A in the middle between p and the plane.
template <typename Corners, typename PutMiddleA>
Manifold collect_points(const Corners& corners, const PutMiddleA& put_middle_A, const Lying& lying) {
  Manifold manifold;
  manifold.normal_A = lying.normal_A;
  const std::size_t total = corners.count();
  const auto put = [&](std::size_t i, ManifoldPoint& point) {
    put_middle_A(corners.place(i), point.p_A);
    point.separation = corners.place(i)[2];
    point.feature = corners.name(i);
  };
  std::size_t count = 0;
  PointsInPlane seen;
  for (std::size_t i = 0; i < total && count < kMaxManifoldPoints; ++i) {
    const Four& p = corners.place(i);
    if (!(p[2] <= lying.margin)) continue;
    seen.set(count, p[0], p[1]);
    put(i, manifold.points[count++]);
  }
  manifold.count = static_cast<int>(count);
  // In the plane they are no further apart than in space but for the tilt of the normal.
  constexpr double kTilted = 1.25;
  if (total > kMaxManifoldPoints || !(seen.closest() > kTilted * lying.tolerance.merge)) {
    manifold.count = 0;
    for (std::size_t i = 0; i < total && manifold.count < kMaxManifoldPoints; ++i) {
      if (!(corners.place(i)[2] <= lying.margin)) continue;
      ManifoldPoint point;
      put(i, point);
      manifold.count = add_or_merge(manifold.points.data(), manifold.count, lying.tolerance.merge, point);
    }
  }
  if (manifold.count > 0 || !lying.overlap || total == 0) return manifold;
  std::size_t lowest = 0;
  for (std::size_t i = 1; i < total; ++i) {
    if (corners.place(i)[2] < corners.place(lowest)[2]) lowest = i;
  }
  manifold.count = 1;
  put(lowest, manifold.points[0]);
  manifold.points[0].separation = std::min(manifold.points[0].separation, lying.margin);
  return manifold;
}

}  // namespace tumble
