// The rungs that the exact solvers climb, cheapest first: take the warm start as it is, sweep, Newton, interior point.
// Each starts from the best impulses so far and only an improvement counts; what has no solution (a press
// that closes on a body) is recognised by its residual or its impulses and gets the compromise of cone_newton.h.
#pragma once

#include <algorithm>
#include <memory>
#include <optional>

#include "dynamics/best_impulses.h"
#include "dynamics/solver.h"
#include "dynamics/velocity_system.h"

namespace tumble {

class Ladder {
 public:
  Ladder(ContactProblem& problem, const SolverSettings& settings);

  /// The warm start is a solution.
  bool accepted() const { return report_.accepted; }
  /// To what was asked for, or to rounding, below which no rung gets reliably.
  bool solved() const { return accepted() || best_.residual() < std::max(wanted_, rounding_); }
  /// A single body with up to two faces' contacts: sweeps cost less than one factorization.
  bool is_small() const;
  /// Fastest velocity of a body at the start of the step [m/s or rad/s].
  double start_speed() const;
  /// Of the heaviest movable body to the lightest.
  double mass_ratio() const { return heaviest_ / lightest_; }
  /// A factorization takes at most `limit` products of blocks. Asked before the first rung that factorizes.
  bool fits(std::uint64_t limit);
  /// Of one factorization, in products of blocks. After `fits`.
  double work() const { return pattern_ ? static_cast<double>(pattern_->products()) : 0.0; }

  void sweep(int max_sweeps);
  void newton(int max_iterations);
  /// Newton on the cones, for heaps.
  void cone_newton(int max_iterations);
  /// Until the residual is below `residual` [m/s]; false if it is not.
  bool interior_point(double residual);

  /// Puts the best impulses into the problem, or a compromise where there is no solution.
  SolverReport finish();
  /// Leaves the problem as it was given.
  void leave();

  double residual() const { return best_.residual(); }
  double wanted() const { return wanted_; }
  int movable() const { return movable_; }  ///< Bodies.

 private:
  bool is_plausible() const;
  VelocitySystem& system();

  ContactProblem& problem_;
  const SolverSettings& settings_;
  double rounding_ = 0.0, wanted_ = 0.0;          // [m/s]
  double mass_ = 0.0;                             // [kg] of the movable bodies
  double lightest_ = kInfinity, heaviest_ = 0.0;  // [kg]
  double speed_ = 0.0;                            // [m/s] fastest approach at a contact, or body
  int movable_ = 0;
  BestImpulses best_;
  SolverReport report_;
  std::shared_ptr<const BlockPattern> pattern_;
  std::optional<VelocitySystem> system_;
};

/// Climbs on until the problem is solved to rounding; solver_exact.cpp. Not `thorough`: what Newton's method does not end
/// near the solution of the interior point (residuals of 1e-4 m/s at most) is left at that.
SolverReport finish_exactly(Ladder& ladder, const SolverSettings& settings, bool thorough = true);

}  // namespace tumble
