// The pair matrix, the pipeline that every pair without a closed form passes, and the one place where A and B swap.
// Everything runs in the frame of the shape that comes first in the matrix.
#include "collision/narrow_phase.h"

#include <array>
#include <cstring>
#include <limits>
#include <new>
#include <type_traits>

#include "collision/collide_box_box.h"
#include "collision/collide_capsule.h"
#include "collision/collide_curved.h"
#include "collision/collide_half_space.h"
#include "collision/collide_polytope.h"
#include "collision/collide_sphere.h"
#include "collision/collide_triangle.h"
#include "collision/gjk.h"
#include "collision/pair_order.h"
#include "math/rotation.h"

namespace tumble {
namespace {

/// Either a closed form, cheaper than any early end, or exact features behind the pipeline below. libccd decides first
/// where it is cheaper than they are: two boxes are told apart by fifteen axes in a quarter of its time, hulls by a walk
/// over their faces in four fifths, a capsule from a polytope by the faces' heights.
struct PairFunction {
  /// A closed form that asks only where B is, not how it is turned.
  Manifold (*of_place)(const Shape&, const Shape&, const Vec3& p_AB, double margin) = nullptr;
  Manifold (*closed_form)(const Shape&, const Shape&, const Pose&, double margin) = nullptr;
  Manifold (*exact)(const Shape&, const Shape&, const Pose&, double margin, PairCache&) = nullptr;
  bool gjk_first = false;
};

template <auto function, typename A, typename B, typename Place>
Manifold unpack(const Shape& a, const Shape& b, const Place& place, double margin) {
  return function(*std::get_if<A>(&a), *std::get_if<B>(&b), place, margin);
}
template <auto function, typename A, typename B>
Manifold unpack(const Shape& a, const Shape& b, const Pose& X_AB, double margin, PairCache& cache) {
  return function(*std::get_if<A>(&a), *std::get_if<B>(&b), X_AB, margin, cache);
}

template <auto function, typename A, typename B>
constexpr PairFunction pair_function(Manifold (*)(const A&, const B&, const Vec3&, double)) {
  return {.of_place = &unpack<function, A, B, Vec3>};
}
template <auto function, typename A, typename B>
constexpr PairFunction pair_function(Manifold (*)(const A&, const B&, const Pose&, double)) {
  return {.closed_form = &unpack<function, A, B, Pose>};
}
template <auto function, typename A, typename B>
constexpr PairFunction pair_function(Manifold (*)(const A&, const B&, const Pose&, double, PairCache&)) {
  return {.exact = &unpack<function, A, B>};
}
template <auto function>
constexpr PairFunction by = pair_function<function>(function);

constexpr PairFunction none;
constexpr PairFunction box_hull{.exact = collide_box_hull}, hull_hull{.exact = collide_hull_hull};
constexpr PairFunction curved{.exact = collide_curved, .gjk_first = true};
constexpr PairFunction on_ground{.closed_form = collide_half_space_curved};

// Rows: shape A, columns: shape B, both in the order of Shape's alternatives. Half-spaces never meet: they don't move.
// clang-format off
constexpr std::array<std::array<PairFunction, kShapeTypes>, kShapeTypes> kMatrix = {{
  //            half-space  sphere                          capsule                          box                          hull                          cylinder                      cone                      ellipsoid
  /*half-space*/ {none,     by<collide_half_space_sphere>,  by<collide_half_space_capsule>,  by<collide_half_space_box>,  by<collide_half_space_hull>,  on_ground,                    on_ground,                on_ground},
  /*sphere    */ {none,     by<collide_sphere_sphere>,      by<collide_sphere_capsule>,      by<collide_sphere_box>,      by<collide_sphere_hull>,      by<collide_sphere_cylinder>,  by<collide_sphere_cone>,  by<collide_sphere_ellipsoid>},
  /*capsule   */ {none,     none,                           by<collide_capsule_capsule>,     by<collide_capsule_box>,     by<collide_capsule_hull>,     curved,                       curved,                   curved},
  /*box       */ {none,     none,                           none,                            by<collide_box_box>,         box_hull,                     curved,                       curved,                   curved},
  /*hull      */ {none,     none,                           none,                            none,                        hull_hull,                    curved,                       curved,                   curved},
  /*cylinder  */ {none,     none,                           none,                            none,                        none,                         curved,                       curved,                   curved},
  /*cone      */ {none,     none,                           none,                            none,                        none,                         none,                         curved,                   curved},
  /*ellipsoid */ {none,     none,                           none,                            none,                        none,                         none,                         none,                     curved},
}};
// clang-format on

/// Upper bound of |R - R0| (spectral norm) between the orientations: 2 sin(angle / 2) <= 2 |q - q0|.
double turned_by(const Quat& q, const Quat& q0) {
  const double sign = q.dot(q0) < 0.0 ? -1.0 : 1.0;
  return 2.0 * (q.coeffs() - sign * q0.coeffs()).norm();
}

/// Lets the result of `make` come into being in the manifold's place, so that nothing is copied.
template <typename Make>
void replace(Manifold& manifold, const Make& make) {
  static_assert(std::is_trivially_destructible_v<Manifold>);
  ::new (&manifold) Manifold(make());
}

template <typename Value>
bool has_same_bits(const Value& value, const Value& other) {
  // NOLINTNEXTLINE(bugprone-suspicious-memory-comparison): the bits are meant
  return std::memcmp(&value, &other, sizeof value) == 0;
}

/// The early ends of the pipeline, for one pair of shapes in matrix order.
class Query {
 public:
  Query(const Shape& a, const Shape& b, const Pose& X_AB, double margin, const NarrowPhaseOptions& options,
        PairCache& cache, NarrowPhaseCounters& counters)
      : a_(a), b_(b), X_AB_(X_AB), margin_(margin), options_(options), cache_(cache), counters_(counters) {}

