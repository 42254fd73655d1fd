// Ground truth for any two convex shapes, with supports of its own in 80-bit arithmetic: the direction of largest
// separation among thousands, the best ones improved by pattern search, and among those on every circle of directions
// where a support jumps (across an edge or an axis, around a cone's side), on which pattern search gets stuck.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "polytope_reference.h"

namespace tumble::test {

/// Furthest reach of a shape along d (unit), in its own frame.
struct ReachL {
  const Vec3L& d;
  using L = long double;

  L across() const { return std::sqrt(d.x() * d.x() + d.y() * d.y()); }
  template <typename Other>  // not convex, or endless
  L operator()(const Other&) const {
    return 0;
  }
  L operator()(const Sphere& s) const { return s.radius; }
  L operator()(const Capsule& c) const { return c.half_length * std::abs(d.z()) + c.radius; }
  L operator()(const Cylinder& c) const { return c.half_length * std::abs(d.z()) + c.radius * across(); }
  L operator()(const Cone& c) const {
    return std::max(c.half_length * d.z(), -c.half_length * d.z() + c.radius * across());
  }
  L operator()(const Ellipsoid& e) const { return e.half_axes.cast<L>().cwiseProduct(d).norm(); }
  L operator()(const Box& b) const { return b.half_extents.cast<L>().dot(d.cwiseAbs()); }
  L operator()(const HullPointer& h) const {
    L most = -std::numeric_limits<L>::infinity();
    for (const Vec3& v : h->vertices) most = std::max(most, v.cast<L>().dot(d));
    return most;
  }
};

/// The point of a shape that is furthest along d (unit), in its own frame.
struct FurthestL {
  const Vec3L& d;
  using L = long double;

  Vec3L on_rim(L radius, L height) const {
    const L across = std::sqrt(d.x() * d.x() + d.y() * d.y());
    return across > 0 ? Vec3L(radius * d.x() / across, radius * d.y() / across, height) : Vec3L(0, 0, height);
  }
  template <typename Other>
  Vec3L operator()(const Other&) const {
    return Vec3L::Zero();
  }
  Vec3L operator()(const Sphere& s) const { return s.radius * d; }
  Vec3L operator()(const Capsule& c) const {
    return Vec3L(0, 0, std::copysign(L{c.half_length}, d.z())) + c.radius * d;
  }
  Vec3L operator()(const Cylinder& c) const {
    return on_rim(c.radius, std::copysign(L{c.half_length}, d.z()));
  }
  Vec3L operator()(const Cone& c) const {
    const Vec3L tip(0, 0, c.half_length), rim = on_rim(c.radius, -c.half_length);
    return tip.dot(d) > rim.dot(d) ? tip : rim;
  }
  Vec3L operator()(const Ellipsoid& e) const {
    const Vec3L h = e.half_axes.cast<L>();
    return h.cwiseProduct(h.cwiseProduct(d)) / h.cwiseProduct(d).norm();
  }
  Vec3L operator()(const Box& b) const {
    const Vec3L h = b.half_extents.cast<L>();
    return {std::copysign(h.x(), d.x()), std::copysign(h.y(), d.y()), std::copysign(h.z(), d.z())};
  }
  Vec3L operator()(const HullPointer& h) const {
    Vec3L best = h->vertices[0].cast<L>();
    for (const Vec3& v : h->vertices) {
      if (v.cast<L>().dot(d) > best.dot(d)) best = v.cast<L>();
    }
    return best;
  }
};

/// Unit directions at a height along an axis.
struct CircleL {
  Vec3L axis;
  long double height;
};

struct CirclesOf {
  std::vector<CircleL>& circles;

