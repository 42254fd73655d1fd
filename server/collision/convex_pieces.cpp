// See convex_pieces.h. S is the shape's own frame; d its direction there.
#include "collision/convex_pieces.h"

namespace tumble {
namespace {

// Pieces of round shapes; of boxes and hulls they are the vertices.
constexpr std::uint32_t kLow = 0, kHigh = 1;

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
  std::uint32_t operator()(const Capsule&) const { return std::signbit(d.z()) ? kLow : kHigh; }
  std::uint32_t operator()(const Cylinder&) const { return std::signbit(d.z()) ? kLow : kHigh; }
  std::uint32_t operator()(const Cone& c) const {
    const double across = std::sqrt(d.x() * d.x() + d.y() * d.y());
    return 2.0 * c.half_length * d.z() >= c.radius * across ? kHigh : kLow;
  }
  std::uint32_t operator()(const Box&) const {
    return (std::signbit(d.x()) ? 0u : 1u) | (std::signbit(d.y()) ? 0u : 2u) |
           (std::signbit(d.z()) ? 0u : 4u);
  }
  std::uint32_t operator()(const HullPointer& h) const {
    return descend(view_of(*h), -d, 0, -kInfinity).vertex;
  }
};

struct PointOf {
  const Vec3& d;
  std::uint32_t piece;

  double side(double length) const { return piece == kLow ? -length : length; }
  template <typename Other>
  Vec3 operator()(const Other&) const {
    return Vec3::Zero();
  }
  Vec3 operator()(const Sphere&) const { return Vec3::Zero(); }
  Vec3 operator()(const Capsule& c) const { return {0.0, 0.0, side(c.half_length)}; }
  Vec3 operator()(const Cylinder& c) const { return on_rim(d, c.radius, side(c.half_length)); }
  Vec3 operator()(const Cone& c) const {
    return piece == kHigh ? Vec3(0, 0, c.half_length) : on_rim(d, c.radius, -c.half_length);
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
    return piece == kHigh ? Curvature{0.0, 0.0, 0.0} : of_rim(c.radius);
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

}  // namespace

ConvexPieces::ConvexPieces(const Shape& shape, const Mat3& R_AS, const Vec3& p_AS)
    : shape_(&shape), R_(R_AS), p_(p_AS), rounding_(std::visit(Rounding(), shape)) {}

ConvexPieces::ConvexPieces(const Polytope& polytope, const Mat3& R_AS, const Vec3& p_AS)
    : polytope_(polytope), R_(R_AS), p_(p_AS), rounding_(0.0) {}

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

}  // namespace tumble
