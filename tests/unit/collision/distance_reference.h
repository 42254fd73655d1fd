// Ground truth for the distance of two polytopes that are apart: every vertex against every face and every edge against
// every edge, in 80-bit arithmetic. It checks itself: the plane pair square to the shortest gap must be as far apart as
// the gap is long (a lower bound that equals the upper one).
#pragma once

#include <algorithm>
#include <limits>
#include <vector>

#include "collision/polytope.h"
#include "polytope_reference.h"

namespace tumble::test {

class DistanceReference {
 public:
  DistanceReference(const Polytope& a, const Polytope& b, const Pose& X_AB) {
    const Mat3L R = rotation_matrix_l(X_AB.q);
    for (const Vec3& v : a.vertices) vertices_a_.push_back(v.cast<long double>());
    for (const Vec3& v : b.vertices)
      vertices_b_.push_back(R * v.cast<long double>() + X_AB.p.cast<long double>());
    for (const Vec3L& v : vertices_a_) try_faces(v, b, vertices_b_, 1.0L);
    for (const Vec3L& v : vertices_b_) try_faces(v, a, vertices_a_, -1.0L);
    for (const Polytope::Edge& e : a.edges) {
      for (const Polytope::Edge& f : b.edges) {
        try_edges(vertices_a_[e.tail], vertices_a_[e.head], vertices_b_[f.tail], vertices_b_[f.head]);
      }
    }
  }

  long double distance() const { return gap_.norm(); }
  /// Of the plane pair square to the gap: distance() if the search was right, less (or < 0) if it was not.
  long double dual() const {
    const Vec3L& n = normal_;
    long double top = -std::numeric_limits<long double>::infinity(), bottom = -top;
    for (const Vec3L& v : vertices_a_) top = std::max(top, n.dot(v));
    for (const Vec3L& v : vertices_b_) bottom = std::min(bottom, n.dot(v));
    return bottom - top;
  }

 private:
  /// With the direction of the gap where the features know it better than the (perhaps tiny) gap itself.
  void offer(const Vec3L& gap, Vec3L normal) {
    if (!(gap.squaredNorm() < gap_.squaredNorm())) return;
    gap_ = gap;
    normal_ = normal.dot(gap) < 0.0L ? Vec3L(-normal) : normal;
  }
  void offer(const Vec3L& p, const Vec3L& tail, const Vec3L& along, long double sign) {
    const long double s = std::clamp(along.dot(p - tail) / along.squaredNorm(), 0.0L, 1.0L);
    const Vec3L gap = sign * (p - tail - s * along);
    Vec3L normal = gap.normalized();
    if (s > 0.0L && s < 1.0L)
      normal = (normal - along * (along.dot(normal) / along.squaredNorm())).normalized();
    offer(gap, normal);
  }

  /// Foot of a point on each face, if it falls inside; the faces' borders are edges.
  void try_faces(const Vec3L& p, const Polytope& polytope, const std::vector<Vec3L>& vertices,
                 long double sign) {
    for (const Polytope::Face& face : polytope.faces) {
      const auto loop = polytope.loop(face);
      const Vec3L n = face_normal_l(polytope, face, vertices);
      bool inside = true;
      for (std::size_t i = 0; i < loop.size() && inside; ++i) {
        const Vec3L& tail = vertices[loop[i]];
        inside = (vertices[loop[(i + 1) % loop.size()]] - tail).cross(p - tail).dot(n) >= 0.0L;
      }
      const long double height = n.dot(p - vertices[loop[0]]);
      if (inside) offer(-sign * height * n, n);
    }
  }

  /// The crossing point of the lines if it lies on both edges, and every end against the other edge.
  void try_edges(const Vec3L& p, const Vec3L& p2, const Vec3L& q, const Vec3L& q2) {
    const Vec3L d = p2 - p, e = q2 - q, r = q - p;
    const long double dd = d.dot(d), ee = e.dot(e), de = d.dot(e), cross = d.cross(e).squaredNorm();
    if (cross > 0.0L) {
      const long double s = (r.dot(d) * ee - r.dot(e) * de) / cross,
                        t = (r.dot(d) * de - r.dot(e) * dd) / cross;
      if (s >= 0.0L && s <= 1.0L && t >= 0.0L && t <= 1.0L) offer(r + t * e - s * d, d.cross(e).normalized());
    }
    offer(q, p, d, 1.0L);
    offer(q2, p, d, 1.0L);
    offer(p, q, e, -1.0L);
    offer(p2, q, e, -1.0L);
  }

  std::vector<Vec3L> vertices_a_, vertices_b_;
  Vec3L gap_ = Vec3L::Constant(1e300L), normal_;  // from A to B
};

}  // namespace tumble::test
