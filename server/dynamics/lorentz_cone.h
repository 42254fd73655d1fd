// The Lorentz cone L = {x in R^3: x0 >= |(x1, x2)|}: its Jordan algebra, the step to its boundary and Nesterov-Todd
// scaling, as the interior point solver needs them. Half lines are the same cone with x1 = x2 = 0 throughout.
// Source: Alizadeh, Goldfarb 2003 "Second-order cone programming"; Vandenberghe 2010 "The CVXOPT linear and quadratic
// cone program solvers".
#pragma once

#include "math/types.h"

namespace tumble {

/// x o y = (x . y, x0 y_bar + y0 x_bar); the unit is (1, 0, 0).
Vec3 cone_product(const Vec3& x, const Vec3& y);
/// The x with l o x = r, for l inside L.
Vec3 cone_divide(const Vec3& r, const Vec3& l);
/// (x0 - |x_bar|)(x0 + |x_bar|), at least 1e-300: > 0 inside, 0 on the boundary.
double cone_determinant(const Vec3& x);
/// Largest a >= 0 with x + a d in L, for x inside L; infinity if there is none.
double cone_step(const Vec3& x, const Vec3& d);

/// The symmetric W with W z = W^-1 s = l, for s and z inside L.
struct ConeScaling {
  Mat3 W, inverse_square;  ///< W, W^-2
  Vec3 l;
};
ConeScaling make_cone_scaling(const Vec3& s, const Vec3& z);

}  // namespace tumble
