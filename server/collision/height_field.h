// A surface over a grid of heights: vertex (i, j) of the grid at (i dx, j dy, height) from the corner of the field, which
// is centred on S's z axis. Triangles are implied: cell (i, j) has two, split along the diagonal from (i, j) to
// (i + 1, j + 1); the one at larger x comes first. The outside is above (+z). In its own frame S [m].
#pragma once

#include <memory>

#include "collision/triangle_surface.h"

namespace tumble {

class HeightField final : public TriangleSurface {
 public:
  /// heights: row after row along +x, the row of least y first; columns * rows of them [m]. spacing: dx, dy > 0 [m].
  /// Throws std::invalid_argument that names the value: fewer than 2 columns or rows, more than 1e8 heights, a wrong
  /// count, not finite, beyond 1e9 m.
  HeightField(std::uint32_t columns, std::uint32_t rows, double dx, double dy, std::vector<double> heights);

  std::uint32_t triangle_count() const override { return 2 * (columns_ - 1) * (rows_ - 1); }
  SurfaceTriangle triangle(std::uint32_t index) const override;
  TriangleNeighbours neighbours(std::uint32_t index) const override;
  bool is_top(std::uint32_t vertex, const Vec3& d) const override;
  std::size_t ring(std::uint32_t vertex, std::span<Vec3> others) const override;
  void visit(const Aabb& bounds, TriangleVisitor visitor) const override;

  std::uint32_t columns() const { return columns_; }
  std::uint32_t rows() const { return rows_; }
  double dx() const { return dx_; }
  double dy() const { return dy_; }
  const std::vector<double>& heights() const { return heights_; }

 private:
  struct Range {
    double low, high;
  };
  /// A level of the pyramid: the range of heights over blocks of 2^(level + 1) cells a side.
  struct Level {
    std::uint32_t columns, rows;
    std::vector<Range> ranges;
  };
  /// Cells i0 <= i < i1, j0 <= j < j1.
  struct Cells {
    std::uint32_t i0, i1, j0, j1;
  };

  Vec3 vertex(std::uint32_t i, std::uint32_t j) const;
  /// One of the two triangles of a cell.
  struct Half {
    std::uint32_t i, j, half;
  };
  Half half_of(std::uint32_t triangle) const {
    const std::uint32_t cell = triangle / 2, cells = columns_ - 1;
    return {cell % cells, cell / cells, triangle % 2};
  }
  /// Corners (as grid vertices) of half `half` (0 or 1) of cell (i, j).
  std::array<std::uint32_t, 3> corners(std::uint32_t i, std::uint32_t j, std::uint32_t half) const;
  Vec3 at(std::uint32_t vertex_index) const {
    return vertex(vertex_index % columns_, vertex_index / columns_);
  }
  Vec3 normal_of(const std::array<std::uint32_t, 3>& corners) const;
  Range cell_range(std::uint32_t i, std::uint32_t j) const;
  void build_pyramid();
  void visit_block(std::size_t level, std::uint32_t i, std::uint32_t j, const Cells& cells,
                   const Aabb& bounds, TriangleVisitor visitor) const;
  void visit_cell(std::uint32_t i, std::uint32_t j, const Aabb& bounds, TriangleVisitor visitor) const;

  std::uint32_t columns_, rows_;
  double dx_, dy_;
  std::vector<double> heights_;
  std::vector<Level> levels_;
};

using HeightFieldPointer = std::shared_ptr<const HeightField>;

}  // namespace tumble
