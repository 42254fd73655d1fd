// Newton's method for a direction in which the Minkowski difference A - B reaches least, on the pieces believed to reach
// furthest there: on one that is smooth, along the ridge of two, at the face of three. In A's frame.
#pragma once

#include <algorithm>
#include <array>
#include <optional>

#include "collision/convex_pieces.h"
#include "collision/difference_hull.h"

namespace tumble {

/// Of the shapes' size: slopes of a reach below this don't matter.
inline constexpr double kLevelSlope = 1e-11;

/// A direction that could be the best, with the pieces believed to be furthest there.
struct CandidateDirection {
  Vec3 n = Vec3::UnitZ();
  double h = kInfinity;  ///< How far A - B reaches along it [m].
  int count = 0;
  std::array<PiecePair, 3> pieces;
  bool optimal = false;     ///< No direction near it is better.
  Vec3 p_A = Vec3::Zero();  ///< If so, where the cores are nearest or deepest [m]: p_A - p_B = h n.
  Vec3 p_B = Vec3::Zero();

  void add(PiecePair pair) {
    const auto end = pieces.begin() + count;
    if (std::find(pieces.begin(), end, pair) == end && count < 3)
      pieces[static_cast<std::size_t>(count++)] = pair;
  }
  bool holds(PiecePair pair) const {
    const auto end = pieces.begin() + count;
    return std::find(pieces.begin(), end, pair) != end;
  }
};

class DirectionDescent {
 public:
  /// Keeps references.
  DirectionDescent(const ConvexPieces& a, const ConvexPieces& b)
      : a_(a), b_(b), size_(a.radius() + b.radius()) {}

  Vec3 point(PiecePair pair, const Vec3& n) const { return a_.point(pair.a, n) - b_.point(pair.b, -n); }

  enum class End { nowhere, under_way, arrived };
  /// On the candidate's pieces alone. Under way: at a place where other pieces reach further.
  End converge(CandidateDirection& c) const;
  /// Takes a pair in that reaches further, with its point k. Of four, the one is left out without which the ray along n
  /// passes best through the triangle of the others; of three in one plane with n, as round a common axis, the one on the
  /// same side of the ray. False: it is one of them.
  bool include(CandidateDirection& c, PiecePair further, const Vec3& k) const;
  /// Of the furthest points of its pieces, for the point of their plane that lies behind the origin along n.
  std::array<double, 3> weights(const CandidateDirection& c) const;
  /// Where A and B are deepest, mixed with these weights.
  void find_points(CandidateDirection& c) const;
  /// Tells a saddle, on which Newton's method may end in a symmetric pose, from a minimum.
  bool is_minimum(const CandidateDirection& c) const;
  /// Whether the reach of a pair has a minimum's curvature along n, up to the slack [m].
  bool bends_up(PiecePair pair, const Vec3& n, double slack = 0.0) const;

  /// The direction nearest by along which the first two pieces reach equally far, and the reach along u from there.
  struct Ridge {
    Vec3 n, u;
    double slope, second;  ///< Derivatives by the angle [m].
  };
  std::optional<Ridge> ridge_at(const CandidateDirection& c, const Vec3& n_near) const;

 private:
  Curvature curvature(PiecePair pair, const Vec3& n, const Vec3& u, const Vec3& v) const {
    return a_.curvature(pair.a, n, u, v) + b_.curvature(pair.b, -n, u, v);
  }
  double newton_step(double slope, double second) const;
  bool step_on_surface(CandidateDirection& c) const;
  std::optional<Vec3> onto_ridge(const CandidateDirection& c, const Vec3& n_near) const;
  bool step_on_ridge(CandidateDirection& c) const;
  bool step_to_face(CandidateDirection& c) const;
  bool is_furthest(const CandidateDirection& c) const;

  const ConvexPieces &a_, &b_;
  double size_;
};

}  // namespace tumble
