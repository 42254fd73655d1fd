// See sdf_geometry.h. One reader a shape; SDF gives full sizes where our shapes have half extents.
#include "scene/sdf_geometry.h"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>
#include <utility>

#include "scene/image.h"
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

/// Capsule, cylinder or cone.
template <class Round>
Shape read_round(SdfElement& round) {
  const double radius = round.required_child("radius").to_number(Range::positive);
  const double length = round.required_child("length").to_number(Range::positive);
  return Round{radius, 0.5 * length};
}

Shape read_ellipsoid(SdfElement& ellipsoid) {
  return Ellipsoid{read_positive_vector(ellipsoid.required_child("radii"))};
}

HullPointer build_hull(const SdfElement& element, const std::vector<Vec3>& points) {
  try {
    return std::make_shared<const ConvexHull>(build_convex_hull(points));
  } catch (const std::invalid_argument& reason) {
    element.fail(reason.what());
  }
}

TriangleMeshPointer build_triangle_mesh(const SdfElement& element, const MeshTriangles& mesh) {
  try {
    auto surface = std::make_shared<const TriangleMesh>(mesh.vertices, mesh.triangles);
    if (surface->dropped() > 0) {
      element.warn(fmt::format("{} of {} triangles have no area and are left out", surface->dropped(),
                               mesh.triangles.size()));
    }
    if (surface->odd_edges() > 0) {
      element.warn(
          fmt::format("at {} edges more than two triangles meet, or two disagree on which side is out",
                      surface->odd_edges()));
    }
    return surface;
  } catch (const std::invalid_argument& reason) {
    element.fail(reason.what());
  }
}

Shape read_mesh(SdfElement& mesh, BodyType type) {
  mesh.refuse("submesh", "submeshes are not supported: give each a file of its own");
  const std::string optimization = mesh.attribute("optimization").value_or("");
  if (optimization != "convex_hull" && !optimization.empty()) {
    mesh.fail_attribute("optimization", "only convex_hull is supported", optimization);
  }
  SdfElement uri = mesh.required_child("uri");
  std::optional<SdfElement> scale_element = mesh.child("scale");
  const Vec3 scale = scale_element ? read_positive_vector(*scale_element) : Vec3(Vec3::Ones());
  MeshTriangles triangles;
  try {
    triangles = read_mesh_file(resolve_mesh_path(uri.to_text(), mesh.file().directory));
  } catch (const MeshError& reason) {
    uri.fail(reason.what());
  }
  for (Vec3& p : triangles.vertices) p = p.cwiseProduct(scale);
  if (type == BodyType::fixed && optimization.empty()) return build_triangle_mesh(uri, triangles);
  return build_hull(uri, distinct_points(triangles.vertices));
}

/// A whole number >= 0 that stands as a number in a list.
std::uint32_t to_index(const SdfElement& element, double value) {
  if (!(value >= 0.0 && value < 4294967295.0 && value == std::floor(value))) {
    element.fail("must be whole numbers >= 0", to_shortest_text(value));
  }
  return static_cast<std::uint32_t>(value);
}

Shape read_triangle_mesh(SdfElement& mesh) {
  SdfElement vertices = mesh.required_child("tumble:vertices"),
             corners = mesh.required_child("tumble:triangles");
  const std::vector<double> n = vertices.to_numbers(), c = corners.to_numbers();
  if (n.size() % 3 != 0) vertices.fail("must be three numbers a vertex, is", std::to_string(n.size()));
  if (c.size() % 3 != 0) corners.fail("must be three indices a triangle, is", std::to_string(c.size()));
  MeshTriangles triangles;
  for (std::size_t i = 0; i < n.size(); i += 3) triangles.vertices.emplace_back(n[i], n[i + 1], n[i + 2]);
  for (std::size_t i = 0; i < c.size(); i += 3) {
    triangles.triangles.push_back(
        {to_index(corners, c[i]), to_index(corners, c[i + 1]), to_index(corners, c[i + 2])});
  }
  return build_triangle_mesh(mesh, triangles);
}

HeightFieldPointer build_height_field(const SdfElement& element, std::uint32_t columns, std::uint32_t rows,
                                      double dx, double dy, std::vector<double> heights) {
  try {
    return std::make_shared<const HeightField>(columns, rows, dx, dy, std::move(heights));
  } catch (const std::invalid_argument& reason) {
    element.fail(reason.what());
  }
}

Shape read_height_field(SdfElement& field) {
  constexpr int kMost = 100'000'000;
  const int columns = field.required_child("tumble:columns").to_integer(2, kMost);
  const int rows = field.required_child("tumble:rows").to_integer(2, kMost);
  const std::vector<double> spacing = field.required_child("tumble:spacing").to_numbers(2);
  return build_height_field(field, static_cast<std::uint32_t>(columns), static_cast<std::uint32_t>(rows),
                            spacing[0], spacing[1], field.required_child("tumble:heights").to_numbers());
}

