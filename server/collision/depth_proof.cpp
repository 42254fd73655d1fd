// See depth_proof.h. n, m: unit vectors; M: an ellipsoid reaches |M n| along n from its centre, also one that is a disc or
// a segment.
#include "collision/depth_proof.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace tumble {
namespace {

/// M n shorter than this of M: the ellipsoid is a disc or segment across n.
constexpr double kAcross = 1e-9;

/// An ellipsoid inside a Minkowski sum of ellipsoids that reaches as far as the sum along n: |sum S_i M_i x| is never more
/// than sum |M_i x|, and equal where the rotations S_i bring all M_i n to one direction (Kurzhanski and Valyi, Ellipsoidal
/// Calculus for Estimation and Control, 1997, 2.3).
class EllipsoidInSum {
 public:
  explicit EllipsoidInSum(const Vec3& n) : n_(n) {}

  void move(const Vec3& way) { centre_ += way; }
  void add(const Mat3& M) {
    const Vec3 reach = M * n_;
    const double length = reach.norm();
    if (!(length > kAcross * M.norm())) {
      G_ += M;
    } else if (common_.isZero()) {
      common_ = reach / length;
      G_ += M;
    } else {
      G_ += turn_to_common(reach / length) * M;
    }
  }

  /// Whether the ball of this radius [m] inside its surface at n has its centre within `tolerance` of the origin, and is
  /// no larger than the least radius of curvature, so that it lies inside (Blaschke, Kreis und Kugel, 1916).
  bool holds_ball(double radius, double tolerance) const {
    const Vec3 Gn = G_ * n_;
    const double length = Gn.norm(), norm2 = G_.squaredNorm();
    if (!(length > 0.0)) return false;
    const Vec3 furthest = centre_ + G_.transpose() * (Gn / length);
    if (!((furthest - radius * n_).norm() <= tolerance)) return false;
    // The radius is sigma_min^2 / sigma_max or more, and sigma_min = |det| / (the others' product).
    const double least = 2.0 * std::abs(G_.determinant()) / norm2;
    return radius * std::sqrt(norm2) <= least * least;
  }

 private:
  /// The least rotation; for opposite directions that of the opposite, turned round.
  Mat3 turn_to_common(const Vec3& direction) const {
    const double sign = direction.dot(common_) < 0.0 ? -1.0 : 1.0;
    const Vec3 from = sign * direction, w = from.cross(common_);
    Mat3 W;
    W << 0.0, -w.z(), w.y(), w.z(), 0.0, -w.x(), -w.y(), w.x(), 0.0;
    return sign * (Mat3::Identity() + W + W * W / (1.0 + from.dot(common_)));
  }

  Vec3 n_, centre_ = Vec3::Zero(), common_ = Vec3::Zero();
  Mat3 G_ = Mat3::Zero();
};

Mat3 along(const Vec3& m) {
  return m * m.transpose();
}

/// Gives the sum the most that lies in the body, or in its mirror image for side -1, and reaches its point `touched`.
struct Inscribe {
  const ConvexPieces& body;
  const Vec3& touched;
  double side;
  std::span<const std::uint32_t> pieces;  // that meet there
  EllipsoidInSum& sum;

  template <typename Other>
  void operator()(const Other&) const {
    sum.move(side * touched);
  }
  void operator()(const Ellipsoid& e) const {
    sum.move(side * body.p());
    sum.add(body.R() * e.half_axes.asDiagonal() * body.R().transpose());
  }
  void operator()(const Capsule& c) const { add_axis(c.half_length); }
  void operator()(const Cylinder& c) const {
    add_axis(c.half_length);
    add_disc(c.radius);
  }
  void operator()(const Cone& c) const {
    if (pieces.size() > 1 || pieces[0] == kHighPiece) return sum.move(side * touched);
    sum.move(side * (body.p() - c.half_length * axis()));
    add_disc(c.radius);
  }
  void operator()(const Box&) const { add_edge(); }
  void operator()(const HullPointer&) const { add_edge(); }

  Vec3 axis() const { return body.R().col(2); }
  void add_disc(double radius) const { sum.add(radius * (Mat3::Identity() - along(axis()))); }
  /// All of it where its end is touched, else what is centred about the place touched.
  void add_axis(double half_length) const {
    const double height = pieces.size() > 1 ? axis().dot(touched - body.p()) : 0.0;
    sum.move(side * (body.p() + height * axis()));
    sum.add(std::max(0.0, half_length - std::abs(height)) * along(axis()));
  }
  void add_edge() const {
    sum.move(side * touched);
    if (pieces.size() != 2) return;
    const Vec3 tail = body.point(pieces[0], axis()), head = body.point(pieces[1], axis());
    const double reach = std::sqrt(std::min((touched - tail).squaredNorm(), (touched - head).squaredNorm()));
    sum.add(reach * along((head - tail).normalized()));
  }
};

void inscribe(const ConvexPieces& body, const Vec3& touched, double side, const CandidateDirection& optimum,
              std::uint32_t PiecePair::*piece, EllipsoidInSum& sum) {
  std::array<std::uint32_t, 3> touching;
  std::size_t count = 0;
  for (int i = 0; i < optimum.count; ++i) {
    const std::uint32_t own = optimum.pieces[static_cast<std::size_t>(i)].*piece;
    if (std::find(touching.begin(), touching.begin() + count, own) == touching.begin() + count)
      touching[count++] = own;
  }
  const Inscribe visitor{body, touched, side, std::span(touching).first(count), sum};
  if (body.shape() != nullptr) {
    std::visit(visitor, *body.shape());
  } else {
    visitor.add_edge();
  }
}

}  // namespace

bool is_proven(const ConvexPieces& a, const ConvexPieces& b, const CandidateDirection& o, double tolerance) {
  const double depth = o.h - tolerance;
  if (depth <= 0.0) return (o.p_A - o.p_B).norm() <= std::abs(o.h) + tolerance;
  if (a.depth(o.p_B) >= depth || b.depth(o.p_A) >= depth) return true;
  EllipsoidInSum sum(o.n);
  inscribe(a, o.p_A, 1.0, o, &PiecePair::a, sum);
  inscribe(b, o.p_B, -1.0, o, &PiecePair::b, sum);
  return sum.holds_ball(o.h, tolerance);
}

}  // namespace tumble
