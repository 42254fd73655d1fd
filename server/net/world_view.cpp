// See world_view.h.
#include "net/world_view.h"

#include "tumble/state_t.hpp"
#include "world/contact_forces.h"

namespace tumble {
namespace {

std::shared_ptr<const BodyModel> make_model(const World& world, std::uint32_t slot) {
  const Body& body = world.body(slot);
  auto model = std::make_shared<BodyModel>();
  model->id = world.id(slot);
  model->name = body.definition.name;
  model->type = body.type;
  model->p_LB = body.p_LB;
  if (body.type == BodyType::dynamic) {
    const MassProperties& mass = world.mass_properties(slot);
    model->mass = mass.mass;
    model->I_B = world_inertia(mass.I, mass.q_BP, Quat::Identity());
  }
  for (std::size_t i = 0; i < body.geometries.size(); ++i) {
    const Geometry& geometry = world.geometries()[body.geometries[i]];
    const bool named = i < body.definition.geometries.size();
    model->parts.push_back({geometry.shape, geometry.X_BS, geometry.material,
                            named ? body.definition.geometries[i].color : GeometryDefinition().color});
  }
  return model;
}

std::int8_t body_flags(const World& world, std::uint32_t slot) {
  int flags = 0;
  const BodyType type = world.body(slot).type;
  if (type == BodyType::fixed) flags |= state_t::FLAG_STATIC;
  if (type == BodyType::kinematic) flags |= state_t::FLAG_KINEMATIC;
  if (type != BodyType::fixed && world.resting(slot)) flags |= state_t::FLAG_RESTING;
  return static_cast<std::int8_t>(flags);
}

void add_flag(const World& world, BodyId id, std::int8_t flag, WorldView& view) {
  if (!world.is_valid(id)) return;
  BodyView& body = view.bodies[id.index];
  body.flags = static_cast<std::int8_t>(body.flags | flag);
}

/// And the hash over them.
void copy_bodies(const World& world, WorldView& view) {
  view.bodies.resize(world.body_capacity());
  for (BodyView& body : view.bodies) body.exists = false;
  view.state_hash = world.state_hash([&](std::uint32_t slot, const Motion& motion) {
    BodyView& body = view.bodies[slot];
    body.exists = true;
    body.generation = world.id(slot).generation;
    body.flags = body_flags(world, slot);
    body.values = {motion.x.x(), motion.x.y(), motion.x.z(), motion.q.w(), motion.q.x(),
                   motion.q.y(), motion.q.z(), motion.v.x(), motion.v.y(), motion.v.z(),
                   motion.w.x(), motion.w.y(), motion.w.z()};
  });
}

void copy_watched(const World& world, const std::vector<BodyId>& watched, WorldView& view) {
  view.watched.clear();
  for (const BodyId id : watched) {
    if (!world.is_valid(id)) continue;
    add_flag(world, id, state_t::FLAG_WATCHED, view);
    WatchedView entry{.slot = id.index};
    if (world.body(id.index).type == BodyType::dynamic) {
      const Motion& motion = world.motion(id.index);
      entry.L = motion.L;
      entry.kinetic_energy =
          0.5 * (world.mass_properties(id.index).mass * motion.v.squaredNorm() + motion.w.dot(motion.L));
    }
    view.watched.push_back(entry);
  }
}

void copy_contacts(const World& world, WorldView& view) {
  const double h = world.options().time_step;
  view.contacts.clear();
  for (const ContactForce& contact : read_contact_forces(world)) {
    view.contacts.push_back({contact.a.index, contact.b.index, contact.p_W, contact.normal_W,
                             h * contact.force_W, contact.separation});
  }
}

}  // namespace

std::shared_ptr<const Catalog> make_catalog(const World& world, std::int64_t epoch, const Catalog* previous) {
  auto catalog = std::make_shared<Catalog>();
  catalog->epoch = epoch;
  catalog->num_bodies = static_cast<std::int32_t>(world.body_count());
  catalog->models.resize(world.body_capacity());
  for (std::uint32_t slot = 0; slot < world.body_capacity(); ++slot) {
    if (!world.body(slot).exists) continue;
    const bool known = previous != nullptr && slot < previous->models.size() && previous->models[slot] &&
                       previous->models[slot]->id == world.id(slot);
    catalog->models[slot] = known ? previous->models[slot] : make_model(world, slot);
  }
  return catalog;
}

void copy_world(const World& world, const ViewRequest& request, WorldView& view) {
  view.step = static_cast<std::int64_t>(world.step_count());
  view.time = world.time();
  copy_bodies(world, view);
  for (const BodyId id : world.contained()) add_flag(world, id, state_t::FLAG_CONTAINED, view);
  copy_watched(world, request.watched, view);
  view.has_contacts = request.contacts;
  if (request.contacts) copy_contacts(world, view);
}

}  // namespace tumble
