// Ground truth for polytopes: every face normal and every pair of edges as axis, each with the true supports of all
// vertices, in 80-bit arithmetic. No pruning, no Gauss map: slow and hard to get wrong.
#pragma once

#include <limits>
#include <vector>

#include "collision/polytope.h"
#include "math/pose.h"

namespace tumble::test {

using Vec3L = Eigen::Matrix<long double, 3, 1>;
using Mat3L = Eigen::Matrix<long double, 3, 3>;

inline Mat3L rotation_matrix_l(const Quat& q) {
  return Eigen::Quaternion<long double>(q.cast<long double>()).normalized().toRotationMatrix();
}

/// Rebuilt from the vertices, placed anywhere: the polytope's own normals are rounded to 64 bits.
inline Vec3L face_normal_l(const Polytope& polytope, const Polytope::Face& face,
                           const std::vector<Vec3L>& vertices) {
  const auto loop = polytope.loop(face);
  Vec3L n = Vec3L::Zero();
  for (std::size_t i = 0; i < loop.size(); ++i) {
    n += (vertices[loop[i]] - vertices[loop[0]])
             .cross(vertices[loop[(i + 1) % loop.size()]] - vertices[loop[0]]);
  }
  return n.normalized();
}

class PolytopeReference {
 public:
  PolytopeReference(const Polytope& a, const Pose& X_WA, const Polytope& b, const Pose& X_WB) {
    const Mat3L R_AW = rotation_matrix_l(X_WA.q).transpose();
    const Mat3L R = R_AW * rotation_matrix_l(X_WB.q);
    const Vec3L p = R_AW * (X_WB.p.cast<long double>() - X_WA.p.cast<long double>());
    for (const Vec3& v : a.vertices) vertices_a_.push_back(v.cast<long double>());
    for (const Vec3& v : b.vertices) vertices_b_.push_back(R * v.cast<long double>() + p);
    add_axes(a, vertices_a_);
    const std::size_t edges_a = edges_.size();
    add_axes(b, vertices_b_);
    for (std::size_t i = 0; i < edges_a; ++i) {
      for (std::size_t j = edges_a; j < edges_.size(); ++j) {
        const Vec3L n = edges_[i].cross(edges_[j]);
        const long double sin2 = n.squaredNorm() / (edges_[i].squaredNorm() * edges_[j].squaredNorm());
        if (sin2 > 1e-24L) add_axis(n.normalized());
      }
    }
    for (const Vec3L& n : axes_) best_ = std::max(best_, separation_along(n));
  }

  /// Largest separation over all axes: < 0 is the depth of the overlap, > 0 proves that they are apart.
  double separation() const { return static_cast<double>(best_); }
  long double separation_along(const Vec3L& n) const {
    long double top = -std::numeric_limits<long double>::infinity(), bottom = -top;
    for (const Vec3L& v : vertices_a_) top = std::max(top, n.dot(v));
    for (const Vec3L& v : vertices_b_) bottom = std::min(bottom, n.dot(v));
    return bottom - top;
  }
  /// Angle [rad] between n and the nearest axis.
  double angle_to_axis(const Vec3& n) const {
    long double nearest = 4.0L;
    for (const Vec3L& axis : axes_) nearest = std::min(nearest, (n.cast<long double>() - axis).norm());
    return static_cast<double>(nearest);
  }

 private:
  void add_axis(const Vec3L& n) {
    axes_.push_back(n);
    axes_.push_back(-n);
  }
  void add_axes(const Polytope& polytope, const std::vector<Vec3L>& vertices) {
    for (const Polytope::Face& face : polytope.faces) {
      add_axis(face_normal_l(polytope, face, vertices));
    }
    for (const Polytope::Edge& edge : polytope.edges)
      edges_.push_back(vertices[edge.head] - vertices[edge.tail]);
  }

  std::vector<Vec3L> vertices_a_, vertices_b_, edges_, axes_;
  long double best_ = -std::numeric_limits<long double>::infinity();
};

}  // namespace tumble::test
