// See convex_hull.h. Three stages: exact triangles on a grid (quickhull.h), coplanar triangles grown together into
// faces, then loops, edges and neighbours. Vertices and planes come from the original points.
#include "collision/convex_hull.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <stdexcept>
#include <tuple>

#include "collision/quickhull.h"

namespace tumble {
namespace {

constexpr std::uint32_t kNone = 0xffffffffu;

/// Points closer to one plane than this share of their extent span no volume worth the name.
constexpr double kNoVolume = 1e-9;

/// Triangles whose corners lie this near to a face's plane belong to the face, as a share of the extent: meshes in
/// single precision are coplanar to 6e-8. And at most this share of the body's depth below the face, for thin plates.
constexpr double kCoplanar = 2e-7;
constexpr double kCoplanarOfDepth = 1e-3;

struct GridPoints {
  std::vector<GridPoint> points;        // distinct
  std::vector<std::uint32_t> original;  // index of the first input point there
  double extent;                        // longest side of the bounding box [m]
};

GridPoints put_on_grid(const std::vector<Vec3>& points) {
  Vec3 lower = points[0], upper = points[0];
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3& p = points[i];
    if (!p.allFinite()) {
      throw std::invalid_argument(
          fmt::format("convex hull: point {} is not finite ({} {} {})", i, p.x(), p.y(), p.z()));
    }
    lower = lower.cwiseMin(p);
    upper = upper.cwiseMax(p);
  }
  GridPoints grid;
  grid.extent = (upper - lower).maxCoeff();
  const double scale = grid.extent > 0.0 ? static_cast<double>(kGridSize) / grid.extent : 0.0;
  if (!std::isfinite(grid.extent) || !std::isfinite(scale)) {
    throw std::invalid_argument(
        fmt::format("convex hull: an extent of {} m can't be computed with", grid.extent));
  }
  std::map<std::array<std::int64_t, 3>, std::uint32_t> seen;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3 at = (points[i] - lower) * scale;
    const std::array<std::int64_t, 3> cell = {std::llround(at.x()), std::llround(at.y()),
                                              std::llround(at.z())};
    if (!seen.emplace(cell, static_cast<std::uint32_t>(i)).second) continue;
    grid.points.push_back({cell[0], cell[1], cell[2]});
    grid.original.push_back(static_cast<std::uint32_t>(i));
  }
  if (grid.points.size() < 4) {
    throw std::invalid_argument(
        fmt::format("convex hull: {} distinct points, at least 4 are needed", grid.points.size()));
  }
  return grid;
}

/// Index of the point with the largest measure, the first of equals.
template <typename Measure>
std::pair<std::uint32_t, double> furthest(const std::vector<Vec3>& points, Measure measure) {
  std::pair<std::uint32_t, double> best{0, measure(points[0])};
  for (std::uint32_t i = 1; i < points.size(); ++i) {
    const double value = measure(points[i]);
    if (value > best.second) best = {i, value};
  }
  return best;
}

/// Four points that span as much as can be found by looking once each: two far apart, one far from their line, one far
/// from their plane.
std::array<std::uint32_t, 4> find_tetrahedron(const std::vector<Vec3>& points, double extent) {
  const auto distance_to = [&](const Vec3& q) { return [q](const Vec3& p) { return (p - q).norm(); }; };
  const std::uint32_t a = furthest(points, distance_to(points[0])).first;
  const std::uint32_t b = furthest(points, distance_to(points[a])).first;
  const Vec3 line = (points[b] - points[a]).normalized();
  const auto [c, from_line] =
      furthest(points, [&](const Vec3& p) { return line.cross(p - points[a]).norm(); });
  if (from_line <= kNoVolume * extent) throw std::invalid_argument("convex hull: all points are on one line");
  const Vec3 normal = line.cross(points[c] - points[a]).normalized();
  const auto [d, from_plane] =
      furthest(points, [&](const Vec3& p) { return std::abs(normal.dot(p - points[a])); });
  if (from_plane <= kNoVolume * extent)
    throw std::invalid_argument("convex hull: all points are in one plane");
  return {a, b, c, d};
}

/// Unit normal of a nearly planar loop: the mean over a fan, then made square to the longest edge. The cross
/// products of a thin loop lose digits, and along its length an error of the normal counts most.
template <typename Loop>
Vec3 loop_normal(const std::vector<Vec3>& points, const Loop& loop) {
  const Vec3& origin = points[loop[0]];
  Vec3 sum = Vec3::Zero(), longest = Vec3::Zero();
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Vec3& p = points[loop[i]];
    const Vec3& next = points[loop[(i + 1) % loop.size()]];
    sum += (p - origin).cross(next - origin);
    if ((next - p).squaredNorm() > longest.squaredNorm()) longest = next - p;
  }
  sum.normalize();
  return (sum - longest * (sum.dot(longest) / longest.squaredNorm())).normalized();
}

