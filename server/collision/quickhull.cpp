// See quickhull.h. A point in the plane of a face counts as not in front of it. That is sound: a point outside the hull
// is strictly in front of some face, and no new triangle is degenerate, since its edge belongs to a face that the point
// is strictly in front of.
#include "collision/quickhull.h"

#include <cassert>
#include <utility>

namespace tumble {
namespace {

__extension__ typedef __int128 Wide;

struct GridNormal {
  Wide x, y, z;
};

GridNormal grid_normal(const GridPoint& a, const GridPoint& b, const GridPoint& c) {
  const Wide ux = b.x - a.x, uy = b.y - a.y, uz = b.z - a.z;
  const Wide vx = c.x - a.x, vy = c.y - a.y, vz = c.z - a.z;
  return {uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx};
}

Wide height(const GridNormal& n, const GridPoint& origin, const GridPoint& p) {
  return n.x * (p.x - origin.x) + n.y * (p.y - origin.y) + n.z * (p.z - origin.z);
}

class Quickhull {
 public:
  explicit Quickhull(const std::vector<GridPoint>& points) : points_(points), face_at_(points.size()) {}

  std::vector<HullTriangle> compute(std::array<std::uint32_t, 4> corner) {
    start(corner);
    while (!pending_.empty()) {
      const std::uint32_t face = pending_.back();
      pending_.pop_back();
      if (faces_[face].alive && !faces_[face].outside.empty()) add_furthest_point_of(face);
    }
    return collect();
  }

 private:
  struct Face {
    HullTriangle triangle;
    GridNormal normal;
    std::vector<std::uint32_t> outside;  // points in front of this face, each in the list of one face
    bool alive = true;
    bool visible = false;
  };
  /// An edge between a face that the new point sees and one that it does not.
  struct HorizonEdge {
    std::uint32_t tail, head, beyond, beyond_edge;
  };

  Wide height_above(const Face& face, std::uint32_t point) const {
    return height(face.normal, points_[face.triangle.vertex[0]], points_[point]);
  }

  std::uint32_t add_face(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    Face face;
    face.triangle.vertex = {a, b, c};
    face.normal = grid_normal(points_[a], points_[b], points_[c]);
    faces_.push_back(std::move(face));
    return static_cast<std::uint32_t>(faces_.size() - 1);
  }

  void start(std::array<std::uint32_t, 4> c) {
    if (orientation(points_[c[0]], points_[c[1]], points_[c[2]], points_[c[3]]) > 0) std::swap(c[0], c[1]);
    add_face(c[0], c[1], c[2]);
    add_face(c[0], c[3], c[1]);
    add_face(c[1], c[3], c[2]);
    add_face(c[2], c[3], c[0]);
    faces_[0].triangle.neighbour = {1, 2, 3};
    faces_[1].triangle.neighbour = {3, 2, 0};
    faces_[2].triangle.neighbour = {1, 3, 0};
    faces_[3].triangle.neighbour = {2, 1, 0};
    for (std::uint32_t point = 0; point < points_.size(); ++point) hand_over(point, 0);
    pending_ = {0, 1, 2, 3};
  }

  /// Gives the point to the first face from `first` on that it is in front of; it is dropped if there is none.
  void hand_over(std::uint32_t point, std::size_t first) {
    for (std::size_t face = first; face < faces_.size(); ++face) {
      if (height_above(faces_[face], point) > 0) {
        faces_[face].outside.push_back(point);
        return;
      }
    }
  }

  std::uint32_t furthest_point(const Face& face) const {
    std::uint32_t best = face.outside[0];
    Wide best_height = height_above(face, best);
    for (const std::uint32_t point : face.outside) {
      const Wide h = height_above(face, point);
      if (h > best_height || (h == best_height && point < best)) {
        best = point;
        best_height = h;
      }
    }
    return best;
  }

  void find_horizon(std::uint32_t face, std::uint32_t point) {
    horizon_.clear();
    visible_.assign(1, face);
    faces_[face].visible = true;
    for (std::size_t i = 0; i < visible_.size(); ++i) {
      const HullTriangle triangle = faces_[visible_[i]].triangle;
      for (std::uint32_t e = 0; e < 3; ++e) {
        const std::uint32_t beyond = triangle.neighbour[e];
        if (faces_[beyond].visible) continue;
        if (height_above(faces_[beyond], point) > 0) {
          faces_[beyond].visible = true;
          visible_.push_back(beyond);
        } else {
          horizon_.push_back({triangle.vertex[e], triangle.vertex[(e + 1) % 3], beyond, 0});
        }
      }
    }
    for (HorizonEdge& edge : horizon_) {
      const HullTriangle& beyond = faces_[edge.beyond].triangle;
      while (beyond.vertex[edge.beyond_edge] != edge.head) ++edge.beyond_edge;
    }
  }

  void add_furthest_point_of(std::uint32_t face) {
    const std::uint32_t point = furthest_point(faces_[face]);
    find_horizon(face, point);
    const std::size_t first_new = faces_.size();
    for (const HorizonEdge& edge : horizon_) {
      const std::uint32_t added = add_face(edge.tail, edge.head, point);
      faces_[added].triangle.neighbour[0] = edge.beyond;
      faces_[edge.beyond].triangle.neighbour[edge.beyond_edge] = added;
      face_at_[edge.tail] = added;
      pending_.push_back(added);
    }
    for (std::size_t added = first_new; added < faces_.size(); ++added) {
      const std::uint32_t next = face_at_[faces_[added].triangle.vertex[1]];
      faces_[added].triangle.neighbour[1] = next;
      faces_[next].triangle.neighbour[2] = static_cast<std::uint32_t>(added);
    }
    for (const std::uint32_t gone : visible_) {
      faces_[gone].alive = false;
      const std::vector<std::uint32_t> orphans = std::move(faces_[gone].outside);
      for (const std::uint32_t orphan : orphans) {
        if (orphan != point) hand_over(orphan, first_new);
      }
    }
  }

  std::vector<HullTriangle> collect() const {
    std::vector<std::uint32_t> new_index(faces_.size());
    std::uint32_t count = 0;
    for (std::size_t i = 0; i < faces_.size(); ++i) new_index[i] = faces_[i].alive ? count++ : 0;
    std::vector<HullTriangle> triangles;
    triangles.reserve(count);
    for (const Face& face : faces_) {
      if (!face.alive) continue;
      HullTriangle triangle = face.triangle;
      for (std::uint32_t& neighbour : triangle.neighbour) {
        assert(faces_[neighbour].alive);
        neighbour = new_index[neighbour];
      }
      triangles.push_back(triangle);
    }
    return triangles;
  }

  const std::vector<GridPoint>& points_;
  std::vector<Face> faces_;
  std::vector<std::uint32_t> pending_, visible_;
  std::vector<HorizonEdge> horizon_;
  std::vector<std::uint32_t> face_at_;  // new face whose edge on the horizon starts at this point
};

}  // namespace

int orientation(const GridPoint& a, const GridPoint& b, const GridPoint& c, const GridPoint& d) {
  const Wide h = height(grid_normal(a, b, c), a, d);
  return (h > 0) - (h < 0);
}

std::vector<HullTriangle> compute_hull_triangles(const std::vector<GridPoint>& points,
                                                 const std::array<std::uint32_t, 4>& tetrahedron) {
  return Quickhull(points).compute(tetrahedron);
}

}  // namespace tumble
