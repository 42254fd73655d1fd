// See ray_cast.h. A convex shape is cut out of the ray by one boundary after the other: planes, and quadrics of which
// the roots are taken about the point of the ray nearest to the shape's centre, where little cancels.
#include "collision/ray_cast.h"

#include <algorithm>
#include <cmath>

namespace tumble {
namespace {

/// The part of a line inside a convex shape, as boundaries cut it down.
class Crossing {
 public:
  explicit Crossing(const Ray& line) : line_(line) {}

  /// Keeps n . x <= offset (n unit).
  void clip_plane(const Vec3& n, double offset, std::uint32_t feature) {
    const double height = n.dot(line_.origin) - offset, rise = n.dot(line_.direction);
    if (rise < 0.0) {
      enter(height / -rise, n, feature);
    } else if (rise > 0.0) {
      leave(-height / rise);
    } else if (height >= 0.0) {
      leave(-kInfinity);
    }
  }
  void enter(double distance, const Vec3& normal, std::uint32_t feature) {
    if (distance <= enter_) return;
    enter_ = distance;
    normal_ = normal;
    feature_ = feature;
  }
  void leave(double distance) { leave_ = std::min(leave_, distance); }
  double enters_at() const { return enter_; }

  /// For a ray that starts at `start` on the line.
  std::optional<RayHit> hit(double start, double length) const {
    const double distance = enter_ - start;
    if (enter_ > leave_ || leave_ <= start || distance > length) return std::nullopt;
    if (distance < 0.0) return RayHit{0.0, -line_.direction, feature_, true};
    return RayHit{distance, normal_, feature_, false};
  }

 private:
  const Ray& line_;
  double enter_ = -kInfinity, leave_ = kInfinity;
  Vec3 normal_ = Vec3::Zero();
  std::uint32_t feature_ = 0;
};

/// Roots of a t^2 + 2 b t + c <= 0 for a > 0, without cancellation; empty (first > second) if there are none.
struct Roots {
  double first = kInfinity, second = -kInfinity;
};
Roots solve(double a, double b, double c) {
  const double discriminant = b * b - a * c;
  if (!(discriminant >= 0.0)) return {};
  const double q = -(b + std::copysign(std::sqrt(discriminant), b));
  const double far = q / a, near = q != 0.0 ? c / q : far;
  return {std::min(far, near), std::max(far, near)};
}

struct Cast {
  /// Its origin is the point of the ray nearest to the shape's origin; the ray starts at `start` <= or > 0.
  const Ray& line;
  double start, length;

  std::optional<RayHit> operator()(const HalfSpace&) const {
    Crossing crossing(line);
    crossing.clip_plane(Vec3::UnitZ(), 0.0, 0);
    return crossing.hit(start, length);
  }
  std::optional<RayHit> operator()(const Sphere& s) const { return cast_ball(Vec3::Zero(), s.radius, 0); }
  std::optional<RayHit> operator()(const Capsule& c) const {
    // A union: what is met first. The side's caps lie inside the balls.
    std::optional<RayHit> first = cast_side(c.radius, c.half_length);
    for (const double side : {1.0, -1.0}) {
      const auto ball = cast_ball({0.0, 0.0, side * c.half_length}, c.radius, side > 0.0 ? 1 : 2);
      if (ball && (!first || ball->distance < first->distance)) first = ball;
    }
    return first;
  }
  std::optional<RayHit> operator()(const Box& b) const {
    Crossing crossing(line);
    for (std::uint32_t i = 0; i < 6; ++i) {
      const int axis = static_cast<int>(i / 2);
      crossing.clip_plane((i % 2 == 0 ? 1.0 : -1.0) * Vec3::Unit(axis), b.half_extents[axis], i);
    }
    return crossing.hit(start, length);
  }
  std::optional<RayHit> operator()(const HullPointer& h) const {
    Crossing crossing(line);
    for (std::uint32_t i = 0; i < h->faces.size(); ++i) {
      crossing.clip_plane(h->faces[i].normal, h->faces[i].offset, i);
    }
    return crossing.hit(start, length);
  }
  std::optional<RayHit> operator()(const TriangleMeshPointer& m) const { return cast_surface(*m); }
  std::optional<RayHit> operator()(const HeightFieldPointer& h) const { return cast_surface(*h); }
  std::optional<RayHit> operator()(const Cylinder& c) const { return cast_side(c.radius, c.half_length); }
  std::optional<RayHit> operator()(const Cone& c) const {
    Crossing crossing(line);
    crossing.clip_plane(Vec3::UnitZ(), c.half_length, 1);
    crossing.clip_plane(-Vec3::UnitZ(), c.half_length, 2);
    clip_cone(crossing, c.radius / (2.0 * c.half_length), c.half_length);
    return crossing.hit(start, length);
  }
  std::optional<RayHit> operator()(const Ellipsoid& e) const {
    // In units of the half axes it is a ball; about the ray's nearest point to the centre there.
    const Vec3 d = line.direction.cwiseQuotient(e.half_axes);
    Vec3 o = line.origin.cwiseQuotient(e.half_axes);
    const double middle = -o.dot(d) / d.squaredNorm();
    o += middle * d;
    const double off = o.norm();
    if (off > 1.0) return std::nullopt;
    const double half_chord = std::sqrt((1.0 - off) * (1.0 + off) / d.squaredNorm());
    Crossing crossing(line);
    crossing.enter(middle - half_chord, (o - half_chord * d).cwiseQuotient(e.half_axes).normalized(), 0);
    crossing.leave(middle + half_chord);
    return crossing.hit(start, length);
  }

