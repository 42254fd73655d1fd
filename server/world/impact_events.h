// The impacts to come within a step, the earliest first, ties by pair. Every body has its own local time in the step, the
// beginning of its trajectory, and a version that rises whenever its trajectory changes: what was foreseen for an older
// version is dropped when its turn comes.
#pragma once

#include <span>
#include <vector>

#include "collision/broad_phase.h"
#include "dynamics/trajectory.h"

namespace tumble {

struct ImpactEvent {
  double time;  ///< [s] from the start of the step.
  GeometryPair pair;
  std::uint32_t body_a, body_b;
  std::uint32_t version_a, version_b;
};

class ImpactEvents {
 public:
  /// Forgets everything; room for bodies in slots below `capacity`.
  void begin_step(std::uint32_t capacity);

  bool has_trajectory(std::uint32_t slot) const { return bodies_[slot].version > 0; }
  const Trajectory& trajectory(std::uint32_t slot) const { return bodies_[slot].trajectory; }
  /// Replaces the trajectory; what was foreseen for the body is void.
  void set_trajectory(std::uint32_t slot, const Trajectory& trajectory);

  /// The bodies that share contacts or ties with this one in the step, in the order they came together; alone at first.
  std::vector<std::uint32_t> group(std::uint32_t slot) const;
  /// The bodies become one group; each was alone.
  void form_group(std::span<const std::uint32_t> slots);
  /// The groups of the two become one.
  void join(std::uint32_t a, std::uint32_t b);

  /// Impacts of the body in this step, for the bound.
  int count(std::uint32_t slot) const { return bodies_[slot].count; }
  void add_impact(std::uint32_t slot) { ++bodies_[slot].count; }

  void push(double time, GeometryPair pair, std::uint32_t body_a, std::uint32_t body_b);
  /// The earliest that still holds, or none.
  const ImpactEvent* next();
  void pop();
  /// Takes all out, in order, that hold and lie before `time`, inclusively.
  std::vector<ImpactEvent> take_until(double time);
  void give_back(const ImpactEvent& event);

 private:
  struct BodyInStep {
    Trajectory trajectory;
    std::uint32_t version = 0;
    std::uint32_t next_in_group = 0;
    int count = 0;
  };
  bool holds(const ImpactEvent& event) const;

  std::vector<BodyInStep> bodies_;  // by slot
  std::vector<ImpactEvent> heap_;
};

}  // namespace tumble
