// See box_faces.h. Sutherland-Hodgman with ContactTolerance's rules, on a fixed number of corners.
#include "collision/box_faces.h"

#include <algorithm>

#include "collision/feature_name.h"
#include "collision/manifold_builder.h"

namespace tumble {
namespace {

/// The edge along axis k that ends in this corner.
constexpr std::uint32_t edge_of(std::uint32_t k, std::uint32_t corner) {
  return 8 * k + (corner & ~(1u << k));
}
constexpr std::uint32_t kEdgeIds = 24;

/// Names of corner i of A (0) or B (1), and of A's edge i with B's edge j.
constexpr auto kCornerNames = [] {
  std::array<std::array<std::uint32_t, 8>, 2> names{};
  for (std::uint32_t i = 0; i < 8; ++i)
    names[0][i] = name_vertex(true, i), names[1][i] = name_vertex(false, i);
  return names;
}();
constexpr auto kCrossingNames = [] {
  std::array<std::array<std::uint32_t, kEdgeIds>, kEdgeIds> names{};
  for (std::uint32_t i = 0; i < kEdgeIds; ++i) {
    for (std::uint32_t j = 0; j < kEdgeIds; ++j) {
      const std::uint32_t a = i % 8, b = j % 8;
      names[i][j] = name_crossing(a, a | 1u << i / 8, b, b | 1u << j / 8);
    }
  }
  return names;
}();

/// The plane of the reference face in its box's frame: x, y along the box's axes k + 1 and k + 2 (cyclic), z outward; as
/// FacePlane, but its axes need no products.
struct BoxFacePlane {
  BoxFacePlane(const BoxFace& face, const Vec3& h, const Vec3& normal)
      : k(face.k),
        k1((k + 1) % 3),
        k2((k + 2) % 3),
        height(face.sign * h[k]),
        h1(h[k1]),
        h2(h[k2]),
        n(normal),
        per_n(1.0 / n[k]) {
    const std::uint32_t bit1 = 1u << k1, bit2 = 1u << k2, base = face.sign > 0.0 ? 1u << k : 0u;
    heads = {base | bit1 | bit2, base | bit2, base, base | bit1};
    const auto along1 = static_cast<std::uint32_t>(k1), along2 = static_cast<std::uint32_t>(k2);
    edges = {edge_of(along2, heads[0]), edge_of(along1, heads[1]), edge_of(along2, heads[2]),
             edge_of(along1, heads[3])};
  }

  /// Of the difference of two points; of a point, less the face's height along k.
  Vec3 to_plane(const Vec3& d) const {
    const double z = d[k] * per_n;
    return {d[k1] - z * n[k1], d[k2] - z * n[k2], z};
  }
  /// The middle between such a point and its foot on the plane.
  Vec3 middle(const Vec3& p) const {
    Vec3 middle = (0.5 * p.z()) * n;
    middle[k] += height;
    middle[k1] += p.x();
    middle[k2] += p.y();
    return middle;
  }

  int k, k1, k2;
  double height, h1, h2;
  Vec3 n;  ///< Contact normal away from the box, unit, near the face's.
  double per_n;
  /// Sides 0 to 3 are +x, +y, -x, -y, seen from outside; side s ends in corner heads[s], where side s + 1 starts.
  std::array<std::uint32_t, 4> heads, edges;
};

/// The incident face, and what is left of it over the reference face.
class FaceClip {
 public:
  /// R, t: pose of the incident box in the reference's frame, h its half extents.
  FaceClip(const BoxFacePlane& plane, bool reference_is_a, const BoxFace& incident, const Mat3& R,
           const Vec3& t, const Vec3& h);

  /// Cuts away what is further than the tolerance [m] beside the reference face.
  void cut(double tolerance);

  /// As ClipPolygon::make_manifold.
  template <typename MiddleA>
  Manifold make_manifold(const MiddleA& middle_A, const Vec3& normal_A, bool overlap, double margin,
                         double merge) const;

