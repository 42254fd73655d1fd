// Distances of a sphere's centre; inside the other shape the nearest face (or any direction, from a line) is the way out.
#include "collision/collide_sphere.h"

#include "collision/manifold_builder.h"
#include "collision/nearest_surface.h"
#include "collision/polytope.h"
#include "collision/segment.h"

namespace tumble {
namespace {

/// B's surface point nearest to A's centre is the centre + `height` * normal_A.
Manifold from_centre(const Sphere& a, const Vec3& normal_A, double height, double margin,
                     std::uint32_t feature) {
  const double separation = height - a.radius;
  return single_point(normal_A, (a.radius + 0.5 * separation) * normal_A, separation, margin, feature);
}

template <typename Curved>
Manifold from_nearest(const Sphere& a, const Curved& b, const Pose& X_AB, double margin) {
  const NearestSurface found = nearest_surface(b, -(X_AB.q.conjugate() * X_AB.p));
  return from_centre(a, X_AB.q * -found.outward_S, found.distance, margin, 0);
}

}  // namespace

Manifold collide_sphere_sphere(const Sphere& a, const Sphere& b, const Vec3& p_AB, double margin) {
  const double reach = a.radius + b.radius + margin;
  const double distance2 = p_AB.squaredNorm();
  if (reach < 0.0 || distance2 > reach * reach) return {};
  const double distance = std::sqrt(distance2);
  const Vec3 normal_A = distance > 0.0 ? Vec3(p_AB / distance) : Vec3(Vec3::UnitZ());
  return from_centre(a, normal_A, distance - b.radius, margin, 0);
}

Manifold collide_sphere_capsule(const Sphere& a, const Capsule& b, const Pose& X_AB, double margin) {
  const Segment axis{X_AB.p, X_AB.q * Vec3(0, 0, b.half_length)};
  const double s = axis.closest_parameter(Vec3::Zero());
  const Vec3 nearest = axis.at(s);
  const double distance = nearest.norm();
  const Vec3 normal_A = distance > 0.0 ? Vec3(nearest / distance) : perpendicular_to(axis.reach);
  return from_centre(a, normal_A, distance - b.radius, margin, 0);
}

Manifold collide_sphere_box(const Sphere& a, const Box& b, const Pose& X_AB, double margin) {
  const Vec3 centre_B = -(X_AB.q.conjugate() * X_AB.p);
  const Vec3 excess = centre_B.cwiseAbs() - b.half_extents;
  Vec3 outward_B = Vec3::Zero();
  for (int k = 0; k < 3; ++k) outward_B[k] = excess[k] > 0.0 ? std::copysign(excess[k], centre_B[k]) : 0.0;
  double height = outward_B.norm();
  if (height > 0.0) {
    outward_B /= height;
  } else {
    int k = 0;
    height = excess.maxCoeff(&k);
    outward_B = Vec3::Unit(k) * std::copysign(1.0, centre_B[k]);
  }
  return from_centre(a, X_AB.q * -outward_B, height, margin, 0);
}

Manifold collide_sphere_hull(const Sphere& a, const HullPointer& b, const Pose& X_AB, double margin) {
  const Vec3 centre_B = -(X_AB.q.conjugate() * X_AB.p);
  const double reach = a.radius + margin;
  if (centre_B.squaredNorm() > (b->radius + reach) * (b->radius + reach)) return {};
  const PointDistance nearest = compute_distance(*b, centre_B, reach);
  return from_centre(a, X_AB.q * -nearest.normal, nearest.distance, margin, nearest.feature);
}

Manifold collide_sphere_cylinder(const Sphere& a, const Cylinder& b, const Pose& X_AB, double margin) {
  return from_nearest(a, b, X_AB, margin);
}

Manifold collide_sphere_cone(const Sphere& a, const Cone& b, const Pose& X_AB, double margin) {
  return from_nearest(a, b, X_AB, margin);
}

Manifold collide_sphere_ellipsoid(const Sphere& a, const Ellipsoid& b, const Pose& X_AB, double margin) {
  return from_nearest(a, b, X_AB, margin);
}

}  // namespace tumble
