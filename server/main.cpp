// tumble-server: arguments -> scene -> world -> server. Exit status 0: ran and ended as asked; 1: the system
// refused something, such as the bus; 2: wrong arguments or scene, nothing was started.
#include <fmt/format.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <exception>
#include <optional>
#include <stdexcept>

#include "arguments.h"
#include "greeting.h"
#include "scene/demo.h"
#include "scene/sdf.h"
#include "server.h"
#include "summary.h"

namespace {

using namespace tumble;

constexpr int kFailed = 1, kBadInput = 2;

volatile std::sig_atomic_t stop_requested = 0;

void request_stop(int) {
  stop_requested = 1;
}

void install_signals() {
  struct sigaction action {};
  action.sa_handler = request_stop;
  ::sigaction(SIGINT, &action, nullptr);
  ::sigaction(SIGTERM, &action, nullptr);
}

Scene read_scene(const Arguments& arguments) {
  SceneReading reading = arguments.scene.empty() ? read_sdf_text(std::string(demo_text(arguments.demo)),
                                                                 "demo " + arguments.demo, ".")
                                                 : read_sdf(arguments.scene);
  for (const std::string& warning : reading.warnings) spdlog::warn("{}", warning);
  Options& options = reading.scene.options;
  if (arguments.accuracy) set_accuracy(options, *arguments.accuracy);
  if (arguments.integrator) options.integrator = *arguments.integrator;
  if (arguments.solver) options.solver = *arguments.solver;
  if (arguments.time_step) options.time_step = *arguments.time_step;
  return std::move(reading.scene);
}

/// Times a run and keeps its worst values.
class RunWatch {
 public:
  explicit RunWatch(Clock& clock) : clock_(clock), wall_start_(clock.now_ns()), cpu_start_(cpu_seconds()) {}

  void note(const StepReport& report) {
    times_.deepest_penetration = std::max(times_.deepest_penetration, report.deepest_penetration);
    times_.max_residual = std::max(times_.max_residual, report.max_residual);
  }
  void print(const World& world, std::int64_t steps, bool json) {
    times_.steps = steps;
    times_.wall_s = static_cast<double>(clock_.now_ns() - wall_start_) * 1e-9;
    times_.cpu_s = cpu_seconds() - cpu_start_;
    if (json) {
      fmt::print("{}\n", summary_json(world, times_));
    } else {
      fmt::print(stderr, "{}\n", summary_text(world, times_));
    }
  }

 private:
  Clock& clock_;
  std::int64_t wall_start_;
  double cpu_start_;
  RunTimes times_;
};

int run_headless(World world, const Arguments& arguments, Clock& clock) {
  RunWatch watch(clock);
  std::int64_t steps = 0;
  for (; steps < arguments.steps && stop_requested == 0; ++steps) {
    world.step();
    watch.note(world.report());
  }
  watch.print(world, steps, arguments.json);
  return 0;
}

int run_server(World world, const std::string& scene_name, const Arguments& arguments, Clock& clock) {
  ServerSettings settings;
  settings.world_name = arguments.world_name;
  settings.scene_name = scene_name;
  settings.publish_rate = arguments.publish_rate;
  settings.steps = arguments.steps;
  const double real_time = 1.0 / world.options().time_step;
  settings.rate = arguments.fast ? 0.0 : arguments.rate > 0.0 ? arguments.rate : real_time;

  Bus bus(parse_bus_url(arguments.lcm_url), settings.world_name);
  Outbox outbox(settings.world_name, bus.payload_limit(), clock,
                [&bus](const std::string& channel, Bytes payload) { return bus.publish(channel, payload); });
  Server server(std::move(world), settings, clock, bus, outbox);
  fmt::print(stderr, "{}\n", greeting(settings, bus, server.world()));
  outbox.start();
  RunWatch watch(clock);
  server.set_observer([&watch](const StepReport& report) { watch.note(report); });
  server.run(stop_requested);
  outbox.stop();
  watch.print(server.world(), server.steps_done(), arguments.json);
  return 0;
}

int serve(const Arguments& arguments) {
  const Scene scene = read_scene(arguments);
  if (arguments.print_scene) {
    fmt::print("{}", write_sdf(scene));
    return 0;
  }
  World world = build_world(scene);
  SystemClock clock;
  install_signals();
  if (arguments.headless()) return run_headless(std::move(world), arguments, clock);
  const std::string name = arguments.scene.empty() ? "demo " + arguments.demo : arguments.scene;
  return run_server(std::move(world), name, arguments, clock);
}

}  // namespace

int main(int argc, char** argv) {
  spdlog::set_default_logger(spdlog::stderr_color_mt("tumble"));
  spdlog::set_pattern("%^%l%$: %v");
  const ParsedArguments parsed = parse_arguments(argc, argv);
  if (!parsed.arguments) return parsed.exit_status;
  if (parsed.arguments->list_demos) {
    for (const std::string_view name : demo_names()) fmt::print("{}\n", name);
    return 0;
  }
  try {
    return serve(*parsed.arguments);
  } catch (const SceneError& error) {
    spdlog::error("{}", error.what());
    return kBadInput;
  } catch (const std::invalid_argument& error) {
    spdlog::error("{}", error.what());
    return kBadInput;
  } catch (const std::exception& error) {
    spdlog::error("{}", error.what());
    return kFailed;
  }
}
