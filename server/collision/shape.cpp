// Bounds, support points and checks of the shapes; one overload a shape, chosen by std::visit.
#include "collision/shape.h"

#include <array>
#include <cmath>
#include <sstream>

#include "math/rotation.h"

namespace tumble {
namespace {

struct Name {
  const char* operator()(const HalfSpace&) const { return "half_space"; }
  const char* operator()(const Sphere&) const { return "sphere"; }
  const char* operator()(const Capsule&) const { return "capsule"; }
  const char* operator()(const Box&) const { return "box"; }
  const char* operator()(const HullPointer&) const { return "convex_hull"; }
  const char* operator()(const Cylinder&) const { return "cylinder"; }
  const char* operator()(const Cone&) const { return "cone"; }
  const char* operator()(const Ellipsoid&) const { return "ellipsoid"; }
  const char* operator()(const TriangleMeshPointer&) const { return "triangle_mesh"; }
  const char* operator()(const HeightFieldPointer&) const { return "height_field"; }
};

std::string check_length(const char* field, double value) {
  if (std::isfinite(value) && value > 0.0) return {};
  std::ostringstream text;
  text.precision(17);
  text << field << ": must be finite and > 0, is " << value;
  return text.str();
}

std::string check_round(double radius, double half_length) {
  const std::string problem = check_length("radius", radius);
  return problem.empty() ? check_length("half_length", half_length) : problem;
}

std::string check_lengths(const std::array<const char*, 3>& fields, const Vec3& lengths) {
  for (int i = 0; i < 3; ++i) {
    std::string problem = check_length(fields[static_cast<std::size_t>(i)], lengths[i]);
    if (!problem.empty()) return problem;
  }
  return {};
}

struct Check {
  std::string operator()(const HalfSpace&) const { return {}; }
  std::string operator()(const Sphere& s) const { return check_length("radius", s.radius); }
  std::string operator()(const Capsule& c) const { return check_round(c.radius, c.half_length); }
  std::string operator()(const Cylinder& c) const { return check_round(c.radius, c.half_length); }
  std::string operator()(const Cone& c) const { return check_round(c.radius, c.half_length); }
  std::string operator()(const Box& b) const {
    return check_lengths({"half_extents.x", "half_extents.y", "half_extents.z"}, b.half_extents);
  }
  std::string operator()(const Ellipsoid& e) const {
    return check_lengths({"half_axes.x", "half_axes.y", "half_axes.z"}, e.half_axes);
  }
  std::string operator()(const HullPointer& h) const {
    if (!h) return "hull: missing";
    if (h->vertices.size() < 4 || h->faces.size() < 4) return "hull: has no volume";
    for (std::size_t i = 0; i < h->vertices.size(); ++i) {
      if (!h->vertices[i].allFinite()) return "hull.vertices[" + std::to_string(i) + "]: not finite";
    }
    return {};
  }
  std::string operator()(const TriangleMeshPointer& m) const { return m ? "" : "triangle mesh: missing"; }
  std::string operator()(const HeightFieldPointer& h) const { return h ? "" : "height field: missing"; }
};

class Bounds {
 public:
  explicit Bounds(const Pose& pose) : X_WS(pose) {}

  Aabb operator()(const HalfSpace&) const {
    Aabb bounds{Vec3::Constant(-kInfinity), Vec3::Constant(kInfinity)};
    const Vec3 n_W = X_WS.q * Vec3::UnitZ();
    for (int i = 0; i < 3; ++i) {
      const bool aligned = n_W[(i + 1) % 3] == 0.0 && n_W[(i + 2) % 3] == 0.0;
      if (aligned) (n_W[i] > 0.0 ? bounds.upper : bounds.lower)[i] = X_WS.p[i];
    }
    return bounds;
  }
  Aabb operator()(const Sphere& s) const {
    return {X_WS.p - Vec3::Constant(s.radius), X_WS.p + Vec3::Constant(s.radius)};
  }
  Aabb operator()(const Capsule& c) const {
    const Vec3 reach = (X_WS.q * Vec3(0, 0, c.half_length)).cwiseAbs() + Vec3::Constant(c.radius);
    return {X_WS.p - reach, X_WS.p + reach};
  }
  Aabb operator()(const Box& b) const {
    const Vec3 reach = rotation_matrix(X_WS.q).cwiseAbs() * b.half_extents;
    return {X_WS.p - reach, X_WS.p + reach};
  }
  Aabb operator()(const HullPointer& h) const {
    const Mat3 R = rotation_matrix(X_WS.q);
    Aabb bounds;
    for (const Vec3& v : h->vertices) {
      const Vec3 p = R * v + X_WS.p;
      bounds.lower = bounds.lower.cwiseMin(p);
      bounds.upper = bounds.upper.cwiseMax(p);
    }
    return bounds;
  }
  Aabb operator()(const Cylinder& c) const {
    const Mat3 R = rotation_matrix(X_WS.q);
    const Vec3 reach = c.half_length * R.col(2).cwiseAbs() + c.radius * disc_reach(R);
    return {X_WS.p - reach, X_WS.p + reach};
  }
  Aabb operator()(const Cone& c) const {
    const Mat3 R = rotation_matrix(X_WS.q);
    const Vec3 apex = c.half_length * R.col(2), rim = c.radius * disc_reach(R);
    return {X_WS.p + apex.cwiseMin(-apex - rim), X_WS.p + apex.cwiseMax(-apex + rim)};
  }
  Aabb operator()(const Ellipsoid& e) const {
    const Vec3 reach = (rotation_matrix(X_WS.q) * e.half_axes.asDiagonal()).rowwise().norm();
    return {X_WS.p - reach, X_WS.p + reach};
  }
  Aabb operator()(const TriangleMeshPointer& m) const { return m->bounds().transformed(X_WS); }
  Aabb operator()(const HeightFieldPointer& h) const { return h->bounds().transformed(X_WS); }

