// A walk to a face that proves itself, else exhaustive search with pruning. Any point of A with any point of B bounds the
// separation along a direction from above, so two well chosen points of each body rule out nearly all facets of the other. Vectors without suffix are in A's frame.
#include "collision/facet_search.h"

#include <array>

#include "collision/edge_arc.h"
#include "collision/point_heights.h"
#include "collision/segment.h"

namespace tumble {
namespace {

/// Share of the radii below which two separations are equal: their rounding, and what a nearly touching pair of arcs
/// may lead by although its edges do not cross.
constexpr double kFacetTie = 1e-14;
/// Share of B's radius: about a smaller disc a facet's neighbours are not told from it.
constexpr double kLeastDisc = 1e-4;
/// From so many pairs of edges on it pays to look for a better point against each edge.
constexpr std::size_t kManyPairs = 256;
/// Of a walk between faces and corners. If three don't end it, edges win.
constexpr int kWalkRounds = 3;
/// Larger indices are not remembered in the 32-bit feature: such hulls are searched without a seed.
constexpr std::uint32_t kIndexBits = 15, kIndexLimit = 1u << kIndexBits;

double tie_of(const PolytopePair& pair) {
  return kFacetTie * (pair.a.radius + pair.b.radius);
}

std::uint32_t encode(const Facet& facet) {
  if (facet.a >= kIndexLimit || facet.b >= kIndexLimit) return 0;
  return static_cast<std::uint32_t>(facet.kind) << 2 * kIndexBits | facet.a << kIndexBits | facet.b;
}

/// One body and what is known of it: two points of the other one, measured over its faces.
struct Side {
  const Polytope& polytope;
  PointHeights near{}, nearer{};

  /// No face separates by more than this.
  double bound(std::size_t face) const { return std::min(near[face], nearer[face]); }
};

/// Which edges of a side may have a facet that overlaps by less than a depth >= 0. Along an arc between two normals the
/// overlap with any one point of the other body is at least the smaller of its ends, as long as both are overlaps.
class EdgesThatMayWin {
 public:
  EdgesThatMayWin(const Side& side, double depth) : side_(side), depth_(depth) {
    const std::size_t fours = std::min(PointHeights::kKeptFours, side.polytope.face_fours.size());
    for (std::size_t i = 0; i < fours; ++i) {
      const FourFlags near = side.near.four_from(i) >= four(-depth),
                      nearer = side.nearer.four_from(i) >= four(-depth);
      const FourFlags points = (near & 1) | (nearer & 2);
      for (std::size_t k = 0; k < 4; ++k) points_[4 * i + k] = static_cast<std::uint8_t>(points[k]);
    }
  }
  bool contains(const Polytope::Edge& edge) const {
    return (points_above(edge.left_face) | points_above(edge.right_face)) == 3;
  }

 private:
  /// Bits of the two points that lie no deeper than that behind a face.
  int points_above(std::uint32_t face) const {
    if (face < 4 * PointHeights::kKeptFours) return points_[face];
    return (side_.near[face] >= -depth_ ? 1 : 0) | (side_.nearer[face] >= -depth_ ? 2 : 0);
  }

  const Side& side_;
  const double depth_;
  std::array<std::uint8_t, 4 * PointHeights::kKeptFours> points_;
};

/// Where two bodies touch in a facet of their difference: a point of each; how far the facet reaches about the point of
/// it that is above the origin [m], < 0 if that lies beside it, or nothing is certain; and until when it stays a facet
/// (as FacetAnswer::lead).
struct FacetTouch {
  Vec3 p_a, p_b;
  double clearance, lead;
};

/// Until when a corner, the lowest along d, stays it (as FacetAnswer::lead): how much higher its neighbours are; where d
/// turns with a body of some radius, a neighbour further off than that moves by as much more.
double lead_of_corner(const Polytope& polytope, std::uint32_t lowest, const Vec3& d, double radius) {
  double lead = kInfinity;
  for (std::uint32_t k = polytope.neighbour_offsets[lowest]; k < polytope.neighbour_offsets[lowest + 1];
       ++k) {
    const Vec3 along = polytope.vertices[polytope.neighbours[k]] - polytope.vertices[lowest];
    const double rise = d.dot(along);
    lead = std::min(lead, radius < kInfinity ? rise * std::min(1.0, radius / along.norm()) : rise);
  }
  return lead;
}

class FacetSearch {
 public:
  FacetSearch(const PolytopePair& pair, PairCache& cache)
      : a_{pair.a}, b_{pair.b}, R_(pair.R_AB), p_(pair.p_AB), cache_(cache), tie_(tie_of(pair)) {}

