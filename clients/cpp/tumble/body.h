// What a client knows of one body: what it is (from the catalogue) and where it is (from the state stream).
// World frame W, SI units; B: origin at the centre of mass, axes of the link.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace tumble::client {

using Vec3 = std::array<double, 3>;
using Quat = std::array<double, 4>;  ///< (w, x, y, z), unit.

struct Shape {
  std::int32_t number = 0;       ///< Within the body.
  std::int8_t type = 0;          ///< catalog_t::SHAPE_*
  Vec3 size{};                   ///< As catalog_t.size_* [m].
  Vec3 position{};               ///< X_BS [m].
  Quat orientation{1, 0, 0, 0};  ///< X_BS.
  double friction = 0.0, restitution = 0.0;
  std::array<float, 4> color{};                ///< RGBA, 0..1.
  std::int32_t num_vertices = 0;               ///< Of a hull; of a surface the corners of its bounds.
  std::vector<std::array<float, 3>> vertices;  ///< In the shape's frame [m]; not yet heard of: not a number.
};

struct Body {
  std::int32_t id = -1, generation = -1;
  std::int64_t epoch = 0;  ///< Newest catalogue epoch in which the server spoke of it.

  // From the catalogue; valid if `described`.
  bool described = false;
  std::string name;
  std::int8_t type = 0;             ///< catalog_t::TYPE_*
  double mass = 0.0;                ///< [kg]; 0 for static and kinematic bodies.
  std::array<double, 6> inertia{};  ///< ixx iyy izz ixy ixz iyz about the centre of mass, link axes [kg m^2].
  Vec3 center_of_mass{};            ///< p_LB, in the link frame [m].
  std::int32_t num_shapes = 0;      ///< That the server announced; `shapes` may still miss some.
  std::vector<Shape> shapes;        ///< In order of their number.

  // From the state stream; valid if `placed`.
  bool placed = false;
  std::int64_t step = -1;        ///< Of the newest message that carried the body.
  double time = 0.0;             ///< The same, simulated [s].
  std::int8_t flags = 0;         ///< Sum of state_t::FLAG_*
  Vec3 position{};               ///< p_WB, centre of mass [m].
  Quat orientation{1, 0, 0, 0};  ///< q_WB, link axes to W.
  Vec3 velocity{};               ///< Of the centre of mass in W [m/s].
  Vec3 angular_velocity{};       ///< In W [rad/s].

  bool is_static() const;
  bool is_kinematic() const;
  bool is_resting() const;
};

/// "sphere", "box", ... for catalog_t::SHAPE_*; "?" for a number this client doesn't know.
const char* shape_type_name(std::int8_t type);
/// "static", "dynamic", "kinematic", for catalog_t::TYPE_*.
const char* body_type_name(std::int8_t type);

}  // namespace tumble::client
