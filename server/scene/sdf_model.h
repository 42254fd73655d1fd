// <model> and <link> of SDF: bodies, described in the model's frame M until they are placed in the world.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "scene/sdf_element.h"
#include "world/definition.h"

namespace tumble {

struct SdfModel {
  std::string name;
  std::optional<Pose> X_WM;           ///< As its <pose> says; none: the identity.
  std::vector<BodyDefinition> links;  ///< `name` is the link's, `X_WL` holds X_ML.
};

/// Resolves the `relative_to` of a model's pose; none: no such frame.
using FrameLookup = std::function<std::optional<Pose>(const std::string& model)>;

SdfModel read_model(SdfElement& model, const FrameLookup& find_frame);

/// The model's bodies in the world, under another model name if given. A lone link's body has the model's name, one of
/// several is called model::link.
std::vector<BodyDefinition> placed(const SdfModel& model, const std::optional<Pose>& X_WM,
                                   const std::string& name);

/// Centre of mass in the link frame: as given, or of the geometries at their densities.
Vec3 center_of_mass(const BodyDefinition& body);

/// Fails unless the name can be one of a body: 1..63 printable ASCII characters, not "world".
void check_body_name(const SdfElement& element, const std::string& name);

}  // namespace tumble
