// The winning facet of two polytopes -> manifold: a face clips the other body's most opposed face, edges meet in a
// point. See collide_polytope.h.
#include "collision/collide_polytope.h"

#include <utility>

#include "collision/clip.h"
#include "collision/corner_contact.h"
#include "collision/facet_search.h"
#include "collision/feature_name.h"
#include "collision/segment_contact.h"
#include "math/rotation.h"

namespace tumble {
namespace {

/// A face and the pose of its body in A.
struct PlacedFace {
  const Polytope& body;
  const ConvexHull::Face& face;
  const Mat3& R;
  const Vec3& p;

  int count() const { return std::min(static_cast<int>(face.count), kMaxFaceVertices); }
  /// Vertex k of the loop, which is thinned to `count()` evenly spread ones from vertex `first` on.
  Vec3 vertex_A(int k, std::size_t first) const { return R * body.vertices[index(k, first)] + p; }
  std::uint32_t index(int k, std::size_t first) const {
    const auto loop = body.loop(face);
    const std::size_t step = static_cast<std::size_t>(k) * loop.size() / static_cast<std::size_t>(count());
    return loop[(first + step) % loop.size()];
  }
};

std::size_t lowest_along(const PlacedFace& placed, const Vec3& n_A) {
  const auto loop = placed.body.loop(placed.face);
  const Vec3 n = placed.R.transpose() * n_A;
  std::size_t lowest = 0;
  for (std::size_t i = 1; i < loop.size(); ++i) {
    if (n.dot(placed.body.vertices[loop[i]]) < n.dot(placed.body.vertices[loop[lowest]])) lowest = i;
  }
  return lowest;
}

Manifold clip_faces(const PlacedFace& reference, const PlacedFace& incident, bool reference_is_a,
                    const Facet& facet, double margin, bool face_to_face) {
  const Vec3& normal_A = facet.normal_A;
  FacePlane plane;
  plane.f_A = reference.R * reference.face.normal;
  plane.n_A = reference_is_a ? normal_A : Vec3(-normal_A);
  plane.origin_A = reference.vertex_A(0, 0);
  plane.u_A = direction_or(reference.vertex_A(1, 0) - plane.origin_A, perpendicular_to(plane.f_A));
  plane.v_A = plane.f_A.cross(plane.u_A);

  ClipPolygon polygon(reference_is_a);
  const bool thinned = incident.count() < static_cast<int>(incident.face.count);
  const std::size_t first = thinned ? lowest_along(incident, plane.n_A) : 0;
  for (int k = 0; k < incident.count(); ++k) {
    polygon.add_vertex(plane.to_plane(incident.vertex_A(k, first)), incident.index(k, first));
  }
  polygon.close();

  const double width = std::min(reference.face.width, incident.face.width);
  const ContactTolerance tolerance = ContactTolerance::of(width, face_to_face);
  const auto corner = [&](int k) -> Vec3 {
    const Vec3 d = reference.vertex_A(k, 0) - plane.origin_A;
    return {plane.u_A.dot(d), plane.v_A.dot(d), 0.0};
  };
  Vec3 tail = Vec3::Zero();
  for (int k = 0; k < reference.count(); ++k) {
    const int next = (k + 1) % reference.count();
    const Vec3 head = corner(next);
    const double x = head.y() - tail.y(), y = tail.x() - head.x(), length = std::sqrt(x * x + y * y);
    if (length > 0.0) {
      const double nx = x / length, ny = y / length;
      polygon.cut({nx, ny, nx * tail.x() + ny * tail.y(), reference.index(k, 0), reference.index(next, 0)},
                  tolerance.inside);
    }
    tail = head;
  }
  const auto middle_A = [&](const Vec3& p) { return plane.middle_A(p); };
  return polygon.make_manifold(middle_A, normal_A, facet.separation <= 0.0, margin, tolerance.merge);
}

/// The edges of A and B that cross, in A's frame.
std::pair<Segment, Segment> crossing_edges(const PolytopePair& pair, const Facet& facet) {
  const ConvexHull::Edge &edge_a = pair.a.edges[facet.a], &edge_b = pair.b.edges[facet.b];
  const Vec3 &tail_a = pair.a.vertices[edge_a.tail], &head_a = pair.a.vertices[edge_a.head];
  const Vec3 tail_b = pair.R_AB * pair.b.vertices[edge_b.tail] + pair.p_AB;
  const Vec3 head_b = pair.R_AB * pair.b.vertices[edge_b.head] + pair.p_AB;
  return {{0.5 * (tail_a + head_a), 0.5 * (head_a - tail_a)},
          {0.5 * (tail_b + head_b), 0.5 * (head_b - tail_b)}};
}

Manifold cross_edges(const PolytopePair& pair, const Facet& facet, double margin) {
  const ConvexHull::Edge &edge_a = pair.a.edges[facet.a], &edge_b = pair.b.edges[facet.b];
  const auto [a, b] = crossing_edges(pair, facet);
  const double merge = ContactTolerance::of(std::min(a.reach.norm(), b.reach.norm())).merge;
  return make_segment_manifold({a, 0.0}, {b, 0.0}, facet.normal_A, margin, merge,
                               name_crossing(edge_a.tail, edge_a.head, edge_b.tail, edge_b.head));
}

/// The faces of A and B that look at each other along an axis.
struct FacePair {
  std::uint32_t a, b;
  double cosine_a, cosine_b;  ///< Of the angle to the axis.

