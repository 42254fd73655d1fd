// error_curves SCENES CSV SECONDS RATES [SCENE...]: runs every method at every step on the scenes (all, or those named)
// and writes a line each to CSV. SECONDS: CPU time allowed for one of them; RATES: steps a second, as 30,60,240.
// Prints the engines and methods as Markdown.
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string>

#include "error/error_run.h"

namespace {

using namespace tumble;
using namespace tumble::bench;

std::vector<int> read_rates(const std::string& text) {
  std::vector<int> rates;
  std::istringstream stream(text);
  for (std::string rate; std::getline(stream, rate, ',');) {
    rates.push_back(std::atoi(rate.c_str()));
    if (rates.back() <= 0 || rates.back() % 10 != 0) {
      throw std::invalid_argument("rates: multiples of 10 are needed (" + rate + ")");
    }
  }
  return rates;
}

void check_names(std::set<std::string> wanted) {
  for (const ErrorScene& definition : error_scenes()) wanted.erase(scene_name(definition));
  if (!wanted.empty()) throw std::invalid_argument("no such scene: " + *wanted.begin());
}

std::vector<Method> all_methods() {
  std::vector<Method> methods = tumble_methods();
  for (const auto& others : {bullet_methods(), ode_methods(), mujoco_methods()}) {
    methods.insert(methods.end(), others.begin(), others.end());
  }
  return methods;
}

void write_line(std::FILE* csv, const PreparedScene& scene, const Method& method, int rate,
                const ErrorRun& run) {
  std::fprintf(csv, "%s,%s,%s,%s,%d,%.4e,%.4e,%.3e,%.3e,%.3e,%.3e,%.3e,%.1e\n", scene.name.c_str(),
               measure_name(scene.definition.measure), method.engine.c_str(), method.name.c_str(), rate,
               run.cpu.front(), run.cpu[run.cpu.size() / 2], run.error, run.energy_drift, run.momentum_drift,
               run.spin_drift, run.overlap, scene.truth.doubt);
  std::fflush(csv);
}

void run_scene(const PreparedScene& scene, const std::vector<Method>& methods, const std::vector<int>& rates,
               double budget, std::FILE* csv) {
  for (const Method& method : methods) {
    int left_out =
        0;  // large steps may cost more than the next, but after two the rest would take longer still
    for (const int rate : rates) {
      const auto run = run_error(scene, method, 1.0 / rate, budget);
      if (run) {
        write_line(csv, scene, method, rate, *run);
      } else if (++left_out == 2) {
        break;
      }
    }
  }
}

int run(int argc, char** argv) {
  if (argc < 5) {
    std::fputs("error_curves SCENES CSV SECONDS RATES [SCENE...]\n", stderr);
    return 2;
  }
  const double budget = std::atof(argv[3]);
  const std::vector<int> rates = read_rates(argv[4]);
  const std::set<std::string> wanted(argv + 5, argv + argc);
  check_names(wanted);
  const std::vector<Method> methods = all_methods();
  std::puts("| engine | method | settings |\n|---|---|---|");
  for (const Method& method : methods) {
    std::printf("| %s | %s | %s |\n", method.engine.c_str(), method.name.c_str(), method.settings.c_str());
  }
  std::FILE* csv = std::fopen(argv[2], "w");
  if (!csv) {
    std::perror(argv[2]);
    return 1;
  }
  std::fputs(
      "scene,measure,engine,method,rate_Hz,cpu_min,cpu_median,error,energy_drift_J_kg,momentum_drift_m_s,"
      "spin_drift_rad_s,overlap_m,doubt\n",
      csv);
  for (const ErrorScene& definition : error_scenes()) {
    if (!wanted.empty() && !wanted.contains(scene_name(definition))) continue;
    const PreparedScene scene = prepare(definition, argv[1]);
    std::fprintf(stderr, "%s\n", scene.name.c_str());
    run_scene(scene, methods, rates, budget, csv);
  }
  return std::fclose(csv) == 0 ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "error_curves: %s\n", error.what());
    return 1;
  }
}
