// The command line of tumble-server.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "world/options.h"

namespace tumble {

struct Arguments {
  std::string scene;  ///< Path of an SDF file; empty: the demo.
  std::string demo = "pyramid";
  double rate = 0.0;  ///< 0: real time, 1 / time step.
  bool fast = false;
  std::int64_t steps = 0;  ///< 0: until stopped.
  double publish_rate = 0.0;
  std::string world_name;  ///< Empty: the default, or the log's.
  std::string lcm_url;     ///< Empty: the environment's or LCM's default.
  std::optional<double> time_step;
  std::optional<Accuracy> accuracy;
  std::optional<Integrator> integrator;
  std::optional<Solver> solver;
  bool packed = false;  ///< Encoding of the state.
  bool json = false;
  std::string record, replay, resume;  ///< Paths of logs; at most one is not empty.
  double record_interval = 0.0;        ///< Simulated time between two pictures in the log [s].
  double snapshot_interval = 0.0;      ///< The same between two snapshots; 0: none.
  bool print_scene = false, list_demos = false, health = false;

  /// With a fixed number of steps as fast as possible nobody can listen: no bus is opened unless a URL asks for it.
  bool headless() const { return fast && steps > 0 && lcm_url.empty() && record.empty() && resume.empty(); }
};

/// Reads the command line. An exit status instead of arguments: everything is said already (help, version, an error).
struct ParsedArguments {
  std::optional<Arguments> arguments;
  int exit_status = 0;
};
ParsedArguments parse_arguments(int argc, const char* const* argv);

}  // namespace tumble
