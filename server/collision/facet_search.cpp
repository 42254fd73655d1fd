// A walk to a face that proves itself, else exhaustive search with pruning. Any point of A with any point of B bounds the
// separation along a direction from above, so two well chosen points of each body rule out nearly all facets of the other. Vectors without suffix are in A's frame.
#include "collision/facet_search.h"

#include <array>
#include <limits>

#include "collision/segment.h"

namespace tumble {
namespace {

/// Facets this little behind the best [parts of the smaller radius] are still evaluated, so that the lead is known and
/// rounding can't prune a winner.
constexpr double kLeadSought = 1e-3;
/// Share of the radii below which two separations are equal: their rounding, and what a nearly touching pair of arcs
/// may lead by although its edges do not cross.
constexpr double kFacetTie = 1e-14;
/// Faces of each body whose bounds are kept; those of larger hulls are computed again where needed.
constexpr std::size_t kKeptFaces = 512;
/// Edges of each side that are looked at together.
constexpr std::size_t kBlock = 128;
/// From so many pairs of edges on it pays to look for a better point against each edge.
constexpr std::size_t kManyPairs = 256;
/// Of a walk between faces and corners; two or three are used.
constexpr int kWalkRounds = 8;
/// Larger indices are not remembered in the 32-bit feature: such hulls are searched without a seed.
constexpr std::uint32_t kIndexBits = 15, kIndexLimit = 1u << kIndexBits;

double tie_of(const PolytopePair& pair) {
  return kFacetTie * (pair.a.radius + pair.b.radius);
}

std::uint32_t encode(const Facet& facet) {
  if (facet.a >= kIndexLimit || facet.b >= kIndexLimit) return 0;
  return static_cast<std::uint32_t>(facet.kind) << 2 * kIndexBits | facet.a << kIndexBits | facet.b;
}

/// The arc that an edge's normals span on the Gauss sphere; of B with its normals turned round.
struct EdgeArc {
  Vec3 tail, along, left, right;
  std::uint32_t index;
};
using Block = std::array<EdgeArc, kBlock>;

/// Heights of one point of the other body over every face of this one: upper bounds of what the faces separate.
class PointHeights {
 public:
  PointHeights() {}  // not defaulted: `{}` would clear thousands of bytes
  void measure(const Polytope& polytope, const Vec3& point) {
    polytope_ = &polytope;
    point_ = point;
    const std::size_t kept = std::min(polytope.faces.size(), kKeptFaces);
    for (std::size_t i = 0; i < kept; ++i) heights_[i] = height_over(i);
  }
  double operator[](std::size_t face) const { return face < kKeptFaces ? heights_[face] : height_over(face); }

 private:
  double height_over(std::size_t i) const {
    return polytope_->faces[i].normal.dot(point_) - polytope_->faces[i].offset;
  }
  const Polytope* polytope_ = nullptr;
  Vec3 point_ = Vec3::Zero();
  std::array<double, kKeptFaces> heights_;
};

/// One body and what is known of it: up to two points of the other one, measured over its faces.
class Side {
 public:
  explicit Side(const Polytope& body) : polytope(body) {}

  void measure(const Vec3& point) { points_[last_ = measured_++ % 2].measure(polytope, point); }
  /// Over the faces, of the point that was measured last.
  const PointHeights& heights() const { return points_[last_]; }
  std::uint32_t nearest_face() const;
  /// Largest height of that point over the other faces.
  double highest_but(std::uint32_t face) const;
  /// No face separates by more than this.
  double bound(std::size_t face) const {
    return measured_ < 2 ? points_[0][face] : std::min(points_[0][face], points_[1][face]);
  }
  /// Along an arc between two normals the overlap with any one point of the other body is at least the smaller of its
  /// ends, as long as both are overlaps. False: no facet of this edge overlaps by less than `depth` >= 0.
  bool may_win(const ConvexHull::Edge& edge, double depth) const {
    const auto reaches = [&](const PointHeights& heights) {
      return std::max(heights[edge.left_face], heights[edge.right_face]) >= -depth;
    };
    return reaches(points_[0]) && (measured_ < 2 || reaches(points_[1]));
  }

