// See patch.h. Where two convex outlines overlap, the corners of the common region are corners of the one inside the other
// and crossings of outlines: all are found directly, so a circle needs no polygon in its place.
#include "collision/patch.h"

#include <algorithm>

#include "collision/box_polytope.h"
#include "collision/feature_name.h"
#include "collision/manifold_builder.h"
#include "collision/segment.h"

namespace tumble {
namespace {

/// sin and cos of 0.1 rad: parts that look further aside than this don't take part.
constexpr double kAside = 0.1, kAhead = 0.995;
/// Points this close, of the patch's width, are one; so is a deepest pair with a corner that is as deep but for this.
constexpr double kSame = 1e-6;
/// A point this far outside an outline, of the patch's width, is still inside: bodies that lie flush have no other.
constexpr double kOutside = 1e-6;
/// The turn between rim points.
constexpr double kEighth = 0.70710678118654752;
constexpr std::array<std::array<double, 2>, Patch::kRimPoints> kCompass = {{{1, 0},
                                                                            {kEighth, kEighth},
                                                                            {0, 1},
                                                                            {-kEighth, kEighth},
                                                                            {-1, 0},
                                                                            {-kEighth, -kEighth},
                                                                            {0, -1},
                                                                            {kEighth, -kEighth}}};

/// Builds the patch in the shape's frame S; d is the direction there.
struct PatchOf {
  const Vec3& d;

  static Patch at_point(const Vec3& p, std::uint32_t name) {
    Patch patch;
    add(patch, p, name);
    return patch;
  }
  static Patch along(const Vec3& tail, const Vec3& head, std::uint32_t name) {
    Patch patch = at_point(tail, name);
    add(patch, head, name + 1);
    patch.kind = Patch::Kind::line;
    patch.width = (head - tail).norm();
    return patch;
  }
  static void add(Patch& patch, const Vec3& p, std::uint32_t name) {
    patch.corners[static_cast<std::size_t>(patch.count)] = p;
    patch.names[static_cast<std::size_t>(patch.count++)] = name;
  }
  static Patch disc(double radius, double z, std::uint32_t name) {
    Patch patch;
    patch.kind = Patch::Kind::disc;
    patch.centre = {0, 0, z};
    patch.normal = {0, 0, std::copysign(1.0, z)};
    patch.radius = patch.width = radius;
    for (const auto& [x, y] : kCompass) add(patch, {radius * x, radius * y, z}, name++);
    return patch;
  }
  /// Point of a circle across z that lies furthest along d.
  Vec3 on_rim(double radius, double z) const {
    const double length = std::sqrt(d.x() * d.x() + d.y() * d.y());
    const double scale = length > 0.0 ? radius / length : 0.0;
    return {d.x() * scale, d.y() * scale, z};
  }
  Patch of_polytope(const Polytope& polytope) const {
    const std::uint32_t face_index = face_towards(polytope, d);
    const Polytope::Face& face = polytope.faces[face_index];
    if (face.normal.dot(d) >= kAhead) {
      Patch patch;
      patch.kind = Patch::Kind::polygon;
      patch.normal = face.normal;
      const auto loop = polytope.loop(face);
      const std::size_t count = std::min<std::size_t>(loop.size(), Patch::kMaxCorners);
      for (std::size_t i = 0; i < count; ++i) {
        const std::uint32_t vertex = loop[i * loop.size() / count];
        add(patch, polytope.vertices[vertex], vertex);
      }
      patch.centre = patch.corners[0];
      patch.width = face.width;
      return patch;
    }
    const std::uint32_t vertex = descend(polytope, -d, 0, -kInfinity).vertex;
    double least = kAside;
    const Polytope::Edge* across = nullptr;
    for (const Polytope::Edge& edge : polytope.edges) {
      if (edge.tail != vertex && edge.head != vertex) continue;
      const Vec3 along = polytope.vertices[edge.head] - polytope.vertices[edge.tail];
      const double slope = std::abs(along.dot(d)) / along.norm();
      if (slope < least) least = slope, across = &edge;
    }
    if (across == nullptr) return at_point(polytope.vertices[vertex], vertex);
    Patch patch = along(polytope.vertices[across->tail], polytope.vertices[across->head], 0);
    patch.names[0] = across->tail;
    patch.names[1] = across->head;
    return patch;
  }

