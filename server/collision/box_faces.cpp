// See box_faces.h. Sutherland-Hodgman with ContactTolerance's rules, on a fixed number of corners.
#include "collision/box_faces.h"

#include <algorithm>

#include "collision/clipped_points.h"
#include "collision/feature_name.h"

namespace tumble {
namespace {

/// The edge along axis k that ends in this corner.
constexpr std::uint16_t edge_of(std::uint32_t k, std::uint32_t corner) {
  return static_cast<std::uint16_t>(8 * k + (corner & ~(1u << k)));
}
constexpr std::uint16_t kEdgeIds = 24;

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
/// FacePlane, but its axes need no products. Sides 0 to 3 are +x, +y, -x, -y, seen from outside.
struct BoxFacePlane {
  BoxFacePlane(const BoxFace& face, const Vec3& h, const Vec3& normal)
      : k(face.k),
        k1((k + 1) % 3),
        k2((k + 2) % 3),
        height(face.sign * h[k]),
        h1(h[k1]),
        h2(h[k2]),
        n1(normal[k1]),
        n2(normal[k2]),
        nk(normal[k]),
        per_n(1.0 / nk) {}

  /// Of the difference of two points; of a point, less the face's height along k.
  Vec3 to_plane(const Vec3& d) const {
    const double z = d[k] * per_n;
    return {d[k1] - z * n1, d[k2] - z * n2, z};
  }
  /// The middle between such a point and its foot on the plane. Put in its place: what is written coordinate by coordinate
  /// and then copied as a whole waits for the writing to be over.
  void put_middle(const Four& p, Vec3& middle) const {
    const double half = 0.5 * p[2];
    middle[k] = half * nk + height;
    middle[k1] = half * n1 + p[0];
    middle[k2] = half * n2 + p[1];
  }
  /// How far p lies outside of a side [m].
  template <std::size_t side>
  double outside(const Four& p) const {
    return (side < 2 ? p[side % 2] : -p[side % 2]) - (side % 2 == 0 ? h1 : h2);
  }

  int k, k1, k2;
  double height, h1, h2;
  double n1, n2, nk;  ///< Contact normal away from the box, unit, near the face's.
  double per_n;
};

/// Side s of the reference face is one of its box's edges and ends in corner heads[s], where side s + 1 starts.
struct SideNames {
  SideNames(const BoxFacePlane& plane) {
    const auto along1 = static_cast<std::uint32_t>(plane.k1), along2 = static_cast<std::uint32_t>(plane.k2);
    const std::uint32_t bit1 = 1u << along1, bit2 = 1u << along2,
                        base = plane.height > 0.0 ? 1u << plane.k : 0u;
    heads = {base | bit1 | bit2, base | bit2, base, base | bit1};
    edges = {edge_of(along2, heads[0]), edge_of(along1, heads[1]), edge_of(along2, heads[2]),
             edge_of(along1, heads[3])};
  }
  std::array<std::uint32_t, 4> heads, edges;
};

/// The incident face, seen from the reference face.
struct SeenFace {
  /// R, t: pose of the incident box in the reference's frame, h its half extents.
  SeenFace(const BoxFacePlane& plane, const BoxFace& face, const Mat3& R, const Vec3& t, const Vec3& h) {
    const int k = face.k, k1 = (k + 1) % 3, k2 = (k + 2) % 3;
    Vec3 centre = t + (face.sign * h[k]) * R.col(k);
    centre[plane.k] -= plane.height;
    const Vec3 middle = plane.to_plane(centre);
    const Vec3 e1 = plane.to_plane(face.sign * h[k1] * R.col(k1)), e2 = plane.to_plane(h[k2] * R.col(k2));
    const Four m = four(middle.x(), middle.y(), middle.z()), f1 = four(e1.x(), e1.y(), e1.z()),
               f2 = four(e2.x(), e2.y(), e2.z());
    corners = {m - f1 - f2, m + f1 - f2, m + f1 + f2, m - f1 + f2};
    const double reach1 = std::abs(e1.x()) + std::abs(e2.x()), reach2 = std::abs(e1.y()) + std::abs(e2.y());
    furthest = {middle.x() + reach1, middle.y() + reach2, reach1 - middle.x(), reach2 - middle.y()};
  }
  /// Whether a corner may be further than the tolerance [m] beside a side.
  template <std::size_t side>
  bool is_cut(const BoxFacePlane& plane, double tolerance) const {
    return furthest[side] > (side % 2 == 0 ? plane.h1 : plane.h2) + tolerance;
  }

