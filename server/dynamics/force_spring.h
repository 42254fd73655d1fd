// A damped spring between two anchors, on two bodies or on a body and the world. Discretised by the implicit midpoint
// rule as a soft row of the island's problem: stable for any stiffness, second order, and free of numerical damping.
#pragma once

#include "dynamics/contact_problem.h"

namespace tumble {

struct Spring {
  double rest_length = 0.0;  ///< [m], >= 0
  double stiffness = 0.0;    ///< k [N/m], >= 0
  double damping = 0.0;      ///< c [N s/m], >= 0, along the line of the anchors
};

/// Force along the line from A's anchor to B's, > 0 pulls together: k (length - rest) + c d(length)/dt  [N].
double spring_tension(const Spring& spring, double length, double length_rate);

/// The row over a step h: tension k (C + h (u0 + u)/4) + c (u0 + u)/2 with C the extension at the start. False (no row)
/// if the anchors coincide, where the direction is undefined and a spring of rest length 0 pulls with no force.
bool make_spring_row(const Spring& spring, const SolverBody& A, const SolverBody& B, double h, ScalarRow& row);

/// Energy stored: k (length - rest)^2 / 2 [J].
double spring_energy(const Spring& spring, double length);

}  // namespace tumble
