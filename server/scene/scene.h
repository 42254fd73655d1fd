// A scene as read from a file or built in: options and everything to create, springs, ropes and joints naming their bodies.
// Reading a scene never touches a world; building a world from it is one call.
#pragma once

#include <string>
#include <vector>

#include "world/world.h"

namespace tumble {

struct SceneAnchor {
  std::string body;       ///< Empty: the world.
  Vec3 p = Vec3::Zero();  ///< In the body's link frame, or in W [m].
};

struct SceneSpring {
  std::string name;
  SceneAnchor a, b;
  Spring spring;
};

struct SceneRope {
  std::string name;
  SceneAnchor a, b;
  Rope rope;
};

struct SceneJoint {
  std::string name;
  JointKind kind;
  SceneAnchor a, b;
};

struct Scene {
  std::string name;  ///< The world's name in the file.
  Options options;
  std::vector<BodyDefinition> bodies;
  std::vector<SceneSpring> springs;
  std::vector<SceneRope> ropes;
  std::vector<SceneJoint> joints;
};

/// A world with everything in it. Throws std::invalid_argument("body 'name': field: reason (value)").
World build_world(const Scene& scene);

}  // namespace tumble
