// Bodies as people and as scripts read them.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "tumble/body.h"

namespace tumble::client {

/// "box 1 x 1 x 0.5", "2 shapes", ...: lengths in [m].
std::string shape_text(const Body& body);
/// "moving", "resting", "static" or "kinematic"; "contained" if the server had to hold it.
std::string motion_text(const Body& body);
/// Everything known of the body, SI units, conventions of protocol/README.md.
nlohmann::ordered_json to_json(const Body& body);

}  // namespace tumble::client
