// See solids.h.
#include "peers/solids.h"

#include <cmath>
#include <stdexcept>

namespace tumble::bench {
namespace {

void check(bool sayable, const std::string& body, const char* reason) {
  if (!sayable) throw std::invalid_argument("body '" + body + "': " + reason);
}

Solid dynamic_solid(const BodyDefinition& body, const MassProperties& mass) {
  check(body.geometries.size() == 1, body.name, "one geometry is needed");
  const GeometryDefinition& geometry = body.geometries.front();
  check(geometry.X_LS.p.isZero() && geometry.X_LS.q.coeffs() == Quat::Identity().coeffs(), body.name,
        "its geometry must lie in its centre of mass");
  check(mass.q_BP.coeffs() == Quat::Identity().coeffs(), body.name, "its axes must be principal");
  return {true, geometry.shape, body.X_WL, geometry.material, mass, body.v_WB, body.w_WB};
}

}  // namespace

std::vector<Solid> solids_of(const Scene& scene) {
  if (!scene.springs.empty() || !scene.ropes.empty() || !scene.joints.empty()) {
    throw std::invalid_argument("springs, ropes and joints are not compared");
  }
  const World world = build_world(scene);
  std::vector<Solid> solids;
  for (const BodyDefinition& body : scene.bodies) {
    check(body.type != BodyType::kinematic, body.name, "kinematic bodies are not compared");
    const std::uint32_t slot = world.find(body.name)->index;
    if (body.type == BodyType::dynamic) {
      solids.push_back(dynamic_solid(body, world.mass_properties(slot)));
      check(world.body(slot).p_LB.isZero(), body.name, "its link must lie in its centre of mass");
    } else {
      for (const GeometryDefinition& geometry : body.geometries) {
        solids.push_back({.shape = geometry.shape,
                          .X_WS = body.X_WL * geometry.X_LS,
                          .material = geometry.material,
                          .mass = {}});
      }
    }
    const Shape& shape = solids.back().shape;
    check(std::holds_alternative<Box>(shape) || std::holds_alternative<Sphere>(shape) ||
              std::holds_alternative<HalfSpace>(shape),
          body.name, "boxes, balls and half-spaces are compared");
  }
  return solids;
}

std::vector<Solid> dynamic_of(const std::vector<Solid>& solids) {
  std::vector<Solid> dynamic;
  for (const Solid& solid : solids) {
    if (solid.dynamic) dynamic.push_back(solid);
  }
  return dynamic;
}

double pair_friction(double mu_a, double mu_b) {
  return std::sqrt(mu_a * mu_b);
}

Plane plane_of(const Solid& half_space) {
  const Vec3 normal = half_space.X_WS.q * Vec3::UnitZ();
  return {normal, normal.dot(half_space.X_WS.p)};
}

}  // namespace tumble::bench
