// See mass_properties.h. Frames: S shape, F any frame of description, B body, P principal axes, W world.
#include "dynamics/mass_properties.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "math/rotation.h"

namespace tumble {
namespace {

using std::numbers::pi;

/// Off-diagonal moments below this share of the largest moment are the rounding of the tensor's own entries.
constexpr double kMomentRounding = 4e-16;

Inertia sphere_inertia(double r, double density) {
  const double m = density * (4.0 / 3.0) * pi * r * r * r;
  return {m, Vec3::Zero(), (0.4 * m * r * r) * Mat3::Identity()};
}

/// With full edges w = 2 h: 1/12 m (w_y^2 + w_z^2) = 1/3 m (h_y^2 + h_z^2).
Inertia box_inertia(const Vec3& h, double density) {
  const double m = density * 8.0 * h.x() * h.y() * h.z();
  const Vec3 h2 = h.cwiseAbs2();
  const Vec3 moments = (m / 3.0) * Vec3(h2.y() + h2.z(), h2.z() + h2.x(), h2.x() + h2.y());
  return {m, Vec3::Zero(), moments.asDiagonal()};
}

/// 1/2 m r^2 about the axis, 1/4 m r^2 + 1/12 m (2 l)^2 across.
Inertia cylinder_inertia(double r, double l, double density) {
  const double m = density * pi * r * r * (2.0 * l);
  const double across = m * (0.25 * r * r + l * l / 3.0);
  return {m, Vec3::Zero(), Vec3(across, across, 0.5 * m * r * r).asDiagonal()};
}

/// Height 2 l; the centre lies a quarter of it above the base. 3/10 m r^2 about the axis, and
/// 3/20 m r^2 + 3/80 m (2 l)^2 across it through the centre.
Inertia cone_inertia(double r, double l, double density) {
  const double m = density * pi * r * r * (2.0 * l) / 3.0;
  const double across = 0.15 * m * (r * r + l * l);
  return {m, Vec3(0, 0, -0.5 * l), Vec3(across, across, 0.3 * m * r * r).asDiagonal()};
}

/// 1/5 m (a_y^2 + a_z^2).
Inertia ellipsoid_inertia(const Vec3& a, double density) {
  const double m = density * (4.0 / 3.0) * pi * a.x() * a.y() * a.z();
  const Vec3 a2 = a.cwiseAbs2();
  const Vec3 moments = (0.2 * m) * Vec3(a2.y() + a2.z(), a2.z() + a2.x(), a2.x() + a2.y());
  return {m, Vec3::Zero(), moments.asDiagonal()};
}

/// A cylinder of length 2 l and two half-spheres, whose own centres lie 3/8 r beyond its ends.
Inertia capsule_inertia(double r, double l, double density) {
  const double cylinder = density * pi * r * r * (2.0 * l);
  const double caps = density * (4.0 / 3.0) * pi * r * r * r;
  const double axial = cylinder * (0.5 * r * r) + caps * (0.4 * r * r);
  const double across = cylinder * (0.25 * r * r + l * l / 3.0) + caps * (0.4 * r * r + l * l + 0.75 * r * l);
  return {cylinder + caps, Vec3::Zero(), Vec3(across, across, axial).asDiagonal()};
}

/// tr(C) 1 - C for the second moments C = int x x^T dm, without subtracting on the diagonal.
Mat3 moments_from_second_moments(const Mat3& C) {
  Mat3 moments = -C;
  moments.diagonal() << C(1, 1) + C(2, 2), C(2, 2) + C(0, 0), C(0, 0) + C(1, 1);
  return moments;
}

/// Sums tetrahedra from a point inside to a fan over each face: all volumes are positive, so nothing cancels. For one
/// with its apex at the origin and base v1 v2 v3, det = [v1 v2 v3], s = v1 + v2 + v3:
///   V = det/6,   int x = det s/24,   int x x^T = det (v1 v1^T + v2 v2^T + v3 v3^T + s s^T)/120.
Inertia hull_inertia(const ConvexHull& hull, double density) {
  Vec3 apex = Vec3::Zero();
  for (const Vec3& vertex : hull.vertices) apex += vertex;
  apex /= static_cast<double>(hull.vertices.size());

  double volume = 0.0;
  Vec3 first = Vec3::Zero();
  Mat3 second = Mat3::Zero();
  for (const Polytope::Face& face : hull.faces) {
    const std::uint32_t* loop = &hull.loops[face.first];
    const Vec3 v1 = hull.vertices[loop[0]] - apex;
    for (std::uint32_t i = 2; i < face.count; ++i) {
      const Vec3 v2 = hull.vertices[loop[i - 1]] - apex;
      const Vec3 v3 = hull.vertices[loop[i]] - apex;
      const double det = v1.dot(v2.cross(v3));
      const Vec3 s = v1 + v2 + v3;
      volume += det / 6.0;
      first += (det / 24.0) * s;
      second += (det / 120.0) *
                (v1 * v1.transpose() + v2 * v2.transpose() + v3 * v3.transpose() + s * s.transpose());
    }
  }
  const Vec3 center = first / volume;  // from the apex
  const Mat3 about_center = second - volume * (center * center.transpose());
  return {density * volume, apex + center, density * moments_from_second_moments(about_center)};
}

struct InertiaOf {
  double density;
  Inertia operator()(const HalfSpace&) const {
    throw std::invalid_argument("shape: a half_space has no mass");
  }
  Inertia operator()(const Sphere& s) const { return sphere_inertia(s.radius, density); }
  Inertia operator()(const Box& b) const { return box_inertia(b.half_extents, density); }
  Inertia operator()(const Capsule& c) const { return capsule_inertia(c.radius, c.half_length, density); }
  Inertia operator()(const Cylinder& c) const { return cylinder_inertia(c.radius, c.half_length, density); }
  Inertia operator()(const Cone& c) const { return cone_inertia(c.radius, c.half_length, density); }
  Inertia operator()(const Ellipsoid& e) const { return ellipsoid_inertia(e.half_axes, density); }
  Inertia operator()(const HullPointer& hull) const { return hull_inertia(*hull, density); }
  Inertia operator()(const TriangleMeshPointer&) const {
    throw std::invalid_argument("shape: a triangle_mesh has no mass");
  }
  Inertia operator()(const HeightFieldPointer&) const {
    throw std::invalid_argument("shape: a height_field has no mass");
  }
};

Mat3 symmetric_part(const Mat3& m) {
  return 0.5 * (m + m.transpose());
}

struct PrincipalAxes {
  Vec3 moments;
  Mat3 R;  // columns: principal axes, right-handed
};

/// Cyclic Jacobi rotations (Golub & Van Loan 8.5). Axes keep their order, so a nearly diagonal tensor is nearly
/// unturned; each rotation is by at most 45 degrees, and their product is right-handed.
PrincipalAxes compute_principal_axes(const Mat3& tensor) {
  Mat3 a = symmetric_part(tensor);
  Mat3 R = Mat3::Identity();
  const double negligible = kMomentRounding * a.diagonal().cwiseAbs().maxCoeff();
  for (int sweep = 0; sweep < 20; ++sweep) {  // converges quadratically: 4 to 6 sweeps seen
    bool diagonal = true;
    for (int p = 0; p < 2; ++p) {
      for (int q = p + 1; q < 3; ++q) {
        if (std::abs(a(p, q)) <= negligible) continue;
        diagonal = false;
        const double theta = (a(q, q) - a(p, p)) / (2.0 * a(p, q));
        const double t = std::copysign(1.0, theta) / (std::abs(theta) + std::sqrt(theta * theta + 1.0));
        const double c = 1.0 / std::sqrt(t * t + 1.0);
        Mat3 G = Mat3::Identity();
        G(p, p) = G(q, q) = c;
        G(p, q) = t * c;
        G(q, p) = -t * c;
        a = symmetric_part(G.transpose() * a * G);
        a(p, q) = a(q, p) = 0.0;
        R = R * G;
      }
    }
    if (diagonal) break;
  }
  return {a.diagonal(), R};
}

}  // namespace

Inertia compute_inertia(const Shape& shape, double density) {
  return std::visit(InertiaOf{density}, shape);
}

Inertia transformed(const Inertia& inertia_S, const Pose& X_FS) {
  const Mat3 R = rotation_matrix(X_FS.q);
  return {inertia_S.mass, X_FS * inertia_S.center, symmetric_part(R * inertia_S.moments * R.transpose())};
}

Inertia combined(const std::vector<Inertia>& parts) {
  if (parts.empty()) throw std::invalid_argument("inertia: a body needs at least one part with mass");
  Inertia whole;
  Vec3 first =
      Vec3::Zero();  // from the first part's centre, so that equal centres stay exactly where they are
  for (const Inertia& part : parts) {
    whole.mass += part.mass;
    first += part.mass * (part.center - parts[0].center);
  }
  whole.center = parts[0].center + first / whole.mass;
  for (const Inertia& part : parts) {
    const Vec3 d = part.center - whole.center;
    whole.moments += part.moments + part.mass * moments_from_second_moments(d * d.transpose());
  }
  return whole;
}

std::string check_inertia(const Inertia& inertia) {
  const double mass = inertia.mass;
  if (!(mass > 0.0) || !std::isfinite(mass) || !std::isfinite(1.0 / mass)) {
    return fmt::format("mass: must be > 0 and finite ({})", mass);
  }
  const Vec3& c = inertia.center;
  if (!c.allFinite()) return fmt::format("center: must be finite ({} {} {})", c.x(), c.y(), c.z());
  const Mat3& I = inertia.moments;
  if (!I.allFinite()) {
    return fmt::format("moments: must be finite (xx {} yy {} zz {} xy {} xz {} yz {})", I(0, 0), I(1, 1),
                       I(2, 2), I(0, 1), I(0, 2), I(1, 2));
  }
  const double scale = I.cwiseAbs().maxCoeff();
  for (const auto& [i, j] : {std::pair{0, 1}, {0, 2}, {1, 2}}) {
    if (std::abs(I(i, j) - I(j, i)) > 1e-9 * scale) {
      return fmt::format("moments: must be symmetric ({0}{1} {2}, {1}{0} {3})", "xyz"[i], "xyz"[j], I(i, j),
                         I(j, i));
    }
  }
  const Vec3 m = compute_principal_axes(I).moments;
  const std::string values = fmt::format("(principal moments {} {} {})", m.x(), m.y(), m.z());
  const double largest = m.maxCoeff();
  // Below 1e-12 of the largest a moment is no longer told from the rounding of the tensor.
  if (!(m.minCoeff() > 1e-12 * largest) || !std::isfinite(1.0 / m.minCoeff())) {
    return "moments: must be positive definite " + values;
  }
  if (largest > (m.sum() - largest) * (1.0 + 1e-9)) {
    return "moments: no mass has a principal moment larger than the sum of the other two " + values;
  }
  return {};
}

MassProperties compute_mass_properties(const Inertia& inertia) {
  const PrincipalAxes axes = compute_principal_axes(inertia.moments);
  MassProperties properties;
  properties.mass = inertia.mass;
  properties.inv_mass = 1.0 / inertia.mass;
  properties.I = axes.moments;
  properties.inv_I = axes.moments.cwiseInverse();
  properties.q_BP = normalized(Quat(axes.R));
  return properties;
}

Mat3 world_inertia(const Vec3& principal_moments, const Quat& q_BP, const Quat& q_WB) {
  const Vec3& m = principal_moments;
  if (m.x() == m.y() && m.y() == m.z())
    return m.x() * Mat3::Identity();  // a ball is the same from every side
  const Mat3 R = rotation_matrix(q_WB * q_BP);
  return symmetric_part(R * m.asDiagonal() * R.transpose());
}

}  // namespace tumble
