// See height_field.h. The pyramid holds the range of heights over ever larger blocks of cells, so that a box far above
// the ground, or a large one, meets few of them.
#include "collision/height_field.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace tumble {
namespace {

/// A vertex is joined to four along the grid and two along the diagonals.
constexpr std::size_t kRing = 6;
constexpr std::uint64_t kMaxHeights = 100'000'000;

void check_spacing(const char* field, double spacing) {
  if (!(spacing > 0.0) || !(spacing <= kMaxCoordinate)) {
    throw std::invalid_argument(
        fmt::format("height field: {} must be finite, > 0 and <= 1e9 m ({})", field, spacing));
  }
}

}  // namespace

HeightField::HeightField(std::uint32_t columns, std::uint32_t rows, double dx, double dy,
                         std::vector<double> heights)
    : columns_(columns), rows_(rows), dx_(dx), dy_(dy), heights_(std::move(heights)) {
  const std::uint64_t count = std::uint64_t{columns} * rows;
  if (columns < 2 || rows < 2 || count > kMaxHeights) {
    throw std::invalid_argument(
        fmt::format("height field: needs 2 x 2 to 1e8 heights ({} x {})", columns, rows));
  }
  if (heights_.size() != count) {
    throw std::invalid_argument(
        fmt::format("height field: {} x {} needs {} heights ({})", columns, rows, count, heights_.size()));
  }
  check_spacing("dx", dx);
  check_spacing("dy", dy);
  for (std::size_t i = 0; i < heights_.size(); ++i) {
    if (!(std::abs(heights_[i]) <= kMaxCoordinate)) {
      throw std::invalid_argument(
          fmt::format("height field: height of column {}, row {} is not within 1e9 m ({})", i % columns,
                      i / columns, heights_[i]));
    }
  }
  const auto [low, high] = std::minmax_element(heights_.begin(), heights_.end());
  const Vec3 corner = vertex(0, 0);
  bounds_ = {Vec3(corner.x(), corner.y(), *low), Vec3(-corner.x(), -corner.y(), *high)};
  for (std::uint32_t v = 0; v < heights_.size(); ++v) radius_ = std::max(radius_, at(v).norm());
  build_pyramid();
}

Vec3 HeightField::vertex(std::uint32_t i, std::uint32_t j) const {
  // From the middle, so that opposite sides are mirror images to the bit.
  const double x = static_cast<double>(i) - 0.5 * static_cast<double>(columns_ - 1);
  const double y = static_cast<double>(j) - 0.5 * static_cast<double>(rows_ - 1);
  return {x * dx_, y * dy_, heights_[std::size_t{j} * columns_ + i]};
}

std::array<std::uint32_t, 3> HeightField::corners(std::uint32_t i, std::uint32_t j,
                                                  std::uint32_t half) const {
  const std::uint32_t v = j * columns_ + i, across = v + columns_ + 1;
  if (half == 0) return {v, v + 1, across};
  return {v, across, v + columns_};
}

Vec3 HeightField::normal_of(const std::array<std::uint32_t, 3>& corners) const {
  const Vec3 a = at(corners[0]);
  return (at(corners[1]) - a).cross(at(corners[2]) - a).normalized();
}

SurfaceTriangle HeightField::triangle(std::uint32_t index) const {
  const auto [i, j, half] = half_of(index);
  SurfaceTriangle triangle;
  triangle.vertex = corners(i, j, half);
  triangle.normal = normal_of(triangle.vertex);
  for (std::size_t k = 0; k < 3; ++k) triangle.corner[k] = at(triangle.vertex[k]);
  return triangle;
}

TriangleNeighbours HeightField::neighbours(std::uint32_t index) const {
  // Across edge k of half 0 (below, right, diagonal) and of half 1 (diagonal, above, left): the neighbour's cell.
  struct Step {
    int di, dj;
  };
  constexpr Step kAcross[2][3] = {{{0, -1}, {1, 0}, {0, 0}}, {{0, 0}, {0, 1}, {-1, 0}}};
  const auto [i, j, half] = half_of(index);
  const SurfaceTriangle own = triangle(index);
  TriangleNeighbours neighbours;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::int64_t ni = std::int64_t{i} + kAcross[half][k].di, nj = std::int64_t{j} + kAcross[half][k].dj;
    neighbours.bend[k] = Bend::open;
    if (ni < 0 || nj < 0 || ni >= columns_ - 1 || nj >= rows_ - 1) continue;
    const auto other = corners(static_cast<std::uint32_t>(ni), static_cast<std::uint32_t>(nj), 1 - half);
    const std::uint32_t tail = own.vertex[k], head = own.vertex[(k + 1) % 3];
    for (const std::uint32_t v : other) {
      if (v != tail && v != head) neighbours.beyond[k] = at(v);
    }
    neighbours.beyond_normal[k] = normal_of(other);
    neighbours.bend[k] = classify_bend(own.normal, own.corner[k], own.corner[(k + 1) % 3],
                                       neighbours.beyond[k], neighbours.beyond_normal[k]);
  }
  return neighbours;
}

