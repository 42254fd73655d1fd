// The demo scenes that ship inside the program: the files of tests/scenes, embedded at build time.
#pragma once

#include <string_view>
#include <vector>

#include "scene/sdf.h"

namespace tumble {

/// Names in alphabetical order: cradle, incline, pile, pyramid, springs, terrain, tumbling.
std::vector<std::string_view> demo_names();
/// The SDF text of a demo; empty if there is no such demo.
std::string_view demo_text(std::string_view name);

}  // namespace tumble
