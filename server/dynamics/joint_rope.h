// A rope: two anchors that cannot be further apart than its length, and are free when it is slack. The unilateral,
// frictionless row 0 <= tension perp (length - distance) >= 0 of the island's problem.
#pragma once

#include "dynamics/contact_problem.h"

namespace tumble {

struct Rope {
  double length = 0.0;       ///< [m], > 0
  double restitution = 0.0;  ///< 0..1: share of the stretching speed that it gives back when it snaps taut.
};

/// The row between the anchors row.rA, row.rB [m from the centres of mass, in W, at the start of the step] over a step h,
/// in the direction that brings the anchors together; direction and arms become those predicted for the middle of the
/// step. Way left: gap = (length^2 - distance^2) / (2 |middle|). Swinging taut: (u0 + u)/2 >= -gap/h; snapping taut:
/// u >= -gap/h, or C_r times the stretching speed. Over-long: taken back at most as `settings` say. False (no row) if it
/// cannot become taut within the step at the velocities of A and B, or the anchors coincide.
bool make_rope_row(const Rope& rope, const SolverBody& A, const SolverBody& B, double h,
                   const BoundSettings& settings, ScalarRow& row);

/// The row as a blow meets it now: u >= 0. False if more than `slack` [m] is left of the rope's length.
bool make_taut_rope_row(const Rope& rope, const SolverBody& A, const SolverBody& B, double slack,
                        ScalarRow& row);

}  // namespace tumble
