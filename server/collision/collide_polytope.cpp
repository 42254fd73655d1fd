// The winning facet of two polytopes -> manifold: a face clips the other body's most opposed face, edges meet in a
// point. See collide_polytope.h.
#include "collision/collide_polytope.h"

#include <utility>

#include "collision/box_polytope.h"
#include "collision/clip.h"
#include "collision/corner_contact.h"
#include "collision/corner_on_face.h"
#include "collision/facet_search.h"
#include "collision/feature_name.h"
#include "collision/segment_contact.h"
#include "math/rotation.h"

namespace tumble {
namespace {

/// A face and the pose of its body in A.
class PlacedFace {
 public:
  /// Without a pose: A's own.
  PlacedFace(const Polytope& body, std::uint32_t face, const PolytopePair* of_b = nullptr)
      : body_(body), face_(body.faces[face]), loop_(body.loop(face_)), pair_(of_b) {}

  double width() const { return face_.width; }
  std::size_t count() const { return std::min<std::size_t>(face_.count, kMaxFaceVertices); }
  bool is_thinned() const { return count() < face_.count; }
  /// Vertex k of the loop, which is thinned to `count()` evenly spread ones from vertex `first` on.
  std::uint32_t index(std::size_t k, std::size_t first = 0) const {
    return is_thinned() ? loop_[(first + k * loop_.size() / count()) % loop_.size()] : loop_[k];
  }
  const Vec3& vertex(std::size_t k, std::size_t first = 0) const { return body_.vertices[index(k, first)]; }
  const Vec3& normal() const { return face_.normal; }
  std::size_t after(std::size_t k) const { return k + 1 == count() ? 0 : k + 1; }
  /// From vertex k to the next one.
  Polytope::Side side(std::size_t k) const {
    return is_thinned() ? make_side(face_.normal, vertex(k), vertex(after(k))) : body_.sides[face_.first + k];
  }
  Vec3 to_A(const Vec3& p) const { return pair_ == nullptr ? p : pair_->R_AB * p + pair_->p_AB; }
  Vec3 turned_to_A(const Vec3& d) const { return pair_ == nullptr ? d : pair_->R_AB * d; }
  Vec3 vertex_A(std::size_t k, std::size_t first = 0) const { return to_A(vertex(k, first)); }
  Vec3 normal_A() const { return turned_to_A(face_.normal); }

  /// Place in the loop of the vertex that is lowest along n.
  std::size_t lowest_along(const Vec3& n_A) const {
    const Vec3 n = pair_ == nullptr ? n_A : pair_->R_AB.transpose() * n_A;
    std::size_t lowest = 0;
    for (std::size_t i = 1; i < loop_.size(); ++i) {
      if (n.dot(body_.vertices[loop_[i]]) < n.dot(body_.vertices[loop_[lowest]])) lowest = i;
    }
    return lowest;
  }

 private:
  const Polytope& body_;
  const Polytope::Face& face_;
  const std::span<const std::uint32_t> loop_;
  const PolytopePair* pair_;
};

Manifold clip_faces(const PlacedFace& reference, const PlacedFace& incident, bool reference_is_a,
                    const Facet& facet, double margin, bool face_to_face) {
  const FaceAxes axes(reference.vertex(0), reference.normal(), reference.side(0));
  const FacePlane plane(reference.to_A(axes.origin()), reference.turned_to_A(axes.u()), reference.normal_A(),
                        reference_is_a ? facet.normal_A : Vec3(-facet.normal_A));
  const ContactTolerance tolerance =
      ContactTolerance::of(std::min(reference.width(), incident.width()), face_to_face);
  ClipPolygon polygon(reference_is_a);
  const std::size_t first = incident.is_thinned() ? incident.lowest_along(plane.n_A()) : 0;
  for (std::size_t k = 0; k < incident.count(); ++k) {
    polygon.add_vertex(plane.to_plane(incident.vertex_A(k, first)), incident.index(k, first));
  }
  polygon.close();
  for (std::size_t k = 0; k < reference.count(); ++k) {
    polygon.cut(axes.see(reference.side(k), reference.index(k), reference.index(reference.after(k))),
                tolerance.inside);
  }
  return polygon.make_manifold(plane, facet.normal_A, facet.separation <= 0.0, margin, tolerance.merge);
}

/// The edges of A and B that cross, in A's frame.
std::pair<Segment, Segment> crossing_edges(const PolytopePair& pair, const Facet& facet) {
  const Polytope::Edge &edge_a = pair.a.edges[facet.a], &edge_b = pair.b.edges[facet.b];
  const Vec3 &tail_a = pair.a.vertices[edge_a.tail], &head_a = pair.a.vertices[edge_a.head];
  const Vec3 tail_b = pair.R_AB * pair.b.vertices[edge_b.tail] + pair.p_AB;
  const Vec3 head_b = pair.R_AB * pair.b.vertices[edge_b.head] + pair.p_AB;
  return {{0.5 * (tail_a + head_a), 0.5 * (head_a - tail_a)},
          {0.5 * (tail_b + head_b), 0.5 * (head_b - tail_b)}};
}

Manifold cross_edges(const PolytopePair& pair, const Facet& facet, double margin) {
  const Polytope::Edge &edge_a = pair.a.edges[facet.a], &edge_b = pair.b.edges[facet.b];
  const auto [a, b] = crossing_edges(pair, facet);
  const double merge = ContactTolerance::of(std::min(a.reach.norm(), b.reach.norm())).merge;
  return make_segment_manifold({a, 0.0}, {b, 0.0}, facet.normal_A, margin, merge,
                               name_crossing(edge_a.tail, edge_a.head, edge_b.tail, edge_b.head));
}

/// The faces of A and B that look at each other along an axis.
struct FacePair {
  std::uint32_t a, b;
  double cosine_a, cosine_b;  ///< Of the angle to the axis.

