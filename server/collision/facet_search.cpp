// Exhaustive search with pruning. Any point of A with any point of B bounds the separation along a direction from above,
// so most facets fall at the first vertex tried. Vectors without suffix are in A's frame.
#include "collision/facet_search.h"

#include <array>
#include <limits>

namespace tumble {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// sin^2 of the angle between edges below which they span no facet; the faces cover its direction.
constexpr double kParallel = 1e-24;
/// Facets this little behind the best [parts of the smaller radius] are still evaluated, so that the lead is known and
/// rounding can't prune a winner.
constexpr double kLeadSought = 1e-3;
/// Faces whose separation is kept for choosing among equals; beyond, they are evaluated a second time.
constexpr std::uint32_t kKeptHeights = 512;
/// Edges of each side that are looked at together.
constexpr std::size_t kBlock = 128;
/// Larger indices are not remembered in the 32-bit feature: such hulls are searched without a seed.
constexpr std::uint32_t kIndexBits = 15, kIndexLimit = 1u << kIndexBits;

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

class FacetSearch {
 public:
  FacetSearch(const PolytopePair& pair, PairCache& cache)
      : a_(pair.a), b_(pair.b), R_(pair.R_AB), p_(pair.p_AB), cache_(cache) {}

  std::uint32_t face_count() const { return static_cast<std::uint32_t>(a_.faces.size() + b_.faces.size()); }
  /// Face i of A, then of B: its separation, or some number below `enough` and not below the separation.
  double height_over(std::uint32_t i, double enough);
  double separation_along(const Vec3& n);
  Facet face_facet(std::uint32_t i, double separation) const;
  Facet edge_facet(std::uint32_t edge_a, std::uint32_t edge_b);

  void search_faces(double margin, double floor, double lead);
  void search_edges(double margin, double lead);
  /// The first face that is within `preference` of the best.
  std::uint32_t first_of_equals(double preference);
  double lead_of(std::uint32_t winner, double preference) const;

  double best_height = -kInfinity;
  std::uint32_t best_face = 0;
  Facet best_edges;

 private:
  double needed(double lead) const { return std::max(best_height, best_edges.separation) - lead; }
  EdgeArc arc_of_a(std::uint32_t i) const;
  EdgeArc arc_of_b(std::uint32_t i) const;
  std::size_t gather_a(std::uint32_t& next, double lead, Block& block);
  std::size_t gather_b(std::uint32_t& next, double lead, Block& block);
  void cross(const EdgeArc& a, const EdgeArc& b);

