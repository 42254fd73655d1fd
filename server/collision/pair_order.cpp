// See pair_order.h.
#include "collision/pair_order.h"

#include <algorithm>

namespace tumble {
namespace {

int sign_of(double difference) {
  return (difference > 0.0) - (difference < 0.0);
}
template <typename VectorA, typename VectorB>
int compare_vectors(const VectorA& a, const VectorB& b) {
  for (int i = 0; i < a.size(); ++i) {
    if (a[i] != b[i]) return sign_of(a[i] - b[i]);
  }
  return 0;
}

/// > 0: the first is larger. Any complete order of the data does.
int compare(const HalfSpace&, const HalfSpace&) {
  return 0;
}
int compare(const Sphere& a, const Sphere& b) {
  return sign_of(a.radius - b.radius);
}
int compare(const Capsule& a, const Capsule& b) {
  return a.radius != b.radius ? sign_of(a.radius - b.radius) : sign_of(a.half_length - b.half_length);
}
int compare(const Box& a, const Box& b) {
  return compare_vectors(a.half_extents, b.half_extents);
}
int compare(const Cylinder& a, const Cylinder& b) {
  return a.radius != b.radius ? sign_of(a.radius - b.radius) : sign_of(a.half_length - b.half_length);
}
int compare(const Cone& a, const Cone& b) {
  return a.radius != b.radius ? sign_of(a.radius - b.radius) : sign_of(a.half_length - b.half_length);
}
int compare(const Ellipsoid& a, const Ellipsoid& b) {
  return compare_vectors(a.half_axes, b.half_axes);
}
int compare(const HullPointer& a, const HullPointer& b) {
  if (a == b) return 0;
  if (a->radius != b->radius) return sign_of(a->radius - b->radius);
  if (a->vertices.size() != b->vertices.size()) return a->vertices.size() > b->vertices.size() ? 1 : -1;
  for (std::size_t i = 0; i < a->vertices.size(); ++i) {
    const int order = compare_vectors(a->vertices[i], b->vertices[i]);
    if (order != 0) return order;
  }
  return 0;
}

/// Surfaces never move, so they never meet.
int compare(const TriangleMeshPointer&, const TriangleMeshPointer&) {
  return 0;
}
int compare(const HeightFieldPointer&, const HeightFieldPointer&) {
  return 0;
}

}  // namespace

bool comes_second(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB) {
  const int size = std::visit(
      [&](const auto& first) { return compare(first, *std::get_if<std::decay_t<decltype(first)>>(&b)); }, a);
  if (size != 0) return size < 0;
  // Askew to everything that people stack in rows.
  const double ahead = (X_WB.p - X_WA.p).dot(Vec3(0.2761, 0.4437, 0.8526));
  if (ahead != 0.0) return ahead < 0.0;
  return compare_vectors(X_WA.q.coeffs(), X_WB.q.coeffs()) < 0;
}

}  // namespace tumble
