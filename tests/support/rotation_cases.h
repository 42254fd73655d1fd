// Rotations of a rigid body with known ends: computed once with Taylor series of order 32 in 113-bit arithmetic at two
// step sizes that agree in all 17 digits. Moments are principal and about the body's axes; the body starts at the
// identity with angular velocity w0 and feels a constant world torque.
#pragma once

#include <cmath>

#include "dynamics/body.h"

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
/// Nearly symmetric: the plain series of theta_4 fails here (4e-11).
inline const RotationCase kNearSymmetric = {
    "nearly symmetric",
    Vec3(0.5, 1.0, 1.0 + 0x1p-45),
    Vec3(0x1p-21, 0x1p-22, 2.0),
    Vec3::Zero(),
    3.0,
    Quat(-0.98999249660039423, -3.3722609063873935e-07, 6.7291263608793739e-08, 0.14112000805980798),
    Vec3(4.7683715820279974e-07, 1.6689300537104699e-06, 1.9999999999993179)};
inline const RotationCase kNearSpin = {
    "near steady spin",
    Vec3(0.5, 0.75, 1.2),
    Vec3(1e-9, -2e-9, 4.0),
    Vec3::Zero(),
    10.0,
    Quat(0.40808206181339196, -5.3558610227667803e-12, -2.3119131564685025e-10, 0.91294525072762767),
    Vec3(-1.1847334622283843e-09, -1.8924742324909305e-09, 4.0)};
inline const RotationCase kSeparatrix = {
    "separatrix",
    Vec3(1.0, 2.0, 3.0),
    Vec3(0x1p-20, 5.0, 0x1p-20),
    Vec3::Zero(),
    10.0,
    Quat(8.330555578692662e-06, -0.79223094029945562, -9.7651017063111507e-07, -0.61022138373043655),
    Vec3(-8.3187552518949201e-05, -4.9999999993080744, 4.8034667631813855e-05)};
inline const RotationCase kGenericLong = {
    "generic, long",
    Vec3(0.6, 0.8, 1.0),
    Vec3(3.0, 0.5, -0.9),
    Vec3::Zero(),
    1000.0,
    Quat(-0.75425294724201697, 0.65343827533348808, -0.023516543077785054, 0.059731767993242139),
    Vec3(2.8308344287555731, 1.3151291402208996, 0.46709114508491251)};
inline const RotationCase kDzhanibekovLong = {
    "Dzhanibekov, long",
    Vec3(1.0, 2.0, 3.0),
    Vec3(1e-3, 5.0, 1e-3),
    Vec3::Zero(),
    1000.0,
    Quat(-5.0135955816426244e-05, 0.33305960614726698, -4.4326725821904778e-05, 0.9429057716837641),
    Vec3(-0.00013461813515176709, -5.0000000981877948, 0.00082018738556335197)};
inline const RotationCase kPlateLong = {
    "plate, long",
    Vec3(0.5, 0.75, 1.2),
    Vec3(6.0, -2.0, 4.0),
    Vec3::Zero(),
    1000.0,
    Quat(-0.57891339277603771, -0.18283511520428533, 0.37084799037929672, -0.70278188105870365),
    Vec3(2.9776537300699895, -5.6690850767036469, 3.1175437616177559)};
inline const RotationCase kTorqueLong = {
    "torque1000",
    Vec3(0.6, 0.8, 1.0),
    Vec3(3.0, 0.5, -0.9),
    Vec3(0.0003, -0.0002, 0.0005),
    1000.0,
    Quat(-0.9583506062536129, -0.2507328503036575, 0.13023110431787244, 0.041677484809951711),
    Vec3(3.1682471635957765, 0.010244569518443773, -0.99816251129827493)};

/// A body of 1 kg with these principal moments along its axes.
inline MassProperties principal_body(const Vec3& I) {
  MassProperties mass;
  mass.mass = 1.0;
  mass.inv_mass = 1.0;
  mass.I = I;
  mass.inv_I = I.cwiseInverse();
  return mass;
}

/// Its motion at the start of the case.
inline Motion start_of(const RotationCase& c) {
  Motion start;
  start.w = c.w0;
  start.L = c.I.cwiseProduct(c.w0);
  return start;
}

/// Angle between two orientations [rad], accurate when tiny, whatever the signs of the quaternions.
inline double angle_between(const Quat& a, const Quat& b) {
  const Quat d = a.conjugate() * b;
  return 2.0 * std::atan2(d.vec().norm(), std::abs(d.w()));
}

}  // namespace tumble