  bool either_is_flat() const { return std::max(cosine_a, cosine_b) > ContactTolerance::kFlat; }
  bool lie_face_to_face() const { return std::min(cosine_a, cosine_b) > ContactTolerance::kFaceToFace; }
};

/// `vertex_a` and `vertex_b` are the furthest ones along the facet's normal.
FacePair find_faces(const PolytopePair& pair, const Facet& facet, std::uint32_t vertex_a,
                    std::uint32_t vertex_b) {
  const Vec3 towards_a_B = pair.R_AB.transpose() * -facet.normal_A;
  std::uint32_t face_a = facet.a, face_b = facet.b;
  if (facet.kind == Facet::Kind::edges) {
    face_a = flatter_face(pair.a, pair.a.edges[facet.a], facet.normal_A);
    face_b = flatter_face(pair.b, pair.b.edges[facet.b], towards_a_B);
  } else if (facet.kind == Facet::Kind::face_a) {
    face_b = face_towards(pair.b, towards_a_B, vertex_b);
  } else {
    face_a = face_towards(pair.a, facet.normal_A, vertex_a);
  }
  return {face_a, face_b, pair.a.faces[face_a].normal.dot(facet.normal_A),
          pair.b.faces[face_b].normal.dot(towards_a_B)};
}

bool reference_is_a(const Facet& facet, const FacePair& faces) {
  return facet.kind == Facet::Kind::face_a || faces.cosine_a > ContactTolerance::kFlat;
}

Manifold make_manifold(const PolytopePair& pair, const Facet& facet, const FacePair& faces, double margin) {
  if (facet.kind == Facet::Kind::edges && !faces.either_is_flat()) return cross_edges(pair, facet, margin);
  const PlacedFace a(pair.a, faces.a), b(pair.b, faces.b, &pair);
  const bool face_to_face = faces.lie_face_to_face(), of_a = reference_is_a(facet, faces);
  return clip_faces(of_a ? a : b, of_a ? b : a, of_a, facet, margin, face_to_face);
}

/// How far the lowest vertex of a contact along a face's normal lies beside that face; how far edges miss each other.
void measure_overhang(const PolytopePair& pair, const Facet& facet, const FacePair& faces,
                      std::uint32_t vertex_a, std::uint32_t vertex_b, AxisContact& contact) {
  if (facet.kind == Facet::Kind::edges) {
    const auto [a, b] = crossing_edges(pair, facet);
    contact.overhang = distance_between(a, b) - facet.separation;
    contact.tilt = 1.0;
    return;
  }
  const Vec3 &normal_a = pair.a.faces[faces.a].normal, &normal_b = pair.b.faces[faces.b].normal;
  contact.tilt = (pair.R_AB * normal_b).cross(normal_a).norm();
  contact.overhang =
      facet.kind == Facet::Kind::face_a
          ? height_beside_face(pair.a, faces.a, pair.R_AB * pair.b.vertices[vertex_b] + pair.p_AB)
          : height_beside_face(pair.b, faces.b,
                               pair.R_AB.transpose() * (pair.a.vertices[vertex_a] - pair.p_AB));
}

/// The corner that is lowest over the facet's face.
struct LowestCorner {
  LowestCorner(const PolytopePair& pair, const Facet& facet, std::uint32_t vertex_a, std::uint32_t vertex_b)
      : is_b(facet.kind == Facet::Kind::face_a),
        vertex(is_b ? vertex_b : vertex_a),
        p_A(is_b ? Vec3(pair.R_AB * pair.b.vertices[vertex] + pair.p_AB) : pair.a.vertices[vertex]) {}
  bool is_b;
  std::uint32_t vertex;
  Vec3 p_A;
};

/// Whether the corner touches the face, and nothing else of its body comes as near.
bool stands_alone(const PolytopePair& pair, const Facet& facet, const LowestCorner& corner, double margin) {
  const double gap = margin - facet.separation;
  if (corner.is_b) {
    const double slope2 = least_slope2({pair.b, corner.vertex, pair.R_AB.transpose() * facet.normal_A}, gap);
    return slope2 > 0.0 && holds_disc(pair.a, facet.a, corner.p_A, gap, slope2);
  }
  const double slope2 = least_slope2({pair.a, corner.vertex, -facet.normal_A}, gap);
  return slope2 > 0.0 &&
         holds_disc(pair.b, facet.b, pair.R_AB.transpose() * (corner.p_A - pair.p_AB), gap, slope2);
}

/// What clipping would find then.
Manifold stand_on_face(const Facet& facet, const LowestCorner& corner, double margin) {
  const double to_middle = (corner.is_b ? -0.5 : 0.5) * facet.separation;
  return single_point(facet.normal_A, corner.p_A + to_middle * facet.normal_A, facet.separation, margin,
                      name_vertex(!corner.is_b, corner.vertex));
}

/// The facet of the last search if its lead (kept by the pipeline) still holds, else a new search.
FacetAnswer choose_facet(const PolytopePair& pair, double margin, PairCache& cache) {
  if (cache.slack >= 0.0) {
    const Facet facet = recall_facet(pair, cache);
    if (facet.kind != Facet::Kind::none && facet.separation < margin) return {facet, cache.slack};
  }
  return find_facet(pair, margin, cache);
}

/// The contact along a facet's normal, or of the closest points where that is not the whole truth.
Manifold touch_along(const PolytopePair& pair, Facet facet, const Shape& a, const Shape& b, const Pose& X_AB,
                     double margin, PairCache& cache) {
  const FacePair faces = find_faces(pair, facet, cache.vertex_A, cache.vertex_B);
  Manifold manifold = make_manifold(pair, facet, faces, margin);
  AxisContact contact{manifold, facet.separation, pair.a.radius + pair.b.radius, faces.lie_face_to_face()};
  if (facet.separation > 0.0 && contact.face_to_face)
    measure_overhang(pair, facet, faces, cache.vertex_A, cache.vertex_B, contact);
  if (touches_along_axis(contact)) return manifold;
  const ClosestContact closest = contact_of_closest_points(contact, a, b, X_AB, margin, cache);
  if (closest.lying) {
    facet.normal_A = closest.manifold.normal_A;
    facet.separation = closest.separation;
    manifold = make_manifold(pair, facet, faces, margin);
    set_deepest(manifold, closest.separation);
  } else {
    manifold = closest.manifold;
  }
  return manifold;
}

Manifold collide(const PolytopePair& pair, const Shape& a, const Shape& b, const Pose& X_AB, double margin,
                 PairCache& cache) {
  const auto [facet, lead] = choose_facet(pair, margin, cache);
  cache.axis_A = facet.normal_A;
  cache.gap = facet.separation;
  cache.slack = lead;
  if (facet.separation > margin) return {};
  if (facet.kind == Facet::Kind::face_a || facet.kind == Facet::Kind::face_b) {
    const LowestCorner corner(pair, facet, cache.vertex_A, cache.vertex_B);
    if (stands_alone(pair, facet, corner, margin)) return stand_on_face(facet, corner, margin);
  }
  return touch_along(pair, facet, a, b, X_AB, margin, cache);
}

const ConvexHull& hull_of(const Shape& shape) {
  return **std::get_if<HullPointer>(&shape);
}

}  // namespace

Manifold collide_box_hull(const Shape& a, const Shape& b, const Pose& X_AB, double margin, PairCache& cache) {
  const BoxPolytope box(*std::get_if<Box>(&a));
  return collide({box, hull_of(b), rotation_matrix(X_AB.q), X_AB.p}, a, b, X_AB, margin, cache);
}

Manifold collide_hull_hull(const Shape& a, const Shape& b, const Pose& X_AB, double margin,
                           PairCache& cache) {
  return collide({hull_of(a), hull_of(b), rotation_matrix(X_AB.q), X_AB.p}, a, b, X_AB, margin, cache);
}

}  // namespace tumble
