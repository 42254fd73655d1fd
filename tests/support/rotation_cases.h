// Rotations of a rigid body with known ends: computed once with Taylor series of order 32 in 113-bit arithmetic at two
// step sizes that agree in all 17 digits. Moments are principal and about the body's axes; the body starts at the
// identity with angular velocity w0 and feels a constant world torque.
#pragma once

#include <cmath>

#include "math/types.h"

namespace tumble {

struct RotationCase {
  const char* name;
  Vec3 I;       ///< [kg m^2]
  Vec3 w0;      ///< [rad/s]
  Vec3 torque;  ///< in W [N m]
  double time;  ///< [s]
  Quat q;       ///< q_WB at `time`
  Vec3 w_B;     ///< at `time`, in body axes [rad/s]
};

inline const RotationCase kGeneric = {
    "generic",
    Vec3(0.6, 0.8, 1.0),
    Vec3(3.0, 0.5, -0.9),
    Vec3::Zero(),
    10.0,
    Quat(-0.73606136416079382, -0.57078695124035073, -0.29938857183079048, -0.20683908610467294),
    Vec3(2.9432708475303464, -0.86933024629135924, 0.77955498148187208)};
/// About the intermediate axis, nearly: it flips over and over.
inline const RotationCase kDzhanibekov = {
    "Dzhanibekov",
    Vec3(1.0, 2.0, 3.0),
    Vec3(1e-3, 5.0, 1e-3),
    Vec3::Zero(),
    10.0,
    Quat(0.20320052058628316, -0.67023187844919518, -0.49284233960116358, -0.51633826687587103),
    Vec3(4.5106271240116529, -2.1573696827688957, 2.6042119122599345)};
inline const RotationCase kPlate = {
    "plate",
    Vec3(0.5, 0.75, 1.2),
    Vec3(6.0, -2.0, 4.0),
    Vec3::Zero(),
    10.0,
    Quat(0.38155567323456357, -0.48034105391019516, 0.31928804810955913, -0.72231771574934378),
    Vec3(5.4121241817256216, -3.3101948670638124, 3.8009224074929797)};
inline const RotationCase kTorque = {
    "torque10",
    Vec3(0.6, 0.8, 1.0),
    Vec3(3.0, 0.5, -0.9),
    Vec3(0.3, -0.2, 0.5),
    10.0,
    Quat(0.69995398828916233, -0.38224893938881965, -0.25144423298744817, -0.54838486513722418),
    Vec3(8.9814821021095295, 4.2177607330994586, 1.4087543947553773)};
/// A thin rod that spins fast about its axis.
inline const RotationCase kRod = {
    "rod",
    Vec3(1e-6, 1.0, 1.0000005),
    Vec3(40.0, 5.0, 1.0),
    Vec3::Zero(),
    1.0,
    Quat(-0.30985779494181376, -0.76975483424646518, 0.30588705374310499, -0.46679626435989879),
    Vec3(40.103090131446081, -2.9127876816498084, -4.185170415403098)};

/// Angle between two orientations [rad], accurate when tiny, whatever the signs of the quaternions.
inline double angle_between(const Quat& a, const Quat& b) {
  const Quat d = a.conjugate() * b;
  return 2.0 * std::atan2(d.vec().norm(), std::abs(d.w()));
}

}  // namespace tumble
