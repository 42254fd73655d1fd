// The cost of impacts: steps full of them, and their parts. `./run bench impacts` also prints the table of errors.
#include <benchmark/benchmark.h>

#include "dynamics/time_of_impact.h"
#include "support/impact_scenes.h"

namespace {

using namespace tumble;
using namespace tumble::test;

void step(benchmark::State& state, World world) {
  const std::uint64_t before = world.counters().impacts;
  for (auto _ : state) world.step();
  state.counters["impacts"] = benchmark::Counter(static_cast<double>(world.counters().impacts - before),
                                                 benchmark::Counter::kAvgIterations);
}

void step_elastic_666(benchmark::State& state) {
  step(state, elastic_666(6, 1e-3));
}
BENCHMARK(step_elastic_666)->Iterations(2000)->Unit(benchmark::kMicrosecond);

void step_gas(benchmark::State& state) {
  step(state, gas(8, with_step(1.0 / 60.0)));
}
BENCHMARK(step_gas)->Iterations(120)->Unit(benchmark::kMicrosecond);

void step_bouncing(benchmark::State& state) {
  step(state, bouncing(7, 1e-3));
}
BENCHMARK(step_bouncing)->Iterations(5000)->Unit(benchmark::kMicrosecond);

/// When a tumbling box falls on the ground.
void find_impact_of_box(benchmark::State& state) {
  const Shape box = Box{Vec3(0.3, 0.2, 0.1)}, ground = HalfSpace{};
  const MassProperties mass = compute_mass_properties(compute_inertia(box, 1000.0));
  Motion motion;
  motion.x = Vec3(0, 0, 0.5);
  motion.v = Vec3(0.5, 0.2, -2.0);
  motion.w = Vec3(3, 4, 5);
  motion.L = angular_momentum(mass, motion.q, motion.w);
  const Vec3 gravity(0, 0, -9.81);
  const Trajectory falls(mass, motion, 0.0, Flight(mass, motion, gravity), 0.0), stays;
  const Pose at_centre;
  int looks = 0;
  for (auto _ : state) {
    const auto impact =
        find_impact({stays, ground, at_centre}, {falls, box, at_centre}, {.from = 0.0, .to = 0.2});
    benchmark::DoNotOptimize(impact);
    looks = impact ? impact->iterations : 0;
  }
  state.counters["looks"] = looks;
}
BENCHMARK(find_impact_of_box);

}  // namespace

BENCHMARK_MAIN();
