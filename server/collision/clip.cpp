// Polygon clipping for contact manifolds, in the frame of the reference face. Tolerances: ContactTolerance.
#include "collision/clip.h"

namespace tumble {
namespace {

/// Labels of reference sides start here; incident edges count from 0.
constexpr std::uint32_t kSideLabel = 0x8000;
/// Signed distances closer than this [m] have no crossing worth computing.
constexpr double kNoCrossing = 1e-12;

std::uint32_t meeting(std::uint32_t edge, std::uint32_t other) {
  return edge < other ? (edge << 16 | other) : (other << 16 | edge);
}

}  // namespace

void ClipPolygon::close() {
  for (std::size_t i = 0; i < static_cast<std::size_t>(count_); ++i) {
    const std::size_t before = i == 0 ? static_cast<std::size_t>(count_ - 1) : i - 1;
    vertices_[i].id = meeting(vertices_[before].edge, vertices_[i].edge);
    if (i == 0 || vertices_[i].p.z() < lowest_.p.z()) lowest_ = vertices_[i];
  }
}

void ClipPolygon::cut(const ClipSide& side, std::uint32_t index, double tolerance) {
  const std::size_t total = static_cast<std::size_t>(count_);
  std::array<double, kCapacity> distance;
  bool all_inside = true;
  for (std::size_t i = 0; i < total; ++i) {
    const Vec3& p = vertices_[i].p;
    distance[i] = side.nx * p.x() + side.ny * p.y() - side.offset;
    all_inside = all_inside && distance[i] <= tolerance;
  }
  if (all_inside) return;

  const std::uint32_t label = kSideLabel + index;
  std::array<Vertex, kCapacity> kept;
  std::size_t n = 0;
  for (std::size_t i = 0; i < total; ++i) {
    const std::size_t j = i + 1 == total ? 0 : i + 1;
    const bool inside = distance[i] <= tolerance, next_inside = distance[j] <= tolerance;
    if (inside) kept[n++] = vertices_[i];
    if (inside == next_inside) continue;
    const double rise = distance[j] - distance[i];
    const bool crosses = distance[i] * distance[j] < 0.0 && std::abs(rise) > kNoCrossing;
    if (crosses && n < kept.size()) {
      const Vec3 p = vertices_[i].p + (distance[i] / -rise) * (vertices_[j].p - vertices_[i].p);
      kept[n++] = {p, meeting(vertices_[i].edge, label), inside ? label : vertices_[i].edge};
    } else if (inside) {
      kept[n - 1].edge = label;
    }
  }
  for (std::size_t i = 0; i < n; ++i) vertices_[i] = kept[i];
  count_ = static_cast<int>(n);
}

Manifold ClipPolygon::make_manifold(const FacePlane& plane, const Vec3& normal_A, double margin, double merge,
                                    std::uint32_t faces) const {
  ManifoldBuilder builder(normal_A, margin, merge);
  for (std::size_t i = 0; i < static_cast<std::size_t>(count_); ++i) {
    const Vertex& vertex = vertices_[i];
    builder.add(plane.middle_A(vertex.p), vertex.p.z(), mix_features(vertex.id, faces));
  }
  if (builder.count() == 0) {
    builder.add(plane.middle_A(lowest_.p), lowest_.p.z(), mix_features(lowest_.id, faces));
  }
  return builder.finish();
}

}  // namespace tumble