/// Assigns triangles to faces. A face grows from its largest triangle and stays a disc with a simple border: a triangle
/// joins over one edge if its far corner is new to the face, else over two edges.
class FaceMerger {
 public:
  FaceMerger(const std::vector<Vec3>& points, const std::vector<HullTriangle>& triangles, double extent)
      : points_(points), triangles_(triangles), extent_(extent), face_of_(triangles.size(), kNone) {}

  /// Loops of point indices, counter-clockwise.
  std::vector<std::vector<std::uint32_t>> merge() {
    std::vector<double> area(triangles_.size());
    std::vector<std::uint32_t> order(triangles_.size());
    for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
      order[t] = t;
      area[t] = area_vector(t).squaredNorm();
    }
    std::stable_sort(order.begin(), order.end(),
                     [&](std::uint32_t s, std::uint32_t t) { return area[s] > area[t]; });
    std::vector<std::vector<std::uint32_t>> loops;
    for (const std::uint32_t seed : order) {
      if (face_of_[seed] == kNone) loops.push_back(grow(seed, static_cast<std::uint32_t>(loops.size())));
    }
    return loops;
  }

 private:
  Vec3 area_vector(std::uint32_t t) const {
    const auto& v = triangles_[t].vertex;
    return (points_[v[1]] - points_[v[0]]).cross(points_[v[2]] - points_[v[0]]);
  }

  std::vector<std::uint32_t> grow(std::uint32_t seed, std::uint32_t face) {
    const Vec3 n = loop_normal(points_, triangles_[seed].vertex);
    const Vec3 origin = points_[triangles_[seed].vertex[0]];
    const double depth = furthest(points_, [&](const Vec3& p) { return n.dot(origin - p); }).second;
    const double tolerance = std::min(kCoplanar * extent_, kCoplanarOfDepth * depth);
    std::vector<std::uint32_t> loop(triangles_[seed].vertex.begin(), triangles_[seed].vertex.end());
    std::vector<std::uint32_t> members = {seed};
    face_of_[seed] = face;
    // A triangle that could not join yet may do so after its neighbours did: repeat until nothing joins.
    for (bool grown = true; grown;) {
      grown = false;
      for (std::size_t m = 0; m < members.size(); ++m) {
        for (const std::uint32_t next : triangles_[members[m]].neighbour) {
          if (face_of_[next] != kNone || !is_near(next, n, origin, tolerance) || !join(next, face, loop))
            continue;
          members.push_back(next);
          grown = true;
        }
      }
    }
    return loop;
  }

  bool is_near(std::uint32_t t, const Vec3& n, const Vec3& origin, double tolerance) const {
    return std::all_of(triangles_[t].vertex.begin(), triangles_[t].vertex.end(),
                       [&](std::uint32_t v) { return std::abs(n.dot(points_[v] - origin)) <= tolerance; });
  }

  bool join(std::uint32_t t, std::uint32_t face, std::vector<std::uint32_t>& loop) {
    const HullTriangle& triangle = triangles_[t];
    std::array<bool, 3> shared{};
    for (int e = 0; e < 3; ++e) shared[e] = face_of_[triangle.neighbour[e]] == face;
    const int count = shared[0] + shared[1] + shared[2];
    if (count == 1) {
      const int e = shared[0] ? 0 : shared[1] ? 1 : 2;
      const std::uint32_t head = triangle.vertex[(e + 1) % 3], far = triangle.vertex[(e + 2) % 3];
      if (std::find(loop.begin(), loop.end(), far) != loop.end()) return false;
      // The face runs through the edge the other way round: head -> tail becomes head -> far -> tail.
      loop.insert(std::find(loop.begin(), loop.end(), head) + 1, far);
    } else if (count == 2 && loop.size() > 3) {
      const int open = !shared[0] ? 0 : !shared[1] ? 1 : 2;
      loop.erase(std::find(loop.begin(), loop.end(), triangle.vertex[(open + 2) % 3]));
    } else {
      return false;  // it would close the surface
    }
    face_of_[t] = face;
    return true;
  }

  const std::vector<Vec3>& points_;
  const std::vector<HullTriangle>& triangles_;
  double extent_;
  std::vector<std::uint32_t> face_of_;
};

/// Drops the corners in which only two faces meet: they lie on the straight edge between them.
void drop_collinear(std::vector<std::vector<std::uint32_t>>& loops, std::size_t points) {
  std::vector<std::uint32_t> degree(points, 0);
  for (const auto& loop : loops) {
    for (const std::uint32_t v : loop) ++degree[v];
  }
  for (auto& loop : loops) {
    std::erase_if(loop, [&](std::uint32_t v) { return degree[v] < 3; });
    if (loop.size() < 3) throw std::invalid_argument("convex hull: too thin to tell its faces apart");
  }
}

