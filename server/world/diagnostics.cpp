// Conserved quantities and the fingerprint of the state. Read-only; not part of a step.
#include <algorithm>

#include "math/hash.h"
#include "world/world.h"

namespace tumble {

Conserved World::compute_conserved() const {
  Conserved sum;
  for (std::uint32_t slot = 0; slot < body_capacity(); ++slot) {
    if (!bodies_[slot].exists || !movable(slot)) continue;
    const Motion motion = this->motion(slot);
    const double mass = masses_[slot].mass;
    const Vec3 p = mass * motion.v;
    sum.kinetic_energy += 0.5 * (p.dot(motion.v) + motion.L.dot(motion.w));
    if (bodies_[slot].gravity) sum.potential_energy -= mass * options_.gravity.dot(motion.x);
    sum.momentum += p;
    sum.angular_momentum += motion.x.cross(p) + motion.L;
  }
  for (const Tie& tie : ties_) {
    const Spring* spring = std::get_if<Spring>(&tie.law);
    if (!spring) continue;
    const auto anchor = [this](std::uint32_t slot, const Vec3& p) -> Vec3 {
      if (slot == kWorld) return p;
      const Motion motion = this->motion(slot);
      return motion.x + motion.q * p;
    };
    sum.potential_energy += spring_energy(*spring, (anchor(tie.b, tie.pB) - anchor(tie.a, tie.pA)).norm());
  }
  return sum;
}

std::uint64_t World::state_hash() const {
  return state_hash([](std::uint32_t, const Motion&) {});
}

std::uint64_t World::state_hash(const std::function<void(std::uint32_t, const Motion&)>& visit) const {
  Hash hash;
  hash.add(step_count_);
  for (std::uint32_t slot = 0; slot < body_capacity(); ++slot) {
    if (!bodies_[slot].exists) continue;
    const Motion motion = this->motion(slot);
    visit(slot, motion);
    if (bodies_[slot].type == BodyType::fixed) continue;
    hash.add(static_cast<std::uint64_t>(slot) << 32 | bodies_[slot].generation);
    hash.add(motion.x);
    hash.add(motion.q);
    hash.add(motion.v);
    hash.add(motion.w);
    hash.add(static_cast<std::uint64_t>(awake(slot)));
  }
  return hash.value();
}

}  // namespace tumble
