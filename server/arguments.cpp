// See arguments.h.
#include "arguments.h"

#include <CLI/CLI.hpp>
#include <algorithm>

#include "protocol/channels.h"
#include "scene/demo.h"
#include "version.h"

namespace tumble {
namespace {

constexpr int kBadArguments = 2;
constexpr double kRecordInterval = 0.1;     // [s]
constexpr double kSnapshotInterval = 10.0;  // [s]

std::string join_demo_names() {
  std::string names;
  for (const std::string_view name : demo_names()) names.append(names.empty() ? "" : ", ").append(name);
  return names;
}

/// Accepts the names for which `from_name` has a value.
template <typename FromName>
CLI::Validator known_name(FromName from_name, const std::string& names) {
  return CLI::Validator(
      [from_name, names](std::string& text) {
        return from_name(text) ? std::string() : "\"" + text + "\" is not one of " + names;
      },
      names);
}

/// The names of the rivals from the first to `last`.
template <typename Rival>
std::string join_names(const char* (*name_of)(Rival), Rival last) {
  std::string names;
  for (int i = 0; i <= static_cast<int>(last); ++i) {
    names.append(i == 0 ? "" : ", ").append(name_of(static_cast<Rival>(i)));
  }
  return names;
}

CLI::Validator number_within(double low, double high) {
  return CLI::Range(low, high);
}

CLI::Validator world_name() {
  return CLI::Validator(
      [](std::string& text) {
        return is_world_name(text) ? std::string()
                                   : "\"" + text + "\" is not a world name: 1 to 40 of A-Z a-z 0-9 _";
      },
      "NAME");
}

CLI::Validator demo_name() {
  return CLI::Validator(
      [](std::string& text) {
        return demo_text(text).empty() ? "there is no demo \"" + text + "\", only " + join_demo_names()
                                       : std::string();
      },
      "NAME");
}

struct Names {
  std::string accuracy, integrator, solver, encoding = "exact", summary = "text";
};

void add_log_options(CLI::App& app, Arguments& a) {
  auto* record =
      app.add_option("--record", a.record, "Write the run to a new LCM log, from which it can be repeated");
  a.record_interval = kRecordInterval;
  app.add_option("--record-interval", a.record_interval,
                 "Simulated seconds between two pictures of the world in the log (default 0.1)")
      ->check(number_within(1e-6, 1e6))
      ->needs(record);
  a.snapshot_interval = kSnapshotInterval;
  app.add_option(
         "--snapshot-interval", a.snapshot_interval,
         "Simulated seconds between two snapshots of the inner state in the log, from the last of which "
         "--resume goes on (default 10; 0: none)")
      ->check(number_within(0.0, 1e6))
      ->needs(record);
  const std::string logged = "its scene and options are the log's";
  auto* replay =
      app.add_option("--replay", a.replay, "Repeat a recorded run, compare every step, and end; " + logged);
  auto* resume = app.add_option("--resume", a.resume,
                                "Go on with a recorded run after its last complete step; " + logged);
  replay->check(CLI::ExistingFile)->excludes(record);
  resume->check(CLI::ExistingFile)->excludes(record)->excludes(replay);
  for (const char* name :
       {"scene", "--demo", "--accuracy", "--integrator", "--solver", "--dt", "--print-scene"}) {
    replay->excludes(app.get_option(name));
    resume->excludes(app.get_option(name));
  }
}

void add_options(CLI::App& app, Arguments& a, Names& names) {
  auto* scene = app.add_option("scene", a.scene, "Scene to serve, an SDF file (default: the demo pyramid)");
  app.add_option("--demo", a.demo, "Built-in scene: " + join_demo_names())
      ->check(demo_name())
      ->excludes(scene);
  auto* rate = app.add_option("--rate", a.rate,
                              "Steps per second of wall time, 1 to 1e6 (default: real time, 1 / time step)");
  rate->check(number_within(1.0, 1e6));
  app.add_flag("--fast", a.fast, "As fast as possible; with --steps and no --lcm-url: without any network")
      ->excludes(rate);
  app.add_option("--steps", a.steps, "Stop after so many steps")
      ->check(CLI::Range(std::int64_t{1}, std::int64_t{1} << 53));
  a.publish_rate = kDefaultPublishRate;
  app.add_option("--publish-rate", a.publish_rate, "Publications of the state per second (default 60)")
      ->check(number_within(0.1, 1000.0));
  app.add_option("--encoding", names.encoding,
                 "Of the state: exact (doubles, 113 bytes a body) or packed (25 bytes a body, for thousands)")
      ->check(CLI::IsMember({"exact", "packed"}));
  app.add_option("--world", a.world_name, "Prefix of the channels (default TUMBLE)")->check(world_name());
  app.add_option("--lcm-url", a.lcm_url,
                 "Bus (default: LCM_DEFAULT_URL, else udpm://239.255.76.67:7667?ttl=0)");
  app.add_option("--accuracy", names.accuracy, "Budgets and tolerances (default: the scene's)")
      ->check(known_name(accuracy_from_name, "fast, balanced, exact"));
  app.add_option("--integrator", names.integrator, "How bodies move through a step (default: the scene's)")
      ->check(known_name(integrator_from_name, join_names(integrator_name, Integrator::closed_form)));
  app.add_option("--solver", names.solver, "How contacts are solved (default: the scene's)")
      ->check(known_name(solver_from_name, join_names(solver_name, Solver::automatic)));
  app.add_option("--dt", a.time_step, "Time step in seconds (default: the scene's, else 1/240)")
      ->check(number_within(1e-6, 0.1));
  app.add_option("--summary", names.summary, "Form of the summary at the end: text (stderr) or json (stdout)")
      ->check(CLI::IsMember({"text", "json"}));
  app.add_flag("--print-scene", a.print_scene, "Write the scene with all defaults as SDF to stdout and end");
  app.add_flag("--list-demos", a.list_demos, "List the built-in scenes and end");
  app.add_flag(
      "--health", a.health,
      "Listen for a server of this world on this machine: exit status 0 if it is heard within 2 s, else 1");
  add_log_options(app, a);
  app.footer(
      "Examples:\n"
      "  tumble-server --demo pile\n"
      "  tumble-server scene.sdf --record run.lcm\n"
      "  tumble-server --resume run.lcm\n"
      "  tumble-server --demo pyramid --fast --steps 2400 --summary json\n\n"
      "Ctrl-C or SIGTERM ends it and closes its log. Exit status: 0 ended as asked; 1 the system refused "
      "something, "
      "such\nas the bus, or a replay differs; 2 wrong arguments or scene, nothing was started.");
  app.set_version_flag("--version", std::string("tumble-server ") + kVersion);
}

}  // namespace

ParsedArguments parse_arguments(int argc, const char* const* argv) {
  Arguments arguments;
  Names names;
  CLI::App app(
      "Serves a world of rigid bodies: steps it, streams its state over LCM, takes forces from clients.",
      "tumble-server");
  add_options(app, arguments, names);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return {std::nullopt, app.exit(error) == 0 ? 0 : kBadArguments};
  }
  if (!names.accuracy.empty()) arguments.accuracy = accuracy_from_name(names.accuracy);
  if (!names.integrator.empty()) arguments.integrator = integrator_from_name(names.integrator);
  if (!names.solver.empty()) arguments.solver = solver_from_name(names.solver);
  arguments.packed = names.encoding == "packed";
  arguments.json = names.summary == "json";
  return {arguments, 0};
}

}  // namespace tumble