  /// Until the next search: the corners in the cache are those that the kept facet's face meets (lead_of_corner).
  void trust_corners() { corners_are_known_ = true; }
  Facet face_a(std::uint32_t i, double enough = -kInfinity);
  Facet face_b(std::uint32_t i, double enough = -kInfinity);
  Facet edges(const EdgeArc& a, const EdgeArc& b);
  EdgeArc arc_of_a(std::uint32_t i) const;
  EdgeArc arc_of_b(std::uint32_t i) const;

  FacetAnswer search(double margin, const Facet& seed);
  double prove(const Facet& facet) const;

 private:
  Lowest lowest_of(const Polytope& polytope, const Vec3& d, std::uint32_t start, double enough) const {
    return corners_are_known_ ? lowest_at(polytope, d, start) : descend(polytope, d, start, enough);
  }
  double separation_along(const Vec3& n);
  Vec3 corner_of_a() const { return a_.polytope.vertices[cache_.vertex_A]; }
  Vec3 corner_of_b() const { return R_ * b_.polytope.vertices[cache_.vertex_B] + p_; }
  Vec3 in_b(const Vec3& point) const { return R_.transpose() * (point - p_); }
  void choose_direction(const Facet& seed);
  Facet walk_on_a(double margin);
  Facet walk_on_b(double margin);
  void search_faces();
  void search_edges(double margin);
  void cross(const EdgeArc& a, const EdgeArc& b);
  bool overlaps_more(const EdgeArc& arc, bool of_a, double depth);
  std::size_t gather(bool of_a, std::uint32_t& next, ArcBlock& block) const;
  std::size_t thin_out(bool of_a, ArcBlock& block, std::size_t count);
  FacetTouch touch_of_face(const Facet& facet) const;
  FacetTouch touch_of_edges(const Facet& facet) const;
  double lead_by_disc(const Facet& facet, const FacetTouch& touch) const;
  double lead_by_ball(const Facet& facet) const;
  void be_not_along(const Vec3& face_normal, const Facet& facet, FacetTouch& touch) const;

  void offer(const Facet& facet);
  double needed() const { return std::max(floor_, best_.separation) - 4.0 * tie_; }

