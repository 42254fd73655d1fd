// Polygon clipping for contact manifolds, in the plane of the reference face. Tolerances: ContactTolerance.
#include "collision/clip.h"

#include <algorithm>

#include "collision/feature_name.h"

namespace tumble {
namespace {

/// Where the edge from p to q crosses a side that they are `outside` and `next_outside` of [m]; false if they lie on one
/// side, or as good as on it.
bool cross_side(const Four& p, const Four& q, double outside, double next_outside, Four& crossing) {
  const double rise = next_outside - outside;
  crossing = p + (outside / -rise) * (q - p);
  return outside * next_outside < 0.0 && std::abs(rise) > ContactTolerance::kNoCrossing;
}

}  // namespace

void ClipPolygon::add_vertex(const Vec3& p, std::uint32_t vertex, std::uint32_t mark) {
  const std::uint32_t name = name_vertex(!reference_is_a_, vertex);
  Vertex& added = loops_[0][static_cast<std::size_t>(count_)];
  added = {four(p), name, vertex, vertex, false, mark, mark};
  if (count_ > 0) {
    Vertex& before = loops_[0][static_cast<std::size_t>(count_ - 1)];
    before.head = vertex;
    added.marks |= before.mark;
  }
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
  std::size_t inner = 0;
  while (inner < total && side.outside(vertices[inner].p) <= tolerance) ++inner;
  if (inner == total) return;

  Loop& kept = loops_[static_cast<std::size_t>(1 - current_)];
  std::size_t n = 0;
  double distance = side.outside(vertices[0].p);
  for (std::size_t i = 0; i < total; ++i) {
    const std::size_t next = i + 1 == total ? 0 : i + 1;
    const Vertex& vertex = vertices[i];
    const double next_distance = side.outside(vertices[next].p);
    const bool inside = distance <= tolerance, next_inside = next_distance <= tolerance;
    if (inside) kept[n++] = vertex;
    if (inside != next_inside) {
      Four p;
      if (n < kept.size() && cross_side(vertex.p, vertices[next].p, distance, next_distance, p)) {
        kept[n] = vertex;
        kept[n].p = p;
        kept[n].name = name_meeting(vertex, side);
        kept[n].marks = vertex.mark | side.mark;
        ++n;
      }
      // The loop leaves: what was kept last is where it turns onto the side.
      if (inside) continue_along(side, kept[n - 1]);
    }
    distance = next_distance;
  }
  current_ = 1 - current_;
  count_ = static_cast<int>(n);
}

ClipPolygon::Corner ClipPolygon::lowest_corner() const {
  Corner lowest = corner(0);
  for (int i = 1; i < count_; ++i) {
    if (corner(i).p.z() < lowest.p.z()) lowest = corner(i);
  }
  return lowest;
}

Manifold ClipPolygon::make_manifold(const FacePlane& plane, const Vec3& normal_A, bool overlap, double margin,
                                    double merge) const {
  ManifoldBuilder builder(normal_A, margin, merge);
  for (int i = 0; i < count_; ++i) {
    const Corner left = corner(i);
    builder.add(plane.middle_A(left.p), left.p.z(), left.name);
  }
  if (builder.count() > 0 || !overlap || count_ == 0) return builder.finish();
  const Corner lowest = lowest_corner();
  return single_point(normal_A, plane.middle_A(lowest.p), std::min(lowest.p.z(), margin), margin,
                      lowest.name);
}

}  // namespace tumble