/// Of a face, the inradius of regular shapes [m].
double compute_width(const ConvexHull::Parts& hull, const ConvexHull::Face& face) {
  double perimeter = 0.0, area2 = 0.0;
  const Vec3& origin = hull.vertices[hull.loops[face.first]];
  for (std::uint32_t i = 0; i < face.count; ++i) {
    const Vec3& tail = hull.vertices[hull.loops[face.first + i]];
    const Vec3& head = hull.vertices[hull.loops[face.first + (i + 1) % face.count]];
    perimeter += (head - tail).norm();
    area2 += (tail - origin).cross(head - origin).dot(face.normal);
  }
  return perimeter > 0.0 ? area2 / perimeter : 0.0;
}

}  // namespace

ConvexHull::ConvexHull(Parts parts)
    : parts_(std::move(parts)),
      own_vertex_fours_((parts_.vertices.size() + 3) / 4),
      own_face_fours_((parts_.faces.size() + 3) / 4) {
  put_in_fours(parts_.vertices, own_vertex_fours_.data());
  put_in_fours(parts_.faces, own_face_fours_.data());
  static_cast<Polytope&>(*this) = {parts_.vertices,   parts_.loops,        parts_.sides,
                                   parts_.faces,      parts_.edges,        parts_.neighbour_offsets,
                                   parts_.neighbours, parts_.edges_around, own_vertex_fours_,
                                   own_face_fours_,   parts_.centre,       parts_.radius};
}

double bounding_radius(std::span<const Vec3> points) {
  double radius = 0.0;
  for (const Vec3& p : points) radius = std::max(radius, p.norm());
  return radius;
}

void add_topology(ConvexHull::Parts& hull) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> left_of;
  for (std::uint32_t f = 0; f < hull.faces.size(); ++f) {
    const ConvexHull::Face& face = hull.faces[f];
    for (std::uint32_t i = 0; i < face.count; ++i) {
      const std::uint32_t tail = hull.loops[face.first + i],
                          head = hull.loops[face.first + (i + 1) % face.count];
      left_of[{tail, head}] = f;
      hull.sides.push_back(make_side(face.normal, hull.vertices[tail], hull.vertices[head]));
    }
  }
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> edge_of;
  hull.neighbour_offsets.assign(hull.vertices.size() + 1, 0);
  for (const auto& [ends, left] : left_of) {  // sorted by tail
    const auto [tail, head] = ends;
    if (tail < head) {
      edge_of[ends] = static_cast<std::uint32_t>(hull.edges.size());
      hull.edges.push_back({tail, head, left, left_of.at({head, tail})});
    }
    hull.neighbours.push_back(head);
    hull.edges_around.push_back(edge_of.at(std::minmax(tail, head)));
    hull.neighbour_offsets[tail + 1] = static_cast<std::uint32_t>(hull.neighbours.size());
  }
  for (ConvexHull::Face& face : hull.faces) face.width = compute_width(hull, face);
  for (const Vec3& vertex : hull.vertices) {
    hull.centre += vertex / static_cast<double>(hull.vertices.size());
  }
  hull.radius = bounding_radius(hull.vertices);
}

ConvexHull build_convex_hull(const std::vector<Vec3>& points) {
  if (points.size() < 4) {
    throw std::invalid_argument(fmt::format("convex hull: {} points, at least 4 are needed", points.size()));
  }
  const GridPoints grid = put_on_grid(points);
  std::vector<Vec3> distinct;
  for (const std::uint32_t i : grid.original) distinct.push_back(points[i]);
  const auto tetrahedron = find_tetrahedron(distinct, grid.extent);
  const auto triangles = compute_hull_triangles(grid.points, tetrahedron);
  auto loops = FaceMerger(distinct, triangles, grid.extent).merge();
  drop_collinear(loops, distinct.size());

  ConvexHull::Parts hull;
  std::vector<std::uint32_t> vertex_of(distinct.size(), kNone);
  for (const auto& loop : loops) {
    for (const std::uint32_t p : loop) vertex_of[p] = 0;
  }
  for (std::uint32_t p = 0; p < distinct.size(); ++p) {  // in the order of the input
    if (vertex_of[p] == kNone) continue;
    vertex_of[p] = static_cast<std::uint32_t>(hull.vertices.size());
    hull.vertices.push_back(distinct[p]);
  }
  for (const auto& loop : loops) {
    const Vec3 normal = loop_normal(distinct, loop);
    // The plane touches the body from outside, so that no point is in front of it, not by a rounding.
    const double offset = furthest(points, [&](const Vec3& p) { return normal.dot(p); }).second;
    hull.faces.push_back({normal, offset, static_cast<std::uint32_t>(hull.loops.size()),
                          static_cast<std::uint32_t>(loop.size())});
    for (const std::uint32_t p : loop) hull.loops.push_back(vertex_of[p]);
  }
  add_topology(hull);
  return ConvexHull(std::move(hull));
}

}  // namespace tumble
