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

/// The row between the anchors row.rA, row.rB [m from the centres of mass, in W, at the start of the step] over a step h:
/// tension k (C + h (u0 + u)/4) + c (u0 + u)/2 with C the extension at the start. False (no row)
/// if the anchors coincide, where the direction is undefined, or if it has neither stiffness nor damping. Velocities of A
/// and B: v0 at the start, v after forces; direction and arms become those predicted for the middle of the step.
bool make_spring_row(const Spring& spring, const SolverBody& A, const SolverBody& B, double h,
                     ScalarRow& row);

/// Sets softness and bias of a spring's row for a (sub-)step h from its extension [m] and rate [m/s] at its start, for
/// bodies that then move with the average velocity (implicit midpoint), or with the end velocity: force of the extension
/// C + h u/2, which damps by about k h/4 per kilogram but is stable for any stiffness, as midpoint would not be.
void soften_row(ScalarRow& row, double h, double extension, double start_speed, ContactProblem::Drift drift);

/// Energy stored: k (length - rest)^2 / 2 [J].
double spring_energy(const Spring& spring, double length);

}  // namespace tumble
