// Poses of SDF: "x y z roll pitch yaw" or "x y z qx qy qz qw", and how they are chained without touching a bit that
// need not change.
#pragma once

#include <optional>

#include "math/pose.h"
#include "scene/sdf_element.h"

namespace tumble {

/// The value of a <pose> [m, rad]; attributes `rotation_format` (euler_rpy, quat_xyzw) and `degrees`. The attribute
/// `relative_to` is the caller's to ask for.
Pose read_pose(SdfElement& pose);

/// Rz(yaw) Ry(pitch) Rx(roll), angles in [rad].
Quat rotation_from_rpy(double roll, double pitch, double yaw);

/// q itself where |q|^2 is 1 to 1e-14, else q / |q|: what was normalised once keeps its bits for ever.
Quat unit_or_same(const Quat& q);

/// X_AB X_BC with a unit quaternion; the other one, bit for bit, where one is missing.
Pose chained(const std::optional<Pose>& X_AB, const std::optional<Pose>& X_BC);

}  // namespace tumble
