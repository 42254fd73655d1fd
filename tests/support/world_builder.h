// Bodies and worlds for tests, in a line each. SI units; shapes of density 1000 kg/m^3 unless a mass is given.
#pragma once

#include <string>

#include "world/world.h"

namespace tumble::test {
/// [s] that the bounds of the tables are asked for.
inline constexpr double kStepLengths[] = {1.0 / 60.0, 1.0 / 240.0, 1.0 / 1000.0};

inline GeometryDefinition geometry(const Shape& shape, const Material& material = {}) {
  GeometryDefinition definition;
  definition.name = "collision";
  definition.shape = shape;
  definition.material = material;
  return definition;
}

inline BodyDefinition body(const std::string& name, const Shape& shape, const Vec3& position,
                           const Material& material = {}) {
  BodyDefinition definition;
  definition.name = name;
  definition.X_WL.p = position;
  definition.geometries = {geometry(shape, material)};
  return definition;
}

/// The same with its uniform density chosen to give `mass` [kg].
inline BodyDefinition body_of_mass(const std::string& name, const Shape& shape, double mass,
                                   const Vec3& position, Material material = {}) {
  material.density = mass / compute_inertia(shape, 1.0).mass;
  return body(name, shape, position, material);
}

inline BodyDefinition ground(const Material& material = {}) {
  BodyDefinition definition = body("ground", HalfSpace{}, Vec3::Zero(), material);
  definition.type = BodyType::fixed;
  return definition;
}

inline Options weightless(double time_step = 1.0 / 240.0) {
  Options options;
  options.time_step = time_step;
  options.gravity.setZero();
  return options;
}

inline void run(World& world, int steps) {
  for (int i = 0; i < steps; ++i) world.step();
}

/// Largest way any body went [m].
inline double largest_displacement(const World& from, const World& to) {
  double largest = 0.0;
  for (std::uint32_t slot = 0; slot < from.body_capacity(); ++slot) {
    largest = std::max(largest, (to.motion(slot).x - from.motion(slot).x).norm());
  }
  return largest;
}

}  // namespace tumble::test
