// <collision> of SDF: shape, pose, surface and density of one solid of a link.
#pragma once

#include "scene/sdf_element.h"
#include "world/definition.h"

namespace tumble {

/// Colours stay at their default; <visual> gives them. `type`: of the body, since a mesh is a surface on a static one and
/// its convex hull on one that moves.
GeometryDefinition read_collision(SdfElement& collision, BodyType type);

/// The n numbers of an RGBA colour, each 0..1.
std::array<float, 4> read_color(SdfElement& color);

}  // namespace tumble
