// Topology of the box, descent over vertices, and point against polytope: the closest point of an outside point lies on
// a face that the point sees, so it is the nearest over all of those.
#include "collision/polytope.h"

#include "collision/feature_name.h"
#include "collision/segment.h"

namespace tumble {
namespace {

// Corner i lies on the positive side of axis k if bit k is set.
constexpr std::array<std::uint32_t, 24> kBoxLoops = {1, 3, 7, 5, 0, 4, 6, 2, 2, 6, 7, 3,
                                                     0, 1, 5, 4, 4, 5, 7, 6, 0, 2, 3, 1};
constexpr std::array<std::uint32_t, 9> kBoxNeighbourOffsets = {0, 3, 6, 9, 12, 15, 18, 21, 24};

constexpr std::array<std::uint32_t, 24> box_neighbours() {
  std::array<std::uint32_t, 24> neighbours{};
  for (std::uint32_t i = 0; i < 24; ++i) neighbours[i] = (i / 3) ^ (1u << i % 3);
  return neighbours;
}

/// The face whose loop runs from one corner to the other.
constexpr std::uint32_t box_face_left_of(std::uint32_t tail, std::uint32_t head) {
  std::uint32_t i = 0;
  while (kBoxLoops[i] != tail || kBoxLoops[i % 4 == 3 ? i - 3 : i + 1] != head) ++i;
  return i / 4;
}

constexpr std::array<ConvexHull::Edge, 12> box_edges() {
  std::array<ConvexHull::Edge, 12> edges{};
  std::size_t n = 0;
  for (std::uint32_t i = 0; i < 24; ++i) {
    const std::uint32_t tail = kBoxLoops[i], head = kBoxLoops[i % 4 == 3 ? i - 3 : i + 1];
    if (tail < head) edges[n++] = {tail, head, i / 4, box_face_left_of(head, tail)};
  }
  return edges;
}

/// The edge from corner i / 3 across axis i % 3.
constexpr std::array<std::uint32_t, 24> box_edges_around() {
  std::array<std::uint32_t, 24> around{};
  const auto edges = box_edges();
  for (std::uint32_t i = 0; i < 24; ++i) {
    const std::uint32_t corner = i / 3, other = corner ^ (1u << i % 3);
    while (edges[around[i]].tail != std::min(corner, other) ||
           edges[around[i]].head != std::max(corner, other)) {
      ++around[i];
    }
  }
  return around;
}

constexpr std::array<std::uint32_t, 24> kBoxNeighbours = box_neighbours(),
                                        kBoxEdgesAround = box_edges_around();
constexpr std::array<ConvexHull::Edge, 12> kBoxEdges = box_edges();

constexpr std::array<std::uint32_t, 6> kTriangleLoops = {0, 1, 2, 0, 2, 1};
constexpr std::array<ConvexHull::Edge, 3> kTriangleEdges = {{{0, 1, 0, 1}, {1, 2, 0, 1}, {0, 2, 1, 0}}};
constexpr std::array<std::uint32_t, 4> kTriangleNeighbourOffsets = {0, 2, 4, 6};
constexpr std::array<std::uint32_t, 6> kTriangleNeighbours = {1, 2, 0, 2, 0, 1},
                                       kTriangleEdgesAround = {0, 2, 0, 1, 2, 1};

/// Share of the sizes below which two distances are equal.
constexpr double kDistanceTie = 1e-15;

/// The nearest of places on the surface. Those that are equally near but for rounding may lie as far from each other as
/// its root: the one whose normal separates more is it.
class NearestPlace {
 public:
  NearestPlace(const Polytope& polytope, const Vec3& p)
      : polytope_(polytope), p_(p), tie_(kDistanceTie * (polytope.radius + p.norm())) {}
  void offer(const PointDistance& place) {
    if (is_better(place)) best_ = place;
  }
  double tie() const { return tie_; }
  double limit() const { return best_.distance + tie_; }
  const PointDistance& best() const { return best_; }

 private:
  bool is_better(const PointDistance& place) const {
    if (std::abs(place.distance - best_.distance) > tie_) return place.distance < best_.distance;
    if ((place.foot - best_.foot).squaredNorm() <= tie_ * tie_) return false;
    return separation_along(place.normal) > separation_along(best_.normal);
  }
  double separation_along(const Vec3& n) const {
    return n.dot(p_) + descend(polytope_, -n, 0, -kInfinity).height;
  }