  template <typename Other>  // not convex, or without a furthest point
  Patch operator()(const Other&) const {
    return at_point(Vec3::Zero(), 0);
  }
  Patch operator()(const Sphere&) const { return at_point(Vec3::Zero(), 0); }
  Patch operator()(const Ellipsoid& e) const {
    return at_point(e.half_axes.cwiseProduct(e.half_axes.cwiseProduct(d).normalized()), 0);
  }
  Patch operator()(const Capsule& c) const {
    if (std::abs(d.z()) < kAside) return along({0, 0, -c.half_length}, {0, 0, c.half_length}, 0);
    return at_point({0, 0, std::copysign(c.half_length, d.z())}, d.z() < 0.0 ? 0 : 1);
  }
  Patch operator()(const Cylinder& c) const {
    const double z = std::copysign(c.half_length, d.z());
    const std::uint32_t cap = z < 0.0 ? 16 : 32;
    if (std::abs(d.z()) > kAhead) return disc(c.radius, z, cap);
    if (std::abs(d.z()) < kAside)
      return along(on_rim(c.radius, -c.half_length), on_rim(c.radius, c.half_length), 0);
    return at_point(on_rim(c.radius, z), z < 0.0 ? 0 : 1);
  }
  Patch operator()(const Cone& c) const {
    if (d.z() < -kAhead) return disc(c.radius, -c.half_length, 16);
    const Vec3 rim = on_rim(c.radius, -c.half_length), apex(0, 0, c.half_length);
    const Vec3 side = (apex - rim).normalized();
    if (std::abs(side.dot(d)) < kAside) return along(rim, apex, 0);
    return side.dot(d) > 0.0 ? at_point(apex, 1) : at_point(rim, 0);
  }
  Patch operator()(const Box& b) const { return of_polytope(BoxPolytope(b)); }
  Patch operator()(const HullPointer& h) const { return of_polytope(*h); }
};

/// Collects pairs of points, one of each body, that lie behind each other along n.
struct FeatureMeeting {
  const PatchContact& contact;
  ManifoldBuilder& builder;
  double lowest = kInfinity;

