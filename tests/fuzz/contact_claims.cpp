// See contact_claims.h. Lengths are judged in shares of the pair's size: the bounding radii and the distance of centres.
#include "contact_claims.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>
#include <vector>

#include "collision/distance.h"
#include "collision/gjk.h"
#include "collision/manifold_builder.h"
#include "collision/narrow_phase.h"
#include "collision/pair_order.h"
#include "math/rotation.h"

namespace tumble::test {
namespace {

constexpr int kDirections = 20000;
/// Of the size. The engine promises 1e-13; supports and poses here round too.
constexpr double kTolerance = 1e-12;
/// The same of cylinders, cones and ellipsoids, whose search ends within 1e-11 (contacts_accuracy_curved).
constexpr double kCurvedTolerance = 2e-11;

/// Directions spread evenly over the sphere: a Fibonacci spiral.
std::vector<Vec3> make_directions() {
  std::vector<Vec3> directions;
  const double turn = std::numbers::pi * (3.0 - std::sqrt(5.0));
  for (int i = 0; i < kDirections; ++i) {
    const double z = 1.0 - (2.0 * i + 1.0) / kDirections, r = std::sqrt(1.0 - z * z);
    directions.push_back({r * std::cos(turn * i), r * std::sin(turn * i), z});
  }
  return directions;
}

bool is_curved(const Shape& shape) {
  return std::holds_alternative<Cylinder>(shape) || std::holds_alternative<Cone>(shape) ||
         std::holds_alternative<Ellipsoid>(shape);
}

bool is_endless(const Shape& shape) {
  return std::holds_alternative<HalfSpace>(shape);
}

Manifold collide_cold(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB, double margin,
                      const NarrowPhaseOptions& options = {}) {
  PairCache cache;
  NarrowPhaseCounters counters;
  return collide(a, X_WA, b, X_WB, margin, options, cache, counters);
}

bool same_bits(const Vec3& u, const Vec3& v) {
  // NOLINTNEXTLINE(bugprone-suspicious-memory-comparison): the bits are meant
  return std::memcmp(u.data(), v.data(), sizeof(double) * 3) == 0;
}

bool same_bits(const Manifold& m, const Manifold& n) {
  if (m.count != n.count || (m.count > 0 && !same_bits(m.normal_A, n.normal_A))) return false;
  for (std::size_t i = 0; i < static_cast<std::size_t>(m.count); ++i) {
    if (!same_bits(m.points[i].p_A, n.points[i].p_A) || m.points[i].separation != n.points[i].separation ||
        m.points[i].feature != n.points[i].feature) {
      return false;
    }
  }
  return true;
}

/// How far a hull's vertices lie below its faces [m]: coplanar within this, they were merged, and planes and vertices are
/// two descriptions of the body.
double unevenness(const Shape& shape) {
  const HullPointer* hull = std::get_if<HullPointer>(&shape);
  double worst = 0.0;
  if (hull == nullptr) return worst;
  for (const Polytope::Face& face : (*hull)->faces) {
    for (std::uint32_t i = face.first; i < face.first + face.count; ++i) {
      worst = std::max(worst, face.offset - face.normal.dot((*hull)->vertices[(*hull)->loops[i]]));
    }
  }
  return worst;
}

/// The shape in other units, s a power of 2: exactly the same, but for the numbers.
Shape scaled(const Shape& shape, double s) {
  if (const auto* sphere = std::get_if<Sphere>(&shape)) return Sphere{s * sphere->radius};
  if (const auto* capsule = std::get_if<Capsule>(&shape))
    return Capsule{s * capsule->radius, s * capsule->half_length};
  if (const auto* box = std::get_if<Box>(&shape)) return Box{s * box->half_extents};
  if (const auto* cylinder = std::get_if<Cylinder>(&shape))
    return Cylinder{s * cylinder->radius, s * cylinder->half_length};
  if (const auto* cone = std::get_if<Cone>(&shape)) return Cone{s * cone->radius, s * cone->half_length};
  if (const auto* ellipsoid = std::get_if<Ellipsoid>(&shape)) return Ellipsoid{s * ellipsoid->half_axes};
  const auto* pointer = std::get_if<HullPointer>(&shape);
  if (pointer == nullptr) return shape;
  ConvexHull::Parts hull = (*pointer)->parts();
  for (Vec3& vertex : hull.vertices) vertex *= s;
  for (Polytope::Side& side : hull.sides) side.offset *= s;
  for (Polytope::Face& face : hull.faces) face.offset *= s, face.width *= s;
  hull.centre *= s;
  hull.radius *= s;
  return std::make_shared<const ConvexHull>(std::move(hull));
}

class Claims {
 public:
  explicit Claims(const ShapePair& pair)
      : pair_(pair),
        X_AB_(relative_pose(pair.X_WA, pair.X_WB)),
        R_AB_(rotation_matrix(X_AB_.q)),
        manifold_(collide_cold(pair.a, pair.X_WA, pair.b, pair.X_WB, pair.margin)) {
    double radii = 0.0, smaller = std::numeric_limits<double>::infinity();
    for (const Shape* shape : {&pair.a, &pair.b}) {
      if (is_endless(*shape)) continue;
      radii += bounding_radius(*shape);
      smaller = std::min(smaller, bounding_radius(*shape));
    }
    const double share = is_curved(pair.a) || is_curved(pair.b) ? kCurvedTolerance : kTolerance;
    tolerance_ = share * (radii + X_AB_.p.norm()) + unevenness(pair.a) + unevenness(pair.b);
    clipping_ = 2.0 * ContactTolerance::of(2.0 * smaller).inside;
    if (!is_endless(pair.a) && !is_endless(pair.b)) distance_ = compute_distance(pair.a, pair.b, X_AB_).upper;
    separation_ = least_separation(manifold_);
  }

