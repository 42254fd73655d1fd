// See difference_hull.h. Faces are few (some dozens), so they are simply scanned.
#include "collision/difference_hull.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace tumble {
namespace {

/// Of the shapes' size: a point this little beyond a face doesn't grow the polytope, nor does one this close to a corner:
/// faces with edges so short have no good normals.
constexpr double kBeyond = 1e-15, kSamePoint = 1e-8;
/// Of the size: a face this near to the origin has it on neither side. Called outside, its nearest point would be noise, and
/// nobody would look along its normal.
constexpr double kThroughOrigin = 1e-14;

/// Weights of the point of triangle abc that is nearest to the origin (Ericson, Real-Time Collision Detection, 5.1.5).
std::array<double, 3> nearest_to_origin(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a;
  const double d1 = -ab.dot(a), d2 = -ac.dot(a);
  if (d1 <= 0.0 && d2 <= 0.0) return {1, 0, 0};
  const double d3 = -ab.dot(b), d4 = -ac.dot(b);
  if (d3 >= 0.0 && d4 <= d3) return {0, 1, 0};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) return {1.0 - d1 / (d1 - d3), d1 / (d1 - d3), 0};
  const double d5 = -ab.dot(c), d6 = -ac.dot(c);
  if (d6 >= 0.0 && d5 <= d6) return {0, 0, 1};
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) return {1.0 - d2 / (d2 - d6), 0, d2 / (d2 - d6)};
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0) {
    const double t = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return {0, 1.0 - t, t};
  }
  const double sum = va + vb + vc;
  return {va / sum, vb / sum, vc / sum};
}

/// Faces that have the origin outside come first, the farthest of them foremost; then the others by how far out they are.
bool is_searched_before(const DifferenceHull::Face& a, const DifferenceHull::Face& b) {
  if (a.outside != b.outside) return a.outside;
  return a.outside ? a.bound > b.bound : a.bound < b.bound;
}

}  // namespace

void DifferenceHull::add_face(std::uint16_t i, std::uint16_t j, std::uint16_t k) {
  const Vec3 &a = corners_[i].k, &b = corners_[j].k, &c = corners_[k].k;
  Face& face = faces_[num_faces_++];
  face.corners = {i, j, k};
  face.weights = {1, 1, 1};
  face.closed = false;
  const Vec3 cross = (b - a).cross(c - a);
  const double length = cross.norm();
  face.normal = length > 0.0 ? Vec3(cross / length) : Vec3(Vec3::Zero());
  face.offset = face.normal.dot(a);
  face.outside = face.offset < -kThroughOrigin * size_;
  face.direction = face.normal;
  face.bound = face.offset;
  if (!(length > 0.0)) face.closed = true;
  if (!face.outside) return;
  face.weights = nearest_to_origin(a, b, c);
  const Vec3 nearest = face.weights[0] * a + face.weights[1] * b + face.weights[2] * c;
  const double distance = nearest.norm();
  if (distance > 0.0 && distance > -face.offset) {
    face.direction = -nearest / distance;
    face.bound = -distance;
  }
}

bool DifferenceHull::start(const std::array<Corner, 4>& corners) {
  std::copy(corners.begin(), corners.end(), corners_.begin());
  num_points_ = 4;
  num_faces_ = 0;
  const Vec3& origin = corners[0].k;
  const double volume = (corners[1].k - origin).cross(corners[2].k - origin).dot(corners[3].k - origin);
  if (!(std::abs(volume) > 0.0)) return false;
  if (volume > 0.0) std::swap(corners_[1], corners_[2]);
  add_face(0, 1, 2);
  add_face(0, 2, 3);
  add_face(0, 3, 1);
  add_face(1, 3, 2);
  return true;
}

bool DifferenceHull::grow(const Corner& corner) {
  if (num_points_ == kMaxPoints) return false;
  std::array<std::uint16_t, kMaxFaces> visible;
  std::size_t num_visible = 0;
  for (std::size_t f = 0; f < num_faces_; ++f) {
    const Face& face = faces_[f];
    if (face.normal.dot(corner.k) - face.offset <= kBeyond * size_) continue;
    for (const std::uint16_t i : face.corners) {
      if ((corners_[i].k - corner.k).squaredNorm() < kSamePoint * kSamePoint * size_ * size_) return false;
    }
    visible[num_visible++] = static_cast<std::uint16_t>(f);
  }
  if (num_visible == 0) return false;
  // Edges of the visible faces that are not between two of them.
  struct Edge {
    std::uint16_t tail, head;
  };
  std::array<Edge, kMaxFaces> horizon;
  std::size_t edges = 0;
  for (std::size_t v = 0; v < num_visible; ++v) {
    const Face& face = faces_[visible[v]];
    for (std::size_t i = 0; i < 3; ++i) {
      const Edge edge{face.corners[i], face.corners[i == 2 ? 0 : i + 1]};
      std::size_t twin = 0;
      while (twin < edges && (horizon[twin].tail != edge.head || horizon[twin].head != edge.tail)) ++twin;
      if (twin < edges) {
        horizon[twin] = horizon[--edges];
      } else if (edges < kMaxFaces) {
        horizon[edges++] = edge;
      }
    }
  }
  if (num_faces_ - num_visible + edges > kMaxFaces) return false;
  // From the last on, so that a face moved into a gap is never a visible one.
  while (num_visible > 0) {
    const std::size_t gap = visible[--num_visible];
    if (gap != --num_faces_) faces_[gap] = faces_[num_faces_];
  }
  const auto index = static_cast<std::uint16_t>(num_points_++);
  corners_[index] = corner;
  for (std::size_t e = 0; e < edges; ++e) add_face(horizon[e].tail, horizon[e].head, index);
  return true;
}

DifferenceHull::Face DifferenceHull::pierced_by(const Vec3& n) const {
  Face best;
  double most = -kInfinity;
  for (std::size_t f = 0; f < num_faces_; ++f) {
    const Face& face = faces_[f];
    if (!(face.normal.dot(n) > 0.5)) continue;
    std::array<double, 3> w;
    for (std::size_t i = 0; i < 3; ++i) {
      w[i] = n.dot(corners_[face.corners[(i + 1) % 3]].k.cross(corners_[face.corners[(i + 2) % 3]].k));
    }
    const double sum = w[0] + w[1] + w[2];
    const double least = std::min({w[0], w[1], w[2]}) / sum;
    if (!(sum > 0.0) || !(least > most)) continue;
    most = least;
    best = face;
    for (std::size_t i = 0; i < 3; ++i) best.weights[i] = w[i] / sum;
  }
  if (!(most > -kInfinity)) best = faces_[0];
  return best;
}

DifferenceHull::Face* DifferenceHull::least() {
  Face* best = nullptr;
  for (std::size_t f = 0; f < num_faces_; ++f) {
    Face& face = faces_[f];
    if (face.closed) continue;
    if (best == nullptr || is_searched_before(face, *best)) best = &face;
  }
  return best;
}

}  // namespace tumble