  void add(const Vec3& p_a, const Vec3& p_b, std::uint32_t name) {
    const Vec3& n = contact.normal_A;
    const double apart = n.dot(p_b - p_a) - contact.rounding_a - contact.rounding_b;
    // What is inside an outline only by its tolerance could seem deeper than the shapes are.
    const double separation = std::max(contact.separation, apart);
    lowest = std::min(lowest, separation);
    builder.add(middle(p_a, p_b), separation, name);
  }
  /// The pair that the search found: its separation is exact even where its points are not.
  void add_deepest() {
    lowest = contact.separation;
    builder.add(middle(contact.p_A, contact.p_B), contact.separation, mix_features(0, 0, 7));
  }
  Vec3 middle(const Vec3& p_a, const Vec3& p_b) const {
    return 0.5 * (p_a + p_b) + (0.5 * (contact.rounding_a - contact.rounding_b)) * contact.normal_A;
  }
};

/// Where the line through p along n meets the patch's plane.
Vec3 drop(const Patch& flat, const Vec3& p, const Vec3& n) {
  return p + (flat.normal.dot(flat.centre - p) / flat.normal.dot(n)) * n;
}

std::size_t next_corner(const Patch& patch, std::size_t i) {
  return i + 1 == static_cast<std::size_t>(patch.count) ? 0 : i + 1;
}
std::size_t num_edges(const Patch& patch) {
  return patch.kind == Patch::Kind::line      ? 1
         : patch.kind == Patch::Kind::polygon ? static_cast<std::size_t>(patch.count)
                                              : 0;
}

/// Is p, a point of the patch's plane, inside its outline?
bool contains(const Patch& flat, const Vec3& p) {
  const double tolerance = kOutside * flat.width;
  if (flat.kind == Patch::Kind::disc) return (p - flat.centre).norm() <= flat.radius + tolerance;
  for (std::size_t i = 0; i < static_cast<std::size_t>(flat.count); ++i) {
    const Vec3 along = flat.corners[next_corner(flat, i)] - flat.corners[i];
    if (along.cross(p - flat.corners[i]).dot(flat.normal) < -tolerance * along.norm()) return false;
  }
  return true;
}

/// Parameters in (0, 1) at which the line tail + s (head - tail), in the flat's plane, crosses its outline.
template <typename Visit>
void visit_crossings(const Patch& flat, const Vec3& tail, const Vec3& head, Visit&& visit) {
  const Vec3 along = head - tail;
  const auto visit_inside = [&](double s, std::uint32_t name) {
    if (s > 0.0 && s < 1.0) visit(s, name);
  };
  if (flat.kind == Patch::Kind::disc) {
    const Vec3 from = tail - flat.centre;
    const double aa = along.squaredNorm(), ab = along.dot(from);
    const double root2 = ab * ab - aa * (from.squaredNorm() - flat.radius * flat.radius);
    if (!(root2 > 0.0)) return;
    visit_inside((-ab - std::sqrt(root2)) / aa, 0);
    visit_inside((-ab + std::sqrt(root2)) / aa, 1);
    return;
  }
  for (std::size_t i = 0; i < static_cast<std::size_t>(flat.count); ++i) {
    const std::size_t j = next_corner(flat, i);
    const Vec3 outward = (flat.corners[j] - flat.corners[i]).cross(flat.normal);
    const double from = outward.dot(tail - flat.corners[i]), rise = outward.dot(along);
    if (from * (from + rise) >= 0.0) continue;
    const double s = -from / rise;
    if (contains(flat, tail + s * along)) visit_inside(s, mix_features(flat.names[i], flat.names[j]));
  }
}

/// Two discs that face each other: where their rims cross, as points of A's rim.
template <typename Visit>
void visit_rim_crossings(const Patch& a, const Patch& b, const Vec3& n, Visit&& visit) {
  const Vec3 apart = drop(a, b.centre, n) - a.centre;
  const double distance = apart.norm();
  if (!(distance > std::abs(a.radius - b.radius) && distance < a.radius + b.radius)) return;
  const double along = 0.5 * (distance + (a.radius - b.radius) * (a.radius + b.radius) / distance);
  const double across = std::sqrt(std::max(0.0, a.radius * a.radius - along * along));
  const Vec3 side = a.normal.cross(apart / distance);
  visit(a.centre + apart * (along / distance) + across * side, 0);
  visit(a.centre + apart * (along / distance) - across * side, 1);
}

/// Lines that run side by side (within 1e-3 rad): the ends of their common part.
void meet_lines(const Patch& a, const Patch& b, FeatureMeeting& meeting) {
  constexpr double kParallelSides = 1e-6;  // sin^2
  const Vec3 along_a = a.corners[1] - a.corners[0], along_b = b.corners[1] - b.corners[0];
  const double aa = along_a.squaredNorm(), ab = along_a.dot(along_b);
  if (along_a.cross(along_b).squaredNorm() > kParallelSides * aa * along_b.squaredNorm()) return;
  const double from = along_a.dot(b.corners[0] - a.corners[0]) / aa, rise = ab / aa;
  const double low = std::max(0.0, std::min(from, from + rise)),
               high = std::min(1.0, std::max(from, from + rise));
  if (low > high) return;
  for (const double s : {low, high}) {
    meeting.add(a.corners[0] + s * along_a, b.corners[0] + ((s - from) / rise) * along_b,
                mix_features(s == low ? 0 : 1, 0, 6));
  }
}

void meet(const Patch& a, const Patch& b, FeatureMeeting& meeting) {
  const Vec3& n = meeting.contact.normal_A;
  if (b.is_flat()) {
    for (std::size_t i = 0; i < static_cast<std::size_t>(a.count); ++i) {
      const Vec3 foot = drop(b, a.corners[i], n);
      if (contains(b, foot)) meeting.add(a.corners[i], foot, mix_features(a.names[i], 0, 1));
    }
    for (std::size_t i = 0; i < num_edges(a); ++i) {
      const Vec3 &tail = a.corners[i], &head = a.corners[next_corner(a, i)];
      const Vec3 tail_b = drop(b, tail, n), head_b = drop(b, head, n);
      visit_crossings(b, tail_b, head_b, [&](double s, std::uint32_t name) {
        meeting.add(tail + s * (head - tail), tail_b + s * (head_b - tail_b),
                    mix_features(a.names[i], name, 3));
      });
    }
  }
  if (a.is_flat()) {
    for (std::size_t i = 0; i < static_cast<std::size_t>(b.count); ++i) {
      const Vec3 foot = drop(a, b.corners[i], n);
      if (contains(a, foot)) meeting.add(foot, b.corners[i], mix_features(b.names[i], 0, 2));
    }
    // Polygons of both were crossed above.
    for (std::size_t i = 0; i < num_edges(b) && !(b.is_flat() && num_edges(a) > 0); ++i) {
      const Vec3 &tail = b.corners[i], &head = b.corners[next_corner(b, i)];
      const Vec3 tail_a = drop(a, tail, n), head_a = drop(a, head, n);
      visit_crossings(a, tail_a, head_a, [&](double s, std::uint32_t name) {
        meeting.add(tail_a + s * (head_a - tail_a), tail + s * (head - tail),
                    mix_features(b.names[i], name, 4));
      });
    }
  }
  if (a.kind == Patch::Kind::disc && b.kind == Patch::Kind::disc) {
    visit_rim_crossings(a, b, n, [&](const Vec3& p, std::uint32_t name) {
      meeting.add(p, drop(b, p, n), mix_features(name, 0, 5));
    });
  }
}

/// The points that `add_points` finds, and the deepest pair if none of them is as deep. It then comes first: a point it is
/// merged with must not give its place to that depth.
template <typename AddPoints>
Manifold collect(const PatchContact& contact, double width, double margin, AddPoints&& add_points) {
  const double merge = kSame * width;
  ManifoldBuilder builder(contact.normal_A, margin, merge);
  FeatureMeeting meeting{contact, builder};
  add_points(meeting);
  if (!(meeting.lowest <= contact.separation + kSame * width)) {
    builder = ManifoldBuilder(contact.normal_A, margin, merge);
    meeting.add_deepest();
    add_points(meeting);
  }
  // A corner that is as deep within rounding is as deep.
  Manifold manifold = builder.finish();
  const auto end = manifold.points.begin() + manifold.count;
  const auto lowest = std::min_element(
      manifold.points.begin(), end, [](const auto& p, const auto& q) { return p.separation < q.separation; });
  if (lowest != end) lowest->separation = contact.separation;
  return manifold;
}

}  // namespace

Patch patch_towards(const ConvexPieces& shape, const Vec3& n_A) {
  const Vec3 d = shape.R().transpose() * n_A;
  const PatchOf part{d};
  Patch patch =
      shape.shape() != nullptr ? std::visit(part, *shape.shape()) : part.of_polytope(*shape.polytope());
  for (std::size_t i = 0; i < static_cast<std::size_t>(patch.count); ++i) {
    patch.corners[i] = shape.R() * patch.corners[i] + shape.p();
  }
  if (!patch.is_flat()) return patch;
  patch.normal = shape.R() * patch.normal;
  patch.centre = shape.R() * patch.centre + shape.p();
  return patch;
}

Manifold make_patch_manifold(const Patch& a, const Patch& b, const PatchContact& contact, double margin) {
  const double width = std::min(a.width > 0.0 ? a.width : b.width, b.width > 0.0 ? b.width : a.width);
  return collect(contact, width, margin, [&](FeatureMeeting& meeting) {
    if (a.kind == Patch::Kind::line && b.kind == Patch::Kind::line) meet_lines(a, b, meeting);
    meet(a, b, meeting);
  });
}

Manifold make_ground_manifold(const Patch& b, const Vec3& lowest, double margin) {
  const Vec3 foot(lowest.x(), lowest.y(), 0.0);
  const PatchContact contact{Vec3::UnitZ(), lowest.z(), foot, lowest, 0.0, 0.0};
  return collect(contact, b.width, margin, [&](FeatureMeeting& meeting) {
    for (std::size_t i = 0; i < static_cast<std::size_t>(b.count); ++i) {
      const Vec3& p = b.corners[i];
      meeting.add({p.x(), p.y(), 0.0}, p, b.names[i]);
    }
  });
}

}  // namespace tumble