  const Polytope& polytope_;
  const Vec3& p_;
  double tie_;
  PointDistance best_{kInfinity, Vec3::UnitZ(), Vec3::Zero(), 0};
};

/// The places of a face that could be nearest to p, at this height over it: its foot, else the nearest of every edge that
/// p is beyond.
void offer_face(const Polytope& polytope, std::uint32_t index, const Vec3& p, double height,
                NearestPlace& nearest) {
  const ConvexHull::Face& face = polytope.faces[index];
  const auto loop = polytope.loop(face);
  bool inside = true;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Vec3& tail = polytope.vertices[loop[i]];
    const Vec3& head = polytope.vertices[loop[i + 1 == loop.size() ? 0 : i + 1]];
    const Vec3 along = head - tail, d = p - tail;
    if (along.cross(d).dot(face.normal) >= -nearest.tie() * along.norm()) continue;
    inside = false;
    const double length2 = along.squaredNorm();
    const double s = length2 > 0.0 ? std::clamp(along.dot(d) / length2, 0.0, 1.0) : 0.0;
    const Vec3 foot = tail + s * along, apart = p - foot;
    // Between its ends at right angles to the edge, which rounding has turned a short way from.
    const Vec3 across = s > 0.0 && s < 1.0 ? Vec3(apart - along * (along.dot(apart) / length2)) : apart;
    nearest.offer({apart.norm(), direction_or(across, face.normal), foot, mix_features(1, loop[i])});
  }
  if (inside) nearest.offer({height, face.normal, p - height * face.normal, mix_features(0, index)});
}

}  // namespace

BoxFeatures::BoxFeatures(const Box& box) : radius_(box.half_extents.norm()) {
  const Vec3& h = box.half_extents;
  for (std::uint32_t i = 0; i < 8; ++i) {
    for (int k = 0; k < 3; ++k) vertices_[i][k] = i >> k & 1 ? h[k] : -h[k];
  }
  for (std::uint32_t i = 0; i < 6; ++i) {
    const int axis = static_cast<int>(i / 2);
    const double h1 = h[(axis + 1) % 3], h2 = h[(axis + 2) % 3];
    faces_[i] = {i % 2 ? Vec3(-Vec3::Unit(axis)) : Vec3::Unit(axis), h[axis], 4 * i, 4,
                 2.0 * h1 * h2 / (h1 + h2)};
  }
  put_in_fours(vertices_, vertex_fours_.data());
  put_in_fours(faces_, face_fours_.data());
}

Polytope BoxFeatures::view() const {
  return {vertices_,      kBoxLoops,       faces_,        kBoxEdges,   kBoxNeighbourOffsets,
          kBoxNeighbours, kBoxEdgesAround, vertex_fours_, face_fours_, Vec3::Zero(),
          radius_};
}

TriangleFeatures::TriangleFeatures(const std::array<Vec3, 3>& corners, const Vec3& normal)
    : vertices_(corners), centre_((corners[0] + corners[1] + corners[2]) / 3.0) {
  const Vec3 u = corners[1] - corners[0], v = corners[2] - corners[0];
  const double width = u.cross(v).norm() / (u.norm() + v.norm() + (v - u).norm());
  const double offset = normal.dot(corners[0]);
  faces_ = {{{normal, offset, 0, 3, width}, {-normal, -offset, 3, 3, width}}};
  for (const Vec3& corner : corners) radius_ = std::max(radius_, corner.norm());
  put_in_fours(vertices_, &vertex_four_);
  put_in_fours(faces_, &face_four_);
}

Polytope TriangleFeatures::view() const {
  return {vertices_,
          kTriangleLoops,
          faces_,
          kTriangleEdges,
          kTriangleNeighbourOffsets,
          kTriangleNeighbours,
          kTriangleEdgesAround,
          {&vertex_four_, 1},
          {&face_four_, 1},
          centre_,
          radius_};
}

Polytope view_of(const ConvexHull& hull) {
  return {hull.vertices,          hull.loops,      hull.faces,        hull.edges,
          hull.neighbour_offsets, hull.neighbours, hull.edges_around, hull.vertex_fours,
          hull.face_fours,        hull.centre,     hull.radius};
}

