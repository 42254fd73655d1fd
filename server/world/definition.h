// What a caller says to create things: plain values with sound defaults. `World::create_*` checks every field and
// throws std::invalid_argument("field: reason (value)") before anything changes.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "dynamics/body.h"
#include "dynamics/force_spring.h"
#include "dynamics/joint.h"
#include "dynamics/joint_rope.h"

namespace tumble {

struct Material {
  double friction = 0.5;  ///< Coulomb's mu, >= 0. Of a pair: sqrt(mu_a mu_b).
  /// [m], >= 0: the contact resists rolling by a moment of up to rolling_friction N, and turning about its normal by up to
  /// torsional_friction N. Of a pair the larger. 0: none.
  double rolling_friction = 0.0, torsional_friction = 0.0;
  double restitution = 0.0;  ///< C_r, 0..1. Of a pair: the larger.
  double density = 1000.0;   ///< [kg/m^3], > 0; used where a body gives no inertia of its own.
  /// [m/s] impacts slower than it do not bounce, >= 0. None: the world's option. Of a pair the larger.
  std::optional<double> restitution_threshold = std::nullopt;
};

struct GeometryDefinition {
  std::string name;
  Shape shape = Sphere{0.5};
  Pose X_LS;  ///< The shape's frame in the link's.
  Material material;
  std::array<float, 4> color = {0.7f, 0.7f, 0.7f, 1.0f};  ///< RGBA 0..1, for viewers.
};

struct BodyDefinition {
  std::string name;  ///< Unique in the world, 1..63 printable characters.
  BodyType type = BodyType::dynamic;
  Pose X_WL;  ///< Link frame in W. The body frame B has its axes and sits at the centre of mass.
  Vec3 v_WB = Vec3::Zero();  ///< Of the centre of mass [m/s].
  Vec3 w_WB = Vec3::Zero();  ///< [rad/s]
  std::vector<GeometryDefinition> geometries;
  std::optional<Inertia> inertia;  ///< In the link frame; else from geometries and densities.
  double linear_damping = 0.0;     ///< c [1/s] >= 0: v' = a - c v.
  double angular_damping = 0.0;    ///< [1/s] >= 0: L' = tau - c L.
  bool gravity = true;
};

/// An end of a spring, rope or joint: a point of a body, or of the world.
struct Anchor {
  std::optional<BodyId> body;  ///< None: the world.
  Vec3 p = Vec3::Zero();       ///< In the body's link frame, or in W [m].
};

struct SpringDefinition {
  std::string name;
  Anchor a, b;
  Spring spring;
};

struct RopeDefinition {
  std::string name;
  Anchor a, b;
  Rope rope;
};

enum class JointKind {
  ball,   ///< The ends stay together, all turns are free.
  fixed,  ///< The bodies stay as they are to each other, ends together.
};

/// Bodies held together do not collide with each other.
struct JointDefinition {
  std::string name;
  JointKind kind = JointKind::ball;
  Anchor a, b;
};

/// A force and a torque that act on one body for a while. The point is fixed to the body.
struct Push {
  enum class Frame : std::uint8_t { world, body };
  BodyId body;
  Frame frame = Frame::world;   ///< Axes of force and torque; a body-frame push turns with the body.
  Vec3 force = Vec3::Zero();    ///< [N]
  Vec3 torque = Vec3::Zero();   ///< [N m]
  Vec3 point_B = Vec3::Zero();  ///< Where the force acts: from the centre of mass, link axes [m].
  double duration = 0.0;  ///< [s]; the last step carries the fraction that is left. 0: exactly one step.
};

}  // namespace tumble
