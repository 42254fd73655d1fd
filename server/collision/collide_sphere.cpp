// Distances of a sphere's centre; inside the other shape the nearest face (or any direction, from a line) is the way out.
#include "collision/collide_sphere.h"

#include "collision/manifold_builder.h"
#include "collision/polytope.h"
#include "collision/segment.h"

namespace tumble {
namespace {

/// Climbing to an ellipsoid's root; 4 to 12 are used.
constexpr int kNewtonRounds = 100;

/// B's surface point nearest to A's centre is the centre + `height` * normal_A.
Manifold from_centre(const Sphere& a, const Vec3& normal_A, double height, double margin,
                     std::uint32_t feature) {
  const double separation = height - a.radius;
  return single_point(normal_A, (a.radius + 0.5 * separation) * normal_A, separation, margin, feature);
}

/// A solid of revolution about z: the half-plane (distance from the axis, z) of a point, and its way back to S.
struct Meridian {
  explicit Meridian(const Vec3& p_S) : rho(std::sqrt(p_S.x() * p_S.x() + p_S.y() * p_S.y())), z(p_S.z()) {
    if (rho > 0.0) cosine = p_S.x() / rho, sine = p_S.y() / rho;
  }
  Vec3 lift(double out, double up) const { return {out * cosine, out * sine, up}; }

  double rho, z, cosine = 1.0, sine = 0.0;
};

/// Distance of a point from a solid and the outward direction there, in the solid's frame.
struct Nearest {
  double distance;
  Vec3 outward_S;
};

Nearest nearest_on_cylinder(const Cylinder& c, const Vec3& p_S) {
  const Meridian m(p_S);
  const double beside = m.rho - c.radius, above = std::abs(m.z) - c.half_length;
  const double up = std::copysign(1.0, m.z);
  if (beside <= 0.0 && above <= 0.0) {
    return above >= beside ? Nearest{above, {0, 0, up}} : Nearest{beside, m.lift(1.0, 0.0)};
  }
  const double out = std::max(beside, 0.0), over = std::max(above, 0.0);
  const double distance = std::sqrt(out * out + over * over);
  return {distance, m.lift(out / distance, up * over / distance)};
}

Nearest nearest_on_cone(const Cone& c, const Vec3& p_S) {
  const Meridian m(p_S);
  const double length = std::sqrt(c.radius * c.radius + 4.0 * c.half_length * c.half_length);
  // The side runs from the rim to the apex along (-nz, nr); (nr, nz) is its normal.
  const double nr = 2.0 * c.half_length / length, nz = c.radius / length;
  const double from_rim = m.rho - c.radius, over_base = m.z + c.half_length;
  const double above_side = nr * from_rim + nz * over_base;
  const double along = nr * over_base - nz * from_rim;
  if (above_side <= 0.0 && over_base >= 0.0) {
    return -over_base >= above_side ? Nearest{-over_base, {0, 0, -1}} : Nearest{above_side, m.lift(nr, nz)};
  }
  if (over_base < 0.0 && from_rim <= 0.0) return {-over_base, {0, 0, -1}};
  if (along >= 0.0 && along <= length) return {above_side, m.lift(nr, nz)};
  const double out = along > length ? m.rho : from_rim, up = along > length ? m.z - c.half_length : over_base;
  const double distance = std::sqrt(out * out + up * up);
  return distance > 0.0 ? Nearest{distance, m.lift(out / distance, up / distance)}
                        : Nearest{0.0, m.lift(nr, nz)};
}

/// The nearest point is x_i = a_i^2 p_i / (t + a_i^2) for the largest root t of sum (x_i / a_i)^2 = 1, and t > -min a^2
/// (Eberly, Distance from a Point to an Ellipse, 2013). Left of it lies a pole where the sum is infinite, or, for a
/// point in the plane across the shortest axis near the middle, an x along that axis that makes up what is missing.
Nearest nearest_on_ellipsoid(const Ellipsoid& e, const Vec3& p_S) {
  const double scale = e.half_axes.maxCoeff();
  const Vec3 a = e.half_axes / scale, y = p_S.cwiseAbs() / scale;
  int least = 0;
  const double a_min = a.minCoeff(&least);
  // With s = t + a_min^2 the denominators are s + gap_i. Each term alone bounds the root from below, and from there
  // Newton's method climbs to it, since the sum falls and is convex.
  const Vec3 gap = (a.array() - a_min) * (a.array() + a_min);
  const Vec3 ay = a.cwiseProduct(y);
  double s = std::max(0.0, (ay - gap).maxCoeff());
  Vec3 x;
  for (int round = 0; round < kNewtonRounds; ++round) {
    double excess = -1.0, slope = 0.0;
    for (int i = 0; i < 3; ++i) {
      const double term = ay[i] > 0.0 ? ay[i] / (s + gap[i]) : 0.0;
      excess += term * term;
      slope += term > 0.0 ? term * term / (s + gap[i]) : 0.0;
    }
    const double next = excess > 0.0 ? s + 0.5 * excess / slope : s;
    if (!(next > s)) break;
    s = next;
  }
  if (s > 0.0) {
    for (int i = 0; i < 3; ++i) x[i] = a[i] * (ay[i] / (s + gap[i]));
  } else {
    double missing = 1.0;
    for (int i = 0; i < 3; ++i) {
      x[i] = gap[i] > 0.0 ? a[i] * (ay[i] / gap[i]) : 0.0;
      missing -= (x[i] / a[i]) * (x[i] / a[i]);
    }
    x[least] = a[least] * std::sqrt(std::max(0.0, missing));
  }
  for (int i = 0; i < 3; ++i) x[i] = std::copysign(x[i], p_S[i]);
  const Vec3 outward = x.cwiseQuotient(a.cwiseAbs2()).normalized();
  return {scale * outward.dot(p_S / scale - x), outward};
}

template <typename Curved>
Manifold from_nearest(const Sphere& a, const Curved& b, Nearest (*nearest)(const Curved&, const Vec3&),
                      const Pose& X_AB, double margin) {
  const Nearest found = nearest(b, -(X_AB.q.conjugate() * X_AB.p));
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
  const PointDistance nearest = compute_distance(view_of(*b), centre_B, reach);
  return from_centre(a, X_AB.q * -nearest.normal, nearest.distance, margin, nearest.feature);
}

Manifold collide_sphere_cylinder(const Sphere& a, const Cylinder& b, const Pose& X_AB, double margin) {
  return from_nearest(a, b, nearest_on_cylinder, X_AB, margin);
}

Manifold collide_sphere_cone(const Sphere& a, const Cone& b, const Pose& X_AB, double margin) {
  return from_nearest(a, b, nearest_on_cone, X_AB, margin);
}

Manifold collide_sphere_ellipsoid(const Sphere& a, const Ellipsoid& b, const Pose& X_AB, double margin) {
  return from_nearest(a, b, nearest_on_ellipsoid, X_AB, margin);
}

}  // namespace tumble
