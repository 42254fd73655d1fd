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

class DirectionReference {
 public:
  DirectionReference(const Shape& a, const Shape& b, const Pose& X_AB)
      : a_(a), b_(b), R_AB_(rotation_matrix_l(X_AB.q)), p_AB_(X_AB.p.cast<long double>()) {}

  long double separation(const Vec3L& n_A) const {
    const Vec3L toward_a = -(R_AB_.transpose() * n_A);
    return n_A.dot(p_AB_) - std::visit(ReachL{toward_a}, b_) - std::visit(ReachL{n_A}, a_);
  }
  long double separation(const Vec3& n_A) const {
    return separation(Vec3L(n_A.cast<long double>().normalized()));
  }

  /// Best of `directions` spread evenly and the axes of both shapes, after improving the `seeds` best.
  struct Best {
    long double separation = -std::numeric_limits<long double>::infinity();
    Vec3L normal_A = Vec3L::UnitZ();
  };
  Best search(int directions, std::size_t seeds) const {
    std::vector<Best> candidates;
    const auto add = [&](const Vec3L& n) { candidates.push_back({separation(n), n}); };
    for (int i = 0; i < directions; ++i) {  // Fibonacci's spiral
      const long double z = 1.0L - (2.0L * i + 1.0L) / directions, turn = 2.39996322972865332L * i;
      const long double across = std::sqrt(1.0L - z * z);
      add({across * std::cos(turn), across * std::sin(turn), z});
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
    std::vector<CircleL> circles, circles_b;
    std::visit(CirclesOf{circles}, a_);
    std::visit(CirclesOf{circles_b}, b_);
    for (const CircleL& c : circles_b) circles.push_back({-(R_AB_ * c.axis), c.height});
    for (const CircleL& circle : circles) {
      const Best on_circle = search_circle(circle);
      if (on_circle.separation > best.separation) best = on_circle;
    }
    return best;
  }

 private:
  /// Thirds between the neighbours of each sample that is a local maximum.
  Best search_circle(const CircleL& circle) const {
    constexpr int kSamples = 180;
    constexpr long double kStep = 6.283185307179586477L / kSamples;
    const Vec3L u = circle.axis.unitOrthogonal(), v = circle.axis.cross(u);
    const long double across = std::sqrt(1.0L - circle.height * circle.height);
    const auto at = [&](long double angle) -> Best {
      const Vec3L n = circle.height * circle.axis + across * (std::cos(angle) * u + std::sin(angle) * v);
      return {separation(n), n};
    };
    std::vector<long double> samples;
    for (int i = 0; i < kSamples; ++i) samples.push_back(at(kStep * i).separation);
    Best best;
    for (int i = 0; i < kSamples; ++i) {
      const auto sample = [&](int k) { return samples[static_cast<std::size_t>((k + kSamples) % kSamples)]; };
      if (sample(i) < sample(i - 1) || sample(i) < sample(i + 1)) continue;
      long double low = kStep * (i - 1), high = kStep * (i + 1);
      while (high - low > 1e-12L) {
        const long double third = (high - low) / 3.0L;
        if (at(low + third).separation < at(high - third).separation) {
          low += third;
        } else {
          high -= third;
        }
      }
      const Best refined = at(0.5L * (low + high));
      if (refined.separation > best.separation) best = refined;
    }
    return best;
  }

  static constexpr int kPatternTurns = 400;  // on a kink it would zigzag for ever

  Best improve(Best best) const {
    long double step = 0.05L;
    for (int turn = 0; step > 1e-10L && turn < kPatternTurns; ++turn) {
      const Vec3L u = best.normal_A.unitOrthogonal(), v = best.normal_A.cross(u);
      bool better = false;
      for (int k = 0; k < 8 && !better; ++k) {
        const long double angle = 0.7853981633974483L * k + 0.37L * turn;
        const Vec3L n = (best.normal_A + step * (std::cos(angle) * u + std::sin(angle) * v)).normalized();
        const long double here = separation(n);
        if (here > best.separation) best = {here, n}, better = true;
      }
      if (!better) step *= 0.6L;
    }
    return best;
  }

  const Shape &a_, &b_;
  Mat3L R_AB_;
  Vec3L p_AB_;
};

}  // namespace tumble::test
