// See corner_contact.h. The closest points come from distance.h, between two bounds that meet at round-off.
#include "collision/corner_contact.h"

#include "collision/distance.h"
#include "collision/feature_name.h"
#include "collision/manifold_builder.h"

namespace tumble {
namespace {

/// Share of the radii to which the axis and the points made along it know their separation.
constexpr double kAxisRounding = 1e-14;
/// Share of the radii by which clipping may miss the lowest point of bodies that lie face to face: a thousandth of the
/// width times their tilt.
constexpr double kLying = 1e-6;

}  // namespace

bool touches_along_axis(Manifold& manifold, double separation, double size) {
  const double rounding = kAxisRounding * size;
  if (separation >= -rounding && least_separation(manifold) > separation + rounding) return false;
  set_deepest(manifold, separation);
  return true;
}

Manifold contact_of_closest_points(const Manifold& along_axis, double separation, bool face_to_face,
                                   const Shape& a, const Shape& b, const Pose& X_AB, double margin,
                                   PairCache& cache) {
  const double size = bounding_radius(a) + bounding_radius(b);
  Manifold manifold = along_axis;
  const Distance distance = compute_distance(a, b, X_AB);
  // Bodies that lie face to face keep their whole polygon: clipping's tolerance for coincident edges left out the corner.
  const bool lying = face_to_face && distance.axis_A.dot(manifold.normal_A) > ContactTolerance::kFaceToFace &&
                     least_separation(manifold) <= distance.upper + kLying * size;
  if (!distance.overlap && lying) {
    set_deepest(manifold, distance.upper);
    return manifold;
  }
  const Vec3 middle_A = 0.5 * (distance.a_A + distance.b_A);
  if (distance.overlap || distance.upper <= separation + kAxisRounding * size) {
    if (manifold.count == 0)
      return single_point(manifold.normal_A, middle_A, separation, margin, name_corners());
    set_deepest(manifold, separation);
    return manifold;
  }
  cache.axis_A = distance.axis_A;
  cache.gap = distance.lower;
  cache.slack = -1.0;
  return single_point(distance.axis_A, middle_A, distance.upper, margin, name_corners());
}

}  // namespace tumble
