// The engine embedded: a ball falls for a second, by the closed form.
#include <cmath>
#include <cstdio>

#include "world/world.h"

int main() {
  tumble::World world;
  tumble::BodyDefinition ball;
  ball.name = "ball";
  ball.type = tumble::BodyType::dynamic;
  ball.geometries.push_back({.shape = tumble::Sphere{0.5}});
  ball.X_WL.p = {0.0, 0.0, 100.0};
  const tumble::BodyId id = world.create_body(ball);
  while (world.time() < 1.0) world.step();
  const double t = world.time(), fallen = 100.0 - world.motion(id.index).x.z();
  std::printf("fell %.15g m\n", fallen);
  return std::abs(fallen - 0.5 * 9.81 * t * t) < 1e-12 ? 0 : 1;
}