  template <typename Other>
  void operator()(const Other&) const {}
  void operator()(const Capsule&) const { circles.push_back({Vec3L::UnitZ(), 0}); }
  void operator()(const Cylinder&) const { circles.push_back({Vec3L::UnitZ(), 0}); }
  void operator()(const Cone& c) const {
    const long double r = c.radius, length = 2.0L * c.half_length;
    circles.push_back({Vec3L::UnitZ(), r / std::sqrt(r * r + length * length)});
  }
  void operator()(const Box&) const {
    for (int k = 0; k < 3; ++k) circles.push_back({Vec3L::Unit(k), 0});
  }
  void operator()(const HullPointer& h) const {
    for (const auto& edge : h->edges) {
      const Vec3L along =
          h->vertices[edge.head].cast<long double>() - h->vertices[edge.tail].cast<long double>();
      circles.push_back({along.normalized(), 0});
    }
  }
};

/// Cosine and sine of an angle that goes on in equal steps, by additions of angles: the library's take longer than all
/// else here.
struct Turning {
  long double cos = 1, sin = 0;
  explicit Turning(long double step) : step_cos_(std::cos(step)), step_sin_(std::sin(step)) {}
  void advance() {
    const long double c = cos * step_cos_ - sin * step_sin_;
    sin = sin * step_cos_ + cos * step_sin_;
    cos = c;
  }

 private:
  long double step_cos_, step_sin_;
};

class DirectionReference {
 public:
  struct Best {
    long double separation = -std::numeric_limits<long double>::infinity();
    Vec3L normal_A = Vec3L::UnitZ();
  };

  DirectionReference(const Shape& a, const Shape& b, const Pose& X_AB)
      : a_(a),
        b_(b),
        R_AB_(rotation_matrix_l(X_AB.q)),
        p_AB_(X_AB.p.cast<long double>()),
        size_(bounding_radius(a) + bounding_radius(b)) {}

  long double separation(const Vec3L& n_A) const {
    const Vec3L toward_a = -(R_AB_.transpose() * n_A);
    return n_A.dot(p_AB_) - std::visit(ReachL{toward_a}, b_) - std::visit(ReachL{n_A}, a_);
  }
  long double separation(const Vec3& n_A) const {
    return separation(Vec3L(n_A.cast<long double>().normalized()));
  }

  /// The optimum that a direction near it belongs to, to the rounding of a gradient instead of the root of that of a
  /// separation: where the way between the furthest points has no part across n (Newton's method); on a circle where
  /// supports jump, no part along the circle; where two circles cross; and along faces. The best of these, of equally good
  /// ones the nearest, or the direction itself if none is better by more than rounding: round an axis all may be equal.
  Best polish(const Vec3& n_A) const {
    const Vec3L start = n_A.cast<long double>().normalized();
    const Best given{separation(start), start};
    std::vector<Best> offers;
    const auto offer = [&](const Vec3L& n) {
      if (!n.allFinite() || (n - start).norm() > 1e-3L) return;
      offers.push_back({separation(Vec3L(n.normalized())), n.normalized()});
    };
    offer(polish_freely(start));
    const std::vector<CircleL> circles = all_circles();
    for (std::size_t i = 0; i < circles.size(); ++i) {
      if (std::abs(circles[i].axis.dot(start) - circles[i].height) > 1e-3L) continue;
      offer(polish_on_circle(circles[i], start));
      for (std::size_t j = 0; j < i; ++j) offer(cross(circles[i], circles[j], start));
    }
    for (int k = 0; k < 3; ++k) {
      for (const long double side : {-1.0L, 1.0L}) {
        offer(side * Vec3L::Unit(k));
        offer(side * R_AB_.col(k));
      }
    }
    offer_faces(a_, [&](const Vec3L& n) { offer(n); });
    offer_faces(b_, [&](const Vec3L& n) { offer(-(R_AB_ * n)); });
    long double most = given.separation;
    for (const Best& other : offers) most = std::max(most, other.separation);
    if (most <= given.separation + kRounding * size_) return given;
    Best nearest{-1.0L, Vec3L::Constant(10.0L)};
    for (const Best& other : offers) {
      if (other.separation < most - kTie * size_) continue;
      if ((other.normal_A - start).norm() < (nearest.normal_A - start).norm()) nearest = other;
    }
    return nearest;
  }

