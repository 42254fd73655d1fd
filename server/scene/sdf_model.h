// <model> and <link> of SDF: bodies, described in the model's frame M until they are placed in the world.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "scene/sdf_joint.h"

namespace tumble {

struct SdfModel {
  std::string name;
  std::optional<Pose> X_WM;           ///< As its <pose> says; none: the identity.
  std::vector<BodyDefinition> links;  ///< `name` is the link's, `X_WL` holds X_ML.
  std::vector<SdfJoint> joints;
};

/// A model in the world: bodies and joints have their names there.
struct PlacedModel {
  std::vector<BodyDefinition> bodies;
  std::vector<SceneJoint> joints;
};

/// Resolves the `relative_to` of a model's pose; none: no such frame.
using FrameLookup = std::function<std::optional<Pose>(const std::string& model)>;

SdfModel read_model(SdfElement& model, const FrameLookup& find_frame);

/// The model in the world, under another name if given. A lone link's body has the model's name, one of several is called
/// model::link, as are joints.
PlacedModel placed(const SdfModel& model, const std::optional<Pose>& X_WM, const std::string& name);

/// Centre of mass in the link frame: as given, or of the geometries at their densities.
Vec3 center_of_mass(const BodyDefinition& body);

/// Fails unless the name can be one of a body: 1..63 printable ASCII characters, not "world".
void check_body_name(const SdfElement& element, const std::string& name);

}  // namespace tumble
