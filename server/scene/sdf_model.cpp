// See sdf_model.h. Tags as in the SDFormat specification (sdformat: model.sdf, link.sdf, inertial.sdf).
#include "scene/sdf_model.h"

#include <algorithm>

#include "scene/sdf_geometry.h"
#include "scene/sdf_pose.h"

namespace tumble {
namespace {

constexpr std::size_t kLongestName = 63;  // characters, see BodyDefinition::name

/// Mass properties of the geometries at their densities.
Inertia inertia_of_geometries(const BodyDefinition& body) {
  std::vector<Inertia> parts;
  for (const GeometryDefinition& g : body.geometries) {
    parts.push_back(transformed(compute_inertia(g.shape, g.material.density), g.X_LS));
  }
  return combined(parts);
}

Mat3 read_moments(SdfElement& inertia) {
  const auto diagonal = [&](const char* tag) {
    return inertia.required_child(tag).to_number(Range::positive);
  };
  const auto product = [&](const char* tag) { return inertia.number(tag).value_or(0.0); };
  const double xx = diagonal("ixx"), yy = diagonal("iyy"), zz = diagonal("izz");
  const double xy = product("ixy"), xz = product("ixz"), yz = product("iyz");
  inertia.finish();
  Mat3 moments;
  moments << xx, xy, xz, xy, yy, yz, xz, yz, zz;
  return moments;
}

/// R M R^T, symmetric to the last bit; M itself for the identity.
Mat3 rotated(const Quat& q, const Mat3& M) {
  if (q.w() == 1.0) return M;
  const Mat3 R = rotation_matrix(q);
  const Mat3 turned = R * M * R.transpose();
  return 0.5 * (turned + turned.transpose());
}

/// The geometries' inertia, scaled to the mass that is given alone.
Inertia scaled_inertia(SdfElement& inertial, const BodyDefinition& body, double mass) {
  const bool solid = std::none_of(body.geometries.begin(), body.geometries.end(),
                                  [](const GeometryDefinition& g) { return is_static_only(g.shape); });
  if (body.geometries.empty() || !solid)
    inertial.fail("has a <mass>, but neither <inertia> nor a solid <collision>");
  Inertia inertia = inertia_of_geometries(body);
  inertia.moments *= mass / inertia.mass;
  inertia.mass = mass;
  if (const std::string reason = check_inertia(inertia); !reason.empty()) inertial.fail(reason);
  return inertia;
}

void read_inertial(SdfElement& inertial, BodyDefinition& body) {
  const std::string automatic = inertial.attribute("auto").value_or("false");
  std::optional<SdfElement> mass_element = inertial.child("mass");
  std::optional<SdfElement> moments_element = inertial.child("inertia");
  std::optional<SdfElement> pose_element = inertial.child("pose");
  if (const auto density = inertial.number("density", Range::positive)) {
    for (GeometryDefinition& g : body.geometries) g.material.density = *density;
  }
  if (automatic != "true" && automatic != "false") {
    inertial.fail_attribute("auto", "must be true or false", automatic);
  }
  const double mass = mass_element ? mass_element->to_number(Range::positive) : 0.0;
  if (automatic == "true") {
    if (mass_element || moments_element || pose_element)
      inertial.fail("auto=\"true\" leaves no room for values");
  } else if (moments_element) {
    if (!mass_element) inertial.fail("has an <inertia>, but no <mass>");
    const Pose X_LI = pose_element ? read_pose(*pose_element) : Pose{};
    body.inertia = Inertia{mass, X_LI.p, rotated(X_LI.q, read_moments(*moments_element))};
    if (const std::string reason = check_inertia(*body.inertia); !reason.empty())
      moments_element->fail(reason);
  } else {
    if (pose_element) pose_element->fail("needs an <inertia> beside it");
    if (mass_element) body.inertia = scaled_inertia(inertial, body, mass);
  }
  inertial.finish();
}

/// A visual gives its colour to the collision of its name, else to all that have none yet.
void read_visual(SdfElement& visual, std::vector<SdfElement>& collisions, BodyDefinition& body) {
  const std::string name = visual.required_attribute("name");
  std::optional<SdfElement> pose = visual.child("pose"), geometry = visual.child("geometry");
  std::size_t match = 0;
  while (match < body.geometries.size() && body.geometries[match].name != name) ++match;
  const std::size_t drawn = match < collisions.size() ? match : 0;
  if (geometry) {
    const std::optional<SdfElement> shape =
        drawn < collisions.size() ? collisions[drawn].child("geometry") : std::nullopt;
    if (!shape || !shape->has_same_content(*geometry))
      geometry->warn_ignored("viewers draw the collision's shape");
  }
  if (pose) {
    const std::optional<SdfElement> place =
        drawn < collisions.size() ? collisions[drawn].child("pose") : std::nullopt;
    if (!place || !place->has_same_content(*pose))
      pose->warn_ignored("viewers draw the collision's shape at its pose");
  }
  if (std::optional<SdfElement> material = visual.child("material")) {
    if (std::optional<SdfElement> diffuse = material->child("diffuse")) {
      const std::array<float, 4> color = read_color(*diffuse);
      for (std::size_t i = 0; i < body.geometries.size(); ++i) {
        if (match == body.geometries.size() || i == match) body.geometries[i].color = color;
      }
    }
    material->finish();
  }
  visual.finish();
}

void read_motion(SdfElement& link, BodyDefinition& body) {
  for (const char* tag : {"tumble:linear_velocity", "tumble:angular_velocity"}) {
    std::optional<SdfElement> velocity = link.child(tag);
    if (!velocity) continue;
    if (body.type == BodyType::fixed) velocity->fail("a static body has no velocity", velocity->to_text());
    (velocity->tag() == "tumble:linear_velocity" ? body.v_WB : body.w_WB) = velocity->to_vector();
  }
  if (std::optional<SdfElement> decay = link.child("velocity_decay")) {
    body.linear_damping = decay->number("linear", Range::non_negative).value_or(0.0);
    body.angular_damping = decay->number("angular", Range::non_negative).value_or(0.0);
    decay->finish();
  }
  body.gravity = link.flag("gravity").value_or(true);
}

void read_collisions(std::vector<SdfElement>& collisions, BodyDefinition& body) {
  for (SdfElement& collision : collisions) {
    GeometryDefinition geometry = read_collision(collision, body.type);
    const auto same_name = [&](const GeometryDefinition& g) { return g.name == geometry.name; };
    if (std::any_of(body.geometries.begin(), body.geometries.end(), same_name)) {
      collision.fail_attribute("name", "is used twice in this link", geometry.name);
    }
    body.geometries.push_back(std::move(geometry));
  }
}

/// X_ML of a link whose pose may be relative to a link before it.
Pose read_link_pose(SdfElement& link, const std::vector<BodyDefinition>& links) {
  std::optional<SdfElement> element = link.child("pose");
  if (!element) return Pose{};
  const std::string frame = element->attribute("relative_to").value_or("");
  const Pose pose = read_pose(*element);
  if (frame.empty() || frame == "__model__") return pose;
  for (const BodyDefinition& other : links) {
    if (other.name == frame) return chained(other.X_WL, pose);
  }
  element->fail_attribute("relative_to", "unknown: must be __model__ or a link above", frame);
}

BodyDefinition read_link(SdfElement& link, bool is_static, const std::vector<BodyDefinition>& links) {
  BodyDefinition body;
  body.name = link.required_attribute("name");
  const auto same_name = [&](const BodyDefinition& other) { return other.name == body.name; };
  if (std::any_of(links.begin(), links.end(), same_name)) {
    link.fail_attribute("name", "is used twice in this model", body.name);
  }
  body.X_WL = read_link_pose(link, links);
  body.type = is_static ? BodyType::fixed : BodyType::dynamic;
  if (std::optional<SdfElement> kinematic = link.child("kinematic"); kinematic && kinematic->to_flag()) {
    if (is_static) kinematic->fail("a static model has no kinematic links", "true");
    body.type = BodyType::kinematic;
  }
  std::vector<SdfElement> collisions = link.children({"collision"});
  read_collisions(collisions, body);
  if (std::optional<SdfElement> inertial = link.child("inertial")) read_inertial(*inertial, body);
  if (body.type == BodyType::dynamic && body.geometries.empty() && !body.inertia) {
    link.fail("needs a <collision> or an <inertial> with mass and inertia");
  }
  if (body.type == BodyType::dynamic && !body.inertia) {
    if (const std::string reason = check_inertia(inertia_of_geometries(body)); !reason.empty())
      link.fail(reason);
  }
  read_motion(link, body);
  for (SdfElement& visual : link.children({"visual"})) read_visual(visual, collisions, body);
  link.finish();
  return body;
}

std::optional<Pose> read_model_pose(SdfElement& model, const FrameLookup& find_frame) {
  std::optional<SdfElement> element = model.child("pose");
  if (!element) return std::nullopt;
  const std::string frame = element->attribute("relative_to").value_or("");
  const Pose pose = read_pose(*element);
  if (frame.empty() || frame == "world") return pose;
  const std::optional<Pose> X_WF = find_frame(frame);
  if (!X_WF) element->fail_attribute("relative_to", "unknown: must be world or a model above", frame);
  return chained(X_WF, pose);
}

void refuse_what_changes_motion(SdfElement& model) {
  model.refuse("model", "nested models are not supported: write them side by side");
  model.refuse("include", "only meshes can be included, by <mesh><uri>");
  if (const auto frame = model.attribute("placement_frame")) {
    model.fail_attribute("placement_frame", "is not supported: place the model's own frame", *frame);
  }
}

}  // namespace

void check_body_name(const SdfElement& element, const std::string& name) {
  const bool printable = std::all_of(name.begin(), name.end(), [](char c) { return c >= ' ' && c <= '~'; });
  if (name.empty() || name.size() > kLongestName || !printable) {
    element.fail("a body's name must be 1..63 printable ASCII characters", name);
  }
  if (name == "world") element.fail("is a reserved name", name);
}

Vec3 center_of_mass(const BodyDefinition& body) {
  if (body.inertia) return body.inertia->center;
  return body.geometries.empty() ? Vec3(Vec3::Zero()) : inertia_of_geometries(body).center;
}

SdfModel read_model(SdfElement& element, const FrameLookup& find_frame) {
  SdfModel model;
  model.name = element.required_attribute("name");
  check_body_name(element, model.name);
  refuse_what_changes_motion(element);
  model.X_WM = read_model_pose(element, find_frame);
  const bool is_static = element.flag("static").value_or(false);
  for (SdfElement& link : element.children({"link"})) {
    model.links.push_back(read_link(link, is_static, model.links));
  }
  if (model.links.empty()) element.fail("needs a <link>", model.name);
  model.joints = read_joints(element, model.links);
  element.finish();
  return model;
}

PlacedModel placed(const SdfModel& model, const std::optional<Pose>& X_WM, const std::string& name) {
  PlacedModel result;
  const auto body_name = [&](const std::string& link) {
    return model.links.size() == 1 ? name : name + "::" + link;
  };
  for (BodyDefinition body : model.links) {
    body.name = body_name(body.name);
    body.X_WL = chained(X_WM, body.X_WL);
    result.bodies.push_back(std::move(body));
  }
  for (const SdfJoint& joint : model.joints) {
    const auto anchor = [&](const SdfJoint::End& end) -> SceneAnchor {
      if (end.link.empty()) return {"", X_WM ? *X_WM * end.p : end.p};
      return {body_name(end.link), end.p};
    };
    result.joints.push_back(
        {name + "::" + joint.name, joint.kind, anchor(joint.parent), anchor(joint.child)});
  }
  return result;
}

}  // namespace tumble