  /// Best of `directions` spread evenly and the axes of both shapes, after improving the `seeds` best.
  Best search(int directions, std::size_t seeds) const {
    std::vector<Best> candidates;
    const auto add = [&](const Vec3L& n) { candidates.push_back({separation(n), n}); };
    Turning spiral(2.39996322972865332L);
    for (int i = 0; i < directions; ++i, spiral.advance()) {  // Fibonacci's spiral
      const long double z = 1.0L - (2.0L * i + 1.0L) / directions;
      const long double across = std::sqrt(1.0L - z * z);
      add({across * spiral.cos, across * spiral.sin, z});
    }
    for (int k = 0; k < 3; ++k) {
      for (const long double side : {-1.0L, 1.0L}) {
        add(side * Vec3L::Unit(k));
        add(side * R_AB_.col(k));
      }
    }
    std::sort(candidates.begin(), candidates.end(),
              [](const Best& p, const Best& q) { return p.separation > q.separation; });
    Best best;
    std::vector<Vec3L> taken;
    for (const Best& candidate : candidates) {
      const auto near = [&](const Vec3L& n) { return n.dot(candidate.normal_A) > 0.99L; };
      if (std::any_of(taken.begin(), taken.end(), near)) continue;
      if (taken.size() == seeds) break;
      taken.push_back(candidate.normal_A);
      const Best improved = improve(candidate);
      if (improved.separation > best.separation) best = improved;
    }
    for (const CircleL& circle : all_circles()) {
      const Best on_circle = search_circle(circle);
      if (on_circle.separation > best.separation) best = on_circle;
    }
    return best;
  }

 private:
  std::vector<CircleL> all_circles() const {
    std::vector<CircleL> circles, circles_b;
    std::visit(CirclesOf{circles}, a_);
    std::visit(CirclesOf{circles_b}, b_);
    for (const CircleL& c : circles_b) circles.push_back({-(R_AB_ * c.axis), c.height});
    return circles;
  }

  template <typename Offer>
  static void offer_faces(const Shape& shape, const Offer& offer) {
    if (const auto* hull = std::get_if<HullPointer>(&shape)) {
      for (const Polytope::Face& face : (*hull)->faces)
        offer(Vec3L(face.normal.cast<long double>().normalized()));
    }
  }

  /// From A's furthest point along n to B's: the gradient of the separation.
  Vec3L way(const Vec3L& n) const {
    const Vec3L toward_a = -(R_AB_.transpose() * n);
    return p_AB_ + R_AB_ * std::visit(FurthestL{toward_a}, b_) - std::visit(FurthestL{n}, a_);
  }

  Vec3L polish_freely(Vec3L n) const {
    constexpr long double kStep = 1e-8L;
    for (int i = 0; i < 30; ++i) {
      const Vec3L u = n.unitOrthogonal(), v = n.cross(u);
      const auto slope = [&](long double x, long double y) -> Eigen::Matrix<long double, 2, 1> {
        const Vec3L m = (n + x * u + y * v).normalized(), w = way(m);
        const Vec3L across = w - w.dot(m) * m;
        return {across.dot(u), across.dot(v)};
      };
      const auto f = slope(0, 0);
      if (i == 0 && f.norm() <= kFlat * size_) return n;
      Eigen::Matrix<long double, 2, 2> jacobian;
      jacobian.col(0) = (slope(kStep, 0) - slope(-kStep, 0)) / (2 * kStep);
      jacobian.col(1) = (slope(0, kStep) - slope(0, -kStep)) / (2 * kStep);
      Eigen::Matrix<long double, 2, 1> step = -jacobian.inverse() * f;
      if (!step.allFinite()) return n;
      if (step.norm() > 1e-4L) step *= 1e-4L / step.norm();
      n = (n + step.x() * u + step.y() * v).normalized();
      if (step.norm() < 1e-17L) break;
    }
    return n;
  }

  /// Bisection of the slope along the circle about the place nearest to n.
  Vec3L polish_on_circle(const CircleL& circle, const Vec3L& n) const {
    const Vec3L u = (n - n.dot(circle.axis) * circle.axis).normalized(), v = circle.axis.cross(u);
    const long double across = std::sqrt(1.0L - circle.height * circle.height);
    const auto at = [&](long double angle) -> Vec3L {
      return circle.height * circle.axis + across * (std::cos(angle) * u + std::sin(angle) * v);
    };
    const auto slope = [&](long double angle) {
      return way(at(angle)).dot(Vec3L(std::cos(angle) * v - std::sin(angle) * u));
    };
    if (std::abs(slope(0)) <= kFlat * size_) return at(0);
    long double low = -1e-3L, high = 1e-3L;
    for (int i = 0; i < 70; ++i) {
      const long double middle = 0.5L * (low + high);
      (slope(middle) > 0 ? low : high) = middle;
    }
    return at(0.5L * (low + high));
  }

