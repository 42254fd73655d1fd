// Linear algebra types used everywhere. Eigen's fixed-size doubles; vector packets are switched off in the build
// (same input, same bits), so these types have no alignment rules and may be stored and passed freely.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace tumble {

using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;
/// Unit quaternion, body to world: v_W = q_WB * v_B. Written (w, x, y, z) wherever a person or a wire sees it.
using Quat = Eigen::Quaterniond;

}  // namespace tumble
