// <state> of SDF: poses and velocities that replace those of the models.
#pragma once

#include "scene/scene.h"
#include "scene/sdf_element.h"

namespace tumble {

/// Applies the state to the bodies of `scene`.
void read_state(SdfElement& state, Scene& scene);

}  // namespace tumble