  const Polytope& polytope;

 private:
  std::size_t measured_ = 0, last_ = 0;
  std::array<PointHeights, 2> points_;
};

std::uint32_t Side::nearest_face() const {
  std::uint32_t best = 0;
  for (std::uint32_t i = 1; i < polytope.faces.size(); ++i) {
    if (heights()[i] > heights()[best]) best = i;
  }
  return best;
}

double Side::highest_but(std::uint32_t face) const {
  double highest = -kInfinity;
  for (std::uint32_t i = 0; i < polytope.faces.size(); ++i) {
    if (i != face) highest = std::max(highest, heights()[i]);
  }
  return highest;
}

/// How much higher than a corner, the lowest along d, all others are.
double lead_of_corner(const Polytope& polytope, std::uint32_t lowest, const Vec3& d) {
  double next = kInfinity;
  for (std::uint32_t k = polytope.neighbour_offsets[lowest]; k < polytope.neighbour_offsets[lowest + 1];
       ++k) {
    next = std::min(next, d.dot(polytope.vertices[polytope.neighbours[k]]));
  }
  return next - d.dot(polytope.vertices[lowest]);
}

class FacetSearch {
 public:
  FacetSearch(const PolytopePair& pair, PairCache& cache)
      : a_(pair.a),
        b_(pair.b),
        R_(pair.R_AB),
        p_(pair.p_AB),
        cache_(cache),
        lead_(kLeadSought * std::min(pair.a.radius, pair.b.radius)),
        tie_(tie_of(pair)) {}

  Facet face_a(std::uint32_t i, double enough = -kInfinity);
  Facet face_b(std::uint32_t i, double enough = -kInfinity);
  Facet edges(const EdgeArc& a, const EdgeArc& b);
  EdgeArc arc_of_a(std::uint32_t i) const;
  EdgeArc arc_of_b(std::uint32_t i) const;

  FacetAnswer search(double margin, const Facet& seed);

 private:
  double separation_along(const Vec3& n);
  Vec3 corner_of_b_in_a() const { return R_ * b_.polytope.vertices[cache_.vertex_B] + p_; }
  Vec3 corner_of_a_in_b() const { return R_.transpose() * (a_.polytope.vertices[cache_.vertex_A] - p_); }
  void choose_points(const Facet& seed);
  Facet walk_on_a();
  Facet walk_on_b();
  FacetAnswer prove_face_a(const Facet& facet) const;
  FacetAnswer prove_face_b(const Facet& facet) const;
  void search_faces();
  void search_edges(double margin);
  void cross(const EdgeArc& a, const EdgeArc& b);
  bool overlaps_more(const EdgeArc& arc, bool of_a, double depth);
  std::size_t gather(bool of_a, std::uint32_t& next, Block& block) const;
  std::size_t thin_out(bool of_a, Block& block, std::size_t count);
  double clearance(const Facet& facet) const;

  void offer(const Facet& facet);
  double needed() const { return std::max(floor_, best_.separation) - lead_; }

