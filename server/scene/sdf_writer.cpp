// The writer of sdf.h: every default spelt out, numbers in the shortest form that reads back to the same bits, poses as
// quaternions. Each body becomes a model of its own with one link, which has the model's frame as its own.
#include <tinyxml2.h>

#include "scene/sdf.h"
#include "scene/sdf_element.h"
#include "scene/sdf_joint.h"
#include "scene/sdf_physics.h"

namespace tumble {
namespace {

std::string to_text(double x) {
  return to_shortest_text(x);
}
std::string to_text(int i) {
  return std::to_string(i);
}
std::string to_text(bool flag) {
  return flag ? "true" : "false";
}
std::string to_text(const Vec3& v) {
  return to_text(v.x()) + " " + to_text(v.y()) + " " + to_text(v.z());
}
std::string to_text(const Quat& q) {
  return to_text(q.x()) + " " + to_text(q.y()) + " " + to_text(q.z()) + " " + to_text(q.w());
}

std::string to_text(std::uint32_t i) {
  return std::to_string(i);
}
std::string to_text(const TriangleMesh::Corners& corners) {
  return to_text(corners[0]) + " " + to_text(corners[1]) + " " + to_text(corners[2]);
}

/// An element that is closed at the end of its scope. The printer keeps a pointer to the name until then.
class Tag {
 public:
  Tag(tinyxml2::XMLPrinter& printer, std::string tag) : printer_(printer), tag_(std::move(tag)) {
    printer_.OpenElement(tag_.c_str());
  }
  Tag(tinyxml2::XMLPrinter& printer, const std::string& tag, const std::string& name) : Tag(printer, tag) {
    attribute("name", name);
  }
  Tag(const Tag&) = delete;
  Tag& operator=(const Tag&) = delete;
  ~Tag() { printer_.CloseElement(); }

  void attribute(const char* name, const std::string& value) { printer_.PushAttribute(name, value.c_str()); }
  void text(const std::string& text) { printer_.PushText(text.c_str()); }