bool HeightField::is_top(std::uint32_t vertex_index, const Vec3& d) const {
  std::array<Vec3, kRing> others;
  const std::size_t count = ring(vertex_index, others);
  const Vec3 p = at(vertex_index);
  return std::all_of(others.begin(), others.begin() + static_cast<std::ptrdiff_t>(count),
                     [&](const Vec3& other) { return stays_below(other, p, d); });
}

std::size_t HeightField::ring(std::uint32_t vertex_index, std::span<Vec3> others) const {
  constexpr int kSteps[kRing][2] = {{1, 0}, {1, 1}, {0, 1}, {-1, 0}, {-1, -1}, {0, -1}};
  const std::int64_t i = vertex_index % columns_, j = vertex_index / columns_;
  std::size_t count = 0;
  for (const auto& [di, dj] : kSteps) {
    if (i + di < 0 || j + dj < 0 || i + di >= columns_ || j + dj >= rows_ || count == others.size()) continue;
    others[count++] = vertex(static_cast<std::uint32_t>(i + di), static_cast<std::uint32_t>(j + dj));
  }
  return count;
}

HeightField::Range HeightField::cell_range(std::uint32_t i, std::uint32_t j) const {
  const std::size_t v = std::size_t{j} * columns_ + i;
  const auto [low, high] =
      std::minmax({heights_[v], heights_[v + 1], heights_[v + columns_], heights_[v + columns_ + 1]});
  return {low, high};
}

void HeightField::build_pyramid() {
  std::uint32_t columns = columns_ - 1, rows = rows_ - 1;
  while (columns > 1 || rows > 1) {
    Level level{(columns + 1) / 2, (rows + 1) / 2, {}};
    for (std::uint32_t j = 0; j < level.rows; ++j) {
      for (std::uint32_t i = 0; i < level.columns; ++i) {
        Range range =
            levels_.empty() ? cell_range(2 * i, 2 * j) : levels_.back().ranges[2 * j * columns + 2 * i];
        for (std::uint32_t part = 1; part < 4; ++part) {
          const std::uint32_t ci = 2 * i + part % 2, cj = 2 * j + part / 2;
          if (ci >= columns || cj >= rows) continue;
          const Range other = levels_.empty() ? cell_range(ci, cj) : levels_.back().ranges[cj * columns + ci];
          range = {std::min(range.low, other.low), std::max(range.high, other.high)};
        }
        level.ranges.push_back(range);
      }
    }
    columns = level.columns;
    rows = level.rows;
    levels_.push_back(std::move(level));
  }
}

void HeightField::visit(const Aabb& bounds, TriangleVisitor visitor) const {
  if (!bounds.overlaps(bounds_)) return;
  const Vec3 corner = bounds_.lower;
  // One cell more on every side than the division says: its rounding must not lose any.
  const auto first = [](double x, double step) {
    return static_cast<std::uint32_t>(std::max(0.0, std::floor(x / step) - 1.0));
  };
  const auto last = [](double x, double step, std::uint32_t cells) {
    return static_cast<std::uint32_t>(
        std::clamp(std::floor(x / step) + 2.0, 0.0, static_cast<double>(cells)));
  };
  const Cells cells{
      first(bounds.lower.x() - corner.x(), dx_), last(bounds.upper.x() - corner.x(), dx_, columns_ - 1),
      first(bounds.lower.y() - corner.y(), dy_), last(bounds.upper.y() - corner.y(), dy_, rows_ - 1)};
  visit_block(levels_.size(), 0, 0, cells, bounds, visitor);
}

/// Block (i, j) of 2^level cells a side; level 0 is a cell.
void HeightField::visit_block(std::size_t level, std::uint32_t i, std::uint32_t j, const Cells& cells,
                              const Aabb& bounds, TriangleVisitor visitor) const {
  const std::uint64_t i0 = std::uint64_t{i} << level, j0 = std::uint64_t{j} << level,
                      side = std::uint64_t{1} << level;
  if (i0 >= cells.i1 || i0 + side <= cells.i0 || j0 >= cells.j1 || j0 + side <= cells.j0) return;
  if (level == 0) return visit_cell(i, j, bounds, visitor);
  const Level& own = levels_[level - 1];
  const Range range = own.ranges[j * own.columns + i];
  if (range.high < bounds.lower.z() || range.low > bounds.upper.z()) return;
  for (std::uint32_t part = 0; part < 4; ++part) {
    visit_block(level - 1, 2 * i + part % 2, 2 * j + part / 2, cells, bounds, visitor);
  }
}

void HeightField::visit_cell(std::uint32_t i, std::uint32_t j, const Aabb& bounds,
                             TriangleVisitor visitor) const {
  for (std::uint32_t half = 0; half < 2; ++half) {
    Aabb box;
    for (const std::uint32_t v : corners(i, j, half)) box = box.united({at(v), at(v)});
    if (box.overlaps(bounds)) visitor(2 * (j * (columns_ - 1) + i) + half);
  }
}

}  // namespace tumble
