// Things that stand: stacks and pyramids of cubes, put down exactly or dropped with gaps and tilts. World z up.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "math/rotation.h"
#include "support/world_builder.h"

namespace tumble::test {

/// How a pile is put down: its height above the ground [m], the gap between rows [m], rotation vectors of `tilt` [rad].
struct Drop {
  double height = 0.0, gap = 0.0, tilt = 0.0;
  double rise(double row) const { return height + gap * row; }
};

/// Where it stands and how large it is: every length but a drop's scales with the edge of a cube [m].
struct Site {
  Vec3 foot = Vec3::Zero();
  double size = 1.0;
};

/// A rotation vector of the length `tilt` that looks random but is a function of the index.
inline Quat tilted(std::size_t index, double tilt) {
  const double i = static_cast<double>(index);
  Vec3 axis(std::cos(2.4 * i), std::sin(2.4 * i), 0.5 * std::cos(1.7 * i));
  axis *= tilt / axis.norm();
  return exp_map(axis);
}

/// An edge of the size `size` [m].
inline BodyDefinition cube(const std::string& name, double mass, const Vec3& position, const Quat& q,
                           double size = 1.0) {
  BodyDefinition definition = body_of_mass(name, Box{Vec3::Constant(0.5 * size)}, mass, position);
  definition.X_WL.q = q;
  return definition;
}

inline BodyDefinition ground_at(const Site& site) {
  BodyDefinition definition = ground();
  definition.X_WL.p = site.foot;
  return definition;
}

/// Cubes on each other, 1 % of their size to the left and the right in turn; masses from below [kg].
inline World cube_stack(const Options& options, const std::vector<double>& masses, const Drop& drop = {},
                        const Site& site = {}) {
  World world(options);
  world.create_body(ground_at(site));
  for (std::size_t i = 0; i < masses.size(); ++i) {
    const double offset = i % 2 == 0 ? 0.01 : -0.01;
    const double level = static_cast<double>(i);
    const Vec3 x =
        site.foot + site.size * Vec3(offset, -0.5 * offset, 0.5 + level) + Vec3(0, 0, drop.rise(level));
    world.create_body(cube("cube" + std::to_string(i), masses[i], x, tilted(i, drop.tilt), site.size));
  }
  return world;
}

/// Adds a wall of base (base + 1)/2 cubes of 1 kg, 5 % of their size between those of a row.
inline void add_cube_pyramid(World& world, int base, const Drop& drop = {}, const Site& site = {},
                             const std::string& name = "cube") {
  std::size_t count = 0;
  for (int row = 0; row < base; ++row) {
    for (int i = 0; i + row < base; ++i, ++count) {
      const Vec3 x =
          site.foot + site.size * Vec3(1.05 * i + 0.525 * row, 0, 0.5 + row) + Vec3(0, 0, drop.rise(row));
      world.create_body(cube(name + std::to_string(count), 1.0, x, tilted(count, drop.tilt), site.size));
    }
  }
}

inline World cube_pyramid(const Options& options, int base, const Drop& drop = {}, const Site& site = {}) {
  World world(options);
  world.create_body(ground_at(site));
  add_cube_pyramid(world, base, drop, site);
  return world;
}

/// Steps until every body rests, at most `limit` [s]; returns the time it took [s].
inline double run_to_rest(World& world, double limit) {
  const double h = world.options().time_step;
  double t = 0.0;
  do {
    world.step();
    t += h;
  } while (t < limit && world.report().bodies_awake > 0);
  return t;
}

}  // namespace tumble::test
