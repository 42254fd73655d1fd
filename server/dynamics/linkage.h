// Joints in a blow: rows that hold u = 0 whatever strikes, and answer every impulse in the same instant.
//   M^-1 J^T lambda is added to the velocities so that J v = 0, J the two-sided rows of a problem.
#pragma once

#include <Eigen/QR>

#include "dynamics/contact_problem.h"

namespace tumble {

class Linkage {
 public:
  /// Of the problem's rigid two-sided rows; their bounds play no part.
  explicit Linkage(const ContactProblem& problem);

  bool empty() const { return rows_.empty(); }
  /// Makes u = 0 in all rows. Kinetic energy falls or stays. Rows that say the same share the impulse.
  void hold(std::vector<SolverBody>& bodies) const;
  /// inverse_mass(A, B, contact) of bodies that are linked, to each other or to others [1/kg].
  Mat3 inverse_mass(const ContactProblem& problem, const PointContact& contact) const;
  /// What a unit impulse along `direction` at one contact does to the velocities of all bodies.
  std::vector<SolverBody> answer(const ContactProblem& problem, const PointContact& contact,
                                 const Vec3& direction) const;

 private:
  std::vector<ScalarRow> rows_;
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> compliance_;  // J M^-1 J^T
};

}  // namespace tumble
