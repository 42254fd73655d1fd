// See sdf_pose.h. SDF's angles are fixed-axis roll, pitch, yaw (sdformat: pose frame semantics).
#include "scene/sdf_pose.h"

#include <cmath>

#include "math/rotation.h"

namespace tumble {
namespace {

constexpr double kLargestAngle = 1e6;                // [rad]; sincos reduces exactly up to 1.6e6
constexpr double kDegree = 0.017453292519943295769;  // [rad]
constexpr double kUnitSlack = 1e-14;                 // of |q|^2; one normalisation leaves less than 1e-15

Quat read_quaternion(SdfElement& pose, const std::vector<double>& n) {
  const Quat q(n[6], n[3], n[4], n[5]);
  const double norm2 = q.squaredNorm();
  if (!(norm2 > 1e-12) || !std::isfinite(norm2)) pose.fail("quaternion has no direction", pose.to_text());
  return unit_or_same(q);
}

}  // namespace

Quat unit_or_same(const Quat& q) {
  return std::abs(q.squaredNorm() - 1.0) <= kUnitSlack ? q : normalized(q);
}

Quat rotation_from_rpy(double roll, double pitch, double yaw) {
  const SinCos r = sincos(0.5 * roll), p = sincos(0.5 * pitch), y = sincos(0.5 * yaw);
  return Quat(r.cos * p.cos * y.cos + r.sin * p.sin * y.sin, r.sin * p.cos * y.cos - r.cos * p.sin * y.sin,
              r.cos * p.sin * y.cos + r.sin * p.cos * y.sin, r.cos * p.cos * y.sin - r.sin * p.sin * y.cos);
}

Pose chained(const std::optional<Pose>& X_AB, const std::optional<Pose>& X_BC) {
  if (!X_AB) return X_BC.value_or(Pose{});
  if (!X_BC) return *X_AB;
  Pose X_AC = *X_AB * *X_BC;
  X_AC.q = unit_or_same(X_AC.q);
  return X_AC;
}

Pose read_pose(SdfElement& pose) {
  const std::string format = pose.attribute("rotation_format").value_or("euler_rpy");
  const std::string degrees = pose.attribute("degrees").value_or("false");
  if (format != "euler_rpy" && format != "quat_xyzw") {
    pose.fail_attribute("rotation_format", "must be euler_rpy or quat_xyzw", format);
  }
  const bool in_degrees = degrees == "true" || degrees == "1";
  if (!in_degrees && degrees != "false" && degrees != "0") {
    pose.fail_attribute("degrees", "must be true or false", degrees);
  }
  if (format == "quat_xyzw") {
    if (in_degrees) pose.fail_attribute("degrees", "a quaternion has no degrees", degrees);
    const std::vector<double> n = pose.to_numbers(7);
    return {read_quaternion(pose, n), Vec3(n[0], n[1], n[2])};
  }
  std::vector<double> n = pose.to_numbers(6);
  for (std::size_t i = 3; i < 6; ++i) {
    if (in_degrees) n[i] *= kDegree;
    if (std::abs(n[i]) > kLargestAngle) pose.fail("angles must be within +-1e6 rad", to_shortest_text(n[i]));
  }
  return {unit_or_same(rotation_from_rpy(n[3], n[4], n[5])), Vec3(n[0], n[1], n[2])};
}

}  // namespace tumble
