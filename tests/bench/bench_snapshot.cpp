// What snapshots in a log cost: taken, as a recording server does within a tick (`take`); cut into events and encoded,
// as another thread does beside the steps (`write`); and restored from them, as --resume does. `copy` is as many bytes
// from one place to another: what memory alone asks for. The demo scenes after a run-in.
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <cstring>
#include <string>
#include <utility>
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
  send_parts(take_whole_snapshot(simulation, {}), 0,
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
  Snapshot snapshot;
  for (auto run : state) take_snapshot(simulation, {}, snapshot);
  tell_size(state, simulation);
}

void measure_write(benchmark::State& state, std::string_view demo) {
  const Simulation simulation = run_in(demo);
  const Snapshot snapshot = take_whole_snapshot(simulation, {});
  std::vector<std::uint8_t> bytes;
  for (auto run : state) send_parts(snapshot, 0, [&](const snapshot_t& part) { encode(part, bytes); });
  tell_size(state, simulation);
}

void measure_copy(benchmark::State& state, std::string_view demo) {
  const Simulation simulation = run_in(demo);
  const std::string from = take_whole_snapshot(simulation, {}).world;
  std::string to = from;
  for (auto run : state) {
    std::memcpy(to.data(), from.data(), from.size());
    benchmark::DoNotOptimize(to.data());
    benchmark::ClobberMemory();
  }
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
  using Measure = void (*)(benchmark::State&, std::string_view);
  const std::pair<const char*, Measure> measures[] = {{"take", tumble::measure_take},
                                                      {"copy", tumble::measure_copy},
                                                      {"write", tumble::measure_write},
                                                      {"restore", tumble::measure_restore}};
  for (const std::string_view demo : {"tumbling", "pyramid", "pile"}) {
    for (const auto& [name, measure] : measures) {
      benchmark::RegisterBenchmark(fmt::format("{}/{}", demo, name).c_str(), measure, demo)
          ->Unit(benchmark::kMillisecond);
    }
  }
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
}
