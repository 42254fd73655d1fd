// See distance.h. Spheres and capsules are searched as point and segment, which end exactly, and get their radius back
// at the end.
#include "collision/distance.h"

#include <algorithm>
#include <cmath>

#include "collision/segment.h"
#include "collision/simplex.h"
#include "math/rotation.h"

namespace tumble {
namespace {

/// Planes are equally far apart within this share of the rounding.
constexpr double kPlaneTie = 0.25;

/// A shape without its rounding, or a triangle.
class Core {
 public:
  explicit Core(const Shape& shape) : shape_(&shape), bounding_radius_(tumble::bounding_radius(shape)) {
    if (const auto* sphere = std::get_if<Sphere>(&shape)) radius_ = sphere->radius;
    if (const auto* capsule = std::get_if<Capsule>(&shape)) radius_ = capsule->radius, segment_ = capsule;
  }
  explicit Core(const std::array<Vec3, 3>& corners)
      : corners_(&corners), bounding_radius_(tumble::bounding_radius(corners)) {
    put_in_fours(corners, &corner_fours_);
  }
  double radius() const { return radius_; }
  /// With the rounding.
  double bounding_radius() const { return bounding_radius_; }
  Vec3 support(const Vec3& d) const {
    if (corners_ != nullptr) return (*corners_)[scan_lowest({&corner_fours_, 1}, -d).vertex];
    if (segment_ != nullptr) return {0.0, 0.0, std::copysign(segment_->half_length, d.z())};
    return radius_ > 0.0 ? Vec3(Vec3::Zero()) : tumble::support(*shape_, d);
  }

 private:
  const Shape* shape_ = nullptr;
  const Capsule* segment_ = nullptr;
  const std::array<Vec3, 3>* corners_ = nullptr;
  FourVectors corner_fours_ = {};
  double radius_ = 0.0, bounding_radius_;
};

class DistanceSearch {
 public:
  DistanceSearch(const Core& a, const Core& b, const Pose& X_AB, const DistanceSettings& settings)
      : a_(a),
        b_(b),
        R_AB_(rotation_matrix(X_AB.q)),
        p_AB_(X_AB.p),
        settings_(settings),
        radii_(a_.radius() + b_.radius()),
        error_(kSeparationRounding * (a_.bounding_radius() + b_.bounding_radius() + X_AB.p.norm())) {}

  Distance run() {
    search(start());
    return upper_ <= radii_ + error_ ? overlapping() : apart();
  }

 private:
  /// First direction: of the last search's carriers where they are now, else from centre to centre.
  Vec3 start() {
    for (std::size_t i = 0; i < static_cast<std::size_t>(settings_.start.count); ++i) {
      simplex_.add(point(settings_.start.a_A[i], settings_.start.b_B[i]));
    }
    Vec3 centre_line = direction_or(p_AB_, Vec3::UnitZ());
    if (simplex_.count() == 0) return centre_line;
    simplex_.reduce();
    upper_ = simplex_.nearest().norm();
    return direction_or(simplex_.normal(), centre_line);
  }

  /// Lowers the upper bound by one point after the other, until the plane through the newest one meets it.
  void search(Vec3 d) {
    const double enough = std::max(settings_.tolerance, error_);
    while (iterations_ < settings_.budget) {
      ++iterations_;
      const SimplexPoint added = point(a_.support(d), b_.support(-(R_AB_.transpose() * d)));
      const double separation = d.dot(added.difference);
      // Of equal planes the later: it comes from the present simplex, the first perhaps from a warm start.
      if (separation > lower_ - kPlaneTie * error_) lower_ = separation, axis_A_ = d;
      if (upper_ - lower_ <= enough || lower_ - radii_ - error_ > settings_.beyond) return;
      if (simplex_.contains(added)) return;
      Simplex next = simplex_;
      next.add(added);
      next.reduce();
      const double length = next.nearest().norm();
      if (length >= upper_) return;
      simplex_ = next;
      upper_ = length;
      if (upper_ <= error_) return;
      d = simplex_.normal();
    }
  }

  SimplexPoint point(const Vec3& a_A, const Vec3& b_B) const {
    const Vec3 b_A = R_AB_ * b_B + p_AB_;
    return {a_A, b_A, b_B, b_A - a_A};
  }

  Distance apart() const {
    Distance distance;
    const Vec3 a = simplex_.point_a(), b = simplex_.point_b();
    distance.lower = std::max(0.0, lower_ - radii_ - error_);
    distance.upper = std::max(upper_, (b - a).norm()) - radii_;
    distance.axis_A = axis_A_;
    distance.a_A = a + a_.radius() * axis_A_;
    distance.b_A = b - b_.radius() * axis_A_;
    for (int i = 0; i < simplex_.count(); ++i) {
      distance.carriers.a_A[static_cast<std::size_t>(i)] = simplex_.point(i).a_A;
      distance.carriers.b_B[static_cast<std::size_t>(i)] = simplex_.point(i).b_B;
    }
    distance.carriers.count = simplex_.count();
    distance.iterations = iterations_;
    return distance;
  }

  Distance overlapping() const {
    Distance distance;
    distance.overlap = true;
    distance.axis_A = axis_A_;
    // Between the cores, as far from each as its radius allows.
    const double share = radii_ > 0.0 ? a_.radius() / radii_ : 0.5;
    distance.a_A = distance.b_A = simplex_.point_a() + share * (simplex_.point_b() - simplex_.point_a());
    distance.iterations = iterations_;
    return distance;
  }

  Core a_, b_;
  Mat3 R_AB_;
  Vec3 p_AB_;
  const DistanceSettings& settings_;
  double radii_, error_;  // [m]

  Simplex simplex_;
  double lower_ = -kInfinity;  // of the cores [m]
  double upper_ = kInfinity;
  Vec3 axis_A_ = Vec3::UnitZ();
  int iterations_ = 0;
};

}  // namespace

Distance compute_distance(const Shape& a, const Shape& b, const Pose& X_AB,
                          const DistanceSettings& settings) {
  return DistanceSearch(Core(a), Core(b), X_AB, settings).run();
}

Distance compute_distance(const Shape& a, const std::array<Vec3, 3>& corners, const Pose& X_AB,
                          const DistanceSettings& settings) {
  return DistanceSearch(Core(a), Core(corners), X_AB, settings).run();
}

Distance compute_distance(const std::array<Vec3, 3>& corners, const Shape& b, const Pose& X_AB,
                          const DistanceSettings& settings) {
  return DistanceSearch(Core(corners), Core(b), X_AB, settings).run();
}

}  // namespace tumble