  std::array<Four, 4> corners;     ///< Counter-clockwise from outside.
  std::array<double, 4> furthest;  ///< No corner is further out towards a side than this.
};

/// A corner of what is left of the incident face over the reference face.
struct ClippedCorner {
  Four p;
  std::uint32_t name;
  std::uint32_t edge;  ///< That starts here: of the incident box, or kEdgeIds + a side of the reference face.
};

/// A cut adds no more than one corner to a convex face, half of all if rounding made it anything else: 4, 6, 9, 13, 19.
constexpr std::size_t kClippedCorners = 19;
using ClippedLoop = std::array<ClippedCorner, kClippedCorners>;

/// Cuts away what is further than the tolerance [m] beside the reference face.
class FaceClip {
 public:
  FaceClip(const BoxFacePlane& plane, bool reference_is_a, const BoxFace& incident, const SeenFace& seen,
           double tolerance)
      : plane_(plane), names_(plane), reference_is_a_(reference_is_a), tolerance_(tolerance) {
    const auto along1 = static_cast<std::uint16_t>((incident.k + 1) % 3),
               along2 = static_cast<std::uint16_t>((incident.k + 2) % 3);
    const bool up = incident.sign > 0.0;
    const std::uint32_t side = up ? 1u << incident.k : 0u, bit1 = 1u << along1, bit2 = 1u << along2;
    const std::uint32_t first = up ? side : side | bit1, second = first ^ bit1;
    const auto& names = kCornerNames[reference_is_a];
    loops_[0][0] = {seen.corners[0], names[first], edge_of(along1, first)};
    loops_[0][1] = {seen.corners[1], names[second], edge_of(along2, second)};
    loops_[0][2] = {seen.corners[2], names[second | bit2], edge_of(along1, second)};
    loops_[0][3] = {seen.corners[3], names[first | bit2], edge_of(along2, first)};
  }

  void cut(const SeenFace& seen) {
    cut_side<0>(seen);
    cut_side<1>(seen);
    cut_side<2>(seen);
    cut_side<3>(seen);
  }

  // What is left.
  std::size_t count() const { return count_; }
  const Four& place(std::size_t i) const { return loops_[current_][i].p; }
  std::uint32_t name(std::size_t i) const { return loops_[current_][i].name; }

 private:
  template <std::uint32_t side>
  void cut_side(const SeenFace& seen);
  std::uint32_t name_meeting(std::uint32_t edge, std::uint32_t side) const;

  const BoxFacePlane& plane_;
  const SideNames names_;
  const bool reference_is_a_;
  const double tolerance_;
  std::size_t count_ = 4, current_ = 0;
  std::array<ClippedLoop, 2> loops_;
};

std::uint32_t FaceClip::name_meeting(std::uint32_t edge, std::uint32_t side) const {
  if (edge >= kEdgeIds) {
    // Two sides meet in the reference's corner, unless all between them was cut away.
    const bool after = edge - kEdgeIds == (side + 1) % 4;
    return kCornerNames[!reference_is_a_][names_.heads[after ? side : (side + 3) % 4]];
  }
  const std::uint32_t of_side = names_.edges[side];
  return reference_is_a_ ? kCrossingNames[of_side][edge] : kCrossingNames[edge][of_side];
}

template <std::uint32_t side>
void FaceClip::cut_side(const SeenFace& seen) {
  if (!seen.is_cut<side>(plane_, tolerance_)) return;
  const ClippedLoop& from = loops_[current_];
  ClippedLoop& to = loops_[1 - current_];
  std::size_t n = 0;
  double outside = plane_.outside<side>(from[0].p);
  for (std::size_t i = 0; i < count_; ++i) {
    const ClippedCorner &corner = from[i], &next = from[i + 1 == count_ ? 0 : i + 1];
    const double next_outside = plane_.outside<side>(next.p);
    const bool inside = outside <= tolerance_;
    if (inside) to[n++] = corner;
    if (inside != (next_outside <= tolerance_)) {
      Four p;
      if (cross_side(corner.p, next.p, outside, next_outside, p))
        to[n++] = {p, name_meeting(corner.edge, side), corner.edge};
      // The loop leaves: what was kept last is where it turns onto the side.
      if (inside) to[n - 1].edge = kEdgeIds + side;
    }
    outside = next_outside;
  }
  current_ = 1 - current_;
  count_ = n;
}

template <typename PutMiddleA>
Manifold clip(const BoxFacePlane& plane, bool reference_is_a, const BoxFace& incident, const SeenFace& seen,
              const PutMiddleA& put_middle_A, const Lying& lying) {
  FaceClip left(plane, reference_is_a, incident, seen, lying.tolerance.inside);
  left.cut(seen);
  return collect_points(left, put_middle_A, lying);
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
  const Lying lying{axis.normal_A, axis.separation <= 0.0, margin,
                    ContactTolerance::of(width, lie_face_to_face(face_a, face_b))};
  if (reference_is_a) {
    const BoxFacePlane plane(face_a, pair.a, axis.normal_A);
    const SeenFace seen(plane, face_b, pair.R, pair.t, pair.b);
    const auto put_middle_A = [&](const Four& p, Vec3& middle) { plane.put_middle(p, middle); };
    return clip(plane, true, face_b, seen, put_middle_A, lying);
  }
  const Mat3 R_BA = pair.R.transpose();
  const BoxFacePlane plane(face_b, pair.b, -(R_BA * axis.normal_A));
  const SeenFace seen(plane, face_a, R_BA, -(R_BA * pair.t), pair.a);
  const auto put_middle_A = [&](const Four& p, Vec3& middle) {
    Vec3 middle_B;
    plane.put_middle(p, middle_B);
    middle = pair.R * middle_B + pair.t;
  };
  return clip(plane, false, face_a, seen, put_middle_A, lying);
}

}  // namespace tumble
