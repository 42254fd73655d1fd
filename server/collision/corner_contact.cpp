// See corner_contact.h. The closest points come from distance.h, between two bounds that meet at round-off.
#include "collision/corner_contact.h"

#include "collision/distance.h"
#include "collision/feature_name.h"
#include "collision/manifold_builder.h"
#include "math/rotation.h"

namespace tumble {
namespace {

/// Share of the radii to which the axis and the points made along it know their separation.
constexpr double kAxisRounding = 1e-14;
/// Share of the radii by which clipping may miss the lowest point of bodies that lie face to face: a thousandth of the
/// width times their tilt.
constexpr double kLying = 1e-6;
/// Share of the radii: across a gap this small, times the tilt, it makes no difference along which face it is seen.
constexpr double kParallelFaces = 1e-11;

/// The lowest point hangs over nothing, and what lies beneath the edge beside it is further away, another way.
bool hangs_over(const AxisContact& contact) {
  return contact.overhang > kAxisRounding * contact.size &&
         contact.tilt * contact.separation > kParallelFaces * contact.size;
}

}  // namespace

bool touches_along_axis(AxisContact& contact) {
  if (contact.manifold.count == 0) return false;
  const double rounding = kAxisRounding * contact.size;
  const bool apart = contact.separation >= -rounding;
  if (apart && least_separation(contact.manifold) > contact.separation + rounding) return false;
  if (apart && hangs_over(contact)) return false;
  set_deepest(contact.manifold, contact.separation);
  return true;
}

ClosestContact contact_of_closest_points(const AxisContact& along_axis, const Shape& a, const Shape& b,
                                         const Pose& X_AB, double margin, PairCache& cache) {
  const Manifold& manifold = along_axis.manifold;
  const double separation = along_axis.separation;
  const Distance distance = compute_distance(a, b, X_AB);
  const Vec3 middle_A = 0.5 * (distance.a_A + distance.b_A);
  if (distance.overlap || distance.upper <= separation + kAxisRounding * along_axis.size) {
    if (manifold.count == 0)
      return {single_point(manifold.normal_A, middle_A, separation, margin, name_corners())};
    ClosestContact contact{manifold};
    set_deepest(contact.manifold, separation);
    return contact;
  }
  cache.axis_A = distance.axis_A;
  cache.gap = distance.lower;
  cache.slack = -1.0;
  const bool lying = along_axis.face_to_face &&
                     distance.axis_A.dot(manifold.normal_A) > ContactTolerance::kFaceToFace &&
                     least_separation(manifold) <= distance.upper + kLying * along_axis.size;
  // The planes are known to round-off; the points, where edges run nearly side by side, only to the root of it.
  const double apart = separation_along(a, b, rotation_matrix(X_AB.q), X_AB.p, distance.axis_A);
  return {single_point(distance.axis_A, middle_A, apart, margin, name_corners()), lying, apart};
}

}  // namespace tumble
