// The best impulses found so far for a contact problem: several methods may be tried on one problem, and only an
// improvement counts. Impulses are always judged on the velocities that follow from them, v = v* + M^-1 J^T lambda, so
// whatever a method believes of its own velocities, momentum is conserved to round-off.
#pragma once

#include <vector>

#include "dynamics/contact_problem.h"

namespace tumble {

class BestImpulses {
 public:
  /// Takes the problem as a solver gets it, velocities v* and stored impulses, and judges these.
  explicit BestImpulses(ContactProblem& problem);

  /// Residual [m/s] of the impulses that are now in the problem; kept if smaller than any before. Leaves the velocities
  /// that follow from them in the problem.
  double offer();
  double residual() const { return residual_; }
  /// Back to what was known of the same problem earlier.
  void go_back(const BestImpulses& earlier);

  /// Puts the best impulses back, with the velocities that follow from them, or with v*.
  void restore();
  void restore_start();
  /// Velocities v* and no impulses; what was kept is forgotten.
  void drop();

 private:
  void keep();
  void set_impulses();
  void set_free_velocities();

  ContactProblem& problem_;
  std::vector<Vec3> free_;  // v*, w* of every body
  std::vector<Vec3> contact_;
  std::vector<double> row_;
  std::vector<Vec3> turning_;
  double residual_;
};

}  // namespace tumble
