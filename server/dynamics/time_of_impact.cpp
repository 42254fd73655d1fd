// See time_of_impact.h. n: unit normal from a to b in W; gap: distance of the planes normal to n that touch both shapes.
//   gap(s) >= G + n.(dx(s) - dx(0)) + [h_b(s) - h_b(0)] - [h_a(s) - h_a(0)] - K s^2 / 2,
//   h_b(s) = min over b of r.(n + s n x w_b),  h_a(s) = max over a of r.(n + s n x w_a),
// where dx is the exact way between the centres of mass, n.(w x r) = r.(n x w), and K bounds the rest of the rotation's
// Taylor series. The right side is concave in s.
#include "dynamics/time_of_impact.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "collision/distance.h"
#include "collision/narrow_phase.h"
#include "math/rotation.h"

namespace tumble {
namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
/// Poses looked at. A tumbling box needs about ten, a graze at a shallow angle thirty.
constexpr int kLooks = 128;
/// Of an interval, until nothing is left of it.
constexpr int kHalvings = 60;
/// Below this share of the sizes a distance's direction is rounding; the contact's normal is not.
constexpr double kNear = 1e-7;

/// First s in (0, span] with G + w s + a s^2 / 2 = 0 and falling; G >= 0 up to rounding.
std::optional<double> first_root(double G, double w, double a, double span) {
  G = std::max(G, 0.0);
  const double D2 = w * w - 2.0 * a * G;
  if (D2 < 0.0 || (w >= 0.0 && a >= 0.0)) return std::nullopt;
  const double D = std::sqrt(D2);
  // Of the two forms of the root the one without cancellation.
  const double s = w > 0.0 ? -(w + D) / a : 2.0 * G / (D - w);
  return s <= span ? std::optional(s) : std::nullopt;
}

/// A sphere about its body's centre of mass.
const Sphere* centred_sphere(const MovingShape& shape) {
  return shape.X_BS.p.isZero(0.0) ? std::get_if<Sphere>(&shape.shape) : nullptr;
}

/// One of the two shapes and what it contributes to the planes' distance.
class Mover {
 public:
  explicit Mover(const MovingShape& of) : of_(of) {
    if (of.way.stays() || centred_sphere(of) != nullptr) return;
    turns_ = of.way.rotation().speed > 0.0;
    reach_ = std::sqrt(of.X_BS.p.squaredNorm()) + bounding_radius(of.shape);
  }

  void look(double t) {
    motion_ = of_.way.drift_at(t);
    velocity_ = of_.way.velocity(t);
    X_WS_ = Pose{motion_.q, motion_.x} * of_.X_BS;
    R_WS_ = rotation_matrix(X_WS_.q);
    arm_ = motion_.q * of_.X_BS.p;
  }
  const Pose& pose() const { return X_WS_; }
  const Mat3& axes() const { return R_WS_; }
  const Motion& motion() const { return motion_; }
  const Vec3& velocity() const { return velocity_; }
  Vec3 point_velocity(const Vec3& p_W) const { return velocity_ + motion_.w.cross(p_W - motion_.x); }
  bool turns() const { return turns_; }
  double acceleration_bound() const { return turns_ ? of_.way.rotation().rate * reach_ : 0.0; }
  double turning_speed() const { return turns_ ? of_.way.rotation().speed * reach_ : 0.0; }
  /// Furthest point along d, from the centre of mass, in W.
  Vec3 furthest(const Vec3& d) const { return R_WS_ * support(of_.shape, R_WS_.transpose() * d) + arm_; }

 private:
  const MovingShape& of_;
  bool turns_ = false;
  double reach_ = 0.0;  // [m] of the points that turning moves
  Motion motion_;
  Vec3 velocity_ = Vec3::Zero(), arm_ = Vec3::Zero();
  Pose X_WS_;
  Mat3 R_WS_ = Mat3::Identity();
};

/// The lower bound of the gap as a concave function of the time s from now.
class GapBound {
 public:
  GapBound(const Mover& a, const Mover& b, const Vec3& n, double gap, const Vec3& acceleration)
      : a_(a),
        b_(b),
        n_(n),
        m_a_(n.cross(a.motion().w)),
        m_b_(n.cross(b.motion().w)),
        gap_(gap),
        w_(n.dot(b.velocity() - a.velocity())),
        g_(std::min(0.0, n.dot(acceleration))),
        K_(a.acceleration_bound() + b.acceleration_bound()) {
    if (a.turns()) h_a_ = n.dot(a.furthest(n));
    if (b.turns()) h_b_ = n.dot(b.furthest(-n));
  }

  double value(double s, double& slope) const {
    double gap = gap_ + s * (w_ + 0.5 * s * (g_ - K_));
    slope = w_ + s * (g_ - K_);
    if (b_.turns()) {
      const Vec3 d = n_ + s * m_b_, r = b_.furthest(-d);
      gap += r.dot(d) - h_b_;
      slope += r.dot(m_b_);
    }
    if (a_.turns()) {
      const Vec3 d = n_ + s * m_a_, r = a_.furthest(d);
      gap -= r.dot(d) - h_a_;
      slope -= r.dot(m_a_);
    }
    return gap;
  }

