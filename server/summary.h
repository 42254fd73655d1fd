// What a run came to, for people or as one JSON object.
#pragma once

#include <cstdint>
#include <string>

#include "world/world.h"

namespace tumble {

struct RunTimes {
  std::int64_t steps = 0;
  double wall_s = 0.0, cpu_s = 0.0;
  double deepest_penetration = 0.0;  ///< Over all steps [m].
  double max_residual = 0.0;         ///< Over all steps [m/s].
};

/// One line of JSON. deepest_penetration, max_residual and contacts are of the last step; worst_* over the run.
std::string summary_json(const World& world, const RunTimes& times);
/// For people. Steps and times are of the whole run, over all resets; a step's time is processor time.
std::string summary_text(const World& world, const RunTimes& times);

/// Processor time of this process so far, all threads [s].
double cpu_seconds();

}  // namespace tumble
