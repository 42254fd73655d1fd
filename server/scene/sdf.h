// Reader and writer of the declared SDFormat subset (scene/README.md lists every tag). Ignored tags are warnings,
// wrong values are errors; both name file, line, field and value.
#pragma once

#include <stdexcept>
#include <string>
#include <vector>

#include "scene/scene.h"

namespace tumble {

/// what(): "FILE:LINE: <tag>: reason (value)".
class SceneError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

struct SceneReading {
  Scene scene;
  std::vector<std::string> warnings;  ///< "FILE:LINE: <tag> is ignored: reason"
};

/// Reads an SDF file; meshes and includes by path relative to it. Throws SceneError.
SceneReading read_sdf(const std::string& path);
/// The same from text; `name` stands for the file in messages, `directory` resolves relative paths.
SceneReading read_sdf_text(const std::string& text, const std::string& name, const std::string& directory);

/// The scene as SDF with every default written out; reading it back gives the same scene to the bit.
std::string write_sdf(const Scene& scene);

}  // namespace tumble