 private:
  /// A cut adds no more than one corner to a convex face, half of all if rounding made it anything else: 4, 6, 9, 13, 19.
  static constexpr std::size_t kCapacity = 19;
  struct Corner {
    Vec3 p;
    std::uint32_t name;
    std::uint32_t
        edge;  ///< That starts here: of the incident box, or kEdgeIds + a side of the reference face.
  };
  using Loop = std::array<Corner, kCapacity>;

  template <std::uint32_t side>
  void cut_side(double half, double tolerance);
  std::uint32_t name_meeting(std::uint32_t edge, std::uint32_t side) const;
  const Loop& loop() const { return loops_[current_]; }
  /// Of what is left.
  const Corner& lowest_corner() const {
    const auto end = loop().begin() + static_cast<std::ptrdiff_t>(count_);
    return *std::min_element(loop().begin(), end,
                             [](const Corner& c, const Corner& d) { return c.p.z() < d.p.z(); });
  }

  const BoxFacePlane& plane_;
  bool reference_is_a_;
  Vec3 middle_,
      reach_;  ///< Of the uncut face; x, y and z of its corners differ from the middle's by no more.
  std::size_t count_ = 4, current_ = 0;
  std::array<Loop, 2> loops_;
};

FaceClip::FaceClip(const BoxFacePlane& plane, bool reference_is_a, const BoxFace& incident, const Mat3& R,
                   const Vec3& t, const Vec3& h)
    : plane_(plane), reference_is_a_(reference_is_a) {
  const int k = incident.k, k1 = (k + 1) % 3, k2 = (k + 2) % 3;
  Vec3 centre = t + (incident.sign * h[k]) * R.col(k);
  centre[plane.k] -= plane.height;
  middle_ = plane.to_plane(centre);
  const Vec3 e1 = plane.to_plane(incident.sign * h[k1] * R.col(k1)), e2 = plane.to_plane(h[k2] * R.col(k2));
  reach_ = e1.cwiseAbs() + e2.cwiseAbs();
  const bool up = incident.sign > 0.0;
  const std::uint32_t side = up ? 1u << k : 0u, bit1 = 1u << k1, bit2 = 1u << k2;
  const std::uint32_t first = up ? side : side | bit1, second = first ^ bit1;
  const auto along1 = static_cast<std::uint32_t>(k1), along2 = static_cast<std::uint32_t>(k2);
  const auto& names = kCornerNames[reference_is_a];
  // Counter-clockwise from outside.
  Loop& corners = loops_[0];
  corners[0] = {middle_ - e1 - e2, names[first], edge_of(along1, first)};
  corners[1] = {middle_ + e1 - e2, names[second], edge_of(along2, second)};
  corners[2] = {middle_ + e1 + e2, names[second | bit2], edge_of(along1, second)};
  corners[3] = {middle_ - e1 + e2, names[first | bit2], edge_of(along2, first)};
}

void FaceClip::cut(double tolerance) {
  const double right = plane_.h1 + tolerance, top = plane_.h2 + tolerance;
  if (middle_.x() + reach_.x() > right) cut_side<0>(plane_.h1, tolerance);
  if (middle_.y() + reach_.y() > top) cut_side<1>(plane_.h2, tolerance);
  if (reach_.x() - middle_.x() > right) cut_side<2>(plane_.h1, tolerance);
  if (reach_.y() - middle_.y() > top) cut_side<3>(plane_.h2, tolerance);
}

std::uint32_t FaceClip::name_meeting(std::uint32_t edge, std::uint32_t side) const {
  if (edge >= kEdgeIds) {
    // Two sides meet in the reference's corner, unless all between them was cut away.
    const bool after = edge - kEdgeIds == (side + 1) % 4;
    return kCornerNames[!reference_is_a_][plane_.heads[after ? side : (side + 3) % 4]];
  }
  const std::uint32_t of_side = plane_.edges[side];
  return reference_is_a_ ? kCrossingNames[of_side][edge] : kCrossingNames[edge][of_side];
}

template <std::uint32_t side>
void FaceClip::cut_side(double half, double tolerance) {
  const Loop& from = loops_[current_];
  Loop& to = loops_[1 - current_];
  const auto height = [half](const Corner& corner) {
    return (side < 2 ? corner.p[side % 2] : -corner.p[side % 2]) - half;
  };
  std::size_t n = 0;
  double outside = height(from[0]);
  for (std::size_t i = 0; i < count_; ++i) {
    const Corner &corner = from[i], &next = from[i + 1 == count_ ? 0 : i + 1];
    const double next_outside = height(next);
    const bool inside = outside <= tolerance;
    if (inside) to[n++] = corner;
    if (inside != (next_outside <= tolerance)) {
      const double rise = next_outside - outside;
      if (outside * next_outside < 0.0 && std::abs(rise) > ContactTolerance::kNoCrossing) {
        to[n++] = {corner.p + (outside / -rise) * (next.p - corner.p), name_meeting(corner.edge, side),
                   corner.edge};
      }
      // The loop leaves: what was kept last is where it turns onto the side.
      if (inside) to[n - 1].edge = kEdgeIds + side;
    }
    outside = next_outside;
  }
  current_ = 1 - current_;
  count_ = n;
}

template <typename MiddleA>
Manifold FaceClip::make_manifold(const MiddleA& middle_A, const Vec3& normal_A, bool overlap, double margin,
                                 double merge) const {
  Manifold manifold;
  manifold.normal_A = normal_A;
  const auto add = [&](const Corner& corner) {
    if (!(corner.p.z() <= margin) || manifold.count == kMaxManifoldPoints) return;
    manifold.count = add_or_merge(manifold.points.data(), manifold.count, merge,
                                  {middle_A(corner.p), corner.p.z(), corner.name});
  };
  for (std::size_t i = 0; i < count_; ++i) add(loop()[i]);
  if (manifold.count > 0 || !overlap || count_ == 0) return manifold;
  const Corner& lowest = lowest_corner();
  return single_point(normal_A, middle_A(lowest.p), std::min(lowest.p.z(), margin), margin, lowest.name);
}

}  // namespace

BoxFace BoxFace::towards(const Vec3& d) {
  int k = 0;
  const double cosine = d.cwiseAbs().maxCoeff(&k);
  return {k, std::copysign(1.0, d[k]), cosine};
}

bool lie_face_to_face(const BoxFace& face_a, const BoxFace& face_b) {
  return std::min(face_a.cosine, face_b.cosine) > ContactTolerance::kFaceToFace;
}

Manifold clip_faces(const BoxPair& pair, const BoxAxis& axis, const BoxFace& face_a, const BoxFace& face_b,
                    bool reference_is_a, double margin) {
  const double width = std::min(face_a.width(pair.a), face_b.width(pair.b));
  const ContactTolerance tolerance = ContactTolerance::of(width, lie_face_to_face(face_a, face_b));
  const bool overlap = axis.separation <= 0.0;
  if (reference_is_a) {
    const BoxFacePlane plane(face_a, pair.a, axis.normal_A);
    FaceClip clip(plane, true, face_b, pair.R, pair.t, pair.b);
    clip.cut(tolerance.inside);
    const auto middle_A = [&](const Vec3& p) { return plane.middle(p); };
    return clip.make_manifold(middle_A, axis.normal_A, overlap, margin, tolerance.merge);
  }
  const Mat3 R_BA = pair.R.transpose();
  const BoxFacePlane plane(face_b, pair.b, -(R_BA * axis.normal_A));
  FaceClip clip(plane, false, face_a, R_BA, -(R_BA * pair.t), pair.a);
  clip.cut(tolerance.inside);
  const auto middle_A = [&](const Vec3& p) -> Vec3 { return pair.R * plane.middle(p) + pair.t; };
  return clip.make_manifold(middle_A, axis.normal_A, overlap, margin, tolerance.merge);
}

}  // namespace tumble
