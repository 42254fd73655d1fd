// See best_impulses.h.
#include "dynamics/best_impulses.h"

namespace tumble {

BestImpulses::BestImpulses(ContactProblem& problem)
    : problem_(problem),
      contact_(problem.contacts.size()),
      row_(problem.rows.size()),
      turning_(problem.turnings.size()),
      residual_(kInfinity) {
  free_.reserve(2 * problem.bodies.size());
  for (const SolverBody& body : problem.bodies) {
    free_.push_back(body.v);
    free_.push_back(body.w);
  }
  keep();
  offer();
}

double BestImpulses::offer() {
  set_free_velocities();
  apply_stored_impulses(problem_);
  const double residual = compute_residual(problem_);
  if (residual < residual_) {
    residual_ = residual;
    keep();
  }
  return residual;
}

void BestImpulses::restore() {
  restore_start();
  apply_stored_impulses(problem_);
}

void BestImpulses::restore_start() {
  set_impulses();
  set_free_velocities();
}

void BestImpulses::drop() {
  for (Vec3& lambda : contact_) lambda.setZero();
  for (double& lambda : row_) lambda = 0.0;
  for (Vec3& lambda : turning_) lambda.setZero();
  residual_ = kInfinity;
  restore_start();
}

void BestImpulses::go_back(const BestImpulses& earlier) {
  contact_ = earlier.contact_;
  row_ = earlier.row_;
  turning_ = earlier.turning_;
  residual_ = earlier.residual_;
}

void BestImpulses::keep() {
  for (std::size_t i = 0; i < contact_.size(); ++i) contact_[i] = problem_.contacts[i].lambda;
  for (std::size_t i = 0; i < row_.size(); ++i) row_[i] = problem_.rows[i].lambda;
  for (std::size_t i = 0; i < turning_.size(); ++i) turning_[i] = problem_.turnings[i].lambda;
}

void BestImpulses::set_impulses() {
  for (std::size_t i = 0; i < contact_.size(); ++i) problem_.contacts[i].lambda = contact_[i];
  for (std::size_t i = 0; i < row_.size(); ++i) problem_.rows[i].lambda = row_[i];
  for (std::size_t i = 0; i < turning_.size(); ++i) problem_.turnings[i].lambda = turning_[i];
}

void BestImpulses::set_free_velocities() {
  for (std::size_t i = 0; i < problem_.bodies.size(); ++i) {
    problem_.bodies[i].v = free_[2 * i];
    problem_.bodies[i].w = free_[2 * i + 1];
  }
}

}  // namespace tumble