  /// False: the manifold of the last query still holds.
  bool run(const PairFunction& function, Manifold& manifold) {
    if (is_unmoved()) return ++counters_.unmoved, false;
    manifold = Manifold();
    cache_.margin = std::numeric_limits<double>::quiet_NaN();
    const bool was_near = cache_.axis_A.squaredNorm() > 0.0 && cache_.gap <= margin_;
    if (stays_beyond_by_motion()) {
      ++counters_.motion_bound;
    } else if (beyond_on_cached_axis()) {
      ++counters_.cached_axis;
    } else if (options_.use_gjk && function.gjk_first && !was_near && beyond_by_gjk()) {
      ++counters_.gjk;
    } else {
      find_exactly(function, manifold);
    }
    return true;
  }

 private:
  bool is_unmoved() const {
    return options_.use_kept_manifold && cache_.margin == margin_ && has_same_bits(X_AB_.p, cache_.p_AB) &&
           has_same_bits(X_AB_.q, cache_.q_AB);
  }

  void find_exactly(const PairFunction& function, Manifold& manifold) {
    ++counters_.exact;
    if (!options_.use_cached_facet) cache_.slack = -1.0;
    if (cache_.slack >= 0.0) cache_.slack -= 4.0 * moved_by();
    if (cache_.slack >= 0.0) ++counters_.facet_kept;
    replace(manifold, [&] { return function.exact(a_, b_, X_AB_, margin_, cache_); });
    remember_pose();
    cache_.margin = margin_;
  }

  /// The gap changes exactly with the translation along the axis, and at most by the turn of B's furthest point.
  bool stays_beyond_by_motion() {
    if (!options_.use_motion_bound || cache_.gap <= margin_) return false;
    const double radius_b = bounding_radius(b_);
    const double bound =
        cache_.gap + cache_.axis_A.dot(X_AB_.p - cache_.p_AB) - turned_by(X_AB_.q, cache_.q_AB) * radius_b;
    return bound > margin_ + kSeparationRounding * (X_AB_.p.norm() + radius_b);
  }

  bool beyond_on_cached_axis() {
    if (!options_.use_cached_axis || cache_.gap <= 0.0) return false;
    const double gap = separation_along(a_, b_, rotation_matrix(X_AB_.q), X_AB_.p, cache_.axis_A) - error();
    if (gap <= margin_) return false;
    remember_gap(cache_.axis_A, gap);
    return true;
  }

  bool beyond_by_gjk() {
    const GjkAnswer answer = decide_apart(a_, b_, X_AB_);
    counters_.gjk_uncertified += answer.kind == GjkAnswer::Kind::undecided;
    counters_.gjk_budget_hit += answer.budget_hit;
    if (answer.kind != GjkAnswer::Kind::apart || answer.gap <= margin_) {
      cache_.axis_A = answer.axis_A;  // where the exact features start to look
      return false;
    }
    remember_gap(answer.axis_A, answer.gap);
    return true;
  }

  /// No point of B is further from where it was at the last query; exactly 0 if the pose is the same to the bit.
  double moved_by() const {
    if (X_AB_.p == cache_.p_AB && X_AB_.q.coeffs() == cache_.q_AB.coeffs()) return 0.0;
    return (X_AB_.p - cache_.p_AB).norm() + turned_by(X_AB_.q, cache_.q_AB) * bounding_radius(b_) + error();
  }

