// What snapshots in a log cost: taken, cut into events and encoded, as a recording server does within a tick; and
// restored from them, as --resume does. The demo scenes after a run-in.
#include <benchmark/benchmark.h>

#include <string>
#include <vector>

#include "scene/demo.h"
#include "scene/sdf.h"
#include "snapshot.h"

namespace tumble {
namespace {

constexpr int kRunIn = 240;  // steps: things have fallen and met

Simulation run_in(std::string_view demo) {
  const Scene scene = read_sdf_text(std::string(demo_text(demo)), std::string(demo), ".").scene;
  Simulation simulation(build_world(scene), 1);
  for (int i = 0; i < kRunIn; ++i) simulation.step();
  return simulation;
}

std::vector<std::vector<std::uint8_t>> write_parts(const Simulation& simulation) {
  std::vector<std::vector<std::uint8_t>> events;
  send_parts(take_snapshot(simulation, {}), 0,
             [&](const snapshot_t& part) { encode(part, events.emplace_back()); });
  return events;
}

void tell_size(benchmark::State& state, const Simulation& simulation) {
  std::size_t bytes = 0;
  for (const auto& event : write_parts(simulation)) bytes += event.size();
  state.counters["bodies"] = simulation.world().body_count();
  state.counters["contacts"] = simulation.world().report().contacts;
  state.counters["bytes"] = static_cast<double>(bytes);
  state.counters["bytes_per_body"] = static_cast<double>(bytes) / simulation.world().body_count();
}

void measure_take(benchmark::State& state, std::string_view demo) {
  const Simulation simulation = run_in(demo);
  for (auto run : state) benchmark::DoNotOptimize(write_parts(simulation));
  tell_size(state, simulation);
}

void measure_restore(benchmark::State& state, std::string_view demo) {
  const Simulation simulation = run_in(demo);
  const auto events = write_parts(simulation);
  for (auto run : state) {
    SnapshotAssembly assembly;
    for (const auto& event : events) {
      snapshot_t part{};
      decode(event, part);
      assembly.add(part);
    }
    Simulation other = simulation;
    CommandInbox inbox;
    restore(assembly.snapshot(), other, inbox);
  }
  tell_size(state, simulation);
}

}  // namespace
}  // namespace tumble

int main(int argc, char** argv) {
  for (const std::string_view demo : {"tumbling", "pyramid", "pile"}) {
    const std::string name(demo);
    benchmark::RegisterBenchmark((name + "/take").c_str(), tumble::measure_take, demo)
        ->Unit(benchmark::kMillisecond);
    benchmark::RegisterBenchmark((name + "/restore").c_str(), tumble::measure_restore, demo)
        ->Unit(benchmark::kMillisecond);
  }
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
}
