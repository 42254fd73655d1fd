// Heaps: bodies dropped on each other without order, in a bin. World z up.
#pragma once

#include <cmath>
#include <string>

#include "math/rotation.h"
#include "support/standing_scenes.h"

namespace tumble::test {

inline Shape heap_shape(std::size_t i, bool mixed) {
  switch (mixed ? i % 4 : 0) {
    case 1:
      return Sphere{0.15};
    case 2:
      return Capsule{0.1, 0.1};
    case 3:
      return Cylinder{0.15, 0.15};
    default:
      return Box{Vec3(0.2, 0.15, 0.12)};
  }
}

/// Layers of `width` x `width` bodies, 0.5 m apart, tilted, in a bin that is a little wider.
inline World heap(const Options& options, std::size_t count, std::size_t width, bool mixed) {
  World world(options);
  world.create_body(ground());
  const double half = 0.25 * static_cast<double>(width) + 0.1;
  for (int side = 0; side < 4; ++side) {
    const double angle = 1.5707963267948966 * side;
    BodyDefinition wall = body("wall" + std::to_string(side), HalfSpace{},
                               Vec3(-half * std::cos(angle), -half * std::sin(angle), 0));
    wall.type = BodyType::fixed;
    wall.X_WL.q = rotation_to_normal(Vec3(std::cos(angle), std::sin(angle), 0));
    world.create_body(wall);
  }
  for (std::size_t i = 0; i < count; ++i) {
    const double x = 0.5 * static_cast<double>(i % width) - half + 0.35;
    const double y = 0.5 * static_cast<double>(i / width % width) - half + 0.35;
    const double z = 0.5 * static_cast<double>(i / (width * width)) + 0.4;
    // Without friction against turning a ball or cylinder on the flat rolls and spins for ever.
    const double turning = mixed ? 2e-3 : 0.0;
    const Material material{.rolling_friction = turning, .torsional_friction = turning};
    BodyDefinition definition =
        body("body" + std::to_string(i), heap_shape(i, mixed), Vec3(x, y, z), material);
    definition.X_WL.q = tilted(i, 0.7);
    world.create_body(definition);
  }
  return world;
}

}  // namespace tumble::test
