// The point nearest to the origin of a simplex of at most four points: the inner step of the distance search in
// distance.h. Points are differences b - a of points of two shapes [m], and remember both.
#pragma once

#include <array>

#include "math/types.h"

namespace tumble {

struct SimplexPoint {
  Vec3 a_A, b_A;    ///< Points of the two shapes, in A's frame.
  Vec3 b_B;         ///< The second in its own.
  Vec3 difference;  ///< b_A - a_A.
};

class Simplex {
 public:
  int count() const { return count_; }
  bool contains(const SimplexPoint& point) const;
  void add(const SimplexPoint& point) { points_[static_cast<std::size_t>(count_++)] = point; }

  /// Drops the points that do not carry the one nearest to the origin. Leaves four only around the origin.
  void reduce();

  /// The nearest point; zero if four points hold the origin.
  const Vec3& nearest() const { return nearest_; }
  /// Unit, towards the nearest point and exactly square to the face or edge that carries it: near contact the nearest
  /// point is short and its direction noise, but the edges of the shapes are long. Zero if there is no such direction.
  Vec3 normal() const;
  /// The points of the two shapes whose difference is the nearest point.
  Vec3 point_a() const;
  Vec3 point_b() const;
  const SimplexPoint& point(int i) const { return points_[static_cast<std::size_t>(i)]; }

 private:
  struct Candidate;
  Candidate nearest_of_point(int i) const;
  Candidate nearest_of_edge(int i, int j) const;
  Candidate nearest_of_triangle(int i, int j, int k) const;
  Candidate nearest_of_tetrahedron() const;
  const Vec3& w(int i) const { return points_[static_cast<std::size_t>(i)].difference; }

  int count_ = 0;
  std::array<SimplexPoint, 4> points_;
  std::array<double, 4> weights_{};
  Vec3 nearest_ = Vec3::Zero();
};

}  // namespace tumble
