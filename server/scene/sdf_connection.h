// <tumble:spring>, <tumble:rope> and <tumble:joint>: connections between points of bodies, or of a body and the world.
#pragma once

#include "scene/scene.h"
#include "scene/sdf_element.h"

namespace tumble {

/// Reads the springs, ropes and joints of a world whose bodies are already in `scene`.
void read_connections(SdfElement& world, Scene& scene);

}  // namespace tumble
