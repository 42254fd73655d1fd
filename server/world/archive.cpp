// See archive.h. One list of members a type, leaves first.
#include "world/archive.h"

#include <algorithm>
#include <stdexcept>
#include <unordered_map>
#include <utility>

#include "math/archive.h"

namespace tumble {
namespace {

/// The hulls and surfaces of the scene, by the first geometry that holds them.
struct SceneShapes {
  const std::vector<Geometry>& geometries;
  std::unordered_map<const void*, std::uint32_t> numbers;
};

const void* address_of(const Shape& shape) {
  return std::visit(
      [](const auto& s) -> const void* {
        if constexpr (requires { s.get(); }) {
          return s.get();
        } else {
          return nullptr;
        }
      },
      shape);
}

SceneShapes number_shapes(const World& start) {
  SceneShapes shapes{start.geometries(), {}};
  for (std::uint32_t i = 0; i < shapes.geometries.size(); ++i) {
    if (const void* address = address_of(shapes.geometries[i].shape)) shapes.numbers.try_emplace(address, i);
  }
  return shapes;
}

/// The archives of this file are all of this kind.
template <typename Archive>
struct WithShapes : Archive {
  template <typename Data>
  WithShapes(SceneShapes scene_shapes, Data& data) : Archive(data), shapes(std::move(scene_shapes)) {}
  SceneShapes shapes;
};
template <typename Archive>
const SceneShapes& shapes_of(Archive& archive) {
  return static_cast<WithShapes<Archive>&>(archive).shapes;
}

void refuse_bytes() {
  throw std::runtime_error("not the bytes of a world of this scene");
}

}  // namespace

// Collision

template <typename Archive, typename Solid>
void save(Archive& archive, const std::shared_ptr<const Solid>& shared) {
  archive(shapes_of(archive).numbers.at(shared.get()));
}
template <typename Archive, typename Solid>
void load(Archive& archive, std::shared_ptr<const Solid>& shared) {
  std::uint32_t number = 0;
  archive(number);
  const std::vector<Geometry>& geometries = shapes_of(archive).geometries;
  if (number >= geometries.size()) refuse_bytes();
  const auto* known = std::get_if<std::shared_ptr<const Solid>>(&geometries[number].shape);
  if (known == nullptr) refuse_bytes();
  shared = *known;
}
template <typename Archive>
void serialize(Archive&, HalfSpace&) {}
template <typename Archive>
void serialize(Archive& archive, Sphere& sphere) {
  auto& [radius] = sphere;
  archive(radius);
}
template <typename Archive>
void serialize(Archive& archive, Box& box) {
  auto& [half_extents] = box;
  archive(half_extents);
}
template <typename Archive>
void serialize(Archive& archive, Capsule& capsule) {
  auto& [radius, half_length] = capsule;
  archive(radius, half_length);
}
template <typename Archive>
void serialize(Archive& archive, Cylinder& cylinder) {
  auto& [radius, half_length] = cylinder;
  archive(radius, half_length);
}
template <typename Archive>
void serialize(Archive& archive, Cone& cone) {
  auto& [radius, half_length] = cone;
  archive(radius, half_length);
}
template <typename Archive>
void serialize(Archive& archive, Ellipsoid& ellipsoid) {
  auto& [half_axes] = ellipsoid;
  archive(half_axes);
}
template <typename Archive>
void serialize(Archive& archive, Aabb& box) {
  auto& [lower, upper] = box;
  archive(lower, upper);
}
template <typename Archive>
void serialize(Archive& archive, GeometryPair& pair) {
  auto& [a, b, part] = pair;
  archive(a, b, part);
}
template <typename Archive>
void serialize(Archive& archive, PairCache& cache) {
  auto& [axis_A, gap, slack, margin, p_AB, q_AB, feature, vertex_A, vertex_B, order] = cache;
  archive(axis_A, gap, slack, margin, p_AB, q_AB, feature, vertex_A, vertex_B, order);
}
template <typename Archive>
void serialize(Archive& archive, ManifoldPoint& point) {
  auto& [p_A, separation, feature] = point;
  archive(p_A, separation, feature);
}
/// The points that are there: the others have no value.
template <typename Archive>
void serialize(Archive& archive, Manifold& manifold) {
  auto& [normal_A, count, points] = manifold;
  archive(normal_A, count);
  if (count < 0 || count > kMaxManifoldPoints) refuse_bytes();
  for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) archive(points[i]);
}
template <>
struct Archived<AabbTree> {
  static void members(auto& archive, AabbTree& tree) {
    auto& [nodes, root, free, leaves] = tree;
    archive(nodes, root, free, leaves);
  }
};
template <>
struct Archived<AabbTree::Node> {
  static void members(auto& archive, auto& node) {
    auto& [bounds, parent, child, height, user] = node;
    archive(bounds, parent, child, height, user);
  }
};
template <>
struct Archived<BroadPhase> {
  static void members(auto& archive, BroadPhase& broad_phase) {
    auto& [moving, fixed, proxies, dirty, found, boxes_renewed] = broad_phase;
    archive(moving, fixed, proxies, dirty, boxes_renewed);
    found.clear();  // within a search only
  }
};
template <>
struct Archived<BroadPhase::Proxy> {
  static void members(auto& archive, auto& proxy) {
    auto& [leaf, moves, dirty] = proxy;
    archive(leaf, moves, dirty);
  }
};