  /// The largest s <= span that is found with the bound >= -tolerance on all of [0, s].
  double safe_until(double span, double tolerance) const {
    double slope;
    double low = 0.0, at_low = value(0.0, slope), high = span, at_high = value(span, slope);
    if (at_high >= 0.0) return span;
    // Touching now: leaves, if the bound is positive anywhere.
    for (int i = 0; i < kHalvings && at_low <= tolerance; ++i) {
      double slope_middle;
      const double middle = 0.5 * high, at_middle = value(middle, slope_middle);
      (at_middle > tolerance ? low : high) = middle;
      (at_middle > tolerance ? at_low : at_high) = at_middle;
      if (at_middle <= tolerance) slope = slope_middle;
    }
    // The chord lies below a concave function, its tangent above: the root is between theirs.
    for (int i = 0; i < kHalvings && at_low > tolerance; ++i) {
      const double chord = low + (high - low) * (at_low / (at_low - at_high));
      const double tangent = slope < 0.0 ? std::clamp(high - at_high / slope, chord, high) : high;
      double slope_chord;
      const double at_chord = value(chord, slope_chord);
      if (!(chord > low)) break;
      low = chord;
      at_low = std::max(0.0, at_chord);
      if (!(tangent < high)) continue;
      const double at_tangent = value(tangent, slope);
      if (at_tangent >= 0.0) return tangent;
      high = tangent;
      at_high = at_tangent;
    }
    return low;
  }

 private:
  const Mover &a_, &b_;
  Vec3 n_, m_a_, m_b_;
  double gap_, w_;
  double
      g_;  // of the acceleration of the gap what closes it; leaving out what opens it keeps the bound concave
  double K_, h_a_ = 0.0, h_b_ = 0.0;
};

/// What separates the shapes at one time.
struct Look {
  enum class State { apart, touching, clear } state;
  Vec3 n = Vec3::Zero();
  double gap = 0.0;
  bool closing = false;  // touching: a point of contact approaches
};

class Pursuit {
 public:
  Pursuit(const MovingShape& a, const MovingShape& b, const ImpactSearch& search)
      : a_(a), b_(b), ways_{&a.way, &b.way}, shapes_{&a.shape, &b.shape}, part_(search.part), to_(search.to) {
    size_ = extent(a.shape) + extent(b.shape);
    if (const TriangleSurface* surface = surface_of(a.shape))
      corners_ = surface->triangle(search.part).corner;
  }

  std::optional<TimeOfImpact> run(double from) {
    TimeOfImpact found{.time = from};
    while (found.iterations < kLooks) {
      const double t = found.time, left = to_ - t;
      ++found.iterations;
      a_.look(t);
      b_.look(t);
      const Look look = look_at(left);
      if (look.state == Look::State::clear) return std::nullopt;
      if (look.closing) return found;
      const GapBound bound(a_, b_, look.n, look.gap, acceleration());
      const double touch = rounding();
      const double s = bound.safe_until(left, 0.1 * touch);
      if (s >= left) return std::nullopt;
      // A touch that is left at once, or not at all: whoever asks decides what a contact at rest is.
      if (t + s <= t) return found;
      found.time = t + s;
    }
    found.bounded = true;
    return found;
  }

 private:
  static double extent(const Shape& shape) {
    return std::holds_alternative<HalfSpace>(shape) || surface_of(shape) != nullptr ? 0.0
                                                                                    : bounding_radius(shape);
  }

  Vec3 acceleration() const { return ways_[1]->acceleration() - ways_[0]->acceleration(); }

  Look look_at(double left) {
    if (std::holds_alternative<HalfSpace>(*shapes_[0])) return look_at_plane();
    const Pose X_AB = relative_pose(a_.pose(), b_.pose());
    const Vec3 v = b_.velocity() - a_.velocity();
    const double reach = left * (std::sqrt(v.squaredNorm()) + a_.turning_speed() + b_.turning_speed() +
                                 0.5 * left * std::sqrt(acceleration().squaredNorm()));
    const DistanceSettings settings{.beyond = reach, .start = start_};
    const Distance distance = corners_ ? compute_distance(*corners_, *shapes_[1], X_AB, settings)
                                       : compute_distance(*shapes_[0], *shapes_[1], X_AB, settings);
    start_ = distance.carriers;
    if (!distance.overlap && distance.lower > reach) return {.state = Look::State::clear};
    const Vec3 n = a_.axes() * distance.axis_A;
    if (distance.lower > kNear * size_) return {.state = Look::State::apart, .n = n, .gap = distance.lower};
    return look_at_contact(n, distance.lower);
  }

