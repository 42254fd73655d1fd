// See linkage.h.
#include "dynamics/linkage.h"

namespace tumble {
namespace {

double speed(const std::vector<SolverBody>& bodies, const ScalarRow& row) {
  return row.n.dot(relative_velocity(bodies[row.a], bodies[row.b], row.rA, row.rB));
}

void apply(std::vector<SolverBody>& bodies, const ScalarRow& row, double lambda) {
  apply_impulse(bodies[row.a], bodies[row.b], row.rA, row.rB, lambda * row.n);
}

/// The bodies at rest.
std::vector<SolverBody> stopped(std::vector<SolverBody> bodies) {
  for (SolverBody& body : bodies) {
    body.v.setZero();
    body.w.setZero();
  }
  return bodies;
}

}  // namespace

Linkage::Linkage(const ContactProblem& problem) {
  for (const ScalarRow& row : problem.rows) {
    if (row.is_two_sided() && row.mass > 0.0) rows_.push_back(row);
  }
  const auto count = static_cast<Eigen::Index>(rows_.size());
  if (count == 0) return;
  Eigen::MatrixXd compliance(count, count);
  for (Eigen::Index j = 0; j < count; ++j) {
    std::vector<SolverBody> bodies = stopped(problem.bodies);
    apply(bodies, rows_[static_cast<std::size_t>(j)], 1.0);
    for (Eigen::Index i = 0; i < count; ++i) {
      compliance(i, j) = speed(bodies, rows_[static_cast<std::size_t>(i)]);
    }
  }
  compliance_.compute(compliance);
}

void Linkage::hold(std::vector<SolverBody>& bodies) const {
  // The second round takes away what rounding left of the first.
  for (int round = 0; round < 2 && !empty(); ++round) {
    Eigen::VectorXd u(static_cast<Eigen::Index>(rows_.size()));
    for (std::size_t i = 0; i < rows_.size(); ++i) u[static_cast<Eigen::Index>(i)] = speed(bodies, rows_[i]);
    const Eigen::VectorXd lambda = compliance_.solve(-u);
    for (std::size_t i = 0; i < rows_.size(); ++i)
      apply(bodies, rows_[i], lambda[static_cast<Eigen::Index>(i)]);
  }
}

std::vector<SolverBody> Linkage::answer(const ContactProblem& problem, const PointContact& contact,
                                        const Vec3& direction) const {
  std::vector<SolverBody> bodies = stopped(problem.bodies);
  apply_impulse(bodies[contact.a], bodies[contact.b], contact.rA, contact.rB, direction);
  hold(bodies);
  return bodies;
}

Mat3 Linkage::inverse_mass(const ContactProblem& problem, const PointContact& contact) const {
  Mat3 frame, K;
  frame << contact.n, contact.t1, contact.t2;
  for (int k = 0; k < 3; ++k) {
    const std::vector<SolverBody> bodies = answer(problem, contact, frame.col(k));
    K.col(k) =
        frame.transpose() * relative_velocity(bodies[contact.a], bodies[contact.b], contact.rA, contact.rB);
  }
  K = 0.5 * (K + K.transpose()).eval();
  // Joints may hold a point of contact altogether; what they hold stays a little soft then, so that K has an inverse.
  constexpr double kSingular = 1e-15, kSoft = 1e-14;
  const double size = K.trace();
  if (K.determinant() < kSingular * size * size * size) K += kSoft * size * Mat3::Identity();
  return K;
}

}  // namespace tumble
