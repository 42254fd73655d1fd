// A convex polyhedron: vertices, merged planar faces with counter-clockwise loops (seen from outside), unique edges.
// Built once from points (3-D quickhull with coplanar faces merged); constant afterwards and shared between bodies.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "collision/polytope.h"

namespace tumble {

/// The polytope and the memory that it views.
class ConvexHull : public Polytope {
 public:
  struct Parts {
    std::vector<Vec3> vertices{};  ///< [m], only points on the hull.
    std::vector<std::uint32_t> loops{};
    std::vector<Side> sides{};
    std::vector<Face> faces{};
    std::vector<Edge> edges{};
    std::vector<std::uint32_t> neighbour_offsets{}, neighbours{}, edges_around{};
    Vec3 centre = Vec3::Zero();  ///< Mean of the vertices [m].
    double radius = 0.0;
  };

  explicit ConvexHull(Parts parts);
  ConvexHull(const ConvexHull& other) : ConvexHull(other.parts_) {}
  ConvexHull& operator=(const ConvexHull&) = delete;
  ConvexHull(ConvexHull&&) = default;  // what vectors own moves without being copied, so views of it stay
  ConvexHull& operator=(ConvexHull&&) = delete;
  ~ConvexHull() = default;

  const Parts& parts() const { return parts_; }

 private:
  Parts parts_;
  std::vector<FourVectors> own_vertex_fours_;
  std::vector<FourFaces> own_face_fours_;
};

/// Fills in sides, edges, neighbours, edges around, widths, centre and radius from vertices, loops and faces.
void add_topology(ConvexHull::Parts& hull);

/// Largest |point| [m].
double bounding_radius(std::span<const Vec3> points);

/// Hull of at least 4 points [m] that span a volume. Throws std::invalid_argument naming the cause and the point
/// (fewer than 4 distinct points, non-finite coordinate, all in one plane within 1e-9 of their extent).
ConvexHull build_convex_hull(const std::vector<Vec3>& points);

}  // namespace tumble
