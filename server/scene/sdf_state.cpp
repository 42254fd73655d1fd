// See sdf_state.h. Link poses and velocities are in W; a velocity is that of the link's origin, as in SDF, and is
// turned into that of the centre of mass here.
#include "scene/sdf_state.h"

#include <fmt/format.h>

#include <algorithm>

#include "scene/sdf_model.h"
#include "scene/sdf_pose.h"

namespace tumble {
namespace {

void set_velocity(SdfElement velocity, BodyDefinition& body) {
  const std::vector<double> n = velocity.to_numbers(6);
  if (body.type == BodyType::fixed) velocity.fail("a static body has no velocity", body.name);
  body.w_WB = Vec3(n[3], n[4], n[5]);
  body.v_WB = Vec3(n[0], n[1], n[2]);
  if (body.w_WB.isZero(0.0)) return;
  const Vec3 r_W = body.X_WL.q * center_of_mass(body);
  body.v_WB += body.w_WB.cross(r_W);
  if (!body.v_WB.allFinite()) velocity.fail("overflows at the centre of mass", velocity.to_text());
}

void set_pose(SdfElement pose, BodyDefinition& body) {
  if (const auto frame = pose.attribute("relative_to"); frame && !frame->empty() && *frame != "world") {
    pose.fail_attribute("relative_to", "poses of a state are in the world's frame", *frame);
  }
  body.X_WL = read_pose(pose);
}

BodyDefinition* find_body(Scene& scene, const std::string& name) {
  const auto has_name = [&](const BodyDefinition& body) { return body.name == name; };
  const auto found = std::find_if(scene.bodies.begin(), scene.bodies.end(), has_name);
  return found == scene.bodies.end() ? nullptr : &*found;
}

void read_model_state(SdfElement& model, Scene& scene) {
  const std::string name = model.required_attribute("name");
  for (SdfElement& link : model.children({"link"})) {
    const std::string full_name = fmt::format("{}::{}", name, link.required_attribute("name"));
    BodyDefinition* body = find_body(scene, full_name);
    if (!body) body = find_body(scene, name);  // a lone link's body is called like its model
    if (!body) link.fail("no such body", full_name);
    if (std::optional<SdfElement> pose = link.child("pose")) set_pose(*pose, *body);
    if (std::optional<SdfElement> velocity = link.child("velocity")) set_velocity(*velocity, *body);
    link.finish();
  }
  model.finish();
}

}  // namespace

void read_state(SdfElement& state, Scene& scene) {
  state.refuse("insertions", "is not supported: put the models into the world");
  state.refuse("deletions", "is not supported: take the models out of the world");
  state.attribute("world_name");
  for (SdfElement& model : state.children({"model"})) read_model_state(model, scene);
  state.finish();
}

}  // namespace tumble