// Dynamics

template <typename Archive>
void serialize(Archive& archive, Motion& motion) {
  auto& [x, q, v, L, w] = motion;
  archive(x, q, v, L, w);
}
template <typename Archive>
void serialize(Archive& archive, Inertia& inertia) {
  auto& [mass, center, moments] = inertia;
  archive(mass, center, moments);
}
template <typename Archive>
void serialize(Archive& archive, MassProperties& properties) {
  auto& [mass, inv_mass, I, inv_I, q_BP] = properties;
  archive(mass, inv_mass, I, inv_I, q_BP);
}
template <typename Archive>
void serialize(Archive& archive, FlightLoad& load) {
  auto& [acceleration, torque, linear_damping, angular_damping] = load;
  archive(acceleration, torque, linear_damping, angular_damping);
}
template <>
struct Archived<Tumbling> {
  static void members(auto& archive, Tumbling& tumbling) {
    auto& [circular, terms, z0, z_rate, half_precession, series, re, loss, W, nome1, K_ratio, shift_ratio] =
        tumbling;
    archive(circular, terms, z0, z_rate, half_precession, series, re, loss, W, nome1, K_ratio, shift_ratio);
  }
};
template <>
struct Archived<FreeRotation::Turn> {
  static void members(auto& archive, auto& turn) {
    auto& [rate, axis, half_speed] = turn;
    archive(rate, axis, half_speed);
  }
};
template <>
struct Archived<FreeRotation> {
  static void members(auto& archive, FreeRotation& rotation) {
    auto& [steady, start, about_L, about_body, tumbling, q_SB, L_over_I] = rotation;
    archive(steady, start, about_L, about_body, tumbling, q_SB, L_over_I);
  }
};
template <>
struct Archived<Flight> {
  static void members(auto& archive, Flight& flight) {
    auto& [x, v, L, load, rotation] = flight;
    archive(x, v, L, load, rotation);
  }
};
template <typename Archive>
void serialize(Archive& archive, Spring& spring) {
  auto& [rest_length, stiffness, damping] = spring;
  archive(rest_length, stiffness, damping);
}
template <typename Archive>
void serialize(Archive& archive, Rope& rope) {
  auto& [length, restitution] = rope;
  archive(length, restitution);
}
template <typename Archive>
void serialize(Archive& archive, HeldPoint& point) {
  auto& [pA, pB, n_A] = point;
  archive(pA, pB, n_A);
}
template <typename Archive>
void serialize(Archive& archive, Joint& joint) {
  auto& [held, rows] = joint;
  archive(held, rows);
  if (rows > held.size()) refuse_bytes();
}

// World

