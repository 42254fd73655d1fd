// tumble-server: arguments -> scene -> world -> server. Exit status 0: ran and ended as asked; 1: the system
// refused something, such as the bus; 2: wrong arguments or scene, nothing was started.
#include <fmt/format.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <bit>
#include <csignal>
#include <cstdio>
#include <exception>
#include <functional>
#include <optional>
#include <stdexcept>
#include <system_error>

#include "arguments.h"
#include "greeting.h"
#include "health.h"
#include "replay.h"
#include "scene/demo.h"
#include "scene/sdf.h"
#include "server.h"
#include "summary.h"
#include "version.h"

namespace {

using namespace tumble;

constexpr int kFailed = 1, kBadInput = 2;
constexpr double kSpread = 0.8;  // part of the time between two publications over which one is sent

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

/// What a log begins with.
recording_t make_head(const Arguments& arguments, const ServerSettings& settings, const std::string& scene,
                      const Simulation& start, Clock& clock) {
  recording_t head{};
  head.utime = clock.wall_us();
  head.session = start.session();
  head.protocol_version = kProtocolVersion;
  head.server_version = kVersion;
  head.world = settings.world_name;
  head.scene_name = settings.scene_name;
  head.dt = start.world().options().time_step;
  head.rate = settings.rate;
  head.interval = arguments.record_interval;
  head.snapshot_interval = arguments.snapshot_interval;
  head.state_hash = std::bit_cast<std::int64_t>(start.world().state_hash());
  head.scene = scene;
  return head;
}

/// `rate`: unless the arguments say another.
ServerSettings make_settings(const Arguments& arguments, const std::string& scene_name, double rate) {
  ServerSettings settings;
  settings.world_name = arguments.world_name.empty() ? std::string(kDefaultWorld) : arguments.world_name;
  settings.scene_name = scene_name;
  settings.publish_rate = arguments.publish_rate;
  settings.steps = arguments.steps;
  settings.packed = arguments.packed;
  settings.rate = arguments.fast ? 0.0 : arguments.rate > 0.0 ? arguments.rate : rate;
  return settings;
}

/// Called once the bus works, so that nothing is written by a server that can't start.
using MakeRecorder = std::function<Recorder()>;

int run_server(Simulation simulation, CommandInbox inbox, const ServerSettings& settings,
               const MakeRecorder& make_recorder, const Arguments& arguments, Clock& clock) {
  Bus bus(parse_bus_url(arguments.lcm_url), settings.world_name);
  Outbox outbox(
      settings.world_name, bus.payload_limit(), clock,
      [&bus](const std::string& channel, Bytes payload) { return bus.publish(channel, payload); },
      settings.packed ? Encoding::packed : Encoding::exact,
      static_cast<std::int64_t>(kSpread * 1e9 / settings.publish_rate));
  Server server(std::move(simulation), settings, clock, bus, outbox, std::move(inbox));
  if (make_recorder) server.set_recorder(make_recorder());
  fmt::print(stderr, "{}\n", greeting(settings, bus, server.world()));
  outbox.start();
  RunWatch watch(clock);
  server.set_observer([&watch](const StepReport& report) { watch.note(report); });
  server.run(stop_requested);
  outbox.stop();
  watch.print(server.world(), server.steps_done(), arguments.json);
  return 0;
}

int run_replay(const Arguments& arguments, Clock& clock) {
  Replay replay(arguments.replay);
  RunWatch watch(clock);
  replay.run([&watch](const StepReport& report) { watch.note(report); }, stop_requested);
  fmt::print(stderr, "{}\n", replay_text(replay));
  watch.print(replay.simulation().world(), replay.steps(), arguments.json);
  const bool damaged = replay.damage() && !replay.damage()->cut;
  return replay.difference() || damaged || !replay.bad_snapshots().empty() ? kFailed : 0;
}

int run_resumed(const Arguments& arguments, Clock& clock) {
  Replay replay(arguments.resume);
  replay.skip_to_last_snapshot();
  replay.run({}, stop_requested);
  fmt::print(stderr, "{}\n", replay_text(replay));
  if (stop_requested != 0) return 0;
  if (replay.difference())
    throw std::runtime_error(arguments.resume + ": can't go on from a run that differs");
  if (replay.damage() && !replay.damage()->cut) {
    throw std::runtime_error(
        fmt::format("{0}: won't overwrite what follows the damage; to go on from before it:\n"
                    "  head -c {1} {0} > sound.lcm && tumble-server --resume sound.lcm",
                    arguments.resume, replay.damage()->offset));
  }
  const recording_t& head = replay.head();
  Arguments with_log = arguments;
  if (with_log.world_name.empty()) with_log.world_name = head.world;
  const ServerSettings settings = make_settings(with_log, head.scene_name, head.rate);
  const auto go_on = [&] {
    return Recorder(EventLogWriter(arguments.resume, replay.log_size(), replay.log_events()), head,
                    replay.checksum());
  };
  return run_server(std::move(replay.simulation()), std::move(replay.inbox()), settings, go_on, arguments,
                    clock);
}

int serve_scene(const Arguments& arguments, Clock& clock) {
  const Scene scene = read_scene(arguments);
  if (arguments.print_scene) {
    fmt::print("{}", write_sdf(scene));
    return 0;
  }
  if (arguments.headless()) return run_headless(build_world(scene), arguments, clock);
  const std::string name = arguments.scene.empty() ? "demo " + arguments.demo : arguments.scene;
  const ServerSettings settings = make_settings(arguments, name, 1.0 / scene.options.time_step);
  if (arguments.record.empty()) {
    return run_server(Simulation(build_world(scene), random_session()), {}, settings, {}, arguments, clock);
  }
  // What runs is what stands in the log.
  const std::string text = write_sdf(scene);
  Simulation simulation(build_world(read_sdf_text(text, name, ".").scene), random_session());
  const recording_t head = make_head(arguments, settings, text, simulation, clock);
  const auto begin = [&] { return Recorder(EventLogWriter(arguments.record), head); };
  return run_server(std::move(simulation), {}, settings, begin, arguments, clock);
}

int check_health(const Arguments& arguments) {
  constexpr double kPatience = 2.0;  // [s]: four heartbeats
  const std::string world = arguments.world_name.empty() ? std::string(kDefaultWorld) : arguments.world_name;
  const BusAddress bus = parse_bus_url(arguments.lcm_url);
  if (hears_heartbeat(bus, world, kPatience)) return 0;
  throw std::runtime_error(fmt::format("no server of {} is heard on {}", world, bus.url));
}

int serve(const Arguments& arguments) {
  if (arguments.health) return check_health(arguments);
  SystemClock clock;
  install_signals();
  if (!arguments.replay.empty()) return run_replay(arguments, clock);
  if (!arguments.resume.empty()) return run_resumed(arguments, clock);
  return serve_scene(arguments, clock);
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
  } catch (const std::exception& error) {  // the system's: the bus, a file
    spdlog::error("{}", error.what());
    return kFailed;
  }
}
