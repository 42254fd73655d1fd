// See sdf_geometry.h. One reader a shape; SDF gives full sizes where our shapes have half extents.
#include "scene/sdf_geometry.h"

#include <cmath>
#include <stdexcept>

#include "scene/mesh.h"
#include "scene/sdf_pose.h"

namespace tumble {
namespace {

constexpr double kDefaultFriction = 1.0;  // SDF's default of <mu>

Vec3 read_positive_vector(SdfElement element) {
  const Vec3 v = element.to_vector();
  if (!(v.minCoeff() > 0.0)) element.fail("must be > 0", element.to_text());
  return v;
}

Shape read_box(SdfElement& box) {
  return Box{0.5 * read_positive_vector(box.required_child("size"))};
}

Shape read_sphere(SdfElement& sphere) {
  return Sphere{sphere.required_child("radius").to_number(Range::positive)};
}

Shape read_capsule(SdfElement& capsule) {
  const double radius = capsule.required_child("radius").to_number(Range::positive);
  const double length = capsule.required_child("length").to_number(Range::positive);
  return Capsule{radius, 0.5 * length};
}

HullPointer build_hull(const SdfElement& element, const std::vector<Vec3>& points) {
  try {
    return std::make_shared<const ConvexHull>(build_convex_hull(points));
  } catch (const std::invalid_argument& reason) {
    element.fail(reason.what());
  }
}

Shape read_mesh(SdfElement& mesh) {
  mesh.refuse("submesh", "submeshes are not supported: give each a file of its own");
  const std::string optimization = mesh.attribute("optimization").value_or("convex_hull");
  if (optimization != "convex_hull" && !optimization.empty()) {
    mesh.fail_attribute("optimization", "only convex_hull is supported", optimization);
  }
  SdfElement uri = mesh.required_child("uri");
  std::optional<SdfElement> scale_element = mesh.child("scale");
  const Vec3 scale = scale_element ? read_positive_vector(*scale_element) : Vec3(Vec3::Ones());
  std::vector<Vec3> points;
  try {
    points = read_mesh_points(resolve_mesh_path(uri.to_text(), mesh.file().directory));
  } catch (const MeshError& reason) {
    uri.fail(reason.what());
  }
  for (Vec3& p : points) p = p.cwiseProduct(scale);
  return build_hull(uri, points);
}

Shape read_convex_hull(SdfElement& hull) {
  SdfElement element = hull.required_child("tumble:points");
  const std::vector<double> n = element.to_numbers();
  if (n.size() % 3 != 0) element.fail("must be three numbers a point, is", std::to_string(n.size()));
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < n.size(); i += 3) points.emplace_back(n[i], n[i + 1], n[i + 2]);
  return build_hull(element, points);
}

/// Turns the shape's frame so that its z is the plane's normal.
void read_plane(SdfElement& plane, GeometryDefinition& geometry) {
  if (std::optional<SdfElement> size = plane.child("size")) {
    size->to_numbers(2);
    size->warn_ignored("a collision plane is infinite");
  }
  geometry.shape = HalfSpace{};
  std::optional<SdfElement> normal = plane.child("normal");
  if (!normal) return;
  const Vec3 n = normal->to_vector();
  const double largest = n.cwiseAbs().maxCoeff();
  if (!(largest > 1e-100)) normal->fail("must not be zero", normal->to_text());
  const Vec3 scaled = n / largest;
  const Vec3 unit = scaled / scaled.norm();
  if (unit == Vec3::UnitZ()) return;
  geometry.X_LS.q = unit_or_same(geometry.X_LS.q * rotation_to_normal(unit));
}

void read_geometry(SdfElement geometry, GeometryDefinition& definition) {
  std::vector<SdfElement> shapes =
      geometry.children({"sphere", "box", "capsule", "plane", "mesh", "tumble:convex_hull"});
  for (const char* unsupported :
       {"cylinder", "cone", "ellipsoid", "heightmap", "image", "polyline", "empty"}) {
    geometry.refuse(unsupported,
                    "this geometry is not supported: use sphere, box, capsule, plane, mesh or "
                    "tumble:convex_hull");
  }
  geometry.finish();
  if (shapes.empty()) geometry.fail("needs one of sphere, box, capsule, plane, mesh, tumble:convex_hull");
  if (shapes.size() > 1) shapes[1].fail("a geometry has one shape only");
  SdfElement& shape = shapes[0];
  if (shape.tag() == "sphere") definition.shape = read_sphere(shape);
  if (shape.tag() == "box") definition.shape = read_box(shape);
  if (shape.tag() == "capsule") definition.shape = read_capsule(shape);
  if (shape.tag() == "mesh") definition.shape = read_mesh(shape);
  if (shape.tag() == "tumble:convex_hull") definition.shape = read_convex_hull(shape);
  if (shape.tag() == "plane") read_plane(shape, definition);
  shape.finish();
  if (const std::string reason = check_shape(definition.shape); !reason.empty()) shape.fail(reason);
}

double read_friction(SdfElement& surface) {
  std::optional<SdfElement> friction = surface.child("friction");
  if (!friction) return kDefaultFriction;
  double mu = kDefaultFriction;
  if (std::optional<SdfElement> ode = friction->child("ode")) {
    mu = ode->number("mu", Range::non_negative).value_or(kDefaultFriction);
    if (std::optional<SdfElement> second = ode->child("mu2")) {
      const double mu2 = second->to_number(Range::non_negative);
      if (mu2 != mu)
        second->warn_ignored("friction is the same in all directions, <mu> is used (" + second->to_text() +
                             ")");
    }
    ode->finish();
  }
  friction->finish();
  return mu;
}

double read_restitution(SdfElement& surface) {
  std::optional<SdfElement> bounce = surface.child("bounce");
  if (!bounce) return 0.0;
  const double restitution = bounce->number("restitution_coefficient", Range::zero_to_one).value_or(0.0);
  if (std::optional<SdfElement> threshold = bounce->child("threshold")) {
    threshold->to_number(Range::non_negative);
    threshold->warn_ignored(
        "one threshold holds for the whole world, <tumble:restitution_threshold> of <physics>");
  }
  bounce->finish();
  return restitution;
}

}  // namespace

