// See way.h.
#include "stability/way.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace tumble::stability {

Options options_of(const Way& way) {
  Options options;
  options.time_step = way.time_step;
  options.solver = way.solver;
  set_accuracy(options, way.accuracy);
  return options;
}

const char* accuracy_name(Accuracy accuracy) {
  switch (accuracy) {
    case Accuracy::fast:
      return "fast";
    case Accuracy::balanced:
      return "balanced";
    case Accuracy::exact:
      return "exact";
  }
  return "?";
}

std::string describe_step(double time_step) {
  const double rate = std::round(1.0 / time_step);
  return std::abs(rate * time_step - 1.0) < 1e-12 && rate > 1.0 ? fmt::format("1/{:g}", rate)
                                                                : fmt::format("{:g}", time_step);
}

std::string describe(const Way& way) {
  return fmt::format("{} {} {}", solver_name(way.solver), describe_step(way.time_step),
                     accuracy_name(way.accuracy));
}

std::vector<Way> all_ways(bool full) {
  std::vector<Way> ways;
  for (const Solver solver : everyone().solvers) {
    for (const double time_step : {1.0 / 60.0, 1.0 / 240.0, 1.0 / 1000.0}) {
      for (const Accuracy accuracy : {Accuracy::fast, Accuracy::balanced, Accuracy::exact}) {
        const bool usual = accuracy == Way{}.accuracy || time_step == Way{}.time_step;
        if (full || usual) ways.push_back({solver, time_step, accuracy});
      }
    }
  }
  return ways;
}

bool Claimants::include(const Way& way) const {
  return way.time_step <= longest_step && way.accuracy >= coarsest &&
         std::find(solvers.begin(), solvers.end(), way.solver) != solvers.end();
}

}  // namespace tumble::stability
