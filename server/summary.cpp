// See summary.h.
#include "summary.h"

#include <fmt/format.h>

#include <ctime>
#include <nlohmann/json.hpp>

namespace tumble {
namespace {

using Json = nlohmann::ordered_json;

Json to_json(const Vec3& v) {
  return {v.x(), v.y(), v.z()};
}

Json counters_json(const Counters& c) {
  const NarrowPhaseCounters& n = c.narrow_phase;
  return {
      {"boxes_renewed", c.boxes_renewed},
      {"pair_queries", n.queries},
      {"pairs_unmoved", n.unmoved},
      {"pairs_skipped_by_motion_bound", n.motion_bound},
      {"pairs_skipped_by_cached_axis", n.cached_axis},
      {"pairs_gjk", n.gjk},
      {"pairs_gjk_uncertified", n.gjk_uncertified},
      {"pairs_gjk_budget_hit", n.gjk_budget_hit},
      {"pairs_exact", n.exact},
      {"pairs_closed_form", n.closed_form},
      {"pairs_facet_kept", n.facet_kept},
      {"pairs_skipped_clear", c.pairs_skipped_clear},
      {"bodies_stepped", c.bodies_stepped},
      {"bodies_skipped_resting", c.bodies_skipped_resting},
      {"bodies_skipped_flying", c.bodies_skipped_flying},
      {"islands_solved", c.islands_solved},
      {"islands_accepted", c.islands_accepted},
      {"islands_free", c.islands_free},
      {"islands_smooth", c.islands_smooth},
      {"sweeps", c.sweeps},
      {"solver_iterations", c.solver_iterations},
      {"newton_steps", c.newton_steps},
      {"exact_work", c.exact_work},
      {"islands_exact", c.islands_exact},
      {"patterns_kept", c.patterns_kept},
      {"patterns_made", c.patterns_made},
      {"solver_fallbacks", c.solver_fallbacks},
      {"impacts", c.impacts},
      {"impacts_capped", c.impacts_capped},
      {"impacts_micro", c.impacts_micro},
      {"overlaps_removed", c.overlaps_removed},
      {"overlap_steps", c.overlap_steps},
      {"slides_ended", c.slides_ended},
      {"landings", c.landings},
      {"cuts_capped", c.cuts_capped},
      {"islands_by_midpoint", c.islands_by_midpoint},
      {"joint_passes", c.joint_passes},
      {"taut_parts", c.taut_parts},
      {"impacts_ended", c.impacts_ended},
      {"impacts_clamped", c.impacts_clamped},
      {"impacts_gained", c.impacts_gained},
      {"impact_passes", c.impact_passes},
      {"impact_searches", c.impact_searches},
      {"impact_searches_bounded", c.impact_searches_bounded},
      {"rests", c.rests},
      {"wakes", c.wakes},
      {"non_finite_contained", c.non_finite_contained},
  };
}

double ms_per_step(const RunTimes& times) {
  return times.steps > 0 ? times.wall_s * 1e3 / static_cast<double>(times.steps) : 0.0;
}

}  // namespace

std::string summary_json(const World& world, const RunTimes& times) {
  const Conserved sums = world.compute_conserved();
  const StepReport& report = world.report();
  const Json summary = {
      {"steps", times.steps},
      {"dt", world.options().time_step},
      {"bodies", world.body_count()},
      {"wall_s", times.wall_s},
      {"cpu_s", times.cpu_s},
      {"ms_per_step", ms_per_step(times)},
      {"state_hash", fmt::format("{:016x}", world.state_hash())},
      {"kinetic_energy", sums.kinetic_energy},
      {"potential_energy", sums.potential_energy},
      {"momentum", to_json(sums.momentum)},
      {"angular_momentum", to_json(sums.angular_momentum)},
      {"deepest_penetration", report.deepest_penetration},
      {"max_residual", report.max_residual},
      {"contacts", report.contacts},
      {"bodies_awake", report.bodies_awake},
      {"bodies_resting", report.bodies_resting},
      {"worst_penetration", times.deepest_penetration},
      {"worst_residual", times.max_residual},
      {"counters", counters_json(world.counters())},
  };
  return summary.dump();
}

std::string summary_text(const World& world, const RunTimes& times) {
  const Conserved sums = world.compute_conserved();
  const StepReport& report = world.report();
  const auto steps = static_cast<double>(times.steps);
  const double dt = world.options().time_step;
  return fmt::format(
      "{} steps of {:g} s ({:g} s simulated) in {:.3f} s of wall time; {:.3f} s of processor time, {:.4f} ms "
      "a step\n"
      "{} bodies, {} awake, {} resting; {} contacts, deepest penetration {:.3g} m\n"
      "kinetic energy {:.9g} J, potential {:.9g} J, momentum ({:.6g}, {:.6g}, {:.6g}) N s\n"
      "state hash {:016x}",
      times.steps, dt, steps * dt, times.wall_s, times.cpu_s,
      times.steps > 0 ? 1e3 * times.cpu_s / steps : 0.0, world.body_count(), report.bodies_awake,
      report.bodies_resting, report.contacts, report.deepest_penetration, sums.kinetic_energy,
      sums.potential_energy, sums.momentum.x(), sums.momentum.y(), sums.momentum.z(), world.state_hash());
}

double cpu_seconds() {
  timespec time{};
  ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_nsec) * 1e-9;
}

}  // namespace tumble
