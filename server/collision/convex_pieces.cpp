// See convex_pieces.h. S is the shape's own frame; d its direction there.
#include "collision/convex_pieces.h"

#include "collision/nearest_surface.h"

namespace tumble {
namespace {

struct Rounding {
  template <typename S>
  double operator()(const S&) const {
    return 0.0;
  }
  double operator()(const Sphere& s) const { return s.radius; }
  double operator()(const Capsule& c) const { return c.radius; }
};

/// Point of the rim with this radius and height that lies furthest along d.
Vec3 on_rim(const Vec3& d, double radius, double z) {
  const double length = std::sqrt(d.x() * d.x() + d.y() * d.y());
  if (!(length > 0.0)) return {std::copysign(radius, d.x()), 0.0, z};
  return {d.x() * (radius / length), d.y() * (radius / length), z};
}

struct PieceOf {
  const Vec3& d;

  template <typename Other>  // not convex, or without a furthest point
  std::uint32_t operator()(const Other&) const {
    return 0;
  }
  std::uint32_t operator()(const Sphere&) const { return 0; }
  std::uint32_t operator()(const Ellipsoid&) const { return 0; }
  std::uint32_t operator()(const Capsule&) const { return std::signbit(d.z()) ? kLowPiece : kHighPiece; }
  std::uint32_t operator()(const Cylinder&) const { return std::signbit(d.z()) ? kLowPiece : kHighPiece; }
  std::uint32_t operator()(const Cone& c) const {
    const double across = std::sqrt(d.x() * d.x() + d.y() * d.y());
    return 2.0 * c.half_length * d.z() >= c.radius * across ? kHighPiece : kLowPiece;
  }
  std::uint32_t operator()(const Box&) const {
    return (std::signbit(d.x()) ? 0u : 1u) | (std::signbit(d.y()) ? 0u : 2u) |
           (std::signbit(d.z()) ? 0u : 4u);
  }
  std::uint32_t operator()(const HullPointer& h) const { return descend(*h, -d, 0, -kInfinity).vertex; }
};

struct PointOf {
  const Vec3& d;
  std::uint32_t piece;

  double side(double length) const { return piece == kLowPiece ? -length : length; }
  template <typename Other>
  Vec3 operator()(const Other&) const {
    return Vec3::Zero();
  }
  Vec3 operator()(const Sphere&) const { return Vec3::Zero(); }
  Vec3 operator()(const Capsule& c) const { return {0.0, 0.0, side(c.half_length)}; }
  Vec3 operator()(const Cylinder& c) const { return on_rim(d, c.radius, side(c.half_length)); }
  Vec3 operator()(const Cone& c) const {
    return piece == kHighPiece ? Vec3(0, 0, c.half_length) : on_rim(d, c.radius, -c.half_length);
  }
  Vec3 operator()(const Box& b) const {
    const Vec3& h = b.half_extents;
    return {piece & 1 ? h.x() : -h.x(), piece & 2 ? h.y() : -h.y(), piece & 4 ? h.z() : -h.z()};
  }
  Vec3 operator()(const HullPointer& h) const { return h->vertices[piece]; }
  Vec3 operator()(const Ellipsoid& e) const {
    const Vec3 stretched = e.half_axes.cwiseProduct(d);
    return e.half_axes.cwiseProduct(stretched / stretched.norm());
  }
};

struct CurvatureOf {
  const Vec3 &d, &u, &v;
  std::uint32_t piece;

  template <typename S>
  Curvature operator()(const S&) const {
    return {0.0, 0.0, 0.0};
  }
  Curvature operator()(const Cylinder& c) const { return of_rim(c.radius); }
  Curvature operator()(const Cone& c) const {
    return piece == kHighPiece ? Curvature{0.0, 0.0, 0.0} : of_rim(c.radius);
  }
  /// Second derivative of |a d|: (D - p p^T) / |a d| with D = diag(a^2) and the furthest point p.
  Curvature operator()(const Ellipsoid& e) const {
    const Vec3 ad = e.half_axes.cwiseProduct(d), au = e.half_axes.cwiseProduct(u),
               av = e.half_axes.cwiseProduct(v);
    const double length = ad.norm(), pu = ad.dot(au) / length, pv = ad.dot(av) / length;
    return Curvature{au.dot(au) - pu * pu, au.dot(av) - pu * pv, av.dot(av) - pv * pv} * (1.0 / length);
  }
  /// radius / |d across z| along the tangent of the rim.
  Curvature of_rim(double radius) const {
    const double across2 = d.x() * d.x() + d.y() * d.y();
    const double tu = d.x() * u.y() - d.y() * u.x(), tv = d.x() * v.y() - d.y() * v.x();
    return Curvature{tu * tu, tu * tv, tv * tv} * (radius / (across2 * std::sqrt(across2)));
  }
};

/// Normal of the flat face that looks most along d.
struct FaceTowards {
  const Vec3& d;

