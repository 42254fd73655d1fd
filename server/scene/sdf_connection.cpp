// See sdf_connection.h. The anchors' distance at the start is the default of rest length and rope length.
#include "scene/sdf_connection.h"

#include <algorithm>
#include <unordered_map>

#include "scene/sdf_joint.h"
#include "scene/sdf_model.h"

namespace tumble {
namespace {

using Bodies = std::unordered_map<std::string, const BodyDefinition*>;

SceneAnchor read_anchor(SdfElement anchor, const Bodies& bodies) {
  SceneAnchor result;
  result.body = anchor.attribute("body").value_or("");
  result.p = anchor.to_vector();
  if (result.body == "world") result.body.clear();
  if (!result.body.empty() && !bodies.contains(result.body))
    anchor.fail_attribute("body", "unknown body", result.body);
  return result;
}

Vec3 position(const SceneAnchor& anchor, const Bodies& bodies) {
  return anchor.body.empty() ? anchor.p : bodies.at(anchor.body)->X_WL * anchor.p;
}

bool is_movable(const SceneAnchor& anchor, const Bodies& bodies) {
  return !anchor.body.empty() && bodies.at(anchor.body)->type == BodyType::dynamic;
}

/// Reads both anchors into `connection`; returns their distance at the start [m].
template <class Connection>
double read_anchors(SdfElement& element, const Bodies& bodies, Connection& connection) {
  connection.a = read_anchor(element.required_child("tumble:a"), bodies);
  connection.b = read_anchor(element.required_child("tumble:b"), bodies);
  if (!is_movable(connection.a, bodies) && !is_movable(connection.b, bodies)) {
    element.fail("neither end is at a dynamic body", connection.name);
  }
  if (connection.a.body == connection.b.body)
    element.fail("both ends are at the same body", connection.a.body);
  return (position(connection.b, bodies) - position(connection.a, bodies)).norm();
}

template <class Connection>
std::string read_name(SdfElement& element, const std::vector<Connection>& others) {
  std::string name = element.required_attribute("name");
  const auto same = [&](const Connection& other) { return other.name == name; };
  if (std::any_of(others.begin(), others.end(), same)) element.fail_attribute("name", "is used twice", name);
  check_body_name(element, name);
  return name;
}

SceneSpring read_spring(SdfElement& element, const Scene& scene, const Bodies& bodies) {
  SceneSpring spring;
  spring.name = read_name(element, scene.springs);
  const double distance = read_anchors(element, bodies, spring);
  spring.spring.rest_length = element.number("tumble:rest_length", Range::non_negative).value_or(distance);
  spring.spring.stiffness = element.required_child("tumble:stiffness").to_number(Range::non_negative);
  spring.spring.damping = element.number("tumble:damping", Range::non_negative).value_or(0.0);
  element.finish();
  return spring;
}

SceneRope read_rope(SdfElement& element, const Scene& scene, const Bodies& bodies) {
  SceneRope rope;
  rope.name = read_name(element, scene.ropes);
  const double distance = read_anchors(element, bodies, rope);
  rope.rope.length = element.number("tumble:length", Range::positive).value_or(distance);
  rope.rope.restitution = element.number("tumble:restitution", Range::zero_to_one).value_or(0.0);
  if (!(rope.rope.length > 0.0)) element.fail("its ends coincide: give a <tumble:length>", rope.name);
  element.finish();
  return rope;
}

SceneJoint read_joint(SdfElement& element, const Scene& scene, const Bodies& bodies) {
  SceneJoint joint;
  joint.name = read_name(element, scene.joints);
  joint.kind = read_joint_kind(element);
  read_anchors(element, bodies, joint);
  element.finish();
  return joint;
}

}  // namespace

void read_connections(SdfElement& world, Scene& scene) {
  Bodies bodies;
  for (const BodyDefinition& body : scene.bodies) bodies.emplace(body.name, &body);
  for (SdfElement& element : world.children({"tumble:spring"})) {
    scene.springs.push_back(read_spring(element, scene, bodies));
  }
  for (SdfElement& element : world.children({"tumble:rope"})) {
    scene.ropes.push_back(read_rope(element, scene, bodies));
  }
  for (SdfElement& element : world.children({"tumble:joint"})) {
    scene.joints.push_back(read_joint(element, scene, bodies));
  }
}

}  // namespace tumble
