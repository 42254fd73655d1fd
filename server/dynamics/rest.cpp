// See rest.h. A speed that is small only at the end of the step may be a turning point (a mass on a spring, a box that
// rocks): both ends of the step must be slow.
#include "dynamics/rest.h"

#include <algorithm>

namespace tumble {

double island_speed(const ContactProblem& problem) {
  double fastest = 0.0;
  for (const SolverBody& body : problem.bodies) {
    if (body.inv_mass == 0.0) continue;
    if (!body.v.allFinite() || !body.w.allFinite()) return kInfinity;
    fastest = std::max({fastest, body.v.norm() + body.w.norm(), body.v0.norm() + body.w0.norm()});
  }
  return fastest;
}

bool check_rest(const ContactProblem& problem, double residual, const RestSettings& settings,
                double& calm_for) {
  if (problem.contacts.empty() && problem.rows.empty()) {
    calm_for = 0.0;
    return false;
  }
  const double speed = island_speed(problem);
  const bool solved = residual < settings.residual;
  calm_for = !solved && speed < settings.calm_speed ? calm_for + problem.h : 0.0;
  const bool certified = solved && speed < std::min(settings.speed, settings.acceleration * problem.h);
  return certified || calm_for >= settings.calm_time;
}

}  // namespace tumble
