// The world: creates and destroys bodies, steps them, answers for them. A regular value: copying it copies model,
// state and scratch, so a copy is a snapshot that continues with the same bits. No clock, thread or socket in here.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "collision/broad_phase.h"
#include "dynamics/island.h"
#include "world/contact_graph.h"
#include "world/definition.h"
#include "world/diagnostics.h"
#include "world/options.h"

namespace tumble {

/// A geometry as it hangs on a body: pose in the body frame B, not the link's.
struct Geometry {
  std::uint32_t body = 0;
  Shape shape;
  Pose X_BS;
  Material material;
  double fat_margin = 0.0;
};

/// What a body is: constant after creation, read rarely.
struct Body {
  bool exists = false;
  std::uint32_t generation = 0;
  BodyType type = BodyType::fixed;
  Vec3 p_LB = Vec3::Zero();  ///< Centre of mass in the link frame.
  double linear_damping = 0.0, angular_damping = 0.0;
  bool gravity = true;
  std::vector<std::uint32_t> geometries;
  BodyDefinition definition;  ///< As created: names, colours, link-frame poses.
};

class World {
 public:
  explicit World(const Options& options = {});  ///< Throws std::invalid_argument for options out of range.

  // Creation: all throw std::invalid_argument("field: reason (value)") and then have changed nothing.
  BodyId create_body(const BodyDefinition& definition);
  /// Also removes its springs, ropes and pushes, and wakes what it touched. False: no such body (stale id).
  bool destroy_body(BodyId id);
  void create_spring(const SpringDefinition& definition);
  void create_rope(const RopeDefinition& definition);

  // Commands between steps.
  /// Starts a push at the next step. Throws for non-finite or out-of-range values, stale ids, fixed bodies.
  void push(const Push& push);
  /// Teleports: pose of the link frame, velocities of the centre of mass.
  void set_motion(BodyId id, const Pose& X_WL, const Vec3& v_WB, const Vec3& w_WB);
  void wake(BodyId id);

  void step();
  /// The same, and calls `stage_done(stage)` at the end of every stage.
  void step(const std::function<void(Stage)>& stage_done);

  // Reading. Bodies are addressed by slot (0 .. body_capacity()) where all are visited.
  std::uint64_t step_count() const { return step_count_; }
  double time() const { return static_cast<double>(step_count_) * options_.time_step; }
  const Options& options() const { return options_; }
  std::uint32_t body_capacity() const { return static_cast<std::uint32_t>(bodies_.size()); }
  std::uint32_t body_count() const { return body_count_; }
  const Body& body(std::uint32_t slot) const { return bodies_[slot]; }
  const Motion& motion(std::uint32_t slot) const { return motions_[slot]; }
  const MassProperties& mass_properties(std::uint32_t slot) const { return masses_[slot]; }
  bool resting(std::uint32_t slot) const { return !awake_flag_[slot]; }
  BodyId id(std::uint32_t slot) const { return {slot, bodies_[slot].generation}; }
  bool is_valid(BodyId id) const;
  std::optional<BodyId> find(std::string_view name) const;
  /// Pose of the link frame.
  Pose link_pose(std::uint32_t slot) const;
  const ContactGraph& contacts() const { return contacts_; }
  const std::vector<Geometry>& geometries() const { return geometries_; }
  /// Rises whenever a body is created or destroyed: the catalogue's epoch.
  std::uint64_t model_epoch() const { return model_epoch_; }

  const Counters& counters() const { return counters_; }
  const StepReport& report() const { return report_; }
  Conserved compute_conserved() const;
  /// Over every body's id, pose, velocity and rest flag, and the step count.
  std::uint64_t state_hash() const;
  /// Bodies that were held at their last good state because a step made them non-finite, in order of occurrence.
  const std::vector<BodyId>& contained() const { return contained_; }

 private:
  struct ActivePush {
    Push push;
    double remaining;  // [s]; < 0: one whole step
  };
  struct Link {  // a spring or rope, anchors in body frames
    std::uint32_t a, b;  // slots, or kWorld
    Vec3 pA, pB;
  };
  static constexpr std::uint32_t kWorld = 0xffffffffu;

  Options options_;
  std::uint64_t step_count_ = 0;
  std::uint64_t model_epoch_ = 0;
  std::uint32_t body_count_ = 0;

  // Model, by slot.
  std::vector<Body> bodies_;
  std::vector<MassProperties> masses_;
  std::vector<Geometry> geometries_;
  std::vector<std::uint32_t> free_bodies_, free_geometries_;

  // State, by slot: hot arrays.
  std::vector<Motion> motions_;
  std::vector<std::uint8_t> awake_flag_;

  BroadPhase broad_phase_;
  ContactGraph contacts_;
  std::vector<ActivePush> pushes_;
  Counters counters_;
  StepReport report_;
  std::vector<BodyId> contained_;
};

}  // namespace tumble
