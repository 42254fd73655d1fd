// See box_faces.h. The names of all points are known beforehand.
#include "collision/box_faces.h"

#include <algorithm>
#include <bit>
#include <cstddef>

#include "collision/box_features.h"
#include "collision/rectangle_clip.h"

namespace tumble {
namespace {

template <typename Features>
const Features& features_of(const std::array<std::array<Features, 2>, 3>& features, const BoxFace& face) {
  return features[static_cast<std::size_t>(face.k)][face.sign > 0.0];
}

/// The two boxes in the order reference, incident, in the reference's frame.
struct OrderedBoxes {
  OrderedBoxes(const BoxPair& pair, bool reference_is_a)
      : reference(reference_is_a ? pair.a : pair.b),
        incident(reference_is_a ? pair.b : pair.a),
        R_(pair.R.data()),
        per_row_(reference_is_a ? 1 : 3),
        per_column_(reference_is_a ? 3 : 1),
        t_(reference_is_a ? pair.t : pair.t_B),
        sign_(reference_is_a ? 1.0 : -1.0) {}

  /// Pose of the incident box.
  double R(int i, int j) const { return R_[per_row_ * i + per_column_ * j]; }
  double t(int i) const { return sign_ * t_[i]; }

  const Vec3 &reference, &incident;  ///< Half extents.

 private:
  const double* R_;
  int per_row_, per_column_;
  const Vec3& t_;
  double sign_;
};

/// The incident face over the reference face's plane: x, y along the reference box's axes k + 1 and k + 2 (cyclic), from
/// the middle of its face; z the distance to there along the contact normal n (unit, in its frame).
Parallelogram see_face(const OrderedBoxes& boxes, const BoxFace& reference, const BoxFace& incident,
                       const Vec3& n) {
  const int k = reference.k, k1 = next_axis(k), k2 = next_axis(k1);
  const int l = incident.k, l1 = next_axis(l), l2 = next_axis(l1);
  const double per_n = 1.0 / n[k];
  const auto to_plane = [&](double x, double y, double height) {
    const double z = height * per_n;
    return Vec3(x - z * n[k1], y - z * n[k2], z);
  };
  const auto along = [&](int axis, double reach) {
    return to_plane(reach * boxes.R(k1, axis), reach * boxes.R(k2, axis), reach * boxes.R(k, axis));
  };
  const double reach = incident.sign * boxes.incident[l];
  return {to_plane(boxes.t(k1) + reach * boxes.R(k1, l), boxes.t(k2) + reach * boxes.R(k2, l),
                   boxes.t(k) + reach * boxes.R(k, l) - reference.sign * boxes.reference[k]),
          along(l1, incident.sign * boxes.incident[l1]), along(l2, boxes.incident[l2])};
}

/// Where a place over the plane lies in A.
struct PlaneInA {
  /// Vectors in A: where x = y = z = 0, the axes x and y, and the contact normal along which z is measured.
  PlaneInA(const Vec3& o, const Vec3& u, const Vec3& v, const Vec3& n)
      : origin{o.x(), o.y(), o.z(), 0.0},
        along_x{u.x(), u.y(), u.z(), 0.0},
        along_y{v.x(), v.y(), v.z(), 0.0},
        along_z{0.5 * n.x(), 0.5 * n.y(), 0.5 * n.z(), 1.0} {}

  /// Half way between the place and the plane; the last lane is z.
  Four middle(double x, double y, double z) const { return origin + x * along_x + y * along_y + z * along_z; }

  Four origin, along_x, along_y, along_z;
};

/// What a manifold needs to know beside its corners.
struct Lying {
  Vec3 normal_A;
  bool overlap;
  double margin;
  ContactTolerance tolerance;
};

/// Places that are left, as they lie in the plane; those that are not there lie far from all.
class PlacesInPlane {
 public:
  void set(std::size_t i, double x, double y) { x_[i] = x, y_[i] = y; }