  /// Of a separation [m].
  double error() const {
    return kSeparationRounding * (bounding_radius(a_) + bounding_radius(b_) + X_AB_.p.lpNorm<1>());
  }

  void remember_gap(const Vec3& axis_A, double gap) {
    cache_.axis_A = axis_A;
    cache_.gap = gap;
    cache_.slack = -1.0;
    remember_pose();
  }
  void remember_pose() {
    cache_.p_AB = X_AB_.p;
    cache_.q_AB = X_AB_.q;
  }

  const Shape &a_, &b_;
  const Pose& X_AB_;
  double margin_;
  const NarrowPhaseOptions& options_;
  PairCache& cache_;
  NarrowPhaseCounters& counters_;
};

/// B's origin in A.
Vec3 relative_place(const Pose& X_WA, const Pose& X_WB) {
  return X_WA.q.conjugate() * (X_WB.p - X_WA.p);
}

Manifold collide_with_surface(const Shape& a, const Shape& b, const Pose& X_AB, double margin,
                              NarrowPhaseCounters& counters, std::uint32_t part) {
  const TriangleSurface* surface = surface_of(b);
  if (surface == nullptr) return {};
  ++counters.triangles;
  return collide_triangle(a, *surface, part, X_AB, margin);
}

/// Shapes of one type have no order in the matrix. Theirs is decided once and then kept: while two equal bodies turn
/// round each other neither the frame of their memory nor the order of their points may change.
bool runs_backwards(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB, PairCache& cache) {
  if (a.index() != b.index()) return a.index() > b.index();
  if (cache.order == PairCache::Order::open) {
    cache.order = comes_second(a, X_WA, b, X_WB) ? PairCache::Order::backwards : PairCache::Order::forwards;
  }
  return cache.order == PairCache::Order::backwards;
}

}  // namespace

void swap_shapes(Manifold& manifold, const Pose& X_AB) {
  if (manifold.count == 0) return;
  const Mat3 R_BA = rotation_matrix(X_AB.q).transpose();
  manifold.normal_A = -(R_BA * manifold.normal_A);
  for (std::size_t i = 0; i < static_cast<std::size_t>(manifold.count); ++i) {
    manifold.points[i].p_A = R_BA * (manifold.points[i].p_A - X_AB.p);
  }
}

void update_manifold(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB, double margin,
                     const NarrowPhaseOptions& options, PairCache& cache, NarrowPhaseCounters& counters,
                     Manifold& manifold, std::uint32_t part) {
  ++counters.queries;
  const bool backwards = runs_backwards(a, X_WA, b, X_WB, cache);
  const Shape &first = backwards ? b : a, &second = backwards ? a : b;
  const Pose &X_W1 = backwards ? X_WB : X_WA, &X_W2 = backwards ? X_WA : X_WB;
  const PairFunction& function = kMatrix[first.index()][second.index()];
  if (function.of_place != nullptr) {
    ++counters.closed_form;
    replace(manifold, [&] { return function.of_place(first, second, relative_place(X_W1, X_W2), margin); });
    if (backwards && manifold.count > 0) swap_shapes(manifold, relative_pose(X_W1, X_W2));
    return;
  }
  const Pose X_12 = relative_pose(X_W1, X_W2);
  if (function.exact != nullptr) {
    Query query(first, second, X_12, margin, options, cache, counters);
    if (!query.run(function, manifold)) return;
  } else {
    ++counters.closed_form;
    replace(manifold, [&] {
      return function.closed_form != nullptr
                 ? function.closed_form(first, second, X_12, margin)
                 : collide_with_surface(first, second, X_12, margin, counters, part);
    });
  }
  if (backwards) swap_shapes(manifold, X_12);
}

Manifold collide(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB, double margin,
                 const NarrowPhaseOptions& options, PairCache& cache, NarrowPhaseCounters& counters,
                 std::uint32_t part) {
  NarrowPhaseOptions keeping_nothing = options;
  keeping_nothing.use_kept_manifold = false;
  Manifold manifold;
  update_manifold(a, X_WA, b, X_WB, margin, keeping_nothing, cache, counters, manifold, part);
  return manifold;
}

Pose relative_pose(const Pose& X_WA, const Pose& X_WB) {
  return {X_WA.q.conjugate() * X_WB.q, relative_place(X_WA, X_WB)};
}

}  // namespace tumble
