// Bodies as text and JSON, see body_text.h.
#include "commands/body_text.h"

#include <fmt/format.h>

#include "tumble/catalog_t.hpp"
#include "tumble/state_t.hpp"

namespace tumble::client {

std::string shape_text(const Body& body) {
  if (body.shapes.empty()) return "?";
  if (body.num_shapes > 1) return fmt::format("{} shapes", body.num_shapes);
  const Shape& shape = body.shapes.front();
  const Vec3& size = shape.size;
  switch (shape.type) {
    case catalog_t::SHAPE_SPHERE:
      return fmt::format("sphere {:.4g}", size[0]);
    case catalog_t::SHAPE_CAPSULE:
    case catalog_t::SHAPE_CYLINDER:
    case catalog_t::SHAPE_CONE:
      return fmt::format("{} {:.4g} x {:.4g}", shape_type_name(shape.type), size[0], size[1]);
    case catalog_t::SHAPE_BOX:
    case catalog_t::SHAPE_ELLIPSOID:
      return fmt::format("{} {:.4g} x {:.4g} x {:.4g}", shape_type_name(shape.type), size[0], size[1],
                         size[2]);
    case catalog_t::SHAPE_HULL:
      return fmt::format("hull, {} vertices", shape.num_vertices);
    case catalog_t::SHAPE_TRIANGLE_MESH:
    case catalog_t::SHAPE_HEIGHT_FIELD:
      return fmt::format("{} {:.4g} x {:.4g} x {:.4g}", shape_type_name(shape.type), size[0], size[1],
                         size[2]);
  }
  return shape_type_name(shape.type);
}

std::string motion_text(const Body& body) {
  if (body.flags & state_t::FLAG_CONTAINED) return "contained";
  if (body.is_static()) return "static";
  if (body.is_kinematic()) return "kinematic";
  return body.is_resting() ? "resting" : "moving";
}

nlohmann::ordered_json to_json(const Body& body) {
  nlohmann::ordered_json object{{"id", body.id}, {"generation", body.generation}};
  if (body.described) {
    object["name"] = body.name;
    object["type"] = body_type_name(body.type);
    object["mass"] = body.mass;
    object["inertia"] = body.inertia;
    object["center_of_mass"] = body.center_of_mass;
    for (const Shape& shape : body.shapes) {
      object["shapes"].push_back({{"type", shape_type_name(shape.type)},
                                  {"size", shape.size},
                                  {"position", shape.position},
                                  {"orientation", shape.orientation},
                                  {"friction", shape.friction},
                                  {"restitution", shape.restitution},
                                  {"color", shape.color}});
    }
  }
  if (body.placed) {
    object["step"] = body.step;
    object["time"] = body.time;
    object["motion"] = motion_text(body);
    object["position"] = body.position;
    object["orientation"] = body.orientation;
    object["velocity"] = body.velocity;
    object["angular_velocity"] = body.angular_velocity;
  }
  return object;
}

}  // namespace tumble::client