  Side a_, b_;
  const Mat3& R_;
  const Vec3& p_;
  PairCache& cache_;
  const double tie_;
  bool corners_are_known_ = false;
  double floor_ = -kInfinity;  // a facet separates by this
  /// The best so far, the first of equals in the order faces of A, of B, edges.
  Facet best_{Facet::Kind::none, 0, 0, -kInfinity};
};

/// Faces of A, then of B, then pairs of edges come by in this order: a later one must be better by more than a tie.
void FacetSearch::offer(const Facet& facet) {
  if (best_.kind == Facet::Kind::none || facet.separation > best_.separation + tie_) best_ = facet;
}

/// Below `enough` the separation may be any number not below the true one.
Facet FacetSearch::face_a(std::uint32_t i, double enough) {
  const Polytope::Face& face = a_.polytope.faces[i];
  const double base = face.normal.dot(p_) - face.offset;
  const Lowest lowest = lowest_of(b_.polytope, R_.transpose() * face.normal, cache_.vertex_B, enough - base);
  cache_.vertex_B = lowest.vertex;
  return {Facet::Kind::face_a, i, 0, lowest.height + base, face.normal};
}

Facet FacetSearch::face_b(std::uint32_t i, double enough) {
  const Polytope::Face& face = b_.polytope.faces[i];
  const Vec3 normal = R_ * face.normal;
  const double base = -normal.dot(p_) - face.offset;
  const Lowest lowest = lowest_of(a_.polytope, normal, cache_.vertex_A, enough - base);
  cache_.vertex_A = lowest.vertex;
  return {Facet::Kind::face_b, 0, i, lowest.height + base, -normal};
}

/// Counted by true supports: edges whose arcs only touch by rounding get no more than their due.
Facet FacetSearch::edges(const EdgeArc& a, const EdgeArc& b) {
  const Vec3 across = a.along.cross(b.along);
  const double length2 = across.squaredNorm();
  if (!(length2 > kParallel * a.along.squaredNorm() * b.along.squaredNorm())) return {};
  const double sign = across.dot(a.middle()) < 0.0 ? -1.0 : 1.0;
  const Vec3 n = across * (sign / std::sqrt(length2));
  return {Facet::Kind::edges, a.index, b.index, separation_along(n), n};
}

double FacetSearch::separation_along(const Vec3& n) {
  const Lowest top_a = descend(a_.polytope, -n, cache_.vertex_A, -kInfinity);
  const Lowest bottom_b = descend(b_.polytope, R_.transpose() * n, cache_.vertex_B, -kInfinity);
  cache_.vertex_A = top_a.vertex;
  cache_.vertex_B = bottom_b.vertex;
  return bottom_b.height + n.dot(p_) + top_a.height;
}

EdgeArc FacetSearch::arc_of_a(std::uint32_t i) const {
  const Polytope& a = a_.polytope;
  const Polytope::Edge& edge = a.edges[i];
  const Vec3& tail = a.vertices[edge.tail];
  return {tail, a.vertices[edge.head] - tail, a.faces[edge.left_face].normal, a.faces[edge.right_face].normal,
          i};
}

EdgeArc FacetSearch::arc_of_b(std::uint32_t i) const {
  const Polytope& b = b_.polytope;
  const Polytope::Edge& edge = b.edges[i];
  const Vec3& tail = b.vertices[edge.tail];
  return {R_ * tail + p_, R_ * (b.vertices[edge.head] - tail), -(R_ * b.faces[edge.left_face].normal),
          -(R_ * b.faces[edge.right_face].normal), i};
}

/// Each body's furthest corner along the seed's axis, else the last known one, else the centre line.
void FacetSearch::choose_direction(const Facet& seed) {
  if (seed.kind == Facet::Kind::none) {
    separation_along(cache_.axis_A.squaredNorm() > 0.0 ? cache_.axis_A : p_);
  } else {
    separation_along(seed.normal_A);
    floor_ = seed.separation;
  }
}

/// The face nearest to B's corner, B's furthest corner behind that face, and so on: the last face, or one beyond the
/// margin.
Facet FacetSearch::walk_on_a(double margin) {
  std::uint32_t nearest = a_.near.measure(a_.polytope, corner_of_b());
  for (int round = 1;; ++round) {
    const Facet facet = face_a(nearest);
    floor_ = std::max(floor_, facet.separation);
    if (facet.separation > margin) return facet;
    nearest = a_.nearer.measure(a_.polytope, corner_of_b());
    if (nearest == facet.a || round == kWalkRounds) return facet;
  }
}

Facet FacetSearch::walk_on_b(double margin) {
  std::uint32_t nearest = b_.near.measure(b_.polytope, in_b(corner_of_a()));
  for (int round = 1;; ++round) {
    const Facet facet = face_b(nearest);
    floor_ = std::max(floor_, facet.separation);
    if (facet.separation > margin) return facet;
    nearest = b_.nearer.measure(b_.polytope, in_b(corner_of_a()));
    if (nearest == facet.b || round == kWalkRounds) return facet;
  }
}

void FacetSearch::search_faces() {
  for (std::uint32_t i = 0; i < a_.polytope.faces.size(); ++i) {
    if (a_.bound(i) >= needed()) offer(face_a(i, needed()));
  }
  for (std::uint32_t i = 0; i < b_.polytope.faces.size(); ++i) {
    if (b_.bound(i) >= needed()) offer(face_b(i, needed()));
  }
}

/// As Side::may_win, with the other body's furthest point between the edge's normals.
bool FacetSearch::overlaps_more(const EdgeArc& arc, bool of_a, double depth) {
  const Vec3 between = arc.left + arc.right;
  Vec3 d;
  if (of_a) {
    cache_.vertex_B = descend(b_.polytope, R_.transpose() * between, cache_.vertex_B, -kInfinity).vertex;
    d = arc.tail - (R_ * b_.polytope.vertices[cache_.vertex_B] + p_);
  } else {
    cache_.vertex_A = descend(a_.polytope, -between, cache_.vertex_A, -kInfinity).vertex;
    d = a_.polytope.vertices[cache_.vertex_A] - arc.tail;
  }
  return std::min(arc.left.dot(d), arc.right.dot(d)) > depth;
}

/// Arcs that straddle each other's planes cross if they do so on the same half of the sphere.
void FacetSearch::cross(const EdgeArc& a, const EdgeArc& b) {
  const Vec3 across = a.along.cross(b.along);
  const double side = across.dot(a.middle());
  if (side * across.dot(b.middle()) <= 0.0) return;
  // Without the root: n . (b - a) <= needed, n = across / |across|.
  const double reach = (side < 0.0 ? -1.0 : 1.0) * across.dot(b.tail - a.tail);
  const double limit = needed();
  const double reach2 = reach * std::abs(reach), limit2 = limit * std::abs(limit) * across.squaredNorm();
  if (reach2 < limit2) return;
  const Facet facet = edges(a, b);
  if (facet.kind != Facet::Kind::none) offer(facet);
}

/// Of B's or A's edges from `next` on, those that may win, until the block is full.
std::size_t FacetSearch::gather(bool of_a, std::uint32_t& next, ArcBlock& block) const {
  const Side& side = of_a ? a_ : b_;
  const EdgesThatMayWin may_win(side, std::max(0.0, -needed()));
  // Without branches, since nobody can foresee which they are.
  std::array<std::uint32_t, kArcBlock> found;
  std::size_t count = 0;
  for (; next < side.polytope.edges.size() && count < kArcBlock; ++next) {
    found[count] = next;
    count += may_win.contains(side.polytope.edges[next]);
  }
  for (std::size_t i = 0; i < count; ++i) block[i] = of_a ? arc_of_a(found[i]) : arc_of_b(found[i]);
  return count;
}

std::size_t FacetSearch::thin_out(bool of_a, ArcBlock& block, std::size_t count) {
  const double depth = std::max(0.0, -needed());
  std::size_t kept = 0;
  for (std::size_t i = 0; i < count; ++i) {
    if (!overlaps_more(block[i], of_a, depth)) block[kept++] = block[i];
  }
  return kept;
}

void FacetSearch::search_edges(double margin) {
  ArcBlock block_a, block_b;
  FourArcBlock fours_b;
  for (std::uint32_t next_a = 0; next_a < a_.polytope.edges.size();) {
    std::size_t count_a = gather(true, next_a, block_a);
    bool thinned = false;
    for (std::uint32_t next_b = 0; count_a > 0 && next_b < b_.polytope.edges.size();) {
      std::size_t count_b = gather(false, next_b, block_b);
      if (count_a * count_b > kManyPairs) {
        if (!thinned) count_a = thin_out(true, block_a, count_a);
        thinned = true;
        count_b = thin_out(false, block_b, count_b);
      }
      put_in_fours(block_b, count_b, fours_b);
      for (std::size_t i = 0; i < count_a; ++i) {
        for (std::size_t j = 0; j < count_b; j += 4) {
          for_each_lane(fours_b[j / 4].straddle(block_a[i]),
                        [&](std::size_t lane) { cross(block_a[i], block_b[j + lane]); });
        }
        if (best_.separation > margin) return;
      }
    }
  }
}

FacetTouch FacetSearch::touch_of_face(const Facet& facet) const {
  const bool of_a = facet.kind == Facet::Kind::face_a;
  const Polytope& polytope = of_a ? a_.polytope : b_.polytope;
  const Vec3 corner = of_a ? corner_of_b() : corner_of_a();
  const Vec3 point = of_a ? corner : in_b(corner);
  const Vec3 foot = corner + (of_a ? -facet.separation : facet.separation) * facet.normal_A;
  FacetTouch touch =
      of_a ? FacetTouch{foot, corner, kInfinity, kInfinity} : FacetTouch{corner, foot, kInfinity, kInfinity};

  const Polytope::Face& face = polytope.faces[of_a ? facet.a : facet.b];
  for (const std::uint32_t vertex : polytope.loop(face)) {
    // A face that was merged from nearly coplanar ones lies partly below its plane.
    if (face.normal.dot(polytope.vertices[vertex]) < face.offset - tie_) return {foot, foot, -1.0, -1.0};
  }
  touch.clearance = -height_beside_face(polytope, of_a ? facet.a : facet.b, point);
  if (of_a) {
    touch.lead = lead_of_corner(b_.polytope, cache_.vertex_B, R_.transpose() * facet.normal_A, kInfinity);
  } else {
    touch.lead = lead_of_corner(a_.polytope, cache_.vertex_A, -facet.normal_A, b_.polytope.radius);
    const std::uint32_t flattest = face_towards(a_.polytope, facet.normal_A, cache_.vertex_A);
    be_not_along(a_.polytope.faces[flattest].normal, facet, touch);
  }
  return touch;
}

FacetTouch FacetSearch::touch_of_edges(const Facet& facet) const {
  const EdgeArc a = arc_of_a(facet.a), b = arc_of_b(facet.b);
  const SegmentPair pair =
      closest_points({a.tail + 0.5 * a.along, 0.5 * a.along}, {b.tail + 0.5 * b.along, 0.5 * b.along});
  if (std::abs(facet.normal_A.dot(b.tail - a.tail) - facet.separation) > tie_)
    return {pair.p_A, pair.p_B, -1.0, -1.0};
  const double length_a = a.along.norm(), length_b = b.along.norm();
  const double sine = a.along.cross(b.along).norm() / (length_a * length_b);
  const double clearance =
      0.5 * sine * std::min((1.0 - std::abs(pair.s_A)) * length_a, (1.0 - std::abs(pair.s_B)) * length_b);
  // The arcs cross until an end of one has turned into the other's plane.
  const double turn_b = std::min(std::abs(b.left.dot(a.along)), std::abs(b.right.dot(a.along))) / length_a;
  const double turn_a = std::min(std::abs(a.left.dot(b.along)), std::abs(a.right.dot(b.along))) / length_b;
  FacetTouch touch{pair.p_A, pair.p_B, clearance, std::min(turn_a, turn_b) * b_.polytope.radius};
  for (const Vec3& normal : {a.left, a.right, b.left, b.right}) be_not_along(normal, facet, touch);
  return touch;
}

/// A face that comes before the facet in order must not lie along it, or else it could be equal.
void FacetSearch::be_not_along(const Vec3& face_normal, const Facet& facet, FacetTouch& touch) const {
  const double sine = face_normal.cross(facet.normal_A).norm();
  touch.lead = std::min(touch.lead, sine * b_.polytope.radius);
  if (sine * touch.clearance <= 4.0 * tie_) touch.clearance = -1.0;
}

/// The origin lies at depth d under a disc of the facet with radius c, which is part of A - B. Along a direction at an
/// angle x to the facet's normal A - B reaches d cos x + c sin x at least, which is more than d up to x = 2 atan(c / d):
/// if c > 2 d, up to 126 degrees. For all others there must be some point of A - B deep enough on the other side. Apart,
/// c > 0 says that the distance itself is along the normal.
double FacetSearch::lead_by_disc(const Facet& facet, const FacetTouch& touch) const {
  const double d = std::max(0.0, -facet.separation);
  const double disc = touch.clearance - 2.0 * d - kLeastDisc * b_.polytope.radius;
  if (disc < 0.0 || d == 0.0) return disc;
  // A point at height -y below the origin and x beside it, as seen from the directions beyond 126 degrees.
  const auto reach = [&](const Vec3& p) {
    const double y = -facet.normal_A.dot(p), x = std::sqrt(std::max(0.0, p.squaredNorm() - y * y));
    return 0.6 * y - 0.8 * x;
  };
  const Vec3 centre_b = R_ * b_.polytope.centre + p_;
  return std::min(disc, std::max(reach(a_.polytope.centre - touch.p_b), reach(touch.p_a - centre_b)) - d);
}

/// The corner lies at depth d behind the face and deeper behind all others of its body: a ball of that radius about it is
/// inside, and so no way out is shorter.
double FacetSearch::lead_by_ball(const Facet& facet) const {
  if (facet.kind == Facet::Kind::edges || facet.separation > 0.0) return -1.0;
  const bool of_a = facet.kind == Facet::Kind::face_a;
  const double deeper = of_a ? depth_behind_others(a_.polytope, facet.a, corner_of_b())
                             : depth_behind_others(b_.polytope, facet.b, in_b(corner_of_a()));
  return deeper + facet.separation - 4.0 * tie_;
}

/// For a facet that is proven to win: how much may move until something else does (as FacetAnswer::lead), else < 0.
double FacetSearch::prove(const Facet& facet) const {
  if (facet.separation < needed()) return -1.0;
  const FacetTouch touch = facet.kind == Facet::Kind::edges ? touch_of_edges(facet) : touch_of_face(facet);
  if (touch.clearance < 0.0) return -1.0;
  const double lead = std::max(lead_by_disc(facet, touch), lead_by_ball(facet));
  return lead < 0.0 ? -1.0 : std::min(lead, touch.lead);
}

FacetAnswer FacetSearch::search(double margin, const Facet& seed) {
  choose_direction(seed);
  const Facet on_a = walk_on_a(margin);
  if (on_a.separation > margin) return {on_a, -1.0};
  if (const double lead = prove(on_a); lead >= 0.0) return {on_a, lead};
  const Facet on_b = walk_on_b(margin);
  if (on_b.separation > margin) return {on_b, -1.0};
  if (const double lead = prove(on_b); lead >= 0.0) return {on_b, lead};
  search_faces();
  if (best_.separation > margin) return {best_, -1.0};
  search_edges(margin);
  if (best_.separation > margin) return {best_, -1.0};
  if (best_.kind == Facet::Kind::face_a) face_a(best_.a);
  if (best_.kind == Facet::Kind::face_b) face_b(best_.b);
  if (best_.kind == Facet::Kind::edges) separation_along(best_.normal_A);
  return {best_, std::max(0.0, prove(best_))};
}

}  // namespace

Facet recall_facet(const PolytopePair& pair, PairCache& cache) {
  const auto kind = static_cast<Facet::Kind>(cache.feature >> 2 * kIndexBits);
  const std::uint32_t a = cache.feature >> kIndexBits & (kIndexLimit - 1),
                      b = cache.feature & (kIndexLimit - 1);
  FacetSearch search(pair, cache);
  if (cache.slack > 0.0) search.trust_corners();
  if (kind == Facet::Kind::face_a && a < pair.a.faces.size()) return search.face_a(a);
  if (kind == Facet::Kind::face_b && b < pair.b.faces.size()) return search.face_b(b);
  if (kind == Facet::Kind::edges && a < pair.a.edges.size() && b < pair.b.edges.size())
    return search.edges(search.arc_of_a(a), search.arc_of_b(b));
  return {};
}

FacetAnswer find_facet(const PolytopePair& pair, double margin, PairCache& cache) {
  const Facet seed = recall_facet(pair, cache);
  FacetSearch search(pair, cache);
  if (seed.kind != Facet::Kind::none) {
    if (seed.separation > margin) return {seed, -1.0};
    if (const double lead = search.prove(seed); lead >= 0.0) return {seed, lead};
  }
  FacetAnswer answer = search.search(margin, seed);
  cache.feature = encode(answer.facet);
  return answer;
}

}  // namespace tumble
