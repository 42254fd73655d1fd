// A rope: two anchors that cannot be further apart than its length, and are free when it is slack. The unilateral,
// frictionless row 0 <= tension perp (length - distance) >= 0 of the island's problem.
#pragma once

#include "dynamics/contact_problem.h"

namespace tumble {

struct Rope {
  double length = 0.0;       ///< [m], > 0
  double restitution = 0.0;  ///< 0..1: share of the stretching speed that it gives back when it snaps taut.
};

/// The row over a step h: u >= -(length - distance)/h in the direction that brings the anchors together, pushed at most
/// by `settings` when over-long. False (no row) if it cannot become taut within the step at the velocities of A and B,
/// or the anchors coincide.
bool make_rope_row(const Rope& rope, const SolverBody& A, const SolverBody& B, double h, const BoundSettings& settings,
                   ScalarRow& row);

}  // namespace tumble
