// See error_scene.h.
#include "error/error_scene.h"

#include <filesystem>

namespace tumble::bench {

const char* measure_name(Measure measure) {
  switch (measure) {
    case Measure::place:
      return "place [m]";
    case Measure::energy:
      return "energy [1]";
    case Measure::overlap:
      return "overlap [m]";
  }
  return "";
}

const std::vector<ErrorScene>& error_scenes() {
  static const std::vector<ErrorScene> scenes = {
      {"error/top.sdf", 10.0, Measure::place, flying},
      {"error/dzhanibekov.sdf", 10.0, Measure::place, flying},
      {"error/bounce.sdf", 5.0, Measure::place, bouncing},
      {"error/incline.sdf", 2.0, Measure::place, on_slope},
      {"error/slide_to_roll.sdf", 2.0, Measure::place, sliding_to_roll},
      {"error/toss.sdf", 0.8, Measure::place, by_tiny_steps},
      {"error/elastic_666.sdf", 1.2, Measure::energy},
      {"error/inelastic_666.sdf", 1.2, Measure::overlap},
      {"error/dropped_stack.sdf", 3.0, Measure::place, dropped},
      {"error/heavy_stack.sdf", 3.0, Measure::place, dropped},
      {"pyramid.sdf", 1.0, Measure::place, dropped},
      {"error/heap.sdf", 1.5, Measure::overlap},
  };
  return scenes;
}

std::string scene_name(const ErrorScene& scene) {
  return std::filesystem::path(scene.file).stem().string();
}

}  // namespace tumble::bench
