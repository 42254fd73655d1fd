// A polytope inside the Minkowski difference A - B that grows by one furthest point after the other (the expanding
// polytope of van den Bergen, 2001, with a true horizon, and also used while the origin is still outside). Each face
// bounds from below how far the difference reaches along any direction whose ray leaves the polytope through it: what no
// face allows can be ruled out. Fixed memory.
#pragma once

#include <array>
#include <cstdint>

#include "math/types.h"

namespace tumble {

/// A smooth piece of A and one of B; see convex_pieces.h.
struct PiecePair {
  std::uint32_t a, b;
  bool operator==(const PiecePair&) const = default;
};

class DifferenceHull {
 public:
  struct Corner {
    Vec3 k, p_A;  ///< The point of the difference, and the point of A in it [m].
    PiecePair pieces;
  };
  struct Face {
    std::array<std::uint16_t, 3> corners;  ///< Counter-clockwise from outside.
    std::array<double, 3> weights;         ///< Of the corners in its point nearest to the origin.
    bool outside;                          ///< The origin lies on its outer side.
    bool closed;                           ///< Its directions need no more search.
    Vec3 normal;                           ///< Unit, outward.
    double offset;                         ///< [m]
    Vec3 direction;                        ///< Where to look for the next point: unit.
    double bound;  ///< The difference reaches at least this far along `direction` [m].
  };

  /// `size` of the difference [m], for the rounding of its points.
  explicit DifferenceHull(double size) : size_(size) {}
  /// Four corners of a tetrahedron; false if it is flat within rounding.
  bool start(const std::array<Corner, 4>& corners);
  /// False if the point is not beyond any face, or there is no more room.
  bool grow(const Corner& corner);

  /// The face that is least far out and not closed; null if there is none. While the origin is outside: the nearest.
  Face* least();
  bool empty() const { return num_faces_ == 0; }
  bool full() const { return num_points_ == kMaxPoints; }
  /// The face through which the ray from the origin along n leaves, its `weights` set for the point where it does.
  Face pierced_by(const Vec3& n) const;
  const Corner& corner(std::uint16_t i) const { return corners_[i]; }

 private:
  static constexpr std::size_t kMaxPoints = 192, kMaxFaces = 2 * kMaxPoints;
  void add_face(std::uint16_t i, std::uint16_t j, std::uint16_t k);

  double size_;
  std::size_t num_points_ = 0, num_faces_ = 0;
  std::array<Corner, kMaxPoints> corners_;
  std::array<Face, kMaxFaces> faces_;
};

}  // namespace tumble