 private:
  tinyxml2::XMLPrinter& printer_;
  std::string tag_;
};

template <class Value>
void write(tinyxml2::XMLPrinter& out, const std::string& tag, const Value& value) {
  Tag element(out, tag);
  if constexpr (std::is_convertible_v<Value, std::string>) {
    element.text(value);
  } else {
    element.text(to_text(value));
  }
}

void write_pose(tinyxml2::XMLPrinter& out, const Pose& X) {
  Tag pose(out, "pose");
  pose.attribute("rotation_format", "quat_xyzw");
  pose.text(to_text(X.p) + " " + to_text(X.q));
}

void write_physics(tinyxml2::XMLPrinter& out, const Options& options) {
  write(out, "gravity", options.gravity);
  Tag physics(out, "physics", "tumble");
  physics.attribute("type", "tumble");
  write(out, "max_step_size", options.time_step);
  write(out, "tumble:integrator", integrator_name(options.integrator));
  write(out, "tumble:solver", solver_name(options.solver));
  for_each_option(options, [&](const char* name, const auto& field) {
    write(out, "tumble:" + std::string(name), field);
  });
}

void write_shape(tinyxml2::XMLPrinter& out, const HalfSpace&) {
  Tag plane(out, "plane");
  write(out, "normal", Vec3(Vec3::UnitZ()));
}

void write_shape(tinyxml2::XMLPrinter& out, const Sphere& sphere) {
  Tag shape(out, "sphere");
  write(out, "radius", sphere.radius);
}

void write_shape(tinyxml2::XMLPrinter& out, const Box& box) {
  Tag shape(out, "box");
  write(out, "size", Vec3(2.0 * box.half_extents));
}

template <class Round>
void write_round(tinyxml2::XMLPrinter& out, const char* tag, const Round& round) {
  Tag shape(out, tag);
  write(out, "radius", round.radius);
  write(out, "length", 2.0 * round.half_length);
}

void write_shape(tinyxml2::XMLPrinter& out, const Capsule& capsule) {
  write_round(out, "capsule", capsule);
}

void write_shape(tinyxml2::XMLPrinter& out, const Cylinder& cylinder) {
  write_round(out, "cylinder", cylinder);
}

void write_shape(tinyxml2::XMLPrinter& out, const Cone& cone) {
  write_round(out, "cone", cone);
}

void write_shape(tinyxml2::XMLPrinter& out, const Ellipsoid& ellipsoid) {
  Tag shape(out, "ellipsoid");
  write(out, "radii", ellipsoid.half_axes);
}

void write_shape(tinyxml2::XMLPrinter& out, const HullPointer& hull) {
  Tag shape(out, "tumble:convex_hull");
  std::string points;
  for (const Vec3& p : hull->vertices) points.append(points.empty() ? "" : "  ").append(to_text(p));
  write(out, "tumble:points", points);
}

template <typename Values>
std::string to_list(const Values& values) {
  std::string text;
  for (const auto& value : values) text.append(text.empty() ? "" : " ").append(to_text(value));
  return text;
}

void write_shape(tinyxml2::XMLPrinter& out, const TriangleMeshPointer& mesh) {
  Tag shape(out, "tumble:triangle_mesh");
  write(out, "tumble:vertices", to_list(mesh->vertices()));
  write(out, "tumble:triangles", to_list(mesh->triangles()));
}

void write_shape(tinyxml2::XMLPrinter& out, const HeightFieldPointer& field) {
  Tag shape(out, "tumble:height_field");
  write(out, "tumble:columns", field->columns());
  write(out, "tumble:rows", field->rows());
  write(out, "tumble:spacing", to_shortest_text(field->dx()) + " " + to_shortest_text(field->dy()));
  write(out, "tumble:heights", to_list(field->heights()));
}

void write_geometry(tinyxml2::XMLPrinter& out, const GeometryDefinition& geometry) {
  write_pose(out, geometry.X_LS);
  Tag element(out, "geometry");
  std::visit([&](const auto& shape) { write_shape(out, shape); }, geometry.shape);
}

void write_collision(tinyxml2::XMLPrinter& out, const GeometryDefinition& geometry) {
  Tag collision(out, "collision", geometry.name);
  write_geometry(out, geometry);
  write(out, "density", geometry.material.density);
  Tag surface(out, "surface");
  {
    Tag friction(out, "friction");
    {
      Tag ode(out, "ode");
      write(out, "mu", geometry.material.friction);
      write(out, "mu2", geometry.material.friction);
    }
    write(out, "tumble:torsional_friction", geometry.material.torsional_friction);
    write(out, "tumble:rolling_friction", geometry.material.rolling_friction);
  }
  Tag bounce(out, "bounce");
  write(out, "restitution_coefficient", geometry.material.restitution);
  if (const auto threshold = geometry.material.restitution_threshold) write(out, "threshold", *threshold);
}

void write_visual(tinyxml2::XMLPrinter& out, const GeometryDefinition& geometry) {
  Tag visual(out, "visual", geometry.name);
  write_geometry(out, geometry);
  Tag material(out, "material");
  std::string color;
  for (const float channel : geometry.color)
    color.append(color.empty() ? "" : " ").append(to_shortest_text(channel));
  write(out, "diffuse", color);
}

void write_inertial(tinyxml2::XMLPrinter& out, const Inertia& inertia) {
  Tag inertial(out, "inertial");
  write_pose(out, {Quat::Identity(), inertia.center});
  write(out, "mass", inertia.mass);
  Tag moments(out, "inertia");
  write(out, "ixx", inertia.moments(0, 0));
  write(out, "ixy", inertia.moments(0, 1));
  write(out, "ixz", inertia.moments(0, 2));
  write(out, "iyy", inertia.moments(1, 1));
  write(out, "iyz", inertia.moments(1, 2));
  write(out, "izz", inertia.moments(2, 2));
}

void write_body(tinyxml2::XMLPrinter& out, const BodyDefinition& body) {
  Tag model(out, "model", body.name);
  write(out, "static", body.type == BodyType::fixed);
  Tag link(out, "link", "link");
  write_pose(out, body.X_WL);
  write(out, "gravity", body.gravity);
  write(out, "kinematic", body.type == BodyType::kinematic);
  {
    Tag decay(out, "velocity_decay");
    write(out, "linear", body.linear_damping);
    write(out, "angular", body.angular_damping);
  }
  if (body.type != BodyType::fixed) {
    write(out, "tumble:linear_velocity", body.v_WB);
    write(out, "tumble:angular_velocity", body.w_WB);
  }
  if (body.inertia) write_inertial(out, *body.inertia);
  for (const GeometryDefinition& geometry : body.geometries) write_collision(out, geometry);
  for (const GeometryDefinition& geometry : body.geometries) write_visual(out, geometry);
}

void write_anchor(tinyxml2::XMLPrinter& out, const char* tag, const SceneAnchor& anchor) {
  Tag element(out, tag);
  if (!anchor.body.empty()) element.attribute("body", anchor.body);
  element.text(to_text(anchor.p));
}

void write_spring(tinyxml2::XMLPrinter& out, const SceneSpring& spring) {
  Tag element(out, "tumble:spring", spring.name);
  write_anchor(out, "tumble:a", spring.a);
  write_anchor(out, "tumble:b", spring.b);
  write(out, "tumble:rest_length", spring.spring.rest_length);
  write(out, "tumble:stiffness", spring.spring.stiffness);
  write(out, "tumble:damping", spring.spring.damping);
}

void write_rope(tinyxml2::XMLPrinter& out, const SceneRope& rope) {
  Tag element(out, "tumble:rope", rope.name);
  write_anchor(out, "tumble:a", rope.a);
  write_anchor(out, "tumble:b", rope.b);
  write(out, "tumble:length", rope.rope.length);
  write(out, "tumble:restitution", rope.rope.restitution);
}

void write_joint(tinyxml2::XMLPrinter& out, const SceneJoint& joint) {
  Tag element(out, "tumble:joint", joint.name);
  element.attribute("type", joint_kind_name(joint.kind));
  write_anchor(out, "tumble:a", joint.a);
  write_anchor(out, "tumble:b", joint.b);
}

}  // namespace

std::string write_sdf(const Scene& scene) {
  tinyxml2::XMLPrinter out;
  out.PushHeader(false, true);
  {
    Tag sdf(out, "sdf");
    sdf.attribute("version", "1.11");
    sdf.attribute("xmlns:tumble", "urn:tumble");
    Tag world(out, "world", scene.name);
    write_physics(out, scene.options);
    for (const BodyDefinition& body : scene.bodies) write_body(out, body);
    for (const SceneSpring& spring : scene.springs) write_spring(out, spring);
    for (const SceneRope& rope : scene.ropes) write_rope(out, rope);
    for (const SceneJoint& joint : scene.joints) write_joint(out, joint);
  }
  return out.CStr();
}

}  // namespace tumble
