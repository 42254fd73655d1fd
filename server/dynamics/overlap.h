// Overlaps at position level: after the velocities of a step are solved, bodies that overlap at its start are shifted and
// turned apart once, without friction and without a velocity, so that coming apart gives no kick and never makes the
// problem of the velocities unsolvable. Gaps of joints are taken back with them. Of all displacements dx the least in
// kinetic energy,
//   min 1/2 dx^T M dx + sum 1/2 k_i max(0, d_i - J_i dx)^2,   d_i what the contact lacks at the end of the step,
// with k_i so large that a millionth of a gap is left. Where something immovable holds the bodies up, M takes none of them
// for more than ten times as heavy as the lightest. What nothing can satisfy (a body between walls that both overlap it)
// ends in the middle instead of without end. World frame.
#pragma once

#include "dynamics/contact_problem.h"

namespace tumble {

struct OverlapReport {
  int factorizations = 0;
  /// Longest displacement of a body, shift [m] and turn [rad] added. 0: there was nothing to remove.
  double largest = 0.0;
};

struct OverlapSettings {
  double speed;  ///< [m/s] a contact or row is corrected by at most speed h in a step.
  /// Islands whose factorization takes more products of 6 x 6 blocks stay as they are.
  std::uint64_t work = ~std::uint64_t{0};
};

/// Adds the displacements to `shift` and `turn` of the bodies; velocities and impulses stay.
OverlapReport remove_overlaps(ContactProblem& problem, const OverlapSettings& settings);

}  // namespace tumble
