// Heights above the plane z_A = 0, see collide_half_space.h.
#include "collision/collide_half_space.h"

#include "collision/manifold_builder.h"
#include "math/rotation.h"

namespace tumble {
namespace {

Vec3 middle_of_gap(const Vec3& p_A) {
  return {p_A.x(), p_A.y(), 0.5 * p_A.z()};
}

}  // namespace

Manifold collide_half_space_sphere(const HalfSpace&, const Sphere& b, const Vec3& p_AB, double margin) {
  const Vec3 lowest = p_AB - Vec3(0, 0, b.radius);
  return single_point(Vec3::UnitZ(), middle_of_gap(lowest), lowest.z(), margin, 0);
}

Manifold collide_half_space_capsule(const HalfSpace&, const Capsule& b, const Pose& X_AB, double margin) {
  const Vec3 reach = X_AB.q * Vec3(0, 0, b.half_length);
  ManifoldBuilder builder(Vec3::UnitZ(), margin, ContactTolerance::of(b.half_length).merge);
  for (const double side : {-1.0, 1.0}) {
    const Vec3 lowest = X_AB.p + side * reach - Vec3(0, 0, b.radius);
    builder.add(middle_of_gap(lowest), lowest.z(), side < 0.0 ? 0 : 1);
  }
  return builder.finish();
}

Manifold collide_half_space_box(const HalfSpace&, const Box& b, const Pose& X_AB, double margin) {
  const Mat3 R = rotation_matrix(X_AB.q);
  Manifold manifold;
  if (X_AB.p.z() - R.row(2).cwiseAbs().dot(b.half_extents.transpose()) > margin) return manifold;
  for (std::uint32_t i = 0; i < 8; ++i) {
    const Vec3 corner(i & 1 ? b.half_extents.x() : -b.half_extents.x(),
                      i & 2 ? b.half_extents.y() : -b.half_extents.y(),
                      i & 4 ? b.half_extents.z() : -b.half_extents.z());
    const Vec3 p_A = R * corner + X_AB.p;
    if (p_A.z() > margin) continue;
    manifold.points[static_cast<std::size_t>(manifold.count++)] = {middle_of_gap(p_A), p_A.z(), i};
  }
  return manifold;
}

Manifold collide_half_space_hull(const HalfSpace&, const HullPointer& b, const Pose& X_AB, double margin) {
  if (X_AB.p.z() - b->radius > margin) return {};
  const Mat3 R = rotation_matrix(X_AB.q);
  ManifoldBuilder builder(Vec3::UnitZ(), margin, ContactTolerance::of(b->radius).merge);
  for (std::size_t i = 0; i < b->vertices.size(); ++i) {
    if (R.row(2).dot(b->vertices[i]) + X_AB.p.z() > margin) continue;
    const Vec3 p_A = R * b->vertices[i] + X_AB.p;
    builder.add(middle_of_gap(p_A), p_A.z(), static_cast<std::uint32_t>(i));
  }
  return builder.finish();
}

}  // namespace tumble
