// <joint> of SDF within a model: ball and fixed ones. Other types are refused, since without them the bodies would move
// differently.
#pragma once

#include <string>
#include <vector>

#include "scene/scene.h"
#include "scene/sdf_element.h"

namespace tumble {

struct SdfJoint {
  struct End {
    std::string link;       ///< Empty: the world.
    Vec3 p = Vec3::Zero();  ///< In the link's frame, of the world in the model's [m].
  };
  std::string name;
  JointKind kind;
  End parent, child;
};

/// The joints of a model whose links (X_WL holds X_ML) are known.
std::vector<SdfJoint> read_joints(SdfElement& model, const std::vector<BodyDefinition>& links);

/// The attribute `type`: "ball" or "fixed".
JointKind read_joint_kind(SdfElement& joint);
const char* joint_kind_name(JointKind kind);

}  // namespace tumble