  Verdict run() {
    check_numbers();
    check_repeats();
    check_moves();
    check_swap();
    check_plane();
    check_points();
    check_motion();
    check_scale();
    if (!is_endless(pair_.a) && !is_endless(pair_.b)) {
      check_distance();
      check_certificate();
      check_every_direction();
    }
    const bool overlaps = manifold_.count > 0 && separation_ < -tolerance_;
    return {broken_, overlaps              ? Outcome::overlapping
                     : manifold_.count > 0 ? Outcome::touching
                                           : Outcome::apart};
  }

 private:
  template <typename... Values>
  void claim(bool holds, const char* text, const Values&... values) {
    if (!holds && broken_.empty()) broken_ = fmt::format(fmt::runtime(text), values...);
  }

  void check_numbers() {
    claim(manifold_.count >= 0 && manifold_.count <= kMaxManifoldPoints, "{} points", manifold_.count);
    claim(std::abs(manifold_.normal_A.norm() - 1.0) < 1e-12, "normal of length {}",
          manifold_.normal_A.norm());
    for (int i = 0; i < manifold_.count; ++i) {
      const ManifoldPoint& point = manifold_.points[static_cast<std::size_t>(i)];
      claim(point.p_A.allFinite() && std::isfinite(point.separation), "point {} is not finite", i);
      claim(point.separation <= pair_.margin, "point {} at {} is beyond the margin {}", i, point.separation,
            pair_.margin);
    }
  }

  /// A function of shapes and poses; libccd and what is remembered only save work.
  void check_repeats() {
    const auto& [a, b, X_WA, X_WB, margin] = pair_;
    claim(same_bits(manifold_, collide_cold(a, X_WA, b, X_WB, margin)), "another answer the second time");
    NarrowPhaseOptions plain;
    plain.use_kept_manifold = plain.use_gjk = plain.use_motion_bound = plain.use_cached_axis =
        plain.use_cached_facet = false;
    claim(same_bits(manifold_, collide_cold(a, X_WA, b, X_WB, margin, plain)), "another answer without GJK");
    PairCache cache;
    NarrowPhaseCounters counters;
    Manifold kept;
    for (int i = 0; i < 2; ++i) {
      update_manifold(a, X_WA, b, X_WB, margin, {}, cache, counters, kept);
      claim(same_bits(manifold_, kept), "another answer from memory");
    }
  }