  const Polytope &a_, &b_;
  const Mat3& R_;
  const Vec3& p_;
  PairCache& cache_;
  std::array<double, kKeptHeights> heights_;
};

double FacetSearch::height_over(std::uint32_t i, double enough) {
  if (i < a_.faces.size()) {
    const ConvexHull::Face& face = a_.faces[i];
    const double base = face.normal.dot(p_) - face.offset;
    const Lowest lowest = descend(b_, R_.transpose() * face.normal, cache_.vertex_B, enough - base);
    cache_.vertex_B = lowest.vertex;
    return lowest.height + base;
  }
  const ConvexHull::Face& face = b_.faces[i - a_.faces.size()];
  const Vec3 normal = R_ * face.normal;
  const double base = -normal.dot(p_) - face.offset;
  const Lowest lowest = descend(a_, normal, cache_.vertex_A, enough - base);
  cache_.vertex_A = lowest.vertex;
  return lowest.height + base;
}

double FacetSearch::separation_along(const Vec3& n) {
  const Lowest top_a = descend(a_, -n, cache_.vertex_A, -kInfinity);
  const Lowest bottom_b = descend(b_, R_.transpose() * n, cache_.vertex_B, -kInfinity);
  cache_.vertex_A = top_a.vertex;
  cache_.vertex_B = bottom_b.vertex;
  return bottom_b.height + n.dot(p_) + top_a.height;
}

Facet FacetSearch::face_facet(std::uint32_t i, double separation) const {
  if (i < a_.faces.size()) return {Facet::Kind::face_a, i, 0, separation, a_.faces[i].normal};
  const std::uint32_t k = i - static_cast<std::uint32_t>(a_.faces.size());
  return {Facet::Kind::face_b, 0, k, separation, -(R_ * b_.faces[k].normal)};
}

Facet FacetSearch::edge_facet(std::uint32_t edge_a, std::uint32_t edge_b) {
  const EdgeArc a = arc_of_a(edge_a), b = arc_of_b(edge_b);
  const Vec3 across = a.along.cross(b.along);
  const double length2 = across.squaredNorm(),
               sin2 = length2 / (a.along.squaredNorm() * b.along.squaredNorm());
  if (!(sin2 > kParallel)) return {};
  const double sign = across.dot(a.left + a.right) < 0.0 ? -1.0 : 1.0;
  const Vec3 n = across * (sign / std::sqrt(length2));
  return {Facet::Kind::edges, edge_a, edge_b, separation_along(n), n, sin2};
}

void FacetSearch::search_faces(double margin, double floor, double lead) {
  for (std::uint32_t i = 0; i < face_count() && best_height <= margin; ++i) {
    const double height = height_over(i, std::max(floor, best_height) - lead);
    if (i < kKeptHeights) heights_[i] = height;
    if (height > best_height) best_height = height, best_face = i;
  }
}

std::uint32_t FacetSearch::first_of_equals(double preference) {
  const double enough = best_height - preference;
  for (std::uint32_t i = 0; i < best_face; ++i) {
    if ((i < kKeptHeights ? heights_[i] : height_over(i, enough)) >= enough) return i;
  }
  return best_face;
}

/// The winner stays while no earlier face comes within `preference` of the best and nothing, in whatever direction,
/// beats it by more than `preference`.
double FacetSearch::lead_of(std::uint32_t winner, double preference) const {
  if (face_count() > kKeptHeights) return 0.0;
  double earlier = -kInfinity, other = best_edges.separation;
  for (std::uint32_t i = 0; i < face_count(); ++i) {
    if (i < winner) earlier = std::max(earlier, heights_[i]);
    if (i != winner) other = std::max(other, heights_[i]);
  }
  const double any_direction = heights_[winner] + preference - std::max(best_height, other);
  return std::min(best_height - preference - earlier, any_direction);
}

EdgeArc FacetSearch::arc_of_a(std::uint32_t i) const {
  const ConvexHull::Edge& edge = a_.edges[i];
  const Vec3& tail = a_.vertices[edge.tail];
  return {tail, a_.vertices[edge.head] - tail, a_.faces[edge.left_face].normal,
          a_.faces[edge.right_face].normal, i};
}

EdgeArc FacetSearch::arc_of_b(std::uint32_t i) const {
  const ConvexHull::Edge& edge = b_.edges[i];
  const Vec3& tail = b_.vertices[edge.tail];
  return {R_ * tail + p_, R_ * (b_.vertices[edge.head] - tail), -(R_ * b_.faces[edge.left_face].normal),
          -(R_ * b_.faces[edge.right_face].normal), i};
}

/// Edges whose facets may separate by `needed`: along an arc between two normals the overlap with any one point of the
/// other body is at least the smaller of its ends, as long as both are overlaps.
std::size_t FacetSearch::gather_a(std::uint32_t& next, double lead, Block& block) {
  const double depth = std::max(0.0, -needed(lead));
  std::size_t n = 0;
  for (; next < a_.edges.size() && n < kBlock; ++next) {
    const EdgeArc arc = arc_of_a(next);
    const auto overlap = [&](std::uint32_t vertex) {
      const Vec3 d = arc.tail - (R_ * b_.vertices[vertex] + p_);
      return std::min(arc.left.dot(d), arc.right.dot(d));
    };
    if (overlap(cache_.vertex_B) > depth) continue;
    cache_.vertex_B =
        descend(b_, R_.transpose() * (arc.left + arc.right), cache_.vertex_B, -kInfinity).vertex;
    if (overlap(cache_.vertex_B) <= depth) block[n++] = arc;
  }
  return n;
}

std::size_t FacetSearch::gather_b(std::uint32_t& next, double lead, Block& block) {
  const double depth = std::max(0.0, -needed(lead));
  std::size_t n = 0;
  for (; next < b_.edges.size() && n < kBlock; ++next) {
    const EdgeArc arc = arc_of_b(next);
    const auto overlap = [&](std::uint32_t vertex) {
      const Vec3 d = a_.vertices[vertex] - arc.tail;
      return std::min(arc.left.dot(d), arc.right.dot(d));
    };
    if (overlap(cache_.vertex_A) > depth) continue;
    cache_.vertex_A = descend(a_, -(arc.left + arc.right), cache_.vertex_A, -kInfinity).vertex;
    if (overlap(cache_.vertex_A) <= depth) block[n++] = arc;
  }
  return n;
}

void FacetSearch::cross(const EdgeArc& a, const EdgeArc& b) {
  // The arcs cross if the ends of each lie on different sides of the other's plane, and on the same half of the sphere.
  const double bl = b.left.dot(a.along), br = b.right.dot(a.along);
  if (bl * br >= 0.0) return;
  const double al = a.left.dot(b.along), ar = a.right.dot(b.along);
  if (al * ar >= 0.0) return;
  const Vec3 across = a.along.cross(b.along);
  const double length2 = across.squaredNorm(),
               sin2 = length2 / (a.along.squaredNorm() * b.along.squaredNorm());
  if (!(sin2 > kParallel)) return;
  const double side = across.dot(a.left + a.right);
  if (side * across.dot(b.left + b.right) <= 0.0) return;
  const Vec3 n = across * ((side < 0.0 ? -1.0 : 1.0) / std::sqrt(length2));
  if (n.dot(b.tail - a.tail) <= best_edges.separation) return;
  // Counted by true supports: arcs that only touch pass the test above by rounding.
  const double separation = separation_along(n);
  if (separation > best_edges.separation)
    best_edges = {Facet::Kind::edges, a.index, b.index, separation, n, sin2};
}

void FacetSearch::search_edges(double margin, double lead) {
  Block block_a, block_b;
  for (std::uint32_t next_a = 0; next_a < a_.edges.size();) {
    const std::size_t count_a = gather_a(next_a, lead, block_a);
    for (std::uint32_t next_b = 0; count_a > 0 && next_b < b_.edges.size();) {
      const std::size_t count_b = gather_b(next_b, lead, block_b);
      for (std::size_t i = 0; i < count_a; ++i) {
        for (std::size_t j = 0; j < count_b; ++j) cross(block_a[i], block_b[j]);
        if (best_edges.separation > margin) return;
      }
    }
  }
}

}  // namespace

