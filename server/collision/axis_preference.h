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
  static AxisPreference of(double radius) { return {std::min(1e-6, 1e-6 * radius), std::min(1e-3, 1e-3 * radius)}; }

  /// Edges that cross nearly in a face's plane have that face's normal up to the tilt of the bodies: within 8 degrees
  /// the face, with its whole polygon of points, is the better contact. Other directions compete on equal terms.
  bool takes_edge(double face_separation, const Vec3& face_normal, double edge_separation,
                  const Vec3& edge_normal) const {
    constexpr double kNearlyParallel = 0.99;
    const bool near = std::abs(face_normal.dot(edge_normal)) > kNearlyParallel;
    return edge_separation > face_separation + (near ? edge : face);
  }
};

}  // namespace tumble
