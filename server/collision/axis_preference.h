// Which of two nearly equal separating axes is taken. A function of the pose alone, so that a stack at rest does not
// flip between them, and so small that no contact is misjudged by more than these lengths.
#pragma once

#include <algorithm>
#include <cmath>

#include "math/types.h"

namespace tumble {

struct AxisPreference {
  double face;  ///< A later face must separate more than an earlier one by this [m].
  double edge;  ///< A pair of edges must separate more than a face of nearly the same direction by this [m].

  /// For shapes whose smaller one has this bounding radius [m]: 1 um and 1 mm on everyday sizes.
  static AxisPreference of(double radius) {
    return {std::min(1e-6, 1e-6 * radius), std::min(1e-3, 1e-3 * radius)};
  }

  /// Bodies that lie on each other have edges crossing in the plane of a face; their axis is that face's normal up to
  /// the tilt of the bodies, or anything if the edges are parallel too. There the face, with its whole polygon of points,
  /// is the better contact. Other directions compete on equal terms. sin2: of the angle between the edges.
  bool takes_edge(double face_separation, const Vec3& face_normal, double edge_separation,
                  const Vec3& edge_normal, double sin2) const {
    constexpr double kNearlyParallel = 1.0 - 5e-5, kIllDefined = 1e-4;  // both 0.01 rad
    const bool near = sin2 < kIllDefined || face_normal.dot(edge_normal) > kNearlyParallel;
    return edge_separation > face_separation + (near ? edge : face);
  }
};

}  // namespace tumble
