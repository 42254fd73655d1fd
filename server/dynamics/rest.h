// When an island may stop being stepped. Certified: residual and every speed below tiny limits after a solve; its
// velocities become exactly zero and its poses stay. Calm: slower than `calm_speed`, and than the residual, for
// `calm_time`; for solvers whose residual never gets that small.
#pragma once

#include "dynamics/contact_problem.h"

namespace tumble {

struct RestSettings {
  double residual = 1e-6;  ///< [m/s] certified: largest residual.
  double speed = 1e-6;     ///< [m/s] certified: largest |v| + |w| r; also capped by `acceleration` h.
  double acceleration =
      6e-5;  ///< [m/s^2] what may go unnoticed at most: the speed limit is min(speed, this h).
  /// [m/s] calm, only for islands whose residual is above `residual`; as Box3D's limit. A sub-stepped heap of 1000 bodies
  /// has a residual of 4e-2 and keeps trembling by as much here and there: motion slower than that is the solver's.
  double calm_speed = 5e-2;
  double calm_time = 0.5;  ///< [s]
};

/// Largest |v| + |w| of the island's movable bodies at either end of the step (m/s and rad/s added), infinite if a
/// velocity is not finite.
double island_speed(const ContactProblem& problem);

/// True if the island, solved with `residual`, may rest now. `calm_for` [s] is how long it has been calm, updated here. An
/// island whose residual is small is judged by the certificate alone: its slow motion is real. An island without contacts
/// or taut rows never rests: nothing holds it.
bool check_rest(const ContactProblem& problem, double residual, const RestSettings& settings,
                double& calm_for);

}  // namespace tumble
