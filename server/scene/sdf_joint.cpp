// See sdf_joint.h. The joint's frame is the child link's unless its <pose> says otherwise; parent and child meet there.
#include "scene/sdf_joint.h"

#include <algorithm>

#include "scene/sdf_pose.h"

namespace tumble {
namespace {

using Links = std::vector<BodyDefinition>;

const BodyDefinition* find_link(const Links& links, const std::string& name) {
  const auto found =
      std::find_if(links.begin(), links.end(), [&](const BodyDefinition& link) { return link.name == name; });
  return found == links.end() ? nullptr : &*found;
}

/// The link that a <parent> or <child> names; null: the world.
const BodyDefinition* read_end(SdfElement& joint, const char* tag, const Links& links) {
  SdfElement end = joint.required_child(tag);
  const std::string name = end.to_text();
  if (name == "world") return nullptr;
  const BodyDefinition* link = find_link(links, name);
  if (!link) end.fail("unknown: must be a link of this model or world", name);
  return link;
}

/// The joint's origin in the model's frame.
Vec3 read_origin(SdfElement& joint, const BodyDefinition* child, const Links& links) {
  Pose X_MF = child ? child->X_WL : Pose{};
  std::optional<SdfElement> element = joint.child("pose");
  if (!element) return X_MF.p;
  const std::string frame = element->attribute("relative_to").value_or("");
  const Pose pose = read_pose(*element);
  if (frame == "__model__") {
    X_MF = Pose{};
  } else if (!frame.empty()) {
    const BodyDefinition* link = find_link(links, frame);
    if (!link) element->fail_attribute("relative_to", "unknown: must be __model__ or a link", frame);
    X_MF = link->X_WL;
  }
  return X_MF * pose.p;
}

SdfJoint::End end_at(const BodyDefinition* link, const Vec3& p_M) {
  if (!link) return {"", p_M};
  return {link->name, link->X_WL.inverse() * p_M};
}

SdfJoint read_joint(SdfElement& element, const Links& links, const std::vector<SdfJoint>& before) {
  SdfJoint joint;
  joint.name = element.required_attribute("name");
  const auto same = [&](const SdfJoint& other) { return other.name == joint.name; };
  if (joint.name.empty() || std::any_of(before.begin(), before.end(), same)) {
    element.fail_attribute("name", "is empty or used twice in this model", joint.name);
  }
  joint.kind = read_joint_kind(element);
  const BodyDefinition* parent = read_end(element, "parent", links);
  const BodyDefinition* child = read_end(element, "child", links);
  if (parent == child) element.fail("both ends are the same", joint.name);
  const auto moves = [](const BodyDefinition* link) { return link && link->type == BodyType::dynamic; };
  if (!moves(parent) && !moves(child)) element.fail("neither end is a dynamic body", joint.name);
  const Vec3 p_M = read_origin(element, child, links);
  joint.parent = end_at(parent, p_M);
  joint.child = end_at(child, p_M);
  element.finish();
  return joint;
}

}  // namespace

const char* joint_kind_name(JointKind kind) {
  return kind == JointKind::ball ? "ball" : "fixed";
}

JointKind read_joint_kind(SdfElement& joint) {
  const std::string type = joint.required_attribute("type");
  for (const JointKind kind : {JointKind::ball, JointKind::fixed}) {
    if (type == joint_kind_name(kind)) return kind;
  }
  joint.fail_attribute("type", "must be ball or fixed", type);
}

std::vector<SdfJoint> read_joints(SdfElement& model, const std::vector<BodyDefinition>& links) {
  std::vector<SdfJoint> joints;
  for (SdfElement& element : model.children({"joint"})) joints.push_back(read_joint(element, links, joints));
  return joints;
}

}  // namespace tumble
