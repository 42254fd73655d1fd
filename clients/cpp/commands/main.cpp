// tumble: the command-line client. Reads the arguments, runs one subcommand, and turns what went wrong into one line on
// standard error and an exit status (command.h).
#include <fmt/format.h>

#include <algorithm>

#include "commands/command.h"

namespace tumble::client {
namespace {

constexpr const char* kFooter =
    "Exit status: 0 done; 1 refused, no answer, or the doctor found a fault; 2 wrong usage.\n"
    "World frame: right-handed, z up, SI units; quaternions w x y z.";

void add_globals(CLI::App& app, Globals& globals) {
  app.add_option("--world", globals.world, "Name of the world, the prefix of its channels")
      ->capture_default_str();
  app.add_option("--lcm-url", globals.url,
                 "LCM URL; default: $LCM_DEFAULT_URL, else " + std::string(kDefaultBusUrl));
  app.add_option("--timeout", globals.timeout, "Seconds to wait for the server and for an answer")
      ->capture_default_str()
      ->check(CLI::Range(0.1, 3600.0));
  app.add_flag("--json", globals.json, "Print JSON");
}

/// As the help of a subcommand shows them.
struct Examples {
  const char* subcommand;
  const char* lines;
};
constexpr Examples kExamples[] = {
    {"list", "  tumble list\n  tumble --json list\n"},
    {"watch", "  tumble watch ball --count 5\n  tumble --json watch --count 1\n"},
    {"push",
     "  tumble push ball --force 0 0 50 --seconds 0.5\n"
     "  tumble push ball --force 0 0 50 --seconds 0 --at 0.1 0 0 --frame body\n"},
    {"torque", "  tumble torque ball --torque 0 0 2 --seconds 1\n"},
    {"spawn", "  tumble spawn sphere --name late --size 0.3 --mass 2 --at 0 0 8\n"},
    {"set", "  tumble set ball --at 0 0 8 --velocity 1 0 0\n"},
    {"remove", "  tumble remove late\n"},
    {"step", "  tumble pause && tumble step 240\n"},
    {"snapshot", "  tumble snapshot before\n"},
    {"restore", "  tumble restore before\n"},
    {"contacts", "  tumble contacts on\n"},
    {"plot", "  tumble plot ball\n"},
    {"record", "  tumble record run.lcm --seconds 2\n  lcm-logplayer run.lcm\n"},
    {"doctor", "  tumble doctor\n  tumble --json doctor --network-only\n"},
    {"completion", "  source <(tumble completion)\n"},
};

/// CLI11 takes "-.5" for an option but knows "-0.5".
std::vector<std::string> read_arguments(int argc, char** argv) {
  std::vector<std::string> arguments(argv + 1, argv + argc);
  for (std::string& argument : arguments) {
    if (argument.starts_with("-.")) argument.insert(1, "0");
  }
  std::reverse(arguments.begin(), arguments.end());  // CLI11 reads a vector from its end
  return arguments;
}

int run(const Action& action) {
  try {
    return action();
  } catch (const BusError& error) {
    fmt::print(stderr, "tumble: {}\n  repair: {}\n", error.what(), error.repair());
  } catch (const NoServer& error) {
    fmt::print(stderr, "tumble: {}\n  try: tumble doctor\n", error.what());
  } catch (const std::exception& error) {
    fmt::print(stderr, "tumble: {}\n", error.what());
  }
  return kRefused;
}

int read_and_run(int argc, char** argv) {
  Globals globals;
  Action action;
  CLI::App app("Talk to a tumble-server over LCM.", "tumble");
  app.footer(kFooter);
  app.fallthrough();
  app.set_version_flag("--version", "tumble " TUMBLE_VERSION);
  app.require_subcommand(1);
  add_globals(app, globals);
  for (const auto add :
       {add_list, add_watch, add_push, add_spawn, add_control, add_record, add_doctor, add_completion}) {
    add(app, globals, action);
  }
  for (const Examples& examples : kExamples) {
    app.get_subcommand(examples.subcommand)
        ->footer(fmt::format("Examples:\n{}\n{}", examples.lines, kFooter));
  }
  try {
    app.parse(read_arguments(argc, argv));
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == static_cast<int>(CLI::ExitCodes::Success)) return app.exit(error);  // --help
    const auto chosen = app.get_subcommands();
    fmt::print(stderr, "tumble: {}\n  try: tumble {}--help\n", error.what(),
               chosen.empty() ? "" : chosen.front()->get_name() + " ");
    return kUsage;
  }
  try {
    parse_bus_url(globals.url);
    if (!is_world_name(globals.world)) {
      throw std::invalid_argument(fmt::format("--world \"{}\": 1 to {} letters, digits or underscores",
                                              globals.world, kMaxWorldName));
    }
  } catch (const std::invalid_argument& error) {
    fmt::print(stderr, "tumble: {}\n", error.what());
    return kUsage;
  }
  return run(action);
}

}  // namespace
}  // namespace tumble::client

int main(int argc, char** argv) {
  return tumble::client::read_and_run(argc, argv);
}
