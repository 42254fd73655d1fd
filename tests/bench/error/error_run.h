// One scene by one method with one step: what it costs and how wrong it is.
#pragma once

#include <optional>
#include <vector>

#include "error/error_scene.h"
#include "peers/peer.h"

namespace tumble::bench {

/// A scene made ready: read, its truth known at the times of measurement.
struct PreparedScene {
  ErrorScene definition;
  std::string name;
  Scene scene;
  std::vector<Solid> solids;
  Truth truth;  ///< Without samples where the scene is chaotic.
};
/// `folder` holds tests/scenes. Throws SceneError.
PreparedScene prepare(const ErrorScene& definition, const std::string& folder);

/// [s] between two measurements; steps must divide it.
inline constexpr double kSampleInterval = 0.1;

/// Extremes over the measurements; infinite once the engine's state is not finite.
struct ErrorRun {
  double error = 0.0;  ///< As the scene's measure says.
  double energy_drift =
      0.0;  ///< [J/kg] from the truth, or the rise where none is known and it may only fall.
  double momentum_drift =
      0.0;  ///< [m/s] of the common centre from the truth; else of what frictionless ground keeps.
  double spin_drift =
      0.0;               ///< [rad/s] sum of the bodies' own angular momenta by their mean inertia, likewise.
  double overlap = 0.0;  ///< [m] deepest.
  std::vector<double>
      cpu;  ///< [s] a simulated second, of each repeat, ascending: steps and reading every body.
};

/// None if a repeat takes more CPU time than `budget` [s]. Repeats up to five times while all of it fits in half the budget.
/// None either if the method's scope leaves the scene out.
std::optional<ErrorRun> run_error(const PreparedScene& prepared, const Method& method, double h,
                                  double budget);

}  // namespace tumble::bench
