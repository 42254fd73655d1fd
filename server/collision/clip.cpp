// Polygon clipping for contact manifolds, in the plane of the reference face. Tolerances: ContactTolerance.
#include "collision/clip.h"

#include <cmath>

#include "collision/feature_name.h"

namespace tumble {
namespace {

/// Signed distances closer than this [m] have no crossing worth computing.
constexpr double kNoCrossing = 1e-12;

}  // namespace

void ClipPolygon::add_vertex(const Vec3& p, std::uint32_t vertex, std::uint32_t mark) {
  Vertex& added = loops_[0][static_cast<std::size_t>(count_)];
  added = {p, name_vertex(!reference_is_a_, vertex), vertex, vertex, false, mark, mark};
  if (count_ > 0) {
    Vertex& before = loops_[0][static_cast<std::size_t>(count_ - 1)];
    before.head = vertex;
    added.marks |= before.mark;
  }
  if (count_ == 0 || p.z() < lowest_.p.z()) lowest_ = added;
  ++count_;
}

void ClipPolygon::close() {
  Vertex& last = loops_[0][static_cast<std::size_t>(count_ - 1)];
  last.head = loops_[0][0].tail;
  loops_[0][0].marks |= last.mark;
}

std::uint32_t ClipPolygon::name_meeting(const Vertex& edge, const ClipSide& side) const {
  if (!edge.on_side) {
    return reference_is_a_ ? name_crossing(side.tail, side.head, edge.tail, edge.head)
                           : name_crossing(edge.tail, edge.head, side.tail, side.head);
  }
  // Two sides meet in the reference's vertex, unless all between them was cut away.
  return name_vertex(reference_is_a_, edge.tail == side.head ? edge.tail : side.tail);
}

void ClipPolygon::continue_along(const ClipSide& side, Vertex& vertex) {
  vertex.tail = side.tail;
  vertex.head = side.head;
  vertex.on_side = true;
  vertex.mark = side.mark;
}

void ClipPolygon::cut(const ClipSide& side, double tolerance) {
  const std::size_t total = static_cast<std::size_t>(count_);
  const Loop& vertices = loops_[static_cast<std::size_t>(current_)];
  std::array<double, kCapacity> distance;
  bool all_inside = true;
  for (std::size_t i = 0; i < total; ++i) {
    const Vec3& p = vertices[i].p;
    distance[i] = side.nx * p.x() + side.ny * p.y() - side.offset;
    all_inside = all_inside && distance[i] <= tolerance;
  }
  if (all_inside) return;

  Loop& kept = loops_[static_cast<std::size_t>(1 - current_)];
  std::size_t n = 0;
  for (std::size_t i = 0; i < total; ++i) {
    const std::size_t j = i + 1 == total ? 0 : i + 1;
    const bool inside = distance[i] <= tolerance, next_inside = distance[j] <= tolerance;
    if (inside) kept[n++] = vertices[i];
    if (inside == next_inside) continue;
    const double rise = distance[j] - distance[i];
    const bool crosses = distance[i] * distance[j] < 0.0 && std::abs(rise) > kNoCrossing;
    if (crosses && n < kept.size()) {
      const Vec3 p = vertices[i].p + (distance[i] / -rise) * (vertices[j].p - vertices[i].p);
      kept[n] = vertices[i];
      kept[n].p = p;
      kept[n].name = name_meeting(vertices[i], side);
      kept[n].marks = vertices[i].mark | side.mark;
      if (inside) continue_along(side, kept[n]);
      ++n;
    } else if (inside) {
      continue_along(side, kept[n - 1]);
    }
  }
  current_ = 1 - current_;
  count_ = static_cast<int>(n);
}

Manifold ClipPolygon::make_manifold(const FacePlane& plane, const Vec3& normal_A, bool overlap, double margin,
                                    double merge) const {
  ManifoldBuilder builder(normal_A, margin, merge);
  for (std::size_t i = 0; i < static_cast<std::size_t>(count_); ++i) {
    const Vertex& vertex = loops_[static_cast<std::size_t>(current_)][i];
    if (vertex.p.z() <= margin) builder.add(plane.middle_A(vertex.p), vertex.p.z(), vertex.name);
  }
  if (builder.count() == 0 && overlap) {
    builder.add(plane.middle_A(lowest_.p), lowest_.p.z(), lowest_.name);
  }
  return builder.finish();
}

}  // namespace tumble