  /// The least of all distances between two of them, along x or y whichever is more [m].
  double closest() const {
    const Four xa = load_four(&x_[0]), ya = load_four(&y_[0]), xb = load_four(&x_[4]), yb = load_four(&y_[4]);
    Four nearest = four(kInfinity);
    const auto compare = [&](const Four& x1, const Four& y1, const Four& x2, const Four& y2) {
      nearest = smaller(larger(absolute(x1 - x2), absolute(y1 - y2)), nearest);
    };
    compare(xa, ya, xb, yb);
    compare(xa, ya, rotated<1>(xa), rotated<1>(ya));
    compare(xa, ya, rotated<2>(xa), rotated<2>(ya));
    compare(xa, ya, rotated<1>(xb), rotated<1>(yb));
    compare(xa, ya, rotated<2>(xb), rotated<2>(yb));
    compare(xa, ya, rotated<3>(xb), rotated<3>(yb));
    compare(xb, yb, rotated<1>(xb), rotated<1>(yb));
    compare(xb, yb, rotated<2>(xb), rotated<2>(yb));
    return least_lane(nearest)[0];
  }

 private:
  using Coordinates = std::array<double, kMaxManifoldPoints>;
  Coordinates x_ = {1e200, 2e200, 3e200, 4e200, 5e200, 6e200, 7e200, 8e200}, y_{};
};

/// What is left of the incident face over the reference face, and what its corners become.
class ClippedFace {
 public:
  ClippedFace(const RectangleClip& clip, const PlaneInA& in_A, const BoxFace& reference,
              const BoxFace& incident, bool reference_is_a)
      : clip_(clip),
        in_A_(in_A),
        of_reference_(features_of(kReferenceFeatures, reference)),
        of_incident_(features_of(kIncidentFeatures, incident)),
        reference_is_a_(reference_is_a) {}

  /// Everything up to the margin. If that is nothing although the bodies overlap, by rounding, the lowest corner of what is
  /// left speaks for it.
  Manifold make_manifold(const Lying& lying) const {
    Manifold manifold;
    manifold.normal_A = lying.normal_A;
    const RectangleClip::Set near = clip_.corners_below(lying.margin);
    if (!put_distinct(near, lying.tolerance.merge, manifold))
      put_merged(near, lying.tolerance.merge, manifold);
    if (manifold.count == 0 && lying.overlap) put_lowest(lying.margin, manifold);
    return manifold;
  }

 private:
  template <typename Do>
  static void for_each(RectangleClip::Set set, const Do& call) {
    for (; set != 0; set &= set - 1) call(static_cast<std::uint32_t>(std::countr_zero(set)));
  }

  // Of a bit in a set.
  double x(std::uint32_t i) const { return clip_.places[i / 4].x[i % 4]; }
  double y(std::uint32_t i) const { return clip_.places[i / 4].y[i % 4]; }
  double z(std::uint32_t i) const { return clip_.places[i / 4].z[i % 4]; }
  std::uint32_t name(std::uint32_t i) const {
    const std::uint8_t reference = of_reference_[static_cast<std::size_t>(clip_.on[i / 4][i % 4])],
                       incident = of_incident_[i];
    return reference_is_a_ ? kBoxNames[reference][incident] : kBoxNames[incident][reference];
  }

  void put(std::uint32_t i, ManifoldPoint& point) const {
    // At once: what is written coordinate by coordinate and then copied as a whole waits for the writing to be over.
    static_assert(offsetof(ManifoldPoint, separation) == 3 * sizeof(double));
    store_four(in_A_.middle(x(i), y(i), z(i)), point.p_A.data());
    point.feature = name(i);
  }

  /// False: too many, or some so close to each other that they might be one.
  bool put_distinct(RectangleClip::Set set, double merge, Manifold& manifold) const {
    if (std::popcount(set) > kMaxManifoldPoints) return false;
    PlacesInPlane seen;
    std::size_t count = 0;
    for_each(set, [&](std::uint32_t i) {
      seen.set(count, x(i), y(i));
      put(i, manifold.points[count++]);
    });
    manifold.count = static_cast<int>(count);
    // In the plane they are no further apart than in space but for the tilt of the normal.
    constexpr double kTilted = 1.25;
    return seen.closest() > kTilted * merge;
  }