 private:
  /// Half extents of a unit disc across the z axis.
  static Vec3 disc_reach(const Mat3& R) { return R.leftCols<2>().rowwise().norm(); }

  const Pose& X_WS;
};

struct Radius {
  double operator()(const HalfSpace&) const { return kInfinity; }
  double operator()(const Sphere& s) const { return s.radius; }
  double operator()(const Capsule& c) const { return c.half_length + c.radius; }
  double operator()(const Box& b) const { return b.half_extents.norm(); }
  double operator()(const HullPointer& h) const { return h->radius; }
  double operator()(const Cylinder& c) const { return rim_distance(c.radius, c.half_length); }
  double operator()(const Cone& c) const { return rim_distance(c.radius, c.half_length); }
  double operator()(const Ellipsoid& e) const { return e.half_axes.maxCoeff(); }
  double operator()(const TriangleMeshPointer& m) const { return m->radius(); }
  double operator()(const HeightFieldPointer& h) const { return h->radius(); }

 private:
  static double rim_distance(double r, double l) { return std::sqrt(r * r + l * l); }
};

Vec3 scaled_to(const Vec3& d, double length) {
  const double norm = d.stableNorm();
  return norm > 0.0 ? Vec3(d * (length / norm)) : Vec3(0, 0, length);
}

/// Furthest point along d of the circle of radius r across the z axis at height z.
Vec3 rim_point(const Vec3& d, double r, double z) {
  const double norm = d.head<2>().stableNorm();
  if (!(norm > 0.0)) return {std::copysign(r, d.x()), 0.0, z};
  const double scale = r / norm;
  return {d.x() * scale, d.y() * scale, z};
}

struct SupportPoint {
  const Vec3& d;

  Vec3 operator()(const HalfSpace&) const { return Vec3::Zero(); }
  Vec3 operator()(const Sphere& s) const { return scaled_to(d, s.radius); }
  Vec3 operator()(const Capsule& c) const {
    return scaled_to(d, c.radius) + Vec3(0, 0, std::copysign(c.half_length, d.z()));
  }
  Vec3 operator()(const Box& b) const {
    return {std::copysign(b.half_extents.x(), d.x()), std::copysign(b.half_extents.y(), d.y()),
            std::copysign(b.half_extents.z(), d.z())};
  }
  Vec3 operator()(const HullPointer& h) const { return h->vertices[descend(*h, -d, 0, -kInfinity).vertex]; }
  Vec3 operator()(const Cylinder& c) const {
    return rim_point(d, c.radius, std::copysign(c.half_length, d.z()));
  }
  Vec3 operator()(const Cone& c) const {
    const Vec3 rim = rim_point(d, c.radius, -c.half_length);
    const Vec3 apex(0, 0, c.half_length);
    return d.dot(apex - rim) >= 0.0 ? apex : rim;
  }
  /// a^2 d / |a d|, componentwise.
  Vec3 operator()(const Ellipsoid& e) const {
    return e.half_axes.cwiseProduct(scaled_to(e.half_axes.cwiseProduct(d), 1.0));
  }
  Vec3 operator()(const TriangleMeshPointer&) const { return Vec3::Zero(); }
  Vec3 operator()(const HeightFieldPointer&) const { return Vec3::Zero(); }
};

}  // namespace

const char* shape_name(const Shape& shape) {
  return std::visit(Name{}, shape);
}
std::string check_shape(const Shape& shape) {
  return std::visit(Check{}, shape);
}
const TriangleSurface* surface_of(const Shape& shape) {
  if (const auto* mesh = std::get_if<TriangleMeshPointer>(&shape)) return mesh->get();
  if (const auto* field = std::get_if<HeightFieldPointer>(&shape)) return field->get();
  return nullptr;
}
bool is_static_only(const Shape& shape) {
  return std::holds_alternative<HalfSpace>(shape) || surface_of(shape) != nullptr;
}
Aabb compute_aabb(const Shape& shape, const Pose& X_WS) {
  return std::visit(Bounds(X_WS), shape);
}
double bounding_radius(const Shape& shape) {
  return std::visit(Radius{}, shape);
}
Vec3 support(const Shape& shape, const Vec3& d_S) {
  return std::visit(SupportPoint{d_S}, shape);
}

double extent_along(const Shape& shape, const Vec3& d_S) {
  if (const auto* box = std::get_if<Box>(&shape)) return box->half_extents.dot(d_S.cwiseAbs());
  if (const auto* hull = std::get_if<HullPointer>(&shape))
    return -descend(**hull, -d_S, 0, -kInfinity).height;
  return d_S.dot(support(shape, d_S));
}

double separation_along(const Shape& a, const Shape& b, const Mat3& R_AB, const Vec3& p_AB, const Vec3& n_A) {
  const Vec3 n_B = R_AB.transpose() * n_A;
  return n_A.dot(p_AB) - extent_along(b, -n_B) - extent_along(a, n_A);
}

}  // namespace tumble