 private:
  /// Piece by piece of the way through the surface's bounds, so that a long slanted ray does not visit all triangles. The
  /// back of a surface is not met. The feature is the triangle.
  std::optional<RayHit> cast_surface(const TriangleSurface& surface) const {
    constexpr int kPieces = 64;
    const double reach = 2.0 * surface.radius();
    const double from = std::max(start, -reach), to = std::min(start + length, reach);
    std::optional<RayHit> first;
    const auto meet = [&](std::uint32_t index) {
      const SurfaceTriangle t = surface.triangle(index);
      const Ray ray{line.at(start), line.direction, first ? first->distance : length};
      const auto hit = cast_ray_on_triangle(t.corner[0], t.corner[1], t.corner[2], ray);
      if (!hit || hit->feature != 0) return;
      // The ray ends at the first, so this is no further; of equals that of lowest index.
      if (first && hit->distance == first->distance && index > first->feature) return;
      first = RayHit{hit->distance, t.normal, index, false};
    };
    const double step = (to - from) / kPieces;
    for (int piece = 0; piece < kPieces && from <= to; ++piece) {
      const double begin = from + piece * step;
      // What was met further on, on a triangle that reaches into an earlier piece, may yet have something before it.
      if (first && first->distance < begin - start) break;
      const Vec3 p = line.at(begin), q = line.at(begin + step);
      surface.visit(Aabb{p.cwiseMin(q), p.cwiseMax(q)}.grown(1e-9 * reach), meet);
    }
    return first;
  }
  std::optional<RayHit> cast_ball(const Vec3& centre, double radius, std::uint32_t feature) const {
    const double middle = line.direction.dot(centre - line.origin);
    const double off = (line.at(middle) - centre).norm();
    if (off > radius) return std::nullopt;
    const double half_chord = std::sqrt((radius - off) * (radius + off));
    Crossing crossing(line);
    crossing.enter(middle - half_chord, (line.at(middle - half_chord) - centre).normalized(), feature);
    crossing.leave(middle + half_chord);
    return crossing.hit(start, length);
  }
  /// The round part of a cylinder along z, closed by flat caps.
  std::optional<RayHit> cast_side(double radius, double half_length) const {
    Crossing crossing(line);
    crossing.clip_plane(Vec3::UnitZ(), half_length, 1);
    crossing.clip_plane(-Vec3::UnitZ(), half_length, 2);
    clip_tube(crossing, radius);
    return crossing.hit(start, length);
  }
  /// The cone opens downwards from its apex at z = top, by `slope` a metre. Of its quadric only that half counts, which
  /// the plane at the apex leaves.
  void clip_cone(Crossing& crossing, double slope, double top) const {
    const auto o = line.origin.head<2>(), d = line.direction.head<2>();
    const double radius = slope * (top - line.origin.z()), widening = -slope * line.direction.z();
    const double a = (d.norm() - widening) * (d.norm() + widening);
    const double b = o.dot(d) - radius * widening, c = (o.norm() - radius) * (o.norm() + radius);
    const auto enter = [&](double distance) {
      const Vec3 p = std::isfinite(distance) ? line.at(distance) : line.origin;
      crossing.enter(distance, Vec3(p.x(), p.y(), slope * p.head<2>().norm()).normalized(), 0);
    };
    if (a > 0.0) {
      const Roots roots = solve(a, b, c);
      enter(roots.first);
      crossing.leave(roots.second);
      return;
    }
    // Steeper than the cone: from one half through the gap between them into the other. Rounded, the gap may vanish at
    // the apex.
    double first = -c / (2.0 * b), second = first;
    if (a < 0.0) {
      const Roots gap = solve(-a, -b, -c);
      const bool open = gap.first <= gap.second;
      first = open ? gap.first : -b / a;
      second = open ? gap.second : -b / a;
    }
    if (widening > 0.0) {
      enter(second);
    } else {
      crossing.leave(first);
    }
  }
  void clip_tube(Crossing& crossing, double radius) const {
    const auto o = line.origin.head<2>(), d = line.direction.head<2>();
    const double a = d.squaredNorm(), c = (o.norm() - radius) * (o.norm() + radius);
    if (a == 0.0) {
      if (c >= 0.0) crossing.leave(-kInfinity);
      return;
    }
    const Roots roots = solve(a, o.dot(d), c);
    const Vec3 p = std::isfinite(roots.first) ? line.at(roots.first) : line.origin;
    crossing.enter(roots.first, Vec3(p.x(), p.y(), 0.0).normalized(), 0);
    crossing.leave(roots.second);
  }
};

}  // namespace

std::optional<RayHit> cast_ray(const Shape& shape, const Ray& ray) {
  const double start = ray.direction.dot(ray.origin);
  const Ray line{ray.at(-start), ray.direction};
  return std::visit(Cast{line, start, ray.length}, shape);
}

std::optional<RayHit> cast_ray_on_triangle(const Vec3& a, const Vec3& b, const Vec3& c, const Ray& ray) {
  // Sheared so that the ray runs along its largest axis z: what is left is a point against a triangle in the plane.
  int z = 0;
  ray.direction.cwiseAbs().maxCoeff(&z);
  const int x = (z + 1) % 3, y = (z + 2) % 3;
  const double slope_x = ray.direction[x] / ray.direction[z], slope_y = ray.direction[y] / ray.direction[z];
  const auto shear = [&](const Vec3& p) {
    const Vec3 d = p - ray.origin;
    return Vec3(d[x] - slope_x * d[z], d[y] - slope_y * d[z], d[z]);
  };
  const Vec3 p = shear(a), q = shear(b), r = shear(c);
  // The same products with the same roundings on both sides of an edge: equal and opposite, so no ray falls between.
  const auto area = [](const Vec3& s, const Vec3& t) { return s.x() * t.y() - s.y() * t.x(); };
  const double at_a = area(q, r), at_b = area(r, p), at_c = area(p, q), sum = at_a + at_b + at_c;
  const bool front = at_a >= 0.0 && at_b >= 0.0 && at_c >= 0.0;
  const bool back = at_a <= 0.0 && at_b <= 0.0 && at_c <= 0.0;
  if (!(front || back) || sum == 0.0) return std::nullopt;
  const double distance = (at_a * p.z() + at_b * q.z() + at_c * r.z()) / sum / ray.direction[z];
  if (!(distance >= 0.0 && distance <= ray.length)) return std::nullopt;
  const Vec3 n = (b - a).cross(c - a).stableNormalized();
  const bool from_front = n.dot(ray.direction) < 0.0;
  return RayHit{distance, from_front ? n : Vec3(-n), from_front ? 0u : 1u, false};
}

}  // namespace tumble
