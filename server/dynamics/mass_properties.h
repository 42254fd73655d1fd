// Mass, centre of mass and inertia: closed forms for the primitive shapes, exact polyhedron integrals for hulls,
// parallel axes for compounds, principal axes for the integrators.
#pragma once

#include <string>
#include <vector>

#include "collision/shape.h"
#include "math/pose.h"

namespace tumble {

/// Mass distribution of one solid or a compound, about its own centre of mass.
struct Inertia {
  double mass = 0.0;            ///< [kg], > 0.
  Vec3 center = Vec3::Zero();   ///< Centre of mass in the frame of description [m].
  Mat3 moments = Mat3::Zero();  ///< Inertia about `center`, axes of the frame of description [kg m^2].
};

/// Inertia of a solid of uniform density [kg/m^3], in the shape's frame S. Sphere 2/5 m r^2 and box 1/12 m (a^2+b^2)
/// as on the course's slide; cylinder, cone and ellipsoid in closed form; capsule from cylinder and half-spheres; hull
/// exactly, as a sum of tetrahedra (Tonon 2004). Throws std::invalid_argument for a half-space, which has no mass.
Inertia compute_inertia(const Shape& shape, double density);

/// The same solid described in another frame F, S at X_FS.
Inertia transformed(const Inertia& inertia_S, const Pose& X_FS);

/// One rigid body made of parts that are described in one frame (parallel axis theorem).
Inertia combined(const std::vector<Inertia>& parts);

/// Empty if physically possible: mass > 0, moments symmetric and positive definite, each principal moment at most the
/// sum of the others (triangle inequality, with 1e-9 relative slack for rounding); else the reason with the values.
std::string check_inertia(const Inertia& inertia);

/// What the integrators and the solver need of a body. Frame B: origin at the centre of mass, axes of the link.
/// Frame P: principal axes. For a body that cannot move all inverses are 0.
struct MassProperties {
  double mass = 0.0, inv_mass = 0.0;  ///< [kg], [1/kg]
  Vec3 I = Vec3::Zero();              ///< Principal moments [kg m^2].
  Vec3 inv_I = Vec3::Zero();
  Quat q_BP = Quat::Identity();  ///< Principal axes in B; exactly the identity if B's axes are principal.
};

/// Principal axes by Jacobi rotations (exactly the identity for an exactly diagonal tensor).
MassProperties compute_mass_properties(const Inertia& inertia);

/// I_W or its inverse: R diag(moments) R^T with R = R_WB R_BP; the course's "inertia to world space".
Mat3 world_inertia(const Vec3& principal_moments, const Quat& q_BP, const Quat& q_WB);

}  // namespace tumble
