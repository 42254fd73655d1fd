// Contacts against ground truth, class by class: the table of `./run bench contacts`, and the same classes with fewer
// poses as tests. A class is a name, a count and a function that makes the next pair of placed shapes.
#pragma once

#include <functional>
#include <ostream>
#include <string>
#include <vector>

#include "collision/narrow_phase.h"
#include "support/core_truth.h"
#include "unit/collision/random_pose.h"

namespace tumble::test {

struct PlacedPair {
  Shape a, b;
  Pose X_WA, X_WB;
  double margin = 0.0;  ///< [m]
};

struct ContactClass {
  std::string pairs, name;
  int queries;  ///< Of the full table.
  std::function<PlacedPair(RandomPose&)> make;
};

inline void PrintTo(const ContactClass& c, std::ostream* out) {
  *out << c.pairs << ", " << c.name;
}

struct ContactFigures {
  int queries = 0, contacts = 0;
  int missed = 0, invented = 0, wrong_side = 0, outside = 0, bad_truth = 0;
  double depth = 0.0;  ///< Largest error of the deepest point, as a share of the size.
  double normal =
      0.0;  ///< Largest |n - best axis|, times how well the axis is determined (CoreTruth::normal_error).
  int wrong() const { return missed + invented + wrong_side + outside + bad_truth; }
};

/// Bounding radii together; of a half-space, twice the other's.
inline double size_of(const PlacedPair& pair) {
  const double a = bounding_radius(pair.a), b = bounding_radius(pair.b);
  return std::isinf(a) ? 2.0 * b : std::isinf(b) ? 2.0 * a : a + b;
}

/// Judges one manifold. Merging and clipping may move a point by this share of the size, and by 1 mm at most.
inline void judge(const PlacedPair& pair, const Manifold& m, const CoreTruth& truth,
                  ContactFigures& figures) {
  constexpr Real kMoved = 1e-2L;
  const double size = size_of(pair);
  const Real round_off = 1e-13L * size, separation = truth.separation();
  ++figures.queries;
  // The axis of a closest pair is known to the rounding of its points over their distance, and a foot on a face to what
  // its corners lie beside one plane.
  const Real rounding =
      (1e-17L * size + truth.unevenness()) * (1 + size / std::max<Real>(1e-15L, truth.core_separation()));
  // A hundredth of what is judged by it will do in any case: far apart, slivers round more than other shapes.
  figures.bad_truth += std::abs(truth.duality_gap()) > std::max<Real>(rounding, 1e-2L * round_off);
  if (m.count == 0) {
    figures.missed += separation < pair.margin - round_off;
    return;
  }
  ++figures.contacts;
  figures.invented += separation > pair.margin + round_off;
  const Vec3L n = m.normal_A.cast<Real>();
  Real deepest = m.points[0].separation;
  bool is_outside = false;
  for (int i = 0; i < m.count; ++i) {
    const ManifoldPoint& point = m.points[static_cast<std::size_t>(i)];
    deepest = std::min<Real>(deepest, point.separation);
    const Vec3L p = point.p_A.cast<Real>(), half = 0.5L * point.separation * n;
    const Real allowed = std::min<Real>(2e-3L, kMoved * size) + round_off;
    // On A's surface and on B's: half a gap back and forth along the normal.
    is_outside = is_outside || truth.outside(truth.a(), p - half) > allowed ||
                 truth.outside(truth.b(), p + half) > allowed;
  }
  figures.outside += is_outside;
  figures.wrong_side += truth.separation_along(n) < separation - kMoved * size;
  figures.depth = std::max(figures.depth, static_cast<double>(std::abs(deepest - separation) / size));
  figures.normal =
      std::max(figures.normal, static_cast<double>(truth.normal_error(m.normal_A, round_off, size)));
}

inline ContactFigures run_class(const ContactClass& contact_class, int queries) {
  RandomPose random(1);
  ContactFigures figures;
  NarrowPhaseCounters counters;
  for (int i = 0; i < queries; ++i) {
    const PlacedPair pair = contact_class.make(random);
    PairCache cache;
    const Manifold m = collide(pair.a, pair.X_WA, pair.b, pair.X_WB, pair.margin, {}, cache, counters);
    judge(pair, m, CoreTruth(pair.a, pair.X_WA, pair.b, pair.X_WB), figures);
  }
  return figures;
}

/// All classes of the table.
std::vector<ContactClass> contact_classes();

}  // namespace tumble::test