  Side a_, b_;
  const Mat3& R_;
  const Vec3& p_;
  PairCache& cache_;
  const double lead_, tie_;
  double floor_ = -kInfinity;  // a facet separates by this
  Facet best_{Facet::Kind::none, 0, 0,
              -kInfinity};      // the best so far, the first of equals in the order faces of A, of B, edges
  double second_ = -kInfinity;  // the best of the others that were evaluated
};

/// Faces of A, then of B, then pairs of edges come by in this order: a later one must be better by more than a tie.
void FacetSearch::offer(const Facet& facet) {
  if (best_.kind == Facet::Kind::none || facet.separation > best_.separation + tie_) {
    second_ = std::max(second_, best_.kind == Facet::Kind::none ? -kInfinity : best_.separation);
    best_ = facet;
  } else {
    second_ = std::max(second_, facet.separation);
  }
}

/// Below `enough` the separation may be any number not below the true one.
Facet FacetSearch::face_a(std::uint32_t i, double enough) {
  const ConvexHull::Face& face = a_.polytope.faces[i];
  const double base = face.normal.dot(p_) - face.offset;
  const Lowest lowest = descend(b_.polytope, R_.transpose() * face.normal, cache_.vertex_B, enough - base);
  cache_.vertex_B = lowest.vertex;
  return {Facet::Kind::face_a, i, 0, lowest.height + base, face.normal};
}

Facet FacetSearch::face_b(std::uint32_t i, double enough) {
  const ConvexHull::Face& face = b_.polytope.faces[i];
  const Vec3 normal = R_ * face.normal;
  const double base = -normal.dot(p_) - face.offset;
  const Lowest lowest = descend(a_.polytope, normal, cache_.vertex_A, enough - base);
  cache_.vertex_A = lowest.vertex;
  return {Facet::Kind::face_b, 0, i, lowest.height + base, -normal};
}

/// Counted by true supports: edges whose arcs only touch by rounding get no more than their due.
Facet FacetSearch::edges(const EdgeArc& a, const EdgeArc& b) {
  const Vec3 across = a.along.cross(b.along);
  const double length2 = across.squaredNorm();
  if (!(length2 > kParallel * a.along.squaredNorm() * b.along.squaredNorm())) return {};
  const double sign = across.dot(a.left + a.right) < 0.0 ? -1.0 : 1.0;
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
  const ConvexHull::Edge& edge = a.edges[i];
  const Vec3& tail = a.vertices[edge.tail];
  return {tail, a.vertices[edge.head] - tail, a.faces[edge.left_face].normal, a.faces[edge.right_face].normal,
          i};
}

EdgeArc FacetSearch::arc_of_b(std::uint32_t i) const {
  const Polytope& b = b_.polytope;
  const ConvexHull::Edge& edge = b.edges[i];
  const Vec3& tail = b.vertices[edge.tail];
  return {R_ * tail + p_, R_ * (b.vertices[edge.head] - tail), -(R_ * b.faces[edge.left_face].normal),
          -(R_ * b.faces[edge.right_face].normal), i};
}

/// The points that bound: each body's furthest along the seed's axis, else the last known one, else the centre line.
void FacetSearch::choose_points(const Facet& seed) {
  if (seed.kind == Facet::Kind::none) {
    separation_along(cache_.axis_A.squaredNorm() > 0.0 ? cache_.axis_A : p_);
  } else {
    separation_along(seed.normal_A);
    floor_ = seed.separation;
  }
  a_.measure(corner_of_b_in_a());
  b_.measure(corner_of_a_in_b());
}

/// The face nearest to B's corner, B's furthest corner behind that face, and so on until they agree.
Facet FacetSearch::walk_on_a() {
  for (int round = 0;; ++round) {
    const std::uint32_t corner = cache_.vertex_B;
    const Facet facet = face_a(a_.nearest_face());
    floor_ = std::max(floor_, facet.separation);
    if (cache_.vertex_B == corner) return facet;
    a_.measure(corner_of_b_in_a());
    if (round == kWalkRounds) return {};
  }
}

Facet FacetSearch::walk_on_b() {
  for (int round = 0;; ++round) {
    const std::uint32_t corner = cache_.vertex_A;
    const Facet facet = face_b(b_.nearest_face());
    floor_ = std::max(floor_, facet.separation);
    if (cache_.vertex_A == corner) return facet;
    b_.measure(corner_of_a_in_b());
    if (round == kWalkRounds) return {};
  }
}

/// The end of a walk is a face of A and B's furthest corner behind it. Along any direction the bodies overlap by at least
/// that corner's depth in A, or are no further apart than it is from A. If that is its height over the face, the
/// face wins; and as long as the corner stays furthest and other faces lower than minus that height.
FacetAnswer FacetSearch::prove_face_a(const Facet& facet) const {
  if (facet.kind == Facet::Kind::none) return {};
  const double lead = -std::abs(facet.separation) - a_.highest_but(facet.a) - 2.0 * tie_;
  if (lead < 0.0) return {};
  const double corner = lead_of_corner(b_.polytope, cache_.vertex_B, R_.transpose() * facet.normal_A);
  return {facet, std::min(lead, corner)};
}

/// As the other way round; but of equal separations a face of A comes first.
FacetAnswer FacetSearch::prove_face_b(const Facet& facet) const {
  if (facet.kind == Facet::Kind::none) return {};
  double lead = -std::abs(facet.separation) - b_.highest_but(facet.b) - 2.0 * tie_;
  for (std::uint32_t i = 0; i < a_.polytope.faces.size() && lead >= 0.0; ++i) {
    lead = std::min(lead, facet.separation - a_.bound(i) - 2.0 * tie_);
  }
  if (lead < 0.0) return {};
  return {facet, std::min(lead, lead_of_corner(a_.polytope, cache_.vertex_A, -facet.normal_A))};
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

/// The arcs cross if the ends of each lie on different sides of the other's plane, and on the same half of the sphere.
void FacetSearch::cross(const EdgeArc& a, const EdgeArc& b) {
  const double bl = b.left.dot(a.along), br = b.right.dot(a.along);
  if (bl * br >= 0.0) return;
  const double al = a.left.dot(b.along), ar = a.right.dot(b.along);
  if (al * ar >= 0.0) return;
  const Vec3 across = a.along.cross(b.along);
  const double side = across.dot(a.left + a.right);
  if (side * across.dot(b.left + b.right) <= 0.0) return;
  // Without the root: n . (b - a) <= needed, n = across / |across|.
  const double reach = (side < 0.0 ? -1.0 : 1.0) * across.dot(b.tail - a.tail);
  const double limit = needed();
  const double reach2 = reach * std::abs(reach), limit2 = limit * std::abs(limit) * across.squaredNorm();
  if (reach2 < limit2) return;
  const Facet facet = edges(a, b);
  if (facet.kind != Facet::Kind::none) offer(facet);
}

/// Of B's or A's edges from `next` on, those that may win, until the block is full.
std::size_t FacetSearch::gather(bool of_a, std::uint32_t& next, Block& block) const {
  const Side& side = of_a ? a_ : b_;
  const double depth = std::max(0.0, -needed());
  std::size_t count = 0;
  for (; next < side.polytope.edges.size() && count < kBlock; ++next) {
    if (side.may_win(side.polytope.edges[next], depth))
      block[count++] = of_a ? arc_of_a(next) : arc_of_b(next);
  }
  return count;
}

std::size_t FacetSearch::thin_out(bool of_a, Block& block, std::size_t count) {
  const double depth = std::max(0.0, -needed());
  std::size_t kept = 0;
  for (std::size_t i = 0; i < count; ++i) {
    if (!overlaps_more(block[i], of_a, depth)) block[kept++] = block[i];
  }
  return kept;
}

void FacetSearch::search_edges(double margin) {
  Block block_a, block_b;
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
      for (std::size_t i = 0; i < count_a; ++i) {
        for (std::size_t j = 0; j < count_b; ++j) cross(block_a[i], block_b[j]);
        if (best_.separation > margin) return;
      }
    }
  }
}

/// How far inside its own border the facet holds the point nearest to the origin of the Minkowski difference, at least
/// [m]; < 0: outside.
double FacetSearch::clearance(const Facet& facet) const {
  if (facet.kind == Facet::Kind::edges) {
    const EdgeArc a = arc_of_a(facet.a), b = arc_of_b(facet.b);
    const SegmentPair pair =
        closest_points({a.tail + 0.5 * a.along, 0.5 * a.along}, {b.tail + 0.5 * b.along, 0.5 * b.along});
    const double length_a = a.along.norm(), length_b = b.along.norm();
    const double sine = a.along.cross(b.along).norm() / (length_a * length_b);
    return 0.5 * sine *
           std::min((1.0 - std::abs(pair.s_A)) * length_a, (1.0 - std::abs(pair.s_B)) * length_b);
  }
  const bool of_a = facet.kind == Facet::Kind::face_a;
  const Polytope& polytope = of_a ? a_.polytope : b_.polytope;
  const Vec3 point = of_a ? Vec3(R_ * b_.polytope.vertices[cache_.vertex_B] + p_)
                          : Vec3(R_.transpose() * (a_.polytope.vertices[cache_.vertex_A] - p_));
  const ConvexHull::Face& face = polytope.faces[of_a ? facet.a : facet.b];
  const auto loop = polytope.loop(face);
  double least = kInfinity;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Vec3& tail = polytope.vertices[loop[i]];
    const Vec3 along = polytope.vertices[loop[i + 1 == loop.size() ? 0 : i + 1]] - tail;
    least = std::min(least, face.normal.cross(along).dot(point - tail) / along.norm());
  }
  return least;
}

