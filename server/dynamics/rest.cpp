// See rest.h. A speed that is small only at the end of the step may be a turning point (a mass on a spring, a box that
// rocks): both ends of the step must be slow.
#include "dynamics/rest.h"

#include <algorithm>
#include <cmath>

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

namespace {

/// sqrt(2 T / m) of the fastest body at either end of the step [m/s]: what turns fast and is small is not fast.
double fastest_by_energy(const ContactProblem& problem) {
  double fastest = 0.0;
  for (const SolverBody& body : problem.bodies) {
    if (body.inv_mass == 0.0) continue;
    const Mat3 I_W = body.inv_I_W.inverse();
    const auto square = [&](const Vec3& v, const Vec3& w) {
      return v.squaredNorm() + body.inv_mass * w.dot(I_W * w);
    };
    const double faster = std::max(square(body.v, body.w), square(body.v0, body.w0));
    if (!(faster < kInfinity)) return kInfinity;
    fastest = std::max(fastest, faster);
  }
  return std::sqrt(fastest);
}

}  // namespace

bool check_rest(const ContactProblem& problem, double residual, const RestSettings& settings,
                double& calm_for) {
  if (problem.contacts.empty() && problem.rows.empty()) {
    calm_for = 0.0;
    return false;
  }
  const bool solved = residual < settings.residual;
  const bool calm = !solved && fastest_by_energy(problem) < std::min(settings.calm_speed, residual);
  calm_for = calm ? calm_for + problem.h : 0.0;
  const bool certified =
      solved && island_speed(problem) < std::min(settings.speed, settings.acceleration * problem.h);
  return certified || calm_for >= settings.calm_time;
}

}  // namespace tumble
