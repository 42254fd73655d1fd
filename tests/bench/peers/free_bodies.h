// Free bodies as a scene: they start alike, 10 m apart, and have principal axes along the link's.
#pragma once

#include <string>

#include "scene/scene.h"

namespace tumble::bench {

/// `count` bodies of 1 kg with principal moments I [kg m^2].
inline Scene free_bodies(int count, const Vec3& I, const Vec3& w, const Vec3& v, const Vec3& gravity) {
  Scene scene;
  scene.options.gravity = gravity;
  for (int i = 0; i < count; ++i) {
    BodyDefinition body;
    body.name = "body" + std::to_string(i);
    body.X_WL.p = Vec3(10.0 * (i % 100), 10.0 * (i / 100), 0.0);
    body.v_WB = v;
    body.w_WB = w;
    body.inertia = Inertia{1.0, Vec3::Zero(), I.asDiagonal()};
    GeometryDefinition geometry;
    geometry.shape = Sphere{0.1};
    body.geometries = {geometry};
    scene.bodies.push_back(body);
  }
  return scene;
}

}  // namespace tumble::bench
