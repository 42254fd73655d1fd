// Names and questions of a body, see body.h.
#include "tumble/body.h"

#include "tumble/catalog_t.hpp"
#include "tumble/state_t.hpp"

namespace tumble::client {

bool Body::is_static() const {
  return flags & state_t::FLAG_STATIC;
}
bool Body::is_kinematic() const {
  return flags & state_t::FLAG_KINEMATIC;
}
bool Body::is_resting() const {
  return flags & state_t::FLAG_RESTING;
}

const char* shape_type_name(std::int8_t type) {
  switch (type) {
    case catalog_t::SHAPE_HALF_SPACE:
      return "half_space";
    case catalog_t::SHAPE_SPHERE:
      return "sphere";
    case catalog_t::SHAPE_CAPSULE:
      return "capsule";
    case catalog_t::SHAPE_BOX:
      return "box";
    case catalog_t::SHAPE_HULL:
      return "convex_hull";
    case catalog_t::SHAPE_CYLINDER:
      return "cylinder";
    case catalog_t::SHAPE_CONE:
      return "cone";
    case catalog_t::SHAPE_ELLIPSOID:
      return "ellipsoid";
    case catalog_t::SHAPE_TRIANGLE_MESH:
      return "triangle_mesh";
    case catalog_t::SHAPE_HEIGHT_FIELD:
      return "height_field";
  }
  return "?";
}

const char* body_type_name(std::int8_t type) {
  switch (type) {
    case catalog_t::TYPE_STATIC:
      return "static";
    case catalog_t::TYPE_DYNAMIC:
      return "dynamic";
    case catalog_t::TYPE_KINEMATIC:
      return "kinematic";
  }
  return "?";
}

}  // namespace tumble::client
