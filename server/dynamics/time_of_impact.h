// When two moving shapes touch within a step. Spheres in flight against spheres and planes in closed form; everything
// else by conservative advancement (Mirtich 1996) of second order: from the plane that separates the two now, a time is
// derived up to which no point can cross it, given the velocities now and bounds on all accelerations. The error of one
// advance is quadratic in its length, so it converges like Newton's method, but from the safe side and to the first
// touch: no fast or thin body is passed by. World frame W, SI units.
#pragma once

#include <optional>

#include "collision/shape.h"
#include "dynamics/trajectory.h"

namespace tumble {

/// A shape that rides on a body.
struct MovingShape {
  const Trajectory& way;
  const Shape& shape;
  const Pose& X_BS;
};

struct ImpactSearch {
  double from, to;         ///< [s]
  std::uint32_t part = 0;  ///< Triangle, if one of the shapes is a surface.
};

struct TimeOfImpact {
  double time =
      0.0;  ///< [s]; at it the shapes are apart by round-off, or overlap because they did at `from`.
  int iterations = 0;    ///< Poses looked at.
  bool bounded = false;  ///< The search ended at its bound: the time is safe, but early.
};

/// The first time in [from, to] at which the shapes touch and approach; shapes that touch at `from` and part are followed
/// until they meet again. None: they do not.
std::optional<TimeOfImpact> find_impact(const MovingShape& a, const MovingShape& b,
                                        const ImpactSearch& search);

/// How long a point with the height `gap` [m], the rate w [m/s] and the acceleration a [m/s^2] stays above 0 [s].
double time_above(double gap, double w, double a);

/// How long two points stay further apart than `distance` [m], at least: d, u [m/s] and g [m/s^2] of one relative to the
/// other. To round-off where g is 0.
double time_apart(const Vec3& d, const Vec3& u, const Vec3& g, double distance);

}  // namespace tumble