  /// Where two circles cross near n: Newton's method on both heights and the length.
  static Vec3L cross(const CircleL& a, const CircleL& b, Vec3L n) {
    for (int i = 0; i < 20; ++i) {
      Mat3L jacobian;
      jacobian.row(0) = a.axis.transpose();
      jacobian.row(1) = b.axis.transpose();
      jacobian.row(2) = n.transpose();
      const Vec3L residual(a.axis.dot(n) - a.height, b.axis.dot(n) - b.height, 0.5L * (n.squaredNorm() - 1));
      n -= jacobian.inverse() * residual;
    }
    return n;
  }

  /// The golden section between the neighbours of each sample that is a local maximum.
  Best search_circle(const CircleL& circle) const {
    constexpr int kSamples = 180;
    constexpr long double kStep = 6.283185307179586477L / kSamples;
    const Vec3L u = circle.axis.unitOrthogonal(), v = circle.axis.cross(u);
    const long double across = std::sqrt(1.0L - circle.height * circle.height);
    const auto at = [&](long double cos, long double sin) -> Best {
      const Vec3L n = circle.height * circle.axis + across * (cos * u + sin * v);
      return {separation(n), n};
    };
    std::vector<Turning> turned;
    std::vector<long double> samples;
    Turning turning(kStep);
    for (int i = 0; i < kSamples; ++i, turning.advance()) {
      turned.push_back(turning);
      samples.push_back(at(turning.cos, turning.sin).separation);
    }
    Best best;
    for (int i = 0; i < kSamples; ++i) {
      const auto sample = [&](int k) { return samples[static_cast<std::size_t>((k + kSamples) % kSamples)]; };
      if (sample(i) < sample(i - 1) || sample(i) < sample(i + 1)) continue;
      const Turning& here = turned[static_cast<std::size_t>(i)];
      const Best refined = refine(-kStep, kStep, [&](long double angle) {
        const long double c = std::cos(angle), s = std::sin(angle);
        return at(here.cos * c - here.sin * s, here.sin * c + here.cos * s);
      });
      if (refined.separation > best.separation) best = refined;
    }
    return best;
  }
  template <typename At>
  static Best refine(long double low, long double high, const At& at) {
    constexpr long double kGolden = 0.6180339887498948482L;
    long double p = high - kGolden * (high - low), q = low + kGolden * (high - low);
    Best at_p = at(p), at_q = at(q);
    while (high - low > 1e-12L) {
      if (at_p.separation < at_q.separation) {
        low = p, p = q, at_p = at_q;
        q = low + kGolden * (high - low), at_q = at(q);
      } else {
        high = q, q = p, at_q = at_p;
        p = high - kGolden * (high - low), at_p = at(p);
      }
    }
    return at_p.separation < at_q.separation ? at_q : at_p;
  }

  static constexpr int kPatternTurns = 400;  // on a kink it would zigzag for ever

  Best improve(Best best) const {
    long double step = 0.05L;
    static const Turning kTurn(0.37L), kEighth(0.7853981633974483L);
    Turning first = kTurn;
    for (int turn = 0; step > 1e-10L && turn < kPatternTurns; ++turn, first.advance()) {
      const Vec3L u = best.normal_A.unitOrthogonal(), v = best.normal_A.cross(u);
      bool better = false;
      Turning around = kEighth;
      for (int k = 0; k < 8 && !better; ++k, around.advance()) {
        const long double c = around.cos * first.cos - around.sin * first.sin;
        const long double s = around.sin * first.cos + around.cos * first.sin;
        const Vec3L n = (best.normal_A + step * (c * u + s * v)).normalized();
        const long double here = separation(n);
        if (here > best.separation) best = {here, n}, better = true;
      }
      if (!better) step *= 0.6L;
    }
    return best;
  }

  static constexpr long double kRounding = 1e-18L;  // of a separation, as a share of the size
  static constexpr long double kTie = 4e-16L;  // the same in double: optima equal up to it are equally good
  /// As a share of the size, the slope of the separation that the rounding of a pose in double makes: where it is no
  /// steeper, as round an axis that both shapes share, one direction is as good as the next.
  static constexpr long double kFlat = 1e-15L;

  const Shape &a_, &b_;
  Mat3L R_AB_;
  Vec3L p_AB_;
  long double size_;
};

}  // namespace tumble::test