  bool are_flat() const { return std::min(cosine_a, cosine_b) > ContactTolerance::kFlat; }
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
  if (facet.kind == Facet::Kind::edges && !faces.are_flat()) return cross_edges(pair, facet, margin);
  const Mat3 identity = Mat3::Identity();
  const Vec3 zero = Vec3::Zero();
  const PlacedFace a{pair.a, pair.a.faces[faces.a], identity, zero};
  const PlacedFace b{pair.b, pair.b.faces[faces.b], pair.R_AB, pair.p_AB};
  const bool face_to_face = faces.lie_face_to_face();
  return reference_is_a(facet, faces) ? clip_faces(a, b, true, facet, margin, face_to_face)
                                      : clip_faces(b, a, false, facet, margin, face_to_face);
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

/// The facet of the last search if its lead (kept by the pipeline) still holds, else a new search.
FacetAnswer choose_facet(const PolytopePair& pair, double margin, PairCache& cache) {
  if (cache.slack >= 0.0) {
    const Facet facet = recall_facet(pair, cache);
    if (facet.kind != Facet::Kind::none && facet.separation < margin) return {facet, cache.slack};
  }
  return find_facet(pair, margin, cache);
}

Manifold collide(const PolytopePair& pair, const Shape& a, const Shape& b, const Pose& X_AB, double margin,
                 PairCache& cache) {
  const FacetAnswer answer = choose_facet(pair, margin, cache);
  const double separation = answer.facet.separation;
  cache.axis_A = answer.facet.normal_A;
  cache.gap = separation;
  cache.slack = answer.lead;
  if (separation > margin) return {};
  Facet facet = answer.facet;
  const FacePair faces = find_faces(pair, facet, cache.vertex_A, cache.vertex_B);
  Manifold manifold = make_manifold(pair, facet, faces, margin);
  AxisContact contact{manifold, separation, pair.a.radius + pair.b.radius, faces.lie_face_to_face()};
  if (separation > 0.0 && contact.face_to_face)
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

}  // namespace

Manifold collide_box_hull(const Box& a, const HullPointer& b, const Pose& X_AB, double margin,
                          PairCache& cache) {
  const BoxFeatures box(a);
  return collide({box.view(), view_of(*b), rotation_matrix(X_AB.q), X_AB.p}, a, b, X_AB, margin, cache);
}

Manifold collide_hull_hull(const HullPointer& a, const HullPointer& b, const Pose& X_AB, double margin,
                           PairCache& cache) {
  return collide({view_of(*a), view_of(*b), rotation_matrix(X_AB.q), X_AB.p}, a, b, X_AB, margin, cache);
}

}  // namespace tumble
