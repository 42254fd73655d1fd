// See integrator.h: the table of rivals, and what they share.
#include "dynamics/integrator.h"

#include "dynamics/rival.h"

namespace tumble {
namespace {

constexpr std::array<Rival<Integrator, IntegrateFunction>, 6> kRivals = {{
    {Integrator::course, "course", integrate_course},
    {Integrator::semi_implicit_euler, "semi_implicit_euler", integrate_semi_implicit_euler},
    {Integrator::rk4, "rk4", integrate_rk4},
    {Integrator::taylor8, "taylor8", integrate_taylor8},
    {Integrator::dmv8, "dmv8", integrate_dmv8},
    {Integrator::closed_form, "closed_form", integrate_closed_form},
}};

}  // namespace

IntegrateFunction integrate_function(Integrator integrator) {
  return rival(kRivals, integrator).function;
}

const char* integrator_name(Integrator integrator) {
  return rival(kRivals, integrator).name;
}

std::optional<Integrator> integrator_from_name(std::string_view name) {
  return kind_from_name(kRivals, name);
}

void set_end_of_step(const MassProperties& mass, const VelocityPath& path, const Quat& q_WB, Motion& body) {
  body.v = path.v1;
  body.L = path.L1;
  body.q = normalized(q_WB);
  body.w = angular_velocity(mass, body.q, body.L);
}

void move_kinematic(Motion& body, double h) {
  body.x += h * body.v;
  body.q = normalized(exp_map(h * body.w) * body.q);
}

}  // namespace tumble