FacetAnswer FacetSearch::search(double margin, const Facet& seed) {
  choose_points(seed);
  if (const FacetAnswer proven = prove_face_a(walk_on_a()); proven.lead >= 0.0) return proven;
  if (const FacetAnswer proven = prove_face_b(walk_on_b()); proven.lead >= 0.0) return proven;
  search_faces();
  if (best_.separation > margin) return {best_, -1.0};
  search_edges(margin);
  if (best_.separation > margin) return {best_, -1.0};
  // The winner is at depth d under a facet of the Minkowski difference that holds a disc of radius c about the point
  // below which the origin lies. Then every direction further than atan(c / d) from its normal overlaps by hypot(c, d)
  // or has a facet of its own on the way down, and all nearer ones are beaten by the disc as long as c > 2 d.
  if (best_.kind != Facet::Kind::edges)
    (best_.kind == Facet::Kind::face_a ? face_a(best_.a) : face_b(best_.b));
  const double c = clearance(best_), d = std::max(0.0, -best_.separation);
  if (c <= 2.0 * d) return {best_, 0.0};
  const double gap = best_.separation - std::max(second_, best_.separation - lead_);
  return {best_, std::min(gap, std::sqrt(c * c + d * d) - d)};
}

}  // namespace

Facet recall_facet(const PolytopePair& pair, PairCache& cache) {
  const auto kind = static_cast<Facet::Kind>(cache.feature >> 2 * kIndexBits);
  const std::uint32_t a = cache.feature >> kIndexBits & (kIndexLimit - 1),
                      b = cache.feature & (kIndexLimit - 1);
  FacetSearch search(pair, cache);
  if (kind == Facet::Kind::face_a && a < pair.a.faces.size()) return search.face_a(a);
  if (kind == Facet::Kind::face_b && b < pair.b.faces.size()) return search.face_b(b);
  if (kind == Facet::Kind::edges && a < pair.a.edges.size() && b < pair.b.edges.size())
    return search.edges(search.arc_of_a(a), search.arc_of_b(b));
  return {};
}

FacetAnswer find_facet(const PolytopePair& pair, double margin, PairCache& cache) {
  const Facet seed = recall_facet(pair, cache);
  if (seed.kind != Facet::Kind::none && seed.separation > margin) return {seed, -1.0};
  FacetSearch search(pair, cache);
  FacetAnswer answer = search.search(margin, seed);
  cache.feature = encode(answer.facet);
  return answer;
}

}  // namespace tumble
