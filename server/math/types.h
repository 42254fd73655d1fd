// Linear algebra types used everywhere. Eigen's fixed-size doubles; vector packets are switched off in the build
// (same input, same bits), so these types have no alignment rules and may be stored and passed freely.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <limits>

namespace tumble {

using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;
/// Unit quaternion, body to world: v_W = q_WB * v_B. Written (w, x, y, z) wherever a person or a wire sees it.
using Quat = Eigen::Quaterniond;

/// [m] What stands further out is refused: a double still resolves 1e-7 m there.
inline constexpr double kMaxCoordinate = 1e9;
inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace tumble
