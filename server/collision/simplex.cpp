// See simplex.h. Every face, edge and corner that may carry the nearest point is tried, and the shortest wins: on slivers
// a decision by signs alone goes wrong, a minimum over points of the simplex stays an upper bound whatever is rounded.
#include "collision/simplex.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace tumble {
namespace {

/// Cross product of the triangle's edges with the least rounding: of the two short ones, which meet in a corner.
Vec3 area_vector(const Vec3& p, const Vec3& q, const Vec3& r) {
  const Vec3 pq = q - p, qr = r - q, rp = p - r;
  const double pq2 = pq.squaredNorm(), qr2 = qr.squaredNorm(), rp2 = rp.squaredNorm();
  if (pq2 >= qr2 && pq2 >= rp2) return qr.cross(rp);
  return qr2 >= rp2 ? rp.cross(pq) : pq.cross(qr);
}

/// The part of d that is square to `along`; twice, since the first time leaves a rounding of the length of d.
Vec3 square_to(const Vec3& along, Vec3 d) {
  const double length2 = along.squaredNorm();
  for (int i = 0; i < 2 && length2 > 0.0; ++i) {
    d -= along * (along.dot(d) / length2);
    const double length = d.norm();
    if (length > 0.0) d /= length;
  }
  return d;
}

}  // namespace

/// A nearest point with its weights, by the place of the points in the simplex.
struct Simplex::Candidate {
  std::array<double, 4> weights{};
  Vec3 nearest;
  double length2;

  const Candidate& or_shorter(const Candidate& other) const {
    return other.length2 < length2 ? other : *this;
  }
};

bool Simplex::contains(const SimplexPoint& point) const {
  return std::any_of(points_.begin(), points_.begin() + count_,
                     [&](const SimplexPoint& own) { return own.a_A == point.a_A && own.b_B == point.b_B; });
}

void Simplex::reduce() {
  Candidate best;
  switch (count_) {
    case 1:
      best = nearest_of_point(0);
      break;
    case 2:
      best = nearest_of_edge(0, 1);
      break;
    case 3:
      best = nearest_of_triangle(0, 1, 2);
      break;
    default:
      best = nearest_of_tetrahedron();
      break;
  }
  nearest_ = best.nearest;
  int kept = 0;
  for (int i = 0; i < count_; ++i) {
    const auto from = static_cast<std::size_t>(i), to = static_cast<std::size_t>(kept);
    if (best.weights[from] <= 0.0) continue;
    points_[to] = points_[from];
    weights_[to] = best.weights[from];
    ++kept;
  }
  count_ = kept;
}

Simplex::Candidate Simplex::nearest_of_point(int i) const {
  Candidate point{{}, w(i), w(i).squaredNorm()};
  point.weights[static_cast<std::size_t>(i)] = 1.0;
  return point;
}

Simplex::Candidate Simplex::nearest_of_edge(int i, int j) const {
  // From the end that is nearer to the origin: the product rounds less.
  if (w(j).squaredNorm() < w(i).squaredNorm()) std::swap(i, j);
  const Vec3 along = w(j) - w(i);
  const double length2 = along.squaredNorm();
  const double s = length2 > 0.0 ? -along.dot(w(i)) / length2 : 0.0;
  if (!(s > 0.0)) return nearest_of_point(i);
  if (s >= 1.0) return nearest_of_point(j);
  Candidate edge;
  edge.weights[static_cast<std::size_t>(i)] = 1.0 - s;
  edge.weights[static_cast<std::size_t>(j)] = s;
  edge.nearest = w(i) + s * along;
  edge.length2 = edge.nearest.squaredNorm();
  return edge;
}

Simplex::Candidate Simplex::nearest_of_triangle(int i, int j, int k) const {
  const Vec3 n = area_vector(w(i), w(j), w(k));
  const double n2 = n.squaredNorm();
  // Twice the areas of the triangles that the origin's foot spans with each side, times |n|.
  const double at_i = n.dot(w(j).cross(w(k))), at_j = n.dot(w(k).cross(w(i))), at_k = n.dot(w(i).cross(w(j)));
  const double sum = at_i + at_j + at_k;
  if (n2 > 0.0 && at_i > 0.0 && at_j > 0.0 && at_k > 0.0 && std::isfinite(1.0 / sum)) {
    Candidate inside;
    inside.weights[static_cast<std::size_t>(i)] = at_i / sum;
    inside.weights[static_cast<std::size_t>(j)] = at_j / sum;
    inside.weights[static_cast<std::size_t>(k)] = at_k / sum;
    inside.nearest = n * (n.dot(w(i)) / n2);
    inside.length2 = inside.nearest.squaredNorm();
    return inside;
  }
  return nearest_of_edge(i, j).or_shorter(nearest_of_edge(j, k)).or_shorter(nearest_of_edge(k, i));
}

Simplex::Candidate Simplex::nearest_of_tetrahedron() const {
  constexpr int kFaces[4][4] = {{0, 1, 2, 3}, {0, 3, 1, 2}, {1, 3, 2, 0}, {2, 3, 0, 1}};  // face, opposite
  Candidate best{{}, Vec3::Zero(), kInfinity};
  bool outside = false;
  for (const auto& [i, j, k, opposite] : kFaces) {
    const Vec3 n = area_vector(w(i), w(j), w(k));
    const double origin = -n.dot(w(i)), inner = n.dot(w(opposite) - w(i));
    if (origin * inner > 0.0) continue;
    outside = true;
    best = best.or_shorter(nearest_of_triangle(i, j, k));
  }
  if (outside) return best;
  // Weights in proportion to the volumes that the origin spans with the opposite faces.
  double sum = 0.0;
  for (const auto& [i, j, k, opposite] : kFaces) {
    const double volume = std::abs(w(i).dot(w(j).cross(w(k))));
    best.weights[static_cast<std::size_t>(opposite)] = volume;
    sum += volume;
  }
  for (double& weight : best.weights) weight /= sum;
  best.length2 = 0.0;
  return best;
}

Vec3 Simplex::normal() const {
  Vec3 n = nearest_;
  if (count_ == 2) {
    n = square_to(w(1) - w(0), n);
  } else if (count_ == 3) {
    n = area_vector(w(0), w(1), w(2));
    if (n.dot(w(0)) < 0.0) n = -n;
  } else if (count_ == 4) {
    return Vec3::Zero();
  }
  const double length = n.stableNorm();
  return length > 0.0 ? Vec3(n / length) : Vec3::Zero();
}

Vec3 Simplex::point_a() const {
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i < static_cast<std::size_t>(count_); ++i) sum += weights_[i] * points_[i].a_A;
  return sum;
}

Vec3 Simplex::point_b() const {
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i < static_cast<std::size_t>(count_); ++i) sum += weights_[i] * points_[i].b_A;
  return sum;
}

}  // namespace tumble
