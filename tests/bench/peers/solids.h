// A scene as every engine can say it: solids of one box, ball or half-space each.
#pragma once

#include <vector>

#include "scene/scene.h"

namespace tumble::bench {

struct Solid {
  bool dynamic = false;
  Shape shape;  ///< Box, Sphere, or HalfSpace (not dynamic).
  Pose X_WS;    ///< Its frame at the start; of a dynamic solid also the link's, origin at the centre of mass.
  Material material;
  MassProperties mass;  ///< Principal axes are the link's; all 0 unless dynamic.
  Vec3 v = Vec3::Zero(), w = Vec3::Zero();
};

/// Of a fixed body a solid each geometry. Throws std::invalid_argument for other shapes, dynamic bodies of several
/// geometries or off their centre of mass, kinematic ones, springs, ropes and joints.
std::vector<Solid> solids_of(const Scene& scene);

/// Its dynamic ones, in the scene's order.
std::vector<Solid> dynamic_of(const std::vector<Solid>& solids);

double pair_friction(double mu_a, double mu_b);
/// Outward normal n of a half-space and the height n.p of its surface.
struct Plane {
  Vec3 normal;
  double height;
};
Plane plane_of(const Solid& half_space);

}  // namespace tumble::bench