/// <size> is the full extent along x and y and the height of full white; <pos> places the middle of the black level.
Shape read_heightmap(SdfElement& heightmap, GeometryDefinition& definition) {
  for (const char* look : {"texture", "blend"}) {
    for (SdfElement& element : heightmap.children({look})) element.warn_ignored("viewers draw plain shapes");
  }
  for (const char* detail : {"use_terrain_paging", "sampling"}) {
    if (std::optional<SdfElement> element = heightmap.child(detail)) {
      element->warn_ignored("every pixel of the image is a height");
    }
  }
  SdfElement uri = heightmap.required_child("uri");
  std::optional<SdfElement> size_element = heightmap.child("size");
  const Vec3 size = size_element ? read_positive_vector(*size_element) : Vec3(Vec3::Ones());
  const Vec3 pos = heightmap.vector("pos").value_or(Vec3::Zero());
  definition.X_LS = chained(definition.X_LS, Pose{Quat::Identity(), pos});
  GrayImage image;
  try {
    image = read_gray_image(resolve_mesh_path(uri.to_text(), heightmap.file().directory));
  } catch (const MeshError& reason) {
    uri.fail(reason.what());
  } catch (const ImageError& reason) {
    uri.fail(reason.what());
  }
  if (image.columns < 2 || image.rows < 2) {
    uri.fail(fmt::format("a heightmap needs 2 x 2 pixels or more, has {} x {}", image.columns, image.rows));
  }
  // An image's first row is the one of largest y.
  std::vector<double> heights;
  for (std::uint32_t row = image.rows; row-- > 0;) {
    for (std::uint32_t column = 0; column < image.columns; ++column) {
      heights.push_back(size.z() * image.at(column, row));
    }
  }
  return build_height_field(uri, image.columns, image.rows, size.x() / (image.columns - 1),
                            size.y() / (image.rows - 1), std::move(heights));
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

void read_geometry(SdfElement geometry, BodyType type, GeometryDefinition& definition) {
  std::vector<SdfElement> shapes =
      geometry.children({"sphere", "box", "capsule", "cylinder", "cone", "ellipsoid", "plane", "mesh",
                         "heightmap", "tumble:convex_hull", "tumble:triangle_mesh", "tumble:height_field"});
  for (const char* unsupported : {"image", "polyline", "empty"}) {
    geometry.refuse(
        unsupported,
        "this geometry is not supported: use sphere, box, capsule, cylinder, cone, ellipsoid, plane, "
        "mesh, heightmap or tumble:convex_hull");
  }
  geometry.finish();
  if (shapes.empty()) {
    geometry.fail(
        "needs one of sphere, box, capsule, cylinder, cone, ellipsoid, plane, mesh, heightmap, "
        "tumble:convex_hull");
  }
  if (shapes.size() > 1) shapes[1].fail("a geometry has one shape only");
  SdfElement& shape = shapes[0];
  if (shape.tag() == "sphere") definition.shape = read_sphere(shape);
  if (shape.tag() == "box") definition.shape = read_box(shape);
  if (shape.tag() == "capsule") definition.shape = read_round<Capsule>(shape);
  if (shape.tag() == "cylinder") definition.shape = read_round<Cylinder>(shape);
  if (shape.tag() == "cone") definition.shape = read_round<Cone>(shape);
  if (shape.tag() == "ellipsoid") definition.shape = read_ellipsoid(shape);
  if (shape.tag() == "mesh") definition.shape = read_mesh(shape, type);
  if (shape.tag() == "heightmap") definition.shape = read_heightmap(shape, definition);
  if (shape.tag() == "tumble:triangle_mesh") definition.shape = read_triangle_mesh(shape);
  if (shape.tag() == "tumble:height_field") definition.shape = read_height_field(shape);
  if (shape.tag() == "tumble:convex_hull") definition.shape = read_convex_hull(shape);
  if (shape.tag() == "plane") read_plane(shape, definition);
  shape.finish();
  if (type != BodyType::fixed && is_static_only(definition.shape)) {
    shape.fail("needs a static model: it has no mass");
  }
  if (const std::string reason = check_shape(definition.shape); !reason.empty()) shape.fail(reason);
}

/// Gazebo's moment of a patch of radius a: 3 pi/16 mu a N.
double read_torsional(SdfElement& torsional) {
  const double coefficient = torsional.number("coefficient", Range::non_negative).value_or(1.0);
  const double radius = torsional.number("patch_radius", Range::non_negative).value_or(0.0);
  torsional.finish();
  constexpr double kPatch = 3.0 * 3.14159265358979323846 / 16.0;
  return kPatch * coefficient * radius;
}

void read_friction(SdfElement& surface, Material& material) {
  std::optional<SdfElement> friction = surface.child("friction");
  if (!friction) return;
  double& mu = material.friction;
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
  if (std::optional<SdfElement> torsional = friction->child("torsional"))
    material.torsional_friction = read_torsional(*torsional);
  if (const auto own = friction->number("tumble:torsional_friction", Range::non_negative))
    material.torsional_friction = *own;
  material.rolling_friction = friction->number("tumble:rolling_friction", Range::non_negative).value_or(0.0);
  friction->finish();
}

void read_bounce(SdfElement& surface, Material& material) {
  std::optional<SdfElement> bounce = surface.child("bounce");
  if (!bounce) return;
  material.restitution = bounce->number("restitution_coefficient", Range::zero_to_one).value_or(0.0);
  material.restitution_threshold = bounce->number("threshold", Range::non_negative);
  bounce->finish();
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

GeometryDefinition read_collision(SdfElement& collision, BodyType type) {
  GeometryDefinition geometry;
  geometry.name = collision.required_attribute("name");
  if (std::optional<SdfElement> pose = collision.child("pose")) {
    if (const std::optional<std::string> frame = pose->attribute("relative_to"); frame && !frame->empty()) {
      pose->fail_attribute("relative_to", "a collision's pose can only be relative to its link", *frame);
    }
    geometry.X_LS = read_pose(*pose);
  }
  read_geometry(collision.required_child("geometry"), type, geometry);
  geometry.material.friction = kDefaultFriction;
  if (std::optional<SdfElement> surface = collision.child("surface")) {
    read_friction(*surface, geometry.material);
    read_bounce(*surface, geometry.material);
    surface->finish();
  }
  if (const auto density = collision.number("density", Range::positive)) geometry.material.density = *density;
  collision.finish();
  return geometry;
}

}  // namespace tumble