  Look look_at_plane() {
    const Vec3 n = a_.axes().col(2);
    const Vec3 lowest = b_.pose() * support(*shapes_[1], b_.axes().transpose() * -n);
    const double gap = n.dot(lowest - a_.pose().p);
    if (gap > kNear * size_) return {.state = Look::State::apart, .n = n, .gap = gap};
    return look_at_contact(n, gap);
  }

  /// Of a separation at the present place [m].
  double rounding() const {
    return 16.0 * kEpsilon * (size_ + a_.pose().p.cwiseAbs().maxCoeff() + b_.pose().p.cwiseAbs().maxCoeff());
  }

  /// So near that the points of contact are known.
  Look look_at_contact(const Vec3& n, double gap) {
    const Manifold manifold = collide(*shapes_[0], a_.pose(), *shapes_[1], b_.pose(), 2.0 * kNear * size_, {},
                                      cache_, counters_, part_);
    if (manifold.count == 0) {
      // A surface that is met from behind or at an edge that does not count.
      if (gap <= 0.0) return {.state = Look::State::clear};
      return {.state = Look::State::apart, .n = n, .gap = gap};
    }
    Look look{.state = Look::State::touching, .n = a_.axes() * manifold.normal_A};
    look.gap = std::max(0.0, least_separation(manifold));
    const double touch = rounding();
    for (int i = 0; i < manifold.count; ++i) {
      const ManifoldPoint& point = manifold.points[static_cast<std::size_t>(i)];
      if (point.separation > touch) continue;
      const Vec3 p_W = a_.pose() * point.p_A;
      if (look.n.dot(b_.point_velocity(p_W) - a_.point_velocity(p_W)) < 0.0) look.closing = true;
    }
    return look;
  }

  Mover a_, b_;
  std::array<const Trajectory*, 2> ways_;
  std::array<const Shape*, 2> shapes_;
  std::uint32_t part_;
  double to_, size_ = 0.0;
  std::optional<std::array<Vec3, 3>> corners_;  // of the triangle, if A is a surface
  Carriers start_;
  PairCache cache_;
  NarrowPhaseCounters counters_;
};

/// Both in flight with the same acceleration: the way between them is straight.
std::optional<double> spheres_touch(const Vec3& d, const Vec3& u, double radii, double span) {
  const double B = d.dot(u), A = u.squaredNorm();
  // Product form: near a touch the difference of squares has no digits left.
  const double distance = std::sqrt(d.squaredNorm()), C = (distance - radii) * (distance + radii);
  if (B >= 0.0) return std::nullopt;
  if (C <= 0.0) return 0.0;
  const double D2 = B * B - A * C;
  if (D2 < 0.0) return std::nullopt;
  const double s = C / (-B + std::sqrt(D2));
  return s <= span ? std::optional(s) : std::nullopt;
}

std::optional<TimeOfImpact> as_impact(double from, const std::optional<double>& s) {
  if (!s) return std::nullopt;
  return TimeOfImpact{.time = from + *s, .iterations = 1};
}

}  // namespace

std::optional<TimeOfImpact> find_impact(const MovingShape& a, const MovingShape& b,
                                        const ImpactSearch& search) {
  const bool swap = std::holds_alternative<HalfSpace>(b.shape) || surface_of(b.shape) != nullptr;
  if (swap) return find_impact(b, a, search);
  const double span = search.to - search.from;
  if (const Sphere* ball = centred_sphere(b)) {
    const Vec3 x = b.way.position(search.from), v = b.way.velocity(search.from);
    if (std::holds_alternative<HalfSpace>(a.shape) && a.way.stays()) {
      const Pose X_WA = Pose{a.way.start().q, a.way.start().x} * a.X_BS;
      const Vec3 n = rotation_matrix(X_WA.q).col(2);
      return as_impact(search.from, first_root(n.dot(x - X_WA.p) - ball->radius, n.dot(v),
                                               n.dot(b.way.acceleration()), span));
    }
    const Sphere* other = centred_sphere(a);
    if (other != nullptr && a.way.acceleration() == b.way.acceleration()) {
      const Vec3 d = x - a.way.position(search.from), u = v - a.way.velocity(search.from);
      return as_impact(search.from, spheres_touch(d, u, ball->radius + other->radius, span));
    }
  }
  return Pursuit(a, b, search).run(search.from);
}

double time_above(double gap, double w, double a) {
  if (!(gap > 0.0)) return 0.0;
  return first_root(gap, w, a, kInfinity).value_or(kInfinity);
}

double time_apart(const Vec3& d, const Vec3& u, const Vec3& g, double distance) {
  const double gap = std::sqrt(d.squaredNorm()) - distance;
  if (!(gap > 0.0)) return 0.0;
  if (g.isZero(0.0)) return spheres_touch(d, u, distance, kInfinity).value_or(kInfinity);
  return time_above(gap, -std::sqrt(u.squaredNorm()), -std::sqrt(g.squaredNorm()));
}

}  // namespace tumble
