// See apply_command.h.
#include "apply_command.h"

#include <fmt/format.h>

#include <stdexcept>

#include "from_message.h"
#include "tumble/catalog_t.hpp"

namespace tumble {
namespace {

BodyId to_id(const Outcome& found) {
  return {static_cast<std::uint32_t>(found.body), static_cast<std::uint32_t>(found.generation)};
}

Outcome refuse(const std::invalid_argument& reason) {
  return {.status = Status::invalid, .detail = reason.what()};
}

/// Runs `change` on the body that `command` names.
template <typename Message, typename Change>
Outcome change_body(World& world, const Message& command, Change&& change) {
  Outcome outcome = find_body(world, command.body, command.generation);
  if (outcome.status != Status::applied) return outcome;
  try {
    change(to_id(outcome));
  } catch (const std::invalid_argument& reason) {
    return refuse(reason);
  }
  return outcome;
}

BodyType make_type(std::int8_t code) {
  if (code == catalog_t::TYPE_DYNAMIC) return BodyType::dynamic;
  return code == catalog_t::TYPE_KINEMATIC ? BodyType::kinematic : BodyType::fixed;
}

BodyDefinition make_body(const control_t& c) {
  GeometryDefinition geometry;
  geometry.name = "shape";
  geometry.shape = make_shape(c.shape_type, c.size);
  geometry.material.friction = c.friction;
  geometry.material.restitution = c.restitution;
  for (std::size_t i = 0; i < geometry.color.size(); ++i) geometry.color[i] = c.color[i];
  BodyDefinition body;
  body.name = c.name;
  body.type = make_type(c.body_type);
  body.X_WL = {to_quaternion(c.orientation), to_vector(c.position)};
  body.v_WB = to_vector(c.velocity);
  body.w_WB = to_vector(c.angular_velocity);
  if (c.mass > 0.0 && body.type == BodyType::dynamic) {
    // The shape's own inertia, scaled to the mass: it is the mass that must come out to the bit.
    Inertia inertia = compute_inertia(geometry.shape, geometry.material.density);
    inertia.moments *= c.mass / inertia.mass;
    inertia.mass = c.mass;
    body.inertia = inertia;
  }
  body.geometries.push_back(std::move(geometry));
  return body;
}

}  // namespace

Outcome find_body(const World& world, std::int32_t index, std::int32_t generation) {
  const auto slot = static_cast<std::uint32_t>(index);
  if (index < 0 || slot >= world.body_capacity()) {
    return {.status = Status::unknown_body, .detail = fmt::format("no body has the index {}", index)};
  }
  const Body& body = world.body(slot);
  const std::int64_t current = body.generation;
  if (!body.exists && generation > current) {
    return {.status = Status::unknown_body, .detail = fmt::format("no body has the index {}", index)};
  }
  if (generation != current) {
    return {.status = Status::stale_generation,
            .detail = fmt::format("body {} has generation {}, not {}", index, current, generation)};
  }
  if (!body.exists) {
    return {.status = Status::stale_generation,
            .detail = fmt::format("body {} of generation {} was removed", index, generation)};
  }
  return {.step = static_cast<std::int64_t>(world.step_count()), .body = index, .generation = generation};
}

Outcome apply_force(World& world, const force_command_t& c) {
  return change_body(world, c, [&](BodyId id) {
    const bool body_frame = c.frame == force_command_t::FRAME_BODY;
    world.push({.body = id,
                .frame = body_frame ? Push::Frame::body : Push::Frame::world,
                .force = to_vector(c.force),
                .torque = to_vector(c.torque),
                .point_B = to_vector(c.point),
                .duration = c.duration});
  });
}

Outcome apply_spawn(World& world, const control_t& c) {
  try {
    const BodyId id = world.create_body(make_body(c));
    return {.step = static_cast<std::int64_t>(world.step_count()),
            .body = static_cast<std::int32_t>(id.index),
            .generation = static_cast<std::int32_t>(id.generation)};
  } catch (const std::invalid_argument& reason) {
    return refuse(reason);
  }
}

Outcome apply_remove(World& world, const control_t& c) {
  return change_body(world, c, [&](BodyId id) { world.destroy_body(id); });
}

Outcome apply_set_state(World& world, const control_t& c) {
  return change_body(world, c, [&](BodyId id) {
    const Quat q_WL = to_quaternion(c.orientation);
    const Vec3 p_WL = to_vector(c.position) - q_WL * world.body(id.index).p_LB;
    world.set_motion(id, {q_WL, p_WL}, to_vector(c.velocity), to_vector(c.angular_velocity));
  });
}

}  // namespace tumble
