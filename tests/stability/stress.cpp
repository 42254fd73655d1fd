// stress [--case NAME]... [--solver NAME]... [--step SECONDS]... [--accuracy NAME]... [--full] [--hours H] [--limit S]
//        [--share K/N] [--list]
// Runs the stress cases every way and prints CSV: one check a line. Exit status 1 if something that was promised does
// not hold.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <ctime>

#include "stability/case.h"

namespace tumble::stability {
namespace {

struct Selection {
  std::vector<std::string> cases, solvers, accuracies;
  std::vector<double> steps;
  Extent extent;
  bool include(const Case& stress) const {
    return cases.empty() || std::find(cases.begin(), cases.end(), stress.name) != cases.end();
  }
  bool include(const Way& way) const {
    const auto among = [](const auto& list, const auto& value) {
      return list.empty() || std::find(list.begin(), list.end(), value) != list.end();
    };
    const bool step = steps.empty() || std::any_of(steps.begin(), steps.end(), [&](double wanted) {
                        return std::abs(wanted / way.time_step - 1.0) < 1e-3;
                      });
    return among(solvers, std::string(solver_name(way.solver))) && step &&
           among(accuracies, std::string(accuracy_name(way.accuracy)));
  }
};

double cpu_seconds() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

/// "1", "0", or "-" where the trial was given up.
void print_row(const Case& stress, const Way& way, const Check& check, const char* holds, double cost) {
  fmt::print("{},{},{},{},{},\"{}\",{:.6g},{:.6g},{},{:.3f}\n", stress.name, solver_name(way.solver),
             describe_step(way.time_step), accuracy_name(way.accuracy), stress.claimants.include(way) ? 1 : 0,
             check.what, check.value, check.bound, holds, cost);
  std::fflush(stdout);
}

/// Prints the checks; false if one does not hold.
bool run_case(const Case& stress, const Way& way, const Extent& extent) {
  const double begin = cpu_seconds();
  std::vector<Check> checks;
  try {
    checks = try_case(stress, way, extent);
  } catch (const TooSlow& slow) {
    print_row(stress, way, {slow.what(), kInfinity, extent.cpu_seconds}, "-", cpu_seconds() - begin);
    return true;
  } catch (const std::exception& error) {
    checks = {{error.what(), kInfinity, 0.0}};
  }
  const double cost = cpu_seconds() - begin;
  for (const Check& check : checks) print_row(stress, way, check, check.holds() ? "1" : "0", cost);
  return std::all_of(checks.begin(), checks.end(), [](const Check& check) { return check.holds(); });
}

int run(const Selection& selection) {
  int broken = 0;
  fmt::print("case,solver,step,accuracy,promised,check,value,bound,holds,cpu_s\n");
  for (const Case& stress : all_cases()) {
    if (!selection.include(stress)) continue;
    fmt::print(stderr, "{}: {}\n", stress.name, stress.claim);
    for (const Way& way : all_ways(selection.extent.full)) {
      if (!selection.include(way) || (stress.own_steps && way.time_step != Way{}.time_step)) continue;
      const bool holds = run_case(stress, way, selection.extent);
      if (holds || !stress.claimants.include(way)) continue;
      ++broken;
      fmt::print(stderr, "  not held: {}\n", describe(way));
    }
  }
  if (broken > 0) fmt::print(stderr, "{} promises are not held\n", broken);
  return broken > 0 ? 1 : 0;
}

}  // namespace
}  // namespace tumble::stability

int main(int argc, char** argv) {
  using namespace tumble::stability;
  Selection selection;
  bool list = false;
  CLI::App app("Runs the stress cases and prints CSV, one check a line");
  app.add_option("--case", selection.cases, "only these cases");
  app.add_option("--solver", selection.solvers, "only these solvers");
  app.add_option("--accuracy", selection.accuracies, "only these levels: fast, balanced, exact");
  app.add_option("--step", selection.steps, "only these steps of 1/60, 1/240, 1/1000 [s]");
  app.add_option("--hours", selection.extent.hours, "simulated time of what must last")
      ->check(CLI::PositiveNumber);
  app.add_option("--limit", selection.extent.cpu_seconds, "processor time of one trial [s]")
      ->check(CLI::PositiveNumber);
  app.add_flag("--full", selection.extent.full,
               "whole sizes and times instead of those of the test program, every accuracy at every step");
  app.add_flag("--list", list, "say which cases there are");
  CLI11_PARSE(app, argc, argv);
  if (list) {
    for (const Case& stress : all_cases()) fmt::print("{}\t{}\n", stress.name, stress.claim);
    return 0;
  }
  return run(selection);
}
