// Pairs of shapes for the benchmark of contacts, class by class, and the ways they go.
#pragma once

#include <algorithm>
#include <memory>
#include <random>
#include <vector>

#include "collision/height_field.h"
#include "collision/shape.h"
#include "math/pose.h"
#include "math/rotation.h"

namespace tumble::bench {

struct Pair {
  Shape a, b;
  Pose X_WA, X_WB;
  std::uint32_t part = 0;  ///< The triangle that is meant, if one of them is a surface.
};

class Source {
 public:
  double uniform(double low, double high) {
    return low + (high - low) * (static_cast<double>(engine_()) / 4294967296.0);
  }
  Vec3 vector(double low, double high) {
    Vec3 v;
    for (int i = 0; i < 3; ++i) v[i] = uniform(low, high);
    return v;
  }
  Quat rotation() {
    Quat q;
    for (int i = 0; i < 4; ++i) q.coeffs()[i] = uniform(-1.0, 1.0);
    return normalized(q);
  }

 private:
  std::mt19937 engine_{1};
};

/// B rests on A's top, turned by q, sunk in by depth [m].
inline Pair rest_on_top(Source& source, const Shape& a, double top, const Shape& b, const Quat& q,
                        double depth) {
  const double height = -(q * support(b, q.conjugate() * -Vec3::UnitZ())).z();
  const Pose X_WA{source.rotation(), source.vector(-10.0, 10.0)};
  return {a, b, X_WA, X_WA * Pose{q, Vec3(0.1, 0.05, top + height - depth)}};
}

/// Two shapes that touch along a random direction, with `depth` [m] of overlap.
inline Pair touching(Source& source, const Shape& a, const Shape& b, double depth) {
  const Quat q = source.rotation();
  const Vec3 n = source.vector(-1.0, 1.0).normalized();
  const Vec3 p = support(a, n) - q * support(b, q.conjugate() * -n) - depth * n;
  const Pose X_WA{source.rotation(), source.vector(-10.0, 10.0)};
  return {a, b, X_WA, X_WA * Pose{q, p}};
}
inline Pair box_face(Source& source) {
  const Box a{source.vector(0.3, 1.0)}, b{source.vector(0.3, 1.0)};
  const double yaw = source.uniform(-1.0, 1.0);
  return rest_on_top(source, a, a.half_extents.z(), b, exp_map(Vec3(0, 0, yaw)), 1e-4);
}

inline Pair box_edge(Source& source) {
  const Box a{source.vector(0.3, 1.0)}, b{source.vector(0.3, 1.0)};
  const double roll_a = source.uniform(0.5, 1.0), roll_b = source.uniform(0.5, 1.0),
               yaw = source.uniform(0.4, 2.7);
  const Quat q_A = exp_map(Vec3(roll_a, 0, 0)), q_B = exp_map(Vec3(0, 0, yaw)) * exp_map(Vec3(roll_b, 0, 0));
  const Vec3 roof = q_A * Vec3(0, a.half_extents.y(), a.half_extents.z());
  const Vec3 floor = q_B * Vec3(0, -b.half_extents.y(), -b.half_extents.z());
  const Pose X_W{source.rotation(), source.vector(-10.0, 10.0)};
  return {a, b, X_W * Pose{q_A, -roof}, X_W * Pose{q_B, -floor - Vec3(0, 0, 1e-4)}};
}

inline Pair box_deep(Source& source) {
  const Box a{source.vector(0.3, 1.0)}, b{source.vector(0.3, 1.0)};
  const Pose X_WA{source.rotation(), source.vector(-10.0, 10.0)};
  const Pose X_AB{source.rotation(), source.vector(-0.4, 0.4)};
  return {a, b, X_WA, X_WA * X_AB};
}

inline Pair box_pair(Source& source, double depth) {
  const Box a{source.vector(0.3, 1.0)}, b{source.vector(0.3, 1.0)};
  return touching(source, a, b, depth);
}
/// About as often apart as not.
inline Pair box_pass(Source& source) {
  return box_pair(source, source.uniform(-0.05, 0.02));
}
inline Pair box_apart(Source& source) {
  return box_pair(source, -0.05);
}

/// 53 % lie on each other, the others are apart, and all stay so: the mixture behind the figure asked for resting pairs.
inline Pair box_calm(Source& source) {
  const double choice = source.uniform(0.0, 1.0), gap = source.uniform(1e-3, 0.05);
  return choice < 0.53 ? box_face(source) : box_pair(source, -gap);
}

inline Pair sphere_sphere(Source& source) {
  const Pose X_WA{Quat::Identity(), source.vector(-10.0, 10.0)};
  const Vec3 d = source.vector(-1.0, 1.0).normalized();
  return {Sphere{0.5}, Sphere{0.4}, X_WA, {Quat::Identity(), X_WA.p + 0.8999 * d}};
}

/// 32 random points on a sphere of radius 0.5.
inline HullPointer hull32(Source& source) {
  std::vector<Vec3> points;
  for (int i = 0; i < 32; ++i) points.push_back(0.5 * source.vector(-1.0, 1.0).normalized());
  return std::make_shared<const ConvexHull>(build_convex_hull(points));
}

inline Pair hull_pair(Source& source, double depth) {
  static const HullPointer hull = hull32(source);
  return touching(source, hull, hull, depth);
}
inline Pair hull_shallow(Source& source) {
  return hull_pair(source, 1e-3);
}
inline Pair hull_deep(Source& source) {
  return hull_pair(source, 0.1);
}
inline Pair hull_apart(Source& source) {
  return hull_pair(source, -0.05);
}

/// A vertex of B lies in the middle of a face of A, 0.1 mm deep.
inline Pair hull_rest(Source& source) {
  static const HullPointer hull = hull32(source);
  const Polytope::Face& face = hull->faces[static_cast<std::size_t>(source.uniform(0.0, 20.0))];
  Vec3 middle = Vec3::Zero();
  for (std::uint32_t k = 0; k < face.count; ++k)
    middle += hull->vertices[hull->loops[face.first + k]] / face.count;
  const Quat q = source.rotation();
  const Vec3 p = middle - q * support(hull, q.conjugate() * -face.normal) - 1e-4 * face.normal;
  const Pose X_WA{source.rotation(), source.vector(-10.0, 10.0)};
  return {hull, hull, X_WA, X_WA * Pose{q, p}};
}
/// As box_calm, 54 %.
inline Pair hull_calm(Source& source) {
  const double choice = source.uniform(0.0, 1.0), gap = source.uniform(1e-3, 0.05);
  return choice < 0.54 ? hull_rest(source) : hull_pair(source, -gap);
}
/// About as often apart as not.
inline Pair hull_pass(Source& source) {
  return hull_pair(source, source.uniform(-0.05, 0.02));
}

inline const Box kBox{Vec3(0.5, 0.4, 0.3)};
inline const Cylinder kCylinder{0.4, 0.5};
inline const Cone kCone{0.4, 0.5};
inline const Ellipsoid kEllipsoid{Vec3(0.5, 0.4, 0.3)};

inline Pair cylinder_on_box(Source& source) {
  return rest_on_top(source, Box{Vec3(1.0, 1.0, 0.5)}, 0.5, kCylinder, Quat::Identity(), 1e-4);
}
inline Pair box_cylinder(Source& source) {
  return touching(source, kBox, kCylinder, 1e-3);
}
inline Pair box_cylinder_deep(Source& source) {
  return touching(source, kBox, kCylinder, 0.1);
}
inline Pair cylinder_cylinder(Source& source) {
  return touching(source, kCylinder, kCylinder, 1e-3);
}
inline Pair cylinder_pass(Source& source) {
  return touching(source, kCylinder, kCylinder, source.uniform(-0.05, 0.02));
}
inline Pair cone_cylinder(Source& source) {
  return touching(source, kCone, kCylinder, 1e-3);
}
inline Pair ellipsoid_ellipsoid(Source& source) {
  return touching(source, kEllipsoid, kEllipsoid, 1e-3);
}
inline Pair ellipsoid_ellipsoid_deep(Source& source) {
  return touching(source, kEllipsoid, kEllipsoid, 0.1);
}
inline Pair sphere_ellipsoid(Source& source) {
  return touching(source, Sphere{0.4}, kEllipsoid, 1e-3);
}

/// Hills and hollows, 40 by 40 cells of 0.5 m.
inline HeightFieldPointer hills() {
  std::vector<double> heights;
  for (int j = 0; j <= 40; ++j) {
    for (int i = 0; i <= 40; ++i) heights.push_back(0.4 * ((i * i + 3 * j) % 7) / 7.0 - 0.01 * (i % 5) * j);
  }
  return std::make_shared<const HeightField>(41, 41, 0.5, 0.5, std::move(heights));
}

/// A body turned at random, its lowest point 1 mm deep in the middle of a triangle of the hills: with one of the triangles
/// that its box meets.
inline Pair on_terrain(Source& source, const Shape& body) {
  static const HeightFieldPointer field = hills();
  const auto pick = [&](double low, double high) {
    return static_cast<std::uint32_t>(source.uniform(low, high));
  };
  const SurfaceTriangle triangle = field->triangle(pick(0.0, field->triangle_count()));
  const Quat q = source.rotation();
  const Vec3 middle = (triangle.corner[0] + triangle.corner[1] + triangle.corner[2]) / 3.0;
  const Vec3 p = middle - q * support(body, q.conjugate() * -triangle.normal) - 1e-3 * triangle.normal;
  std::vector<std::uint32_t> near;
  field->query(compute_aabb(body, {q, p}), near);
  return {body, field, {q, p}, Pose{}, near[pick(0.0, static_cast<double>(near.size()))]};
}
inline Pair sphere_on_terrain(Source& source) {
  return on_terrain(source, Sphere{0.3});
}
inline Pair box_on_terrain(Source& source) {
  return on_terrain(source, kBox);
}
inline Pair capsule_on_terrain(Source& source) {
  return on_terrain(source, Capsule{0.2, 0.3});
}
inline Pair cylinder_on_terrain(Source& source) {
  return on_terrain(source, kCylinder);
}
inline Pair cone_on_terrain(Source& source) {
  return on_terrain(source, kCone);
}
inline Pair ellipsoid_on_terrain(Source& source) {
  return on_terrain(source, kEllipsoid);
}
inline Pair hull_on_terrain(Source& source) {
  static const HullPointer hull = hull32(source);
  return on_terrain(source, hull);
}

using Make = Pair (*)(Source&);

/// Pairs of one kind; with every step B moves by about `pace` [m] and [rad].
struct Course {
  Make make;
  double pace;
  bool shuffled;
};

/// Pairs and the way of each B: with every step it has moved by about `pace` [m] and [rad], to and fro along one direction
/// for 64 steps each.
class Trace {
 public:
  static constexpr std::size_t kPairs = 512;

