// What free motion costs: making and reading a flight, a step of each integrator, and whole steps of free bodies beside
// Bullet's and ODE's, all in double precision.
#include <benchmark/benchmark.h>

#include <string>

#include "dynamics/flight.h"
#include "dynamics/integrator.h"
#include "peers/free_bodies.h"
#include "peers/peer.h"
#include "support/rotation_cases.h"
#include "world/world.h"

namespace tumble {
namespace {

constexpr double kStep = 1.0 / 240.0;
constexpr int kBodies = 256;

struct Kind {
  const char* name;
  Vec3 I, w;
};
const Kind kKinds[] = {{"sphere", Vec3(2, 2, 2), Vec3(6, -2, 4)},
                       {"symmetric", Vec3(1, 1, 2), Vec3(6, -2, 4)},
                       {"triaxial_circular", Vec3(0.6, 0.8, 1.0), Vec3(3.0, 0.5, -0.9)},
                       {"triaxial_hyperbolic", Vec3(0.5, 0.75, 1.2), Vec3(6, -2, 4)}};

Motion start_of(const Kind& kind) {
  Motion start;
  start.w = kind.w;
  start.L = kind.I.cwiseProduct(kind.w);
  return start;
}

void make_flight(benchmark::State& state, const Kind& kind) {
  const MassProperties mass = principal_body(kind.I);
  Motion start = start_of(kind);
  for (auto run : state) {
    benchmark::DoNotOptimize(start);
    Flight flight(mass, start, Vec3(0, 0, -9.81));
    benchmark::DoNotOptimize(flight);
  }
}

void read_flight(benchmark::State& state, const Kind& kind) {
  const Flight flight(principal_body(kind.I), start_of(kind), Vec3(0, 0, -9.81));
  double t = 0.0;
  for (auto run : state) benchmark::DoNotOptimize(flight.at(t += kStep));
}

void read_position(benchmark::State& state) {
  const Flight flight(principal_body(kKinds[2].I), start_of(kKinds[2]), Vec3(0, 0, -9.81));
  double t = 0.0;
  for (auto run : state) benchmark::DoNotOptimize(flight.position(t += kStep));
}

void integrate(benchmark::State& state, Integrator integrator, bool torque) {
  const IntegrateFunction step = integrate_function(integrator);
  const MassProperties mass = principal_body(kKinds[2].I);
  Motion body = start_of(kKinds[2]);
  const Vec3 change = torque ? Vec3(1e-3, -1e-3, 1e-3) : Vec3(Vec3::Zero());
  for (auto run : state) {
    step(mass, {.v0 = body.v, .v1 = body.v, .L0 = body.L, .L1 = body.L + change}, kStep, body);
    benchmark::DoNotOptimize(body);
    if (torque) body.L = start_of(kKinds[2]).L;
  }
}

void per_body(benchmark::State& state, int bodies) {
  state.counters["ns_per_body"] = benchmark::Counter(
      1e-9 * bodies, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

/// Once every body is aloft for long.
void step_world(benchmark::State& state, int count, bool read, Integrator integrator) {
  Scene scene = bench::free_bodies(count, kKinds[2].I, kKinds[2].w, Vec3(0, 0, 20), Vec3(0, 0, -9.81));
  scene.options.integrator = integrator;
  World world = build_world(scene);
  for (int i = 0; i < 600; ++i) world.step();
  double sum = 0.0;
  for (auto run : state) {
    world.step();
    for (int i = 0; read && i < count; ++i) sum += world.motion(static_cast<std::uint32_t>(i)).w.x();
  }
  benchmark::DoNotOptimize(sum);
  if (count > 0) per_body(state, count);
}

void step_peer(benchmark::State& state, const bench::Method& method) {
  const Scene scene = bench::free_bodies(kBodies, kKinds[2].I, kKinds[2].w, Vec3::Zero(), Vec3::Zero());
  const auto peer = method.make(scene, kStep);
  for (auto run : state) peer->step();
  per_body(state, kBodies);
}

void add_measurements() {
  const auto add = [](const std::string& name, auto function) {
    return benchmark::RegisterBenchmark(name.c_str(), function);
  };
  for (const Kind& kind : kKinds) {
    add(std::string("make_flight/") + kind.name, [&kind](benchmark::State& s) { make_flight(s, kind); });
    add(std::string("read_flight/") + kind.name, [&kind](benchmark::State& s) { read_flight(s, kind); });
  }
  add("read_position", read_position);
  for (int i = 0; i <= static_cast<int>(Integrator::closed_form); ++i) {
    const auto integrator = static_cast<Integrator>(i);
    add(std::string("step/") + integrator_name(integrator),
        [=](benchmark::State& s) { integrate(s, integrator, false); });
  }
  add("step/taylor8_under_torque", [](benchmark::State& s) { integrate(s, Integrator::taylor8, true); });
  add("world/256_read", [](benchmark::State& s) { step_world(s, kBodies, true, Integrator::closed_form); });
  add("world/256_semi_implicit_euler",
      [](benchmark::State& s) { step_world(s, kBodies, true, Integrator::semi_implicit_euler); });
  add("world/256_bullet", [](benchmark::State& s) { step_peer(s, bench::bullet_methods().front()); });
  add("world/256_ode", [](benchmark::State& s) { step_peer(s, bench::ode_methods().front()); });
  add("world/empty", [](benchmark::State& s) { step_world(s, 0, false, Integrator::closed_form); });
  add("world/10000_unread",
      [](benchmark::State& s) { step_world(s, 10000, false, Integrator::closed_form); });
}

[[maybe_unused]] const bool kAdded = (add_measurements(), true);

}  // namespace
}  // namespace tumble

BENCHMARK_MAIN();