template <typename Archive>
void serialize(Archive& archive, Material& material) {
  auto& [friction, rolling_friction, torsional_friction, restitution, density, threshold] = material;
  archive(friction, rolling_friction, torsional_friction, restitution, density, threshold);
}
template <typename Archive>
void serialize(Archive& archive, GeometryDefinition& definition) {
  auto& [name, shape, X_LS, material, color] = definition;
  archive(name, shape, X_LS, material, color);
}
template <typename Archive>
void serialize(Archive& archive, BodyDefinition& definition) {
  auto& [name, type, X_WL, v_WB, w_WB, geometries, inertia, linear_damping, angular_damping, gravity] =
      definition;
  archive(name, type, X_WL, v_WB, w_WB, geometries, inertia, linear_damping, angular_damping, gravity);
}
template <typename Archive>
void serialize(Archive& archive, Geometry& geometry) {
  auto& [body, shape, X_BS, material, radius, reach, fat_margin, contact_margin] = geometry;
  archive(body, shape, X_BS, material, radius, reach, fat_margin, contact_margin);
}
template <typename Archive>
void serialize(Archive& archive, Body& body) {
  auto& [exists, generation, type, p_LB, linear_damping, angular_damping, gravity, geometries, definition] =
      body;
  archive(exists, generation, type, p_LB, linear_damping, angular_damping, gravity, geometries, definition);
}
template <typename Archive>
void serialize(Archive& archive, Push& push) {
  auto& [body, frame, force, torque, point_B, duration] = push;
  archive(body, frame, force, torque, point_B, duration);
}
/// Impulses of the points that are there.
template <typename Archive>
void serialize(Archive& archive, Contact& contact) {
  auto& [pair, body_a, body_b, friction, restitution, rolling, torsional, threshold, fast, flies, manifold,
         normal_W, cache, impulse, moment] = contact;
  archive(pair);
  archive(body_a, body_b, friction, restitution, rolling, torsional, threshold, fast, flies);
  archive(manifold, normal_W, cache);
  for (std::size_t i = 0; i < static_cast<std::size_t>(manifold.count); ++i) archive(impulse[i], moment[i]);
}
template <>
struct Archived<ContactGraph> {
  static void members(auto& archive, ContactGraph& graph) {
    [[maybe_unused]] auto& [order, incoming, places, free, late] = graph;
    auto count = static_cast<std::uint32_t>(order.size());
    archive(count);
    for (std::uint32_t i = 0; i < count; ++i) {
      if (i == order.size()) graph.append({});
      Contact& contact = places[order[i].place];
      archive(contact);
      order[i].pair = contact.pair;
    }
    archive(late);
    if (late > order.size()) refuse_bytes();
  }
};
template <typename Archive>
void serialize(Archive& archive, ClearPair& clear) {
  auto& [a, b, body_a, body_b, way_a, way_b, until] = clear;
  archive(a, b, body_a, body_b, way_a, way_b, until);
}
template <>
struct Archived<ClearPairs> {
  static void members(auto& archive, ClearPairs& clear) {
    auto& [pairs, incoming] = clear;
    archive(pairs);
    incoming.clear();  // within a step only
  }
};
template <typename Archive>
void serialize(Archive& archive, StepReport& report) {
  auto& [awake, resting, pairs, contacts, islands, deepest_penetration, max_residual, push_work] = report;
  archive(awake, resting, pairs, contacts, islands, deepest_penetration, max_residual, push_work);
}
template <>
struct Archived<World::ActivePush> {
  static void members(auto& archive, auto& active) {
    auto& [push, steps_left] = active;
    archive(push, steps_left);
  }
};
template <>
struct Archived<World::FreeBody> {
  static void members(auto& archive, auto& body) {
    auto& [flight, takeoff, last, due, boxed, reach] = body;
    archive(flight, takeoff, last, due, boxed, reach);
  }
};
template <>
struct Archived<World::Due> {
  static void members(auto& archive, auto& due) {
    auto& [step, slot] = due;
    archive(step, slot);
  }
};
template <>
struct Archived<World::Tie> {
  static void members(auto& archive, auto& tie) {
    auto& [a, b, pA, pB, law, lambda] = tie;
    archive(a, b, pA, pB, law, lambda);
  }
};
template <>
struct Archived<World> {
  static void members(auto& archive, World& world) {
    auto& [options, step_count, time_before, steps_before, model_epoch, body_count, dynamic_count,  //
           bodies, masses, geometries, free_bodies, free_geometries, names,                         //
           motions, flight_state, free, way, awake_flag, pushed, paired, calm_for, rest_next,       //
           broad_phase, contacts, clear_pairs, ties, jointed, pushes, due, aloft_count,             //
           active_stale, awake, kinematic, active_contacts, resting_points, resting_penetration,    //
           work_saved, step_residual, step_push_work, counters, report, contained, scratch] = world;
    archive(options.time_step);  // the other options are the scene's
    archive(step_count, time_before, steps_before, model_epoch, body_count, dynamic_count);
    archive(bodies, masses, geometries, free_bodies, free_geometries, names);
    archive(motions, flight_state, way, awake_flag, pushed, paired, calm_for, rest_next);
    archive(broad_phase, contacts, clear_pairs, ties, jointed, pushes, due, aloft_count);
    archive(active_stale, awake, kinematic, active_contacts, resting_points, resting_penetration);
    archive(work_saved, step_residual, step_push_work, report, contained);
    archive(scratch.loaded);  // whose loads the next step takes off
    free.resize(bodies.size());
    for (std::size_t slot = 0; slot < free.size(); ++slot) {
      if (flight_state[slot] != World::FlightState::none) archive(free[slot]);
    }
  }

  /// Sizes what a step expects to be as long as the world has slots.
  static void make_room(World& world) {
    world.scratch_.load.resize(world.bodies_.size());
    world.scratch_.local.assign(world.bodies_.size(), World::kWorld);
  }
};

void write_world(const World& world, const World& start, std::string& bytes) {
  WithShapes<OutputArchive> archive(number_shapes(start), bytes);
  archive(world);
}

World read_world(const World& start, std::string_view bytes) {
  World world(start.options());
  try {
    WithShapes<InputArchive> archive(number_shapes(start), bytes);
    archive(world);
  } catch (const std::exception&) {  // cereal's, or of an allocation that nobody can have asked for
    refuse_bytes();
  }
  Archived<World>::make_room(world);
  return world;
}

}  // namespace tumble