  explicit Trace(const Course& course) : turns_(course.pace > 0.0 ? 64 : 1), shuffled_(course.shuffled) {
    Source source;
    for (std::size_t i = 0; i < kPairs; ++i) pairs_.push_back(course.make(source));
    std::vector<Pair> now = pairs_;
    const double pace = course.pace;
    for (std::size_t i = 0; i < kPairs; ++i) {
      shift_.push_back(source.vector(-pace, pace));
      turn_.push_back(exp_map(source.vector(-pace, pace)));
    }
    for (std::size_t step = 0; step < turns_; ++step) {
      for (std::size_t i = 0; i < kPairs; ++i) {
        X_WB_.push_back(now[i].X_WB);
        now[i].X_WB = {normalized(turn_[i] * now[i].X_WB.q), now[i].X_WB.p + shift_[i]};
      }
    }
  }

  const std::vector<Pair>& pairs() const { return pairs_; }
  /// Goes on to the next pair or, after all, to the first one a step later.
  void advance() {
    if (++visited_ == kPairs) {
      visited_ = 0;
      step_ = (step_ + 1) % (2 * turns_);
      if (shuffled_) stride_ = (5 * stride_ + 2) % (1u << 30);  // odd, so that every pair is visited
    }
    pair_ = (pair_ + stride_) % kPairs;
  }
  std::size_t index() const { return pair_; }
  const Pair& pair() const { return pairs_[pair_]; }
  const Pose& X_WB() const { return X_WB_[std::min(step_, 2 * turns_ - 1 - step_) * kPairs + pair_]; }

 private:
  std::size_t turns_, pair_ = 0, visited_ = 0, step_ = 0, stride_ = 1;
  bool shuffled_;
  std::vector<Pair> pairs_;
  std::vector<Vec3> shift_;
  std::vector<Quat> turn_;
  std::vector<Pose> X_WB_;  // step by step
};

}  // namespace tumble::bench