  /// What is remembered of one pose is no part of the answer at the next, near or far.
  void check_moves() {
    const auto& [a, b, X_WA, X_WB, margin] = pair_;
    PairCache cache;
    NarrowPhaseCounters counters;
    Manifold kept;
    Pose X_WM = X_WB;
    for (const double share : {0.0, 1e-9, 1e-7, 1e-4, 1e-2}) {
      X_WM.p += share * bounding_radius(b) * Vec3(0.36, -0.48, 0.8);
      X_WM.q = normalized(Quat(1.0, 0.6 * share, 0.0, -0.8 * share) * X_WM.q);
      if (!X_WM.p.allFinite()) return;
      update_manifold(a, X_WA, b, X_WM, margin, {}, cache, counters, kept);
      PairCache cold;
      cold.order = cache.order;  // is decided once
      const Manifold afresh = collide(a, X_WA, b, X_WM, margin, {}, cold, counters);
      if (least_separation(afresh) <= 0.0)
        claim(same_bits(afresh, kept), "another answer after moving by {}", share);
    }
  }

  void check_swap() {
    const auto& [a, b, X_WA, X_WB, margin] = pair_;
    const bool told_apart =
        a.index() != b.index() || comes_second(a, X_WA, b, X_WB) || comes_second(b, X_WB, a, X_WA);
    if (!told_apart) return;
    const Manifold other = collide_cold(b, X_WB, a, X_WA, margin);
    Manifold turned = other, own = manifold_;
    swap_shapes(turned, relative_pose(X_WB, X_WA));
    swap_shapes(own, X_AB_);
    claim(same_bits(turned, manifold_) || same_bits(own, other),
          "B-A is not A-B turned round: {} points, {} points", other.count, manifold_.count);
  }

  /// The planes square to the normal that touch A and B are apart by the least separation.
  void check_plane() {
    if (manifold_.count == 0) return;
    const double along = separation_of(manifold_.normal_A);
    claim(std::abs(along - separation_) <= tolerance_, "planes {} apart, contact says {}", along,
          separation_);
  }

  double separation_of(const Vec3& n_A) const {
    const Vec3 n_B = R_AB_.transpose() * n_A;
    if (is_endless(pair_.a)) return n_A.z() * (X_AB_ * support(pair_.b, -n_B)).z();
    if (is_endless(pair_.b)) return -n_B.z() * (X_AB_.inverse() * support(pair_.a, n_A)).z();
    return separation_along(pair_.a, pair_.b, R_AB_, X_AB_.p, n_A);
  }

  /// Points lie within both shapes but for half the gap, which they are in the middle of, and for what clipping leaves.
  /// Where corners face each other across a gap, nothing lies along the normal: there, within the distance.
  void check_points() {
    for (int i = 0; i < manifold_.count; ++i) {
      const ManifoldPoint& point = manifold_.points[static_cast<std::size_t>(i)];
      const double gap = std::max(0.5 * std::abs(point.separation), separation_ > 0.0 ? distance_ : 0.0);
      const double slack = gap + clipping_ + tolerance_;
      const Vec3 p_B = X_AB_.inverse() * point.p_A;
      claim(is_within(pair_.a, point.p_A, slack), "point {} is outside A by more than {}", i, slack);
      claim(is_within(pair_.b, p_B, slack), "point {} is outside B by more than {}", i, slack);
    }
  }

  static bool is_within(const Shape& shape, const Vec3& p, double slack) {
    if (is_endless(shape)) return p.z() <= slack;
    const Aabb bounds = compute_aabb(shape, {}).grown(slack);
    if (!bounds.contains({p, p})) return false;
    constexpr int kEvery = 100;
    for (int i = 0; i < kDirections; i += kEvery) {
      const Vec3& n = directions()[static_cast<std::size_t>(i)];
      if (n.dot(p - support(shape, n)) > slack) return false;
    }
    return true;
  }

