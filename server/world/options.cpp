// See options.h.
#include "world/options.h"

#include <fmt/format.h>

#include <string>

namespace tumble {
namespace {

constexpr double kMostTurning = 1e6;  // [rad/s]

}  // namespace

void set_accuracy(Options& options, Accuracy accuracy) {
  const Options balanced;
  SolverSettings& solver = options.solver_settings;
  solver.max_sweeps = balanced.solver_settings.max_sweeps;
  solver.tolerance = balanced.solver_settings.tolerance;
  solver.exact_work = balanced.solver_settings.exact_work;
  solver.exact_calm_factor = balanced.solver_settings.exact_calm_factor;
  solver.longest_sub_step = balanced.solver_settings.longest_sub_step;
  options.landing_bodies = balanced.landing_bodies;
  options.midpoint_bodies = balanced.midpoint_bodies;
  options.midpoint_turn = balanced.midpoint_turn;
  options.crowd_turning = balanced.crowd_turning;
  if (accuracy == Accuracy::fast) {
    solver.max_sweeps = 8;
    solver.tolerance = 1e-6;
    solver.exact_work = 100.0;
    solver.exact_calm_factor = 90.0;
    solver.longest_sub_step = 1.0;
    options.landing_bodies = options.midpoint_bodies = 0;
  } else if (accuracy == Accuracy::exact) {
    solver.max_sweeps = 1000;
    solver.tolerance = 1e-10;
    solver.exact_work = 1e6;
    solver.exact_calm_factor = 30.0;
    solver.longest_sub_step = 1.0 / 3840.0;
    options.midpoint_turn = 0.0025;
    options.crowd_turning = kMostTurning;
  }
}

std::optional<Accuracy> accuracy_from_name(std::string_view name) {
  if (name == "fast") return Accuracy::fast;
  if (name == "balanced") return Accuracy::balanced;
  if (name == "exact") return Accuracy::exact;
  return std::nullopt;
}

std::string check_options(const Options& options) {
  struct Range {
    const char* field;
    double value, low, high;
  };
  const Range ranges[] = {
      {"time step", options.time_step, 1e-6, 0.1},
      {"gravity", options.gravity.norm(), 0.0, 1e6},
      {"contact margin", options.contact_margin, 0.0, 1.0},
      {"fat margin", options.fat_margin, 0.0, 10.0},
      {"slop", options.bounds.slop, 0.0, 1.0},
      {"sweep slop", options.sweep_slop, 0.0, 1.0},
      {"push fraction", options.bounds.push_fraction, 0.0, 1.0},
      {"push speed", options.bounds.push_speed, 0.0, 1e3},
      {"restitution threshold", options.restitution_threshold, 0.0, 1e3},
      {"max impacts", static_cast<double>(options.max_impacts), 1.0, 1e6},
      {"slide bodies", static_cast<double>(options.slide_bodies), 0.0, 1e6},
      {"landing bodies", static_cast<double>(options.landing_bodies), 0.0, 1e6},
      {"midpoint bodies", static_cast<double>(options.midpoint_bodies), 0.0, 1e6},
      {"midpoint turn", options.midpoint_turn, 1e-4, 10.0},
      {"crowd turning", options.crowd_turning, 0.0, kMostTurning},
      {"max cuts", static_cast<double>(options.max_cuts), 0.0, 1000.0},
      {"taut parts", static_cast<double>(options.taut_parts), 1.0, 1000.0},
      {"joint passes", static_cast<double>(options.joint_passes), 1.0, 1000.0},
      {"work rate", options.work_rate, 0.0, 1e12},
      {"max sweeps", static_cast<double>(options.solver_settings.max_sweeps), 1.0, 1e6},
      {"tolerance", options.solver_settings.tolerance, 0.0, 1.0},
      {"exact work", options.solver_settings.exact_work, 0.0, 1e9},
      {"exact calm factor", options.solver_settings.exact_calm_factor, 1.0, 1e6},
      {"exact calm speed", options.solver_settings.exact_calm_speed, 0.0, 1e3},
      {"sub steps", static_cast<double>(options.solver_settings.sub_steps), 1.0, 1000.0},
      {"longest sub step", options.solver_settings.longest_sub_step, 1e-6, 1.0},
      {"rest residual", options.rest.residual, 0.0, 1.0},
      {"rest speed", options.rest.speed, 0.0, 1.0},
      {"rest acceleration", options.rest.acceleration, 0.0, 10.0},
      {"calm speed", options.rest.calm_speed, 0.0, 1.0},
      {"calm time", options.rest.calm_time, 0.0, 1e9},
  };
  for (const Range& range : ranges) {
    if (!(range.value >= range.low && range.value <= range.high)) {
      return fmt::format("{}: must be {}..{} ({})", range.field, range.low, range.high, range.value);
    }
  }
  return {};
}

}  // namespace tumble
