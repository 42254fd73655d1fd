// See scene.h. Order of creation is the order of the scene, which makes ids and every later order reproducible.
#include "scene/scene.h"

#include <stdexcept>

namespace tumble {
namespace {

/// Calls create() and puts the kind and name of what was to be created before the reason if it fails.
template <class Create>
void create_named(const char* kind, const std::string& name, Create&& create) {
  try {
    create();
  } catch (const std::invalid_argument& reason) {
    throw std::invalid_argument(std::string(kind) + " '" + name + "': " + reason.what());
  }
}

Anchor find_anchor(const World& world, const SceneAnchor& anchor, const char* end) {
  if (anchor.body.empty()) return {std::nullopt, anchor.p};
  const std::optional<BodyId> body = world.find(anchor.body);
  if (!body) throw std::invalid_argument(std::string(end) + ": unknown body (" + anchor.body + ")");
  return {*body, anchor.p};
}

}  // namespace

World build_world(const Scene& scene) {
  World world(scene.options);
  for (const BodyDefinition& body : scene.bodies) {
    create_named("body", body.name, [&] { world.create_body(body); });
  }
  for (const SceneSpring& spring : scene.springs) {
    create_named("spring", spring.name, [&] {
      world.create_spring(
          {spring.name, find_anchor(world, spring.a, "a"), find_anchor(world, spring.b, "b"), spring.spring});
    });
  }
  for (const SceneRope& rope : scene.ropes) {
    create_named("rope", rope.name, [&] {
      world.create_rope(
          {rope.name, find_anchor(world, rope.a, "a"), find_anchor(world, rope.b, "b"), rope.rope});
    });
  }
  for (const SceneJoint& joint : scene.joints) {
    create_named("joint", joint.name, [&] {
      world.create_joint(
          {joint.name, joint.kind, find_anchor(world, joint.a, "a"), find_anchor(world, joint.b, "b")});
    });
  }
  return world;
}

}  // namespace tumble
