// See collide_curved.h.
#include "collision/collide_curved.h"

#include "collision/manifold_builder.h"
#include "collision/patch.h"
#include "collision/segment.h"
#include "collision/separation_search.h"
#include "math/rotation.h"

namespace tumble {
namespace {

/// A face this nearly along the best direction (cosine), and within this of its separation (of the shapes' size), is the
/// best direction: it gives the normal exactly.
constexpr double kAlong = 1.0 - 1e-8, kAsGood = 1e-11;

double separation_along(const ConvexPieces& a, const ConvexPieces& b, const Vec3& n) {
  return n.dot(b.furthest(-n).p_A - a.furthest(n).p_A) - a.rounding() - b.rounding();
}

/// sin^2 of the slope from which on a part of a shape has one point that is furthest, whatever the normal's last digits.
constexpr double kSloping = 1e-6;

bool has_one_point(const Patch& patch, const Vec3& n) {
  if (patch.kind == Patch::Kind::point) return true;
  if (patch.is_flat()) return patch.normal.cross(n).squaredNorm() > kSloping;
  const Vec3 along = patch.corners[1] - patch.corners[0];
  return along.dot(n) * along.dot(n) > kSloping * along.squaredNorm();
}

/// Gives an inexact answer its place: where only one point of A or B looks along the normal, there, else in the middle of
/// the smaller of the parts that do.
void place_points(const Patch& a, const Patch& b, const ConvexPieces& pieces_a, const ConvexPieces& pieces_b,
                  Separation& best) {
  const Vec3 across = (best.separation + pieces_a.rounding() + pieces_b.rounding()) * best.normal_A;
  const bool one_of_a = has_one_point(a, best.normal_A), one_of_b = has_one_point(b, best.normal_A);
  const auto middle = [](const Patch& patch, const Vec3& n, const Vec3& furthest) -> Vec3 {
    Vec3 sum = Vec3::Zero();
    for (std::size_t i = 0; i < static_cast<std::size_t>(patch.count); ++i) sum += patch.corners[i];
    const Vec3 mean = sum / patch.count;
    return mean + n.dot(furthest - mean) * n;
  };
  const Vec3 of_a = pieces_a.furthest(best.normal_A).p_A, of_b = pieces_b.furthest(-best.normal_A).p_A;
  if (one_of_a || (!one_of_b && a.width <= b.width)) {
    best.p_A = one_of_a ? of_a : middle(a, best.normal_A, of_a);
    best.p_B = best.p_A + across;
  } else {
    best.p_B = one_of_b ? of_b : middle(b, best.normal_A, of_b);
    best.p_A = best.p_B - across;
  }
}

/// Takes the normal of a face of A or B if it does.
void snap(const ConvexPieces& a, const ConvexPieces& b, const Vec3& face_normal, double size,
          Separation& best) {
  if (face_normal.dot(best.normal_A) < kAlong) return;
  const double separation = separation_along(a, b, face_normal);
  if (separation < best.separation - kAsGood * size) return;
  best.normal_A = face_normal;
  best.separation = separation;
}

/// The contact along the direction that separates most.
Manifold touch_where(const ConvexPieces& a, const ConvexPieces& b, Separation best, double margin) {
  const Patch patch_a = patch_towards(a, best.normal_A), patch_b = patch_towards(b, -best.normal_A);
  const double size = a.radius() + b.radius();
  if (patch_a.is_flat()) snap(a, b, patch_a.normal, size, best);
  if (patch_b.is_flat()) snap(a, b, -patch_b.normal, size, best);
  if (!best.exact) place_points(patch_a, patch_b, a, b, best);
  const PatchContact contact{best.normal_A, best.separation, best.p_A, best.p_B, a.rounding(), b.rounding()};
  return make_patch_manifold(patch_a, patch_b, contact, margin);
}

}  // namespace

Manifold collide_curved(const Shape& shape_a, const Shape& shape_b, const Pose& X_AB, double margin,
                        PairCache& cache) {
  const ConvexPieces a(shape_a, Mat3::Identity(), Vec3::Zero()), b(shape_b, rotation_matrix(X_AB.q), X_AB.p);
  // From the line of centres and not from the last answer, so that a contact is a function of the pose to the last bit.
  const Separation best = find_separation(a, b, direction_or(X_AB.p, Vec3::UnitZ()), margin);
  cache.axis_A = best.normal_A;
  cache.gap = best.separation;
  cache.slack = 0.0;
  return best.separation > margin ? Manifold() : touch_where(a, b, best, margin);
}

Manifold collide_pieces(const ConvexPieces& a, const ConvexPieces& b, const Vec3& guess, double margin) {
  const Separation best = find_separation(a, b, guess, margin);
  return best.separation > margin ? Manifold() : touch_where(a, b, best, margin);
}

Manifold collide_half_space_curved(const Shape&, const Shape& shape_b, const Pose& X_AB, double margin) {
  const ConvexPieces b(shape_b, rotation_matrix(X_AB.q), X_AB.p);
  const Vec3 up = Vec3::UnitZ();
  const Vec3 lowest = b.furthest(-up).p_A;
  if (lowest.z() > margin) return {};
  return make_ground_manifold(patch_towards(b, -up), lowest, margin);
}

}  // namespace tumble
