// A physics engine under comparison: made from a scene, stepped, read. One adapter a file, all in double precision.
// Common to all: no damping, no sleeping but our certified rest, friction of a pair sqrt(mu_a mu_b), restitution the larger.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "scene/scene.h"

namespace tumble::bench {

class Peer {
 public:
  virtual ~Peer() = default;
  virtual void step() = 0;
  /// Of the scene's dynamic body `i`, in the scene's order: x of the centre of mass, q of the link's axes, v, w; no L.
  virtual Motion motion(std::size_t i) const = 0;
};

/// The scenes in which a method is another one than its engine's first: all, those with contacts, those without.
enum class Scope { any, contact, flight };

/// A way to run a scene.
struct Method {
  std::string engine;    ///< With its version, if it has one.
  std::string name;      ///< Unique among all methods.
  std::string settings;  ///< What differs from how the engine comes.
  /// The scene with the time step h [s]. Throws std::invalid_argument for what the engine is not taught here (solids.h).
  std::function<std::unique_ptr<Peer>(const Scene&, double h)> make;
  Scope scope = Scope::any;
  std::size_t most_bodies = 1000000;  ///< A step of larger scenes takes minutes.
};

std::vector<Method> bullet_methods();
std::vector<Method> ode_methods();
std::vector<Method> mujoco_methods();  ///< None if MuJoCo was not there when this was built.
inline constexpr const char* kMujocoRungeKutta = "mujoco_rk4";  ///< Its most accurate one for free bodies.
/// The default first, then levels of accuracy, solvers and integrators, each with all else at its default.
std::vector<Method> tumble_methods();
inline constexpr const char* kExactLevel = "exact_level";  ///< Name of the one with accuracy exact.

}  // namespace tumble::bench