  void put_merged(RectangleClip::Set set, double merge, Manifold& manifold) const {
    manifold.count = 0;
    for_each(set, [&](std::uint32_t i) {
      if (manifold.count == kMaxManifoldPoints) return;
      ManifoldPoint point;
      put(i, point);
      manifold.count = add_or_merge(manifold.points.data(), manifold.count, merge, point);
    });
  }

  void put_lowest(double margin, Manifold& manifold) const {
    const RectangleClip::Set left = clip_.corners_below(kInfinity);
    if (left == 0) return;
    auto lowest = static_cast<std::uint32_t>(std::countr_zero(left));
    for_each(left, [&](std::uint32_t i) {
      if (z(i) < z(lowest)) lowest = i;
    });
    manifold.count = 1;
    put(lowest, manifold.points[0]);
    manifold.points[0].separation = std::min(manifold.points[0].separation, margin);
  }

  const RectangleClip& clip_;
  const PlaneInA& in_A_;
  const ReferenceFeatures& of_reference_;
  const IncidentFeatures& of_incident_;
  const bool reference_is_a_;
};

}  // namespace

BoxFace BoxFace::towards(const Vec3& d) {
  const double x = std::abs(d.x()), y = std::abs(d.y()), z = std::abs(d.z());
  const double most = std::max(x, std::max(y, z));
  const int k = most == x ? 0 : (most == y ? 1 : 2);
  return {k, std::copysign(1.0, d[k]), most};
}

FacingFaces::FacingFaces(const BoxPair& pair, const BoxAxis& axis) : normal_A(tumble::normal_A(pair, axis)) {
  if (axis.kind == BoxAxis::Kind::face_a) {
    towards_a_B = -axis.scale * pair.R.row(axis.i).transpose();
    a = {axis.i, axis.scale, 1.0};
    b = BoxFace::towards(towards_a_B);
  } else if (axis.kind == BoxAxis::Kind::face_b) {
    towards_a_B = -axis.scale * Vec3::Unit(axis.j);
    a = BoxFace::towards(normal_A);
    b = {axis.j, -axis.scale, 1.0};
  } else {
    towards_a_B = pair.R.transpose() * -normal_A;
    a = BoxFace::towards(normal_A);
    b = BoxFace::towards(towards_a_B);
  }
}

void FacingFaces::see_along(const BoxPair& pair, const Vec3& n_A) {
  normal_A = n_A;
  towards_a_B = pair.R.transpose() * -n_A;
}

Manifold clip_faces(const BoxPair& pair, const FacingFaces& faces, double separation, bool reference_is_a,
                    double margin) {
  const BoxFace &reference = reference_is_a ? faces.a : faces.b,
                &incident = reference_is_a ? faces.b : faces.a;
  const int k = reference.k, k1 = next_axis(k), k2 = next_axis(k1);
  const Vec3& h = reference_is_a ? pair.a : pair.b;
  const Lying lying{
      faces.normal_A, separation <= 0.0, margin,
      ContactTolerance::of(std::min(faces.a.width(pair.a), faces.b.width(pair.b)), faces.lie_face_to_face())};
  const RectangleClip clip(see_face(OrderedBoxes(pair, reference_is_a), reference, incident,
                                    reference_is_a ? faces.normal_A : faces.towards_a_B),
                           h[k1], h[k2], lying.tolerance.inside);
  const double height = reference.sign * h[k];
  const PlaneInA in_A =
      reference_is_a
          ? PlaneInA(height * Vec3::Unit(k), Vec3::Unit(k1), Vec3::Unit(k2), faces.normal_A)
          : PlaneInA(pair.t + height * pair.R.col(k), pair.R.col(k1), pair.R.col(k2), -faces.normal_A);
  return ClippedFace(clip, in_A, reference, incident, reference_is_a).make_manifold(lying);
}

}  // namespace tumble
