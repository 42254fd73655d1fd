// The impact of one contact point with Coulomb friction: compression to u_n = 0, then restitution of the normal impulse
// (Poisson), never gaining kinetic energy. Contact frame (n, t1, t2); u velocity of b relative to a, p impulse on b.
#pragma once

#include "math/types.h"

namespace tumble {

/// Minimum of p.K p / 2 + u.p over the disc |p| <= radius (K symmetric positive definite): the friction impulse that a
/// fixed normal impulse allows. [N s]
Eigen::Vector2d solve_friction_disc(const Eigen::Matrix2d& K, const Eigen::Vector2d& u, double radius);

/// Inelastic impulse: u_n + (K p)_n = 0, |p_t| <= mu p_n, sliding friction against the sliding direction that it leaves.
/// u.x() < 0; K [1/kg] symmetric positive definite.
Vec3 solve_compression(const Mat3& K, const Vec3& u, double friction);

/// Whole impulse of the impact, p_n = (1 + restitution) times the compression's. Kinetic energy does not rise.
Vec3 solve_point_impact(const Mat3& K, const Vec3& u, double friction, double restitution);

}  // namespace tumble
