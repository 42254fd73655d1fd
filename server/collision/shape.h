// The solids that collide. A shape is constant and knows no pose; its frame S has the origin and axes named here.
// All lengths in [m], all finite and > 0 (`check_shape` says what is wrong, the scene and command readers call it).
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <variant>

#include "collision/aabb.h"
#include "collision/convex_hull.h"
#include "collision/height_field.h"
#include "collision/triangle_mesh.h"
#include "math/pose.h"

namespace tumble {

struct Sphere {
  double radius;
};
struct Box {
  Vec3 half_extents;
};
/// Segment of length 2 half_length along S's z axis, inflated by radius.
struct Capsule {
  double radius, half_length;
};
/// Axis z, caps at z = +-half_length.
struct Cylinder {
  double radius, half_length;
};
/// Axis z, base at z = -half_length, apex at z = +half_length (SDFormat's convention: S lies at half the height).
struct Cone {
  double radius, half_length;
};
/// Half axes along S's axes.
struct Ellipsoid {
  Vec3 half_axes;
};
/// Everything with z_S <= 0; the surface normal is +z_S. Static bodies only: it has no mass.
struct HalfSpace {};
/// Shared, since hulls are big and constant.
using HullPointer = std::shared_ptr<const ConvexHull>;

/// The order of the alternatives is the order of the pair matrix in narrow_phase.cpp.
/// Half-spaces and the surfaces at the end belong to static bodies only: they have no mass.
using Shape = std::variant<HalfSpace, Sphere, Capsule, Box, HullPointer, Cylinder, Cone, Ellipsoid,
                           TriangleMeshPointer, HeightFieldPointer>;
inline constexpr std::size_t kShapeTypes = std::variant_size_v<Shape>;

/// Plain lower-case name of the shape's type, as on the wire: "half_space", "sphere", "capsule", "box", "convex_hull",
/// "cylinder", "cone", "ellipsoid", "triangle_mesh", "height_field".
const char* shape_name(const Shape& shape);

/// Empty if the shape is sound, else "field: what is wrong with which value".
std::string check_shape(const Shape& shape);

/// The surface of a triangle mesh or height field, else null.
const TriangleSurface* surface_of(const Shape& shape);

/// True for the shapes without mass, which only static bodies may have.
bool is_static_only(const Shape& shape);

/// Tight bounds of the shape at X_WS, in W; of a surface those of its turned bounding box. A half-space has infinite bounds on every side but an axis-aligned top.
Aabb compute_aabb(const Shape& shape, const Pose& X_WS);

/// Largest distance of a point of the shape from S's origin [m]; infinite for a half-space.
double bounding_radius(const Shape& shape);

/// Furthest point of the shape along d (any length > 0), both in S. True vertices, ties resolved by copysign, so that
/// mirrored calls give mirrored points. Not for half-spaces and surfaces.
Vec3 support(const Shape& shape, const Vec3& d_S);

/// How far the shape reaches along d, both in S: d . support [m] for a unit d.
double extent_along(const Shape& shape, const Vec3& d_S);

/// Distance between the planes normal to n_A (unit, from A to B) that touch A and B at X_AB [m]; > 0: n_A separates.
double separation_along(const Shape& a, const Shape& b, const Mat3& R_AB, const Vec3& p_AB, const Vec3& n_A);
/// Its rounding error per length involved: two supports of three products each, a transform and a normalised axis stay
/// below 16 epsilon.
inline constexpr double kSeparationRounding = 32.0 * std::numeric_limits<double>::epsilon();

}  // namespace tumble
