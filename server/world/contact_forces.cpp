// See contact_forces.h. Contacts store impulses of a step; at rest these are kept, and so are the forces.
#include "world/contact_forces.h"

#include <algorithm>

namespace tumble {
namespace {

std::uint32_t index_in_body(const World& world, std::uint32_t geometry) {
  const std::vector<std::uint32_t>& of_body = world.body(world.geometries()[geometry].body).geometries;
  return static_cast<std::uint32_t>(std::find(of_body.begin(), of_body.end(), geometry) - of_body.begin());
}

void read_points(const World& world, const Contact& contact, std::vector<ContactForce>& forces) {
  if (contact.manifold.count == 0) return;
  ContactForce force;
  force.a = world.id(contact.body_a);
  force.b = world.id(contact.body_b);
  force.geometry_a = index_in_body(world, contact.pair.a);
  force.geometry_b = index_in_body(world, contact.pair.b);
  const Pose X_WA = world.geometry_pose(world.geometries()[contact.pair.a]);
  force.normal_W = X_WA.q * contact.manifold.normal_A;
  for (std::size_t i = 0; i < static_cast<std::size_t>(contact.manifold.count); ++i) {
    const ManifoldPoint& point = contact.manifold.points[i];
    force.p_W = X_WA * point.p_A;
    force.separation = point.separation;
    force.force_W = contact.impulse[i] / world.options().time_step;
    force.moment_W = contact.moment[i] / world.options().time_step;
    forces.push_back(force);
  }
}

}  // namespace

std::vector<ContactForce> read_contact_forces(const World& world) {
  std::vector<ContactForce> forces;
  for (const Contact& contact : world.contacts()) read_points(world, contact, forces);
  return forces;
}

std::vector<ContactForce> read_contact_forces(const World& world, BodyId body) {
  std::vector<ContactForce> forces;
  if (!world.is_valid(body)) return forces;
  for (const Contact& contact : world.contacts()) {
    if (contact.body_a == body.index || contact.body_b == body.index) read_points(world, contact, forces);
  }
  return forces;
}

ContactLoad sum_contact_forces(const World& world, BodyId body) {
  ContactLoad load;
  if (!world.is_valid(body)) return load;
  const Vec3 x = world.motion(body.index).x;
  for (const ContactForce& contact : read_contact_forces(world, body)) {
    const double sign = contact.b.index == body.index ? 1.0 : -1.0;
    load.force += sign * contact.force_W;
    load.torque += sign * (Vec3(contact.p_W - x).cross(contact.force_W) + contact.moment_W);
  }
  return load;
}

}  // namespace tumble
