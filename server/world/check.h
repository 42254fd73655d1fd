// What commands to and questions of the world have in common: a bad value is refused as "field: reason (value)", by
// std::invalid_argument.
#pragma once

#include <string>

#include "math/pose.h"

namespace tumble {

[[noreturn]] void refuse(const std::string& reason);
void check_finite(const char* field, const Vec3& v);
/// Finite, and the quaternion unit to 1e-6 of its square.
void check_pose(const char* position_field, const char* orientation_field, const Pose& pose);

}  // namespace tumble
