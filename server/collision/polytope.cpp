// Topology of the box, descent over vertices, and point against polytope: the closest point of an outside point lies on
// a face that the point sees, so it is the nearest over all of those.
#include "collision/polytope.h"

#include "collision/feature_name.h"
#include "collision/segment.h"

namespace tumble {
namespace {

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
  const Polytope::Face& face = polytope.faces[index];
  const auto loop = polytope.loop(face);
  bool inside = true;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Vec3& tail = polytope.vertices[loop[i]];
    const Vec3 d = p - tail;
    if (polytope.sides[face.first + i].outward.dot(d) <= nearest.tie()) continue;
    inside = false;
    const Vec3 along = polytope.vertices[loop[i + 1 == loop.size() ? 0 : i + 1]] - tail;
    const double length2 = along.squaredNorm();
    const double s = length2 > 0.0 ? std::clamp(along.dot(d) / length2, 0.0, 1.0) : 0.0;
    const Vec3 foot = tail + s * along, apart = p - foot;
    // Between its ends at right angles to the edge, which rounding has turned a short way from.
    const Vec3 across = s > 0.0 && s < 1.0 ? Vec3(apart - along * (along.dot(apart) / length2)) : apart;
    nearest.offer({apart.norm(), direction_or(across, face.normal), foot, mix_features(1, loop[i])});
  }
  if (inside) nearest.offer({height, face.normal, p - height * face.normal, mix_features(0, index)});
}

/// From vertex `start`, of many.
Lowest descend_edges(const Polytope& polytope, const Vec3& d, std::uint32_t start, double enough) {
  const std::span<const Vec3> vertices = polytope.vertices;
  Lowest lowest{start < vertices.size() ? start : 0, 0.0};
  lowest.height = d.dot(vertices[lowest.vertex]);
  // A vertex that no neighbour is below is the lowest of all: heights have no second minimum on a convex body.
  for (bool descending = true; descending && lowest.height >= enough;) {
    descending = false;
    const std::uint32_t from = lowest.vertex;
    for (std::uint32_t k = polytope.neighbour_offsets[from]; k < polytope.neighbour_offsets[from + 1]; ++k) {
      const double height = d.dot(vertices[polytope.neighbours[k]]);
      if (height < lowest.height) lowest = {polytope.neighbours[k], height}, descending = true;
    }
  }
  return lowest;
}

}  // namespace

void put_in_fours(std::span<const Vec3> vertices, FourVectors* fours) {
  for (std::size_t i = 0; i < (vertices.size() + 3) / 4 * 4; ++i) {
    fours[i / 4].set(i % 4, vertices[i < vertices.size() ? i : 0]);
  }
}

void put_in_fours(std::span<const Polytope::Face> faces, Polytope::FourFaces* fours) {
  for (std::size_t i = 0; i < (faces.size() + 3) / 4 * 4; ++i) {
    const Polytope::Face& face = faces[i < faces.size() ? i : 0];
    fours[i / 4].normal.set(i % 4, face.normal);
    fours[i / 4].offset[i % 4] = face.offset;
  }
}

Lowest scan_lowest(std::span<const FourVectors> vertices, const Vec3& d) {
  FirstLowest lowest;
  for (const FourVectors& v : vertices) lowest.look_at(dot(v, d));
  return {lowest.index(), lowest.value()};
}

Lowest descend(const Polytope& polytope, const Vec3& d, std::uint32_t start, double enough) {
  if (polytope.vertices.size() <= kScannedVertices) return scan_lowest(polytope.vertex_fours, d);
  return descend_edges(polytope, d, start, enough);
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

std::uint32_t flatter_face(const Polytope& polytope, const Polytope::Edge& edge, const Vec3& d) {
  const auto along = [&](std::uint32_t face) { return polytope.faces[face].normal.dot(d); };
  return along(edge.left_face) >= along(edge.right_face) ? edge.left_face : edge.right_face;
}

double height_beside_face(const Polytope& polytope, std::uint32_t face, const Vec3& p) {
  double height = -kInfinity;
  for (const Polytope::Side& side : polytope.sides_of(polytope.faces[face])) {
    height = std::max(height, side.outward.dot(p) - side.offset);
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
  if (highest <= 0.0 || highest > enough || height_beside_face(polytope, nearest, p) <= 0.0)
    return {highest, normal, p - highest * normal, mix_features(0, nearest)};
  NearestPlace place(polytope, p);
  for (std::uint32_t i = 0; i < polytope.faces.size(); ++i) {
    const double height = polytope.faces[i].normal.dot(p) - polytope.faces[i].offset;
    if (height > 0.0 && height < place.limit()) offer_face(polytope, i, p, height, place);
  }
  return place.best();
}

}  // namespace tumble