Lowest descend(const Polytope& polytope, const Vec3& d, std::uint32_t start, double enough) {
  if (polytope.vertices.size() <= kScannedVertices) return scan_lowest(polytope.vertex_fours, d);
  return descend_edges(polytope.vertices, polytope.neighbour_offsets, polytope.neighbours, d, start, enough);
}

Lowest lowest_at(const Polytope& polytope, const Vec3& d, std::uint32_t vertex) {
  const Vec3& v = polytope.vertices[vertex];
  if (polytope.vertices.size() > kScannedVertices) return {vertex, d.dot(v)};
  return {vertex, d.x() * v.x() + d.y() * v.y() + d.z() * v.z()};  // summed as by scan_lowest
}

std::uint32_t face_towards(const Polytope& polytope, const Vec3& d) {
  return face_towards(polytope, d, descend(polytope, -d, 0, -kInfinity).vertex);
}

std::uint32_t face_towards(const Polytope& polytope, const Vec3& d, std::uint32_t vertex) {
  std::uint32_t best = 0;
  double most = -kInfinity;
  for (const std::uint32_t edge : polytope.edges_around_vertex(vertex)) {
    const std::uint32_t face = flatter_face(polytope, polytope.edges[edge], d);
    const double along = polytope.faces[face].normal.dot(d);
    if (along > most) best = face, most = along;
  }
  return best;
}

std::uint32_t flatter_face(const Polytope& polytope, const ConvexHull::Edge& edge, const Vec3& d) {
  const auto along = [&](std::uint32_t face) { return polytope.faces[face].normal.dot(d); };
  return along(edge.left_face) >= along(edge.right_face) ? edge.left_face : edge.right_face;
}

bool is_over_face(const Polytope& polytope, std::uint32_t face, const Vec3& p) {
  const auto loop = polytope.loop(polytope.faces[face]);
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Vec3& tail = polytope.vertices[loop[i]];
    const Vec3 along = polytope.vertices[loop[i + 1 == loop.size() ? 0 : i + 1]] - tail;
    if (along.cross(p - tail).dot(polytope.faces[face].normal) < 0.0) return false;
  }
  return true;
}

double height_beside_face(const Polytope& polytope, std::uint32_t face, const Vec3& p) {
  const auto loop = polytope.loop(polytope.faces[face]);
  double height = -kInfinity;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Vec3& tail = polytope.vertices[loop[i]];
    const Vec3 along = polytope.vertices[loop[i + 1 == loop.size() ? 0 : i + 1]] - tail;
    height = std::max(height, -along.cross(p - tail).dot(polytope.faces[face].normal) / along.norm());
  }
  return height;
}

double depth_behind_others(const Polytope& polytope, std::uint32_t face, const Vec3& p) {
  Four least = four(kInfinity);
  for (std::size_t i = 0; i < polytope.face_fours.size(); ++i) {
    Four depth = polytope.face_fours[i].offset - dot(polytope.face_fours[i].normal, p);
    // The first faces come again after the last.
    for (const std::size_t own : {std::size_t{face}, face + polytope.faces.size()}) {
      if (own / 4 == i) depth[own % 4] = kInfinity;
    }
    least = smaller(depth, least);
  }
  return std::min({least[0], least[1], least[2], least[3]});
}

PointDistance compute_distance(const Polytope& polytope, const Vec3& p, double enough) {
  double highest = -kInfinity;
  std::uint32_t nearest = 0;
  for (std::uint32_t i = 0; i < polytope.faces.size(); ++i) {
    const double height = polytope.faces[i].normal.dot(p) - polytope.faces[i].offset;
    if (height > highest) highest = height, nearest = i;
  }
  const Vec3& normal = polytope.faces[nearest].normal;
  if (highest <= 0.0 || highest > enough || is_over_face(polytope, nearest, p))
    return {highest, normal, p - highest * normal, mix_features(0, nearest)};
  NearestPlace place(polytope, p);
  for (std::uint32_t i = 0; i < polytope.faces.size(); ++i) {
    const double height = polytope.faces[i].normal.dot(p) - polytope.faces[i].offset;
    if (height > 0.0 && height < place.limit()) offer_face(polytope, i, p, height, place);
  }
  return place.best();
}

}  // namespace tumble