std::array<float, 4> read_color(SdfElement& color) {
  const std::vector<double> n = color.to_numbers();
  if (n.size() != 3 && n.size() != 4) color.fail("must be 3 or 4 numbers", color.to_text());
  std::array<float, 4> rgba = {0.0f, 0.0f, 0.0f, 1.0f};
  for (std::size_t i = 0; i < n.size(); ++i) {
    if (n[i] < 0.0 || n[i] > 1.0) color.fail("must be in 0..1", to_shortest_text(n[i]));
    rgba[i] = static_cast<float>(n[i]);
  }
  return rgba;
}

GeometryDefinition read_collision(SdfElement& collision) {
  GeometryDefinition geometry;
  geometry.name = collision.required_attribute("name");
  if (std::optional<SdfElement> pose = collision.child("pose")) {
    if (const std::optional<std::string> frame = pose->attribute("relative_to"); frame && !frame->empty()) {
      pose->fail_attribute("relative_to", "a collision's pose can only be relative to its link", *frame);
    }
    geometry.X_LS = read_pose(*pose);
  }
  read_geometry(collision.required_child("geometry"), geometry);
  geometry.material.friction = kDefaultFriction;
  if (std::optional<SdfElement> surface = collision.child("surface")) {
    geometry.material.friction = read_friction(*surface);
    geometry.material.restitution = read_restitution(*surface);
    surface->finish();
  }
  if (const auto density = collision.number("density", Range::positive)) geometry.material.density = *density;
  collision.finish();
  return geometry;
}

}  // namespace tumble