Facet recall_facet(const PolytopePair& pair, PairCache& cache) {
  const auto kind = static_cast<Facet::Kind>(cache.feature >> 2 * kIndexBits);
  const std::uint32_t a = cache.feature >> kIndexBits & (kIndexLimit - 1),
                      b = cache.feature & (kIndexLimit - 1);
  FacetSearch search(pair, cache);
  const std::uint32_t faces_a = static_cast<std::uint32_t>(pair.a.faces.size());
  if (kind == Facet::Kind::face_a && a < faces_a)
    return search.face_facet(a, search.height_over(a, -kInfinity));
  if (kind == Facet::Kind::face_b && b < pair.b.faces.size()) {
    return search.face_facet(faces_a + b, search.height_over(faces_a + b, -kInfinity));
  }
  if (kind == Facet::Kind::edges && a < pair.a.edges.size() && b < pair.b.edges.size())
    return search.edge_facet(a, b);
  return {};
}

FacetAnswer find_facet(const PolytopePair& pair, double margin, const AxisPreference& preference,
                       PairCache& cache) {
  FacetAnswer answer;
  const Facet seed = recall_facet(pair, cache);
  const double lead = kLeadSought * std::min(pair.a.radius, pair.b.radius);
  if (seed.kind != Facet::Kind::none && seed.separation > margin) {
    answer.facet = seed;
    return answer;
  }
  FacetSearch search(pair, cache);
  search.best_edges.separation = -kInfinity;
  search.search_faces(margin, seed.kind == Facet::Kind::none ? -kInfinity : seed.separation, lead);
  if (search.best_height > margin) {
    answer.facet = search.face_facet(search.best_face, search.best_height);
    return answer;
  }
  search.search_edges(margin, lead);
  const std::uint32_t winner = search.first_of_equals(preference.face);
  answer.facet = search.face_facet(winner, search.height_over(winner, -kInfinity));
  if (search.best_edges.separation > margin ||
      preference.takes_edge(answer.facet.separation, answer.facet.normal_A, search.best_edges.separation,
                            search.best_edges.normal_A, search.best_edges.sin2)) {
    answer.facet = search.best_edges;
  } else {
    answer.lead = search.lead_of(winner, preference.face);
  }
  cache.feature = encode(answer.facet);
  return answer;
}

}  // namespace tumble