  template <typename Round>
  std::optional<Vec3> operator()(const Round&) const {
    return std::nullopt;
  }
  std::optional<Vec3> operator()(const Box&) const {
    int axis = 0;
    d.cwiseAbs().maxCoeff(&axis);
    return Vec3(std::copysign(1.0, d[axis]) * Vec3::Unit(axis));
  }
  std::optional<Vec3> operator()(const HullPointer& h) const {
    return h->faces[tumble::face_towards(*h, d)].normal;
  }
  std::optional<Vec3> operator()(const Cylinder&) const { return Vec3(0, 0, std::copysign(1.0, d.z())); }
  std::optional<Vec3> operator()(const Cone&) const {
    return d.z() < 0.0 ? std::optional(Vec3(0, 0, -1)) : std::nullopt;
  }
};

struct DepthOf {
  const Vec3& p;

  template <typename Other>  // points and segments
  double operator()(const Other&) const {
    return -kInfinity;
  }
  double operator()(const Box& b) const { return (b.half_extents - p.cwiseAbs()).minCoeff(); }
  double operator()(const HullPointer& h) const {
    double depth = kInfinity;
    for (const Polytope::Face& face : h->faces) depth = std::min(depth, face.offset - face.normal.dot(p));
    return depth;
  }
  double operator()(const Cylinder& c) const { return -nearest_surface(c, p).distance; }
  double operator()(const Cone& c) const { return -nearest_surface(c, p).distance; }
  double operator()(const Ellipsoid& e) const { return -nearest_surface(e, p).distance; }
};

}  // namespace

ConvexPieces::ConvexPieces(const Shape& shape, const Mat3& R_AS, const Vec3& p_AS)
    : shape_(&shape), R_(R_AS), p_(p_AS), rounding_(std::visit(Rounding(), shape)) {}

ConvexPieces::ConvexPieces(const Polytope& polytope, const Mat3& R_AS, const Vec3& p_AS)
    : polytope_(&polytope), R_(R_AS), p_(p_AS), rounding_(0.0) {}

ConvexPieces::Point ConvexPieces::furthest(const Vec3& n_A) const {
  const Vec3 d = R_.transpose() * n_A;
  if (shape_ == nullptr) {
    const std::uint32_t vertex = descend(*polytope_, -d, 0, -kInfinity).vertex;
    return {R_ * polytope_->vertices[vertex] + p_, vertex};
  }
  const std::uint32_t piece = std::visit(PieceOf{d}, *shape_);
  return {R_ * std::visit(PointOf{d, piece}, *shape_) + p_, piece};
}

Vec3 ConvexPieces::point(std::uint32_t piece, const Vec3& n_A) const {
  if (shape_ == nullptr) return R_ * polytope_->vertices[piece] + p_;
  const Vec3 d = R_.transpose() * n_A;
  return R_ * std::visit(PointOf{d, piece}, *shape_) + p_;
}

Curvature ConvexPieces::curvature(std::uint32_t piece, const Vec3& n_A, const Vec3& u_A,
                                  const Vec3& v_A) const {
  if (shape_ == nullptr) return {0.0, 0.0, 0.0};
  const Mat3 R_SA = R_.transpose();
  const Vec3 d = R_SA * n_A, u = R_SA * u_A, v = R_SA * v_A;
  return std::visit(CurvatureOf{d, u, v, piece}, *shape_);
}

bool ConvexPieces::has_cap(double side) const {
  if (shape_ == nullptr) return false;
  return std::holds_alternative<Cylinder>(*shape_) || (side < 0.0 && std::holds_alternative<Cone>(*shape_));
}

std::optional<Vec3> ConvexPieces::face_towards(const Vec3& n_A) const {
  const Vec3 d = R_.transpose() * n_A;
  const std::optional<Vec3> normal = shape_ ? std::visit(FaceTowards{d}, *shape_) : std::nullopt;
  return normal ? std::optional(Vec3(R_ * *normal)) : normal;
}

double ConvexPieces::depth(const Vec3& p_A) const {
  const Vec3 p_S = R_.transpose() * (p_A - p_);
  return shape_ ? std::visit(DepthOf{p_S}, *shape_) : -kInfinity;
}

}  // namespace tumble
