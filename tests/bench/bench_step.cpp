// Cost and quality of one World::step() on the demo scenes, solvers and integrators side by side (the one not named is
// the default). Each measurement replays the same steps from a copy of the same world, after a run-in.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cstdint>
#include <string>

#include "dynamics/integrator.h"
#include "dynamics/solver.h"
#include "scene/demo.h"

namespace tumble {
namespace {

constexpr int kRunIn = 240;     // steps before the measurement: things have fallen and met
constexpr int kMeasured = 120;  // steps measured; half a second of simulated time

/// Total energy now; its change over the measured steps tells what a scheme loses or invents.
double compute_energy(const World& world) {
  const Conserved conserved = world.compute_conserved();
  return conserved.kinetic_energy + conserved.potential_energy;
}

void measure_step(benchmark::State& state, const Scene& scene) {
  World start = build_world(scene);
  for (int i = 0; i < kRunIn; ++i) start.step();
  double penetration = 0.0, residual = 0.0, energy_change = 0.0;
  std::uint32_t contacts = 0, awake = 0;
  for (auto run : state) {
    state.PauseTiming();
    World world = start;
    state.ResumeTiming();
    for (int i = 0; i < kMeasured; ++i) {
      world.step();
      penetration = std::max(penetration, world.report().deepest_penetration);
      residual = std::max(residual, world.report().max_residual);
    }
    state.PauseTiming();
    energy_change = compute_energy(world) - compute_energy(start);
    contacts = world.report().contacts;
    awake = world.report().bodies_awake;
    state.ResumeTiming();
  }
  state.counters["us_per_step"] = benchmark::Counter(
      1e-6 * kMeasured, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
  state.counters["bodies"] = start.body_count();
  state.counters["awake"] = awake;
  state.counters["contacts"] = contacts;
  state.counters["penetration_m"] = penetration;
  state.counters["residual_m_s"] = residual;
  state.counters["energy_change_J"] = energy_change;
}

void add_measurement(const std::string& name, const Scene& scene) {
  benchmark::RegisterBenchmark(name.c_str(), measure_step, scene)
      ->Unit(benchmark::kMillisecond)
      ->UseRealTime();
}

void add_measurements() {
  for (const std::string_view demo : demo_names()) {
    const std::string name(demo);
    const Scene scene = read_sdf_text(std::string(demo_text(demo)), name, ".").scene;
    for (const Solver solver : {Solver::course_impulse, Solver::pgs, Solver::nncg, Solver::soft_step,
                                Solver::alm_newton, Solver::interior_point, Solver::exact}) {
      Scene changed = scene;
      changed.options.solver = solver;
      add_measurement(name + "/solver:" + solver_name(solver), changed);
    }
    for (const Integrator integrator : {Integrator::course, Integrator::semi_implicit_euler, Integrator::rk4,
                                        Integrator::taylor8, Integrator::dmv8, Integrator::closed_form}) {
      Scene changed = scene;
      changed.options.integrator = integrator;
      add_measurement(name + "/integrator:" + integrator_name(integrator), changed);
    }
  }
}

[[maybe_unused]] const bool kAdded = (add_measurements(), true);

}  // namespace
}  // namespace tumble

BENCHMARK_MAIN();
