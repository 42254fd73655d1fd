// The forces of contacts, read between steps: per point, and summed up per body. Of a body that rests they are those that
// hold it, to rounding. World frame W, SI units.
#pragma once

#include <vector>

#include "world/world.h"

namespace tumble {

/// One point of contact after the last step. A struck pair's blow is no part of it, only what presses for the rest of
/// the step.
struct ContactForce {
  BodyId a, b;
  std::uint32_t geometry_a = 0, geometry_b = 0;  ///< Index among the body's geometries.
  Vec3 p_W = Vec3::Zero();                       ///< Halfway between both surfaces [m].
  Vec3 normal_W = Vec3::Zero();                  ///< Unit, from a to b.
  double separation = 0.0;                       ///< Gap along the normal [m]; < 0: overlap.
  Vec3 force_W = Vec3::Zero();                   ///< On b, mean over the step [N]; a feels the opposite.
  Vec3 moment_W = Vec3::Zero();                  ///< On b, of rolling and torsional friction, likewise [N m].
};

/// Of every point of every pair within the contact margin, also of those that carry nothing, in the order of the pairs.
std::vector<ContactForce> read_contact_forces(const World& world);
/// Those in which the body takes part, in the same order. Empty for a stale id.
std::vector<ContactForce> read_contact_forces(const World& world, BodyId body);

struct ContactLoad {
  Vec3 force = Vec3::Zero();   ///< [N]
  Vec3 torque = Vec3::Zero();  ///< About the centre of mass [N m].
};

/// Sum of what all contacts do to the body; zero for a stale id.
ContactLoad sum_contact_forces(const World& world, BodyId body);

}  // namespace tumble
