// The scenes of ./run bench error, and what counts as the error of each.
#pragma once

#include <string>
#include <vector>

#include "error/truth.h"

namespace tumble::bench {

enum class Measure {
  place,    ///< Farthest that any body's point is from its truth [m].
  energy,   ///< Largest departure of the total energy from its start, relative to it.
  overlap,  ///< Deepest overlap of two bodies [m].
};
const char* measure_name(Measure measure);

struct ErrorScene {
  const char* file;  ///< In tests/scenes; its stem is the scene's name.
  double seconds;    ///< Simulated.
  Measure measure;
  ComputeTruth truth = nullptr;  ///< None: the scene is chaotic.
};

const std::vector<ErrorScene>& error_scenes();
std::string scene_name(const ErrorScene& scene);

}  // namespace tumble::bench
