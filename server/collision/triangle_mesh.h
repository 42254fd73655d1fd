// A surface of triangles given by vertices and indices, with what contacts need to know of the neighbourhood of each
// triangle, and a tree of boxes over the triangles. Constant once built. In its own frame S [m].
#pragma once

#include <memory>

#include "collision/triangle_surface.h"

namespace tumble {

class TriangleMesh final : public TriangleSurface {
 public:
  using Corners = std::array<std::uint32_t, 3>;

  /// Vertices with the same coordinates become one. Triangles without area (two corners the same, or a height below
  /// 1e-12 of the longest edge) are dropped and counted. Throws std::invalid_argument that names the vertex or
  /// triangle: not finite, beyond 1e9 m, index out of range; or nothing left.
  TriangleMesh(const std::vector<Vec3>& vertices, const std::vector<Corners>& triangles);

  std::uint32_t triangle_count() const override { return static_cast<std::uint32_t>(triangles_.size()); }
  SurfaceTriangle triangle(std::uint32_t index) const override;
  TriangleNeighbours neighbours(std::uint32_t index) const override;
  bool is_top(std::uint32_t vertex, const Vec3& d) const override;
  std::size_t ring(std::uint32_t vertex, std::span<Vec3> others) const override;
  void visit(const Aabb& bounds, TriangleVisitor visitor) const override;

  const std::vector<Vec3>& vertices() const { return vertices_; }
  const std::vector<Corners>& triangles() const { return triangles_; }
  /// Triangles given but left out for having no area.
  std::size_t dropped() const { return dropped_; }
  /// Edges with a triangle on one side only, and those where more than two meet or two disagree on which side is out;
  /// both count as open.
  std::size_t open_edges() const { return open_edges_; }
  std::size_t odd_edges() const { return odd_edges_; }

 private:
  static constexpr std::uint32_t kNone = 0xffffffffu;
  /// In depth-first order: the first child follows its parent, `skip` is the next node that is not below this one.
  struct Node {
    Aabb bounds;
    std::uint32_t skip;
    std::uint32_t first, count;  // slice of order_; count 0: inner node
  };

  void take_vertices(const std::vector<Vec3>& vertices, std::vector<std::uint32_t>& welded);
  void take_triangles(const std::vector<Corners>& triangles, const std::vector<std::uint32_t>& welded);
  void find_neighbours();
  void find_rings();
  void build_tree();
  void build_node(std::uint32_t first, std::uint32_t count, const std::vector<Vec3>& middles);
  Aabb triangle_bounds(std::uint32_t index) const;
  Bend bend_at(std::uint32_t triangle, std::uint32_t edge) const;
  /// Corner of the neighbour across edge `edge` of `triangle` that is not on that edge.
  std::uint32_t far_vertex(std::uint32_t triangle, std::uint32_t edge) const;

  std::vector<Vec3> vertices_;
  std::vector<Corners> triangles_;
  std::vector<Vec3> normals_;
  std::vector<Corners> neighbours_;  // triangle across edge k, or kNone
  std::vector<std::array<Bend, 3>> bends_;
  std::vector<std::uint32_t> ring_offsets_, rings_;  // vertices joined to each vertex
  std::vector<Node> nodes_;
  std::vector<std::uint32_t> order_;  // triangles as the leaves hold them
  std::size_t dropped_ = 0, open_edges_ = 0, odd_edges_ = 0;
};

using TriangleMeshPointer = std::shared_ptr<const TriangleMesh>;

}  // namespace tumble
