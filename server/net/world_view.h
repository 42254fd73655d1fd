// What the I/O thread may know of the world: plain values copied between steps, never a reference into it.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "world/world.h"

namespace tumble {

/// A body as <WORLD>_STATE tells it.
struct BodyView {
  bool exists = false;
  std::int8_t flags = 0;  ///< state_t::FLAG_*
  std::uint32_t generation = 0;
  std::array<double, 13> values{};  ///< p_WB, q_WB (w, x, y, z), v, w: in the order of the wire.

  bool operator==(const BodyView&) const = default;
};

/// A body as the catalogue tells it; constant after creation and shared between views.
struct BodyModel {
  BodyId id;
  std::string name;
  BodyType type = BodyType::fixed;
  double mass = 0.0;        ///< 0 unless dynamic, as the inertia.
  Mat3 I_B = Mat3::Zero();  ///< About the centre of mass, link axes.
  Vec3 p_LB = Vec3::Zero();
  struct Part {
    Shape shape;
    Pose X_BS;
    Material material;
    std::array<float, 4> color;
  };
  std::vector<Part> parts;
};

/// All models by slot; null where there is no body.
struct Catalog {
  std::int64_t epoch = 0;
  std::int32_t num_bodies = 0;
  std::vector<std::shared_ptr<const BodyModel>> models;
};

/// The catalogue of `world`; models of bodies that `previous` knows already are shared with it.
std::shared_ptr<const Catalog> make_catalog(const World& world, std::int64_t epoch, const Catalog* previous);

struct ContactView {
  std::uint32_t body_a = 0, body_b = 0;
  Vec3 p_W, n_W, impulse_W;
  double separation = 0.0;
};

struct WatchedView {
  std::uint32_t slot = 0;
  Vec3 L = Vec3::Zero();
  double kinetic_energy = 0.0;
};

/// A force command that acts, as an arrow.
struct PushView {
  std::uint32_t body = 0;
  Vec3 p_W, force_W, torque_W;
  double seconds_left = 0.0;
};

struct WorldView {
  std::int64_t utime = 0, session = 0, step = 0;
  double time = 0.0;
  std::uint64_t state_hash = 0;
  std::shared_ptr<const Catalog> catalog;
  bool whole = false;            ///< To be told of every body, changed or not.
  bool at_once = false;          ///< Somebody waits for it: not to be spread over time.
  std::vector<BodyView> bodies;  ///< By slot.
  std::vector<WatchedView> watched;
  bool has_contacts = false;
  std::vector<ContactView> contacts;
  bool has_pushes = false;
  std::vector<PushView> pushes;
};

/// What a view shows beyond poses.
struct ViewRequest {
  std::vector<BodyId> watched;
  bool contacts = false;
};

/// Copies the world into `view`, whose buffers are reused. Leaves utime, session, catalog, whole, at_once and pushes to the caller.
void copy_world(const World& world, const ViewRequest& request, WorldView& view);

}  // namespace tumble
