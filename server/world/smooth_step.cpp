// Bodies that smooth forces move but no contact or rope holds: a body under a push that turns with it, an island of springs.
#include <algorithm>
#include <variant>

#include "dynamics/smooth_motion.h"
#include "world/world.h"

namespace tumble {

bool World::advance_smooth_body(std::uint32_t slot, const StepContext& step) {
  SmoothSystem& system = scratch_.smooth;
  system.bodies.clear();
  system.springs.clear();
  system.bodies.push_back(smooth_body(slot));
  if (!advance_smoothly(system, step.h)) return false;
  motions_[slot] = system.bodies[0].motion;
  return true;
}

SmoothBody World::smooth_body(std::uint32_t slot) const {
  if (slot == kWorld) return {};
  const Body& body = bodies_[slot];
  return {.type = body.type,
          .mass = masses_[slot],
          .motion = motions_[slot],
          .load = scratch_.load[slot],
          .gravity = body.gravity ? options_.gravity : Vec3(Vec3::Zero()),
          .linear_damping = body.linear_damping,
          .angular_damping = body.angular_damping};
}

bool World::has_springs_only(std::size_t island) const {
  const Islands& islands = scratch_.islands;
  const auto contact_count = static_cast<std::uint32_t>(contacts_.size());
  const auto is_spring = [&](std::uint32_t edge) {
    const std::uint32_t source = scratch_.edge_source[edge];
    return source >= contact_count && std::holds_alternative<Spring>(ties_[source - contact_count].law);
  };
  const auto edges = islands.edges.begin();
  return std::all_of(edges + islands.edge_begin[island], edges + islands.edge_begin[island + 1], is_spring);
}

bool World::advance_springs(std::size_t island, const StepContext& step) {
  if (options_.integrator != Integrator::closed_form || !has_springs_only(island)) return false;
  const Islands& islands = scratch_.islands;
  SmoothSystem& system = scratch_.smooth;
  system.bodies.clear();
  system.springs.clear();
  scratch_.problem_slot.clear();
  const auto index_of = [&](std::uint32_t slot) {
    if (slot != kWorld && scratch_.local[slot] != kWorld) return scratch_.local[slot];
    const auto index = static_cast<std::uint32_t>(system.bodies.size());
    system.bodies.push_back(smooth_body(slot));
    scratch_.problem_slot.push_back(slot);
    if (slot != kWorld) scratch_.local[slot] = index;
    return index;
  };
  for (std::uint32_t i = islands.body_begin[island]; i < islands.body_begin[island + 1]; ++i) {
    index_of(islands.bodies[i]);
  }
  for (std::uint32_t i = islands.edge_begin[island]; i < islands.edge_begin[island + 1]; ++i) {
    const Tie& tie = ties_[scratch_.edge_source[islands.edges[i]] - contacts_.size()];
    system.springs.push_back({.a = index_of(tie.a),
                              .b = index_of(tie.b),
                              .pA = tie.pA,
                              .pB = tie.pB,
                              .spring = std::get<Spring>(tie.law)});
  }
  for (const std::uint32_t slot : scratch_.problem_slot) {
    if (slot != kWorld) scratch_.local[slot] = kWorld;
  }
  if (!advance_smoothly(system, step.h)) return false;
  return store_smooth_motion(step);
}

/// False if the bodies are all but at rest at both ends: then the rows of the springs, which can certify rest, decide.
bool World::store_smooth_motion(const StepContext& step) {
  const std::vector<SmoothBody>& bodies = scratch_.smooth.bodies;
  const double limit = std::min(options_.rest.speed, options_.rest.acceleration * step.h);
  const auto speed = [](const Motion& motion) { return motion.v.norm() + motion.w.norm(); };
  bool slow = options_.skip_resting, finite = true;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (bodies[i].type != BodyType::dynamic) continue;
    slow = slow && speed(bodies[i].motion) < limit && speed(motions_[scratch_.problem_slot[i]]) < limit;
    finite = finite && is_finite(bodies[i].motion);
  }
  if (slow || !finite) return false;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (bodies[i].type != BodyType::dynamic) continue;
    const std::uint32_t slot = scratch_.problem_slot[i];
    land(slot);
    const Motion start = motions_[slot];
    motions_[slot] = bodies[i].motion;
    if (step.ways_only) note_end(slot, start, step);
    calm_for_[slot] = 0.0;
  }
  ++counters_.islands_smooth;
  return true;
}

}  // namespace tumble