  /// Elsewhere and turned it is the same contact.
  void check_motion() {
    const Pose X{exp_map(Vec3(0.3, -1.1, 0.7)), Vec3(1.5, -0.25, 3.0)};
    const auto moved = [&](const Pose& X_WS) { return Pose{normalized(X.q * X_WS.q), X * X_WS.p}; };
    // Rounding of the new poses, in shares of their coordinates.
    const double far = pair_.X_WA.p.norm() + pair_.X_WB.p.norm() + X.p.norm();
    const double slack = tolerance_ + 1e-15 * far;
    const Manifold there =
        collide_cold(pair_.a, moved(pair_.X_WA), pair_.b, moved(pair_.X_WB), pair_.margin + 2.0 * slack);
    if (manifold_.count == 0) return;
    claim(there.count > 0, "no contact after a motion, {} before", separation_);
    const double deepest_there = least_separation(there);
    if (separation_ > 0.0) return;  // across a gap any facet that separates will do
    claim(std::abs(deepest_there - separation_) <= slack, "{} apart after a motion, {} before", deepest_there,
          separation_);
  }

  /// Ants and giants touch alike. Points may be others, since clipping has tolerances in metres; the depth has none.
  void check_scale() {
    if (manifold_.count == 0 || separation_ > 0.0) return;
    for (const double s : {0x1p-10, 0x1p10}) {
      const Pose X_WA{pair_.X_WA.q, s * pair_.X_WA.p}, X_WB{pair_.X_WB.q, s * pair_.X_WB.p};
      const double margin = s * (pair_.margin + 2.0 * tolerance_);
      const Manifold there = collide_cold(scaled(pair_.a, s), X_WA, scaled(pair_.b, s), X_WB, margin);
      claim(there.count > 0, "no contact in other units, {} before", separation_);
      if (there.count == 0) return;
      const double deepest = least_separation(there) / s;
      claim(std::abs(deepest - separation_) <= tolerance_, "{} apart when scaled by {}, {} before", deepest,
            s, separation_);
    }
  }

  /// The closest points are another algorithm: they must be no nearer than the contact says, and overlap if it does.
  void check_distance() {
    const DistanceSettings settings;
    const Distance distance = compute_distance(pair_.a, pair_.b, X_AB_, settings);
    claim(distance.iterations <= settings.budget, "{} supports for a distance", distance.iterations);
    claim(distance.lower <= distance.upper, "distance of {}..{}", distance.lower, distance.upper);
    claim(distance.a_A.allFinite() && distance.b_A.allFinite() && std::isfinite(distance.upper),
          "distance {} is not finite", distance.upper);
    if (manifold_.count == 0) {
      claim(distance.upper >= pair_.margin - tolerance_, "no contact, but {} apart with a margin of {}",
            distance.upper, pair_.margin);
    } else {
      claim(separation_ <= distance.upper + tolerance_, "separation {} above the distance {}", separation_,
            distance.upper);
      claim(separation_ > 0.0 || distance.lower <= tolerance_, "separation {}, but {} apart", separation_,
            distance.lower);
    }
  }

  void check_certificate() {
    const GjkAnswer answer = decide_apart(pair_.a, pair_.b, X_AB_);
    claim(!answer.budget_hit, "libccd stopped by its budget");
    if (answer.kind != GjkAnswer::Kind::apart) return;
    claim(answer.gap > 0.0 && separation_of(answer.axis_A) >= answer.gap, "GJK proves {}, its plane says {}",
          answer.gap, separation_of(answer.axis_A));
  }

  /// No direction separates more than the normal.
  void check_every_direction() {
    if (manifold_.count == 0 || separation_ > 0.0) return;
    for (const Vec3& n : directions()) {
      const double along = separation_of(n);
      claim(along <= separation_ + tolerance_, "({} {} {}) separates by {}, the normal by {}", n.x(), n.y(),
            n.z(), along, separation_);
    }
  }

  static const std::vector<Vec3>& directions() {
    static const std::vector<Vec3> all = make_directions();
    return all;
  }

  const ShapePair& pair_;
  Pose X_AB_;
  Mat3 R_AB_;
  Manifold manifold_;
  double tolerance_, clipping_, separation_, distance_ = 0.0;  // [m]
  std::string broken_;
};

}  // namespace

Verdict check_contact(const ShapePair& pair) {
  Claims claims(pair);
  return claims.run();
}

}  // namespace tumble::test
