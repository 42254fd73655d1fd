// Creation, removal and reading of what the world holds. Everything is checked before anything changes.
#include "world/world.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "world/check.h"

namespace tumble {
namespace {

void check_range(const char* field, double value, double low, double high) {
  if (!(value >= low && value <= high))
    refuse(fmt::format("{}: must be {}..{} ({})", field, low, high, value));
}

/// Speeds above this [m/s, rad/s] are mistakes, not physics; it keeps one step's motion finite in every formula.
constexpr double kMaxSpeed = 1e6;
constexpr double kMaxFriction = 1e6;
constexpr double kMaxForce = 1e15;  // [N, N m]

void check_material(const Material& material) {
  check_range("friction", material.friction, 0.0, kMaxFriction);
  check_range("rolling friction", material.rolling_friction, 0.0, kMaxFriction);
  check_range("torsional friction", material.torsional_friction, 0.0, kMaxFriction);
  check_range("restitution", material.restitution, 0.0, 1.0);
  check_range("density", material.density, 1e-9, 1e9);
  if (const auto threshold = material.restitution_threshold) {
    check_range("restitution threshold", *threshold, 0.0, std::numeric_limits<double>::max());
  }
}

void check_name(const std::string& name) {
  if (name.empty() || name.size() > 63) refuse(fmt::format("name: must have 1..63 characters ('{}')", name));
  for (const char c : name) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f)
      refuse(fmt::format("name: control character ('{}')", name));
  }
}

void check_velocity(const char* field, const Vec3& v) {
  check_finite(field, v);
  check_range(field, v.norm(), 0.0, kMaxSpeed);
}

void check_place(const char* field, const Pose& pose) {
  check_pose(field, field, pose);
  check_range(field, pose.p.cwiseAbs().maxCoeff(), 0.0, kMaxCoordinate);
}

void check_definition(const BodyDefinition& definition) {
  check_name(definition.name);
  check_place("pose", definition.X_WL);
  check_velocity("linear velocity", definition.v_WB);
  check_velocity("angular velocity", definition.w_WB);
  check_range("linear damping", definition.linear_damping, 0.0, 1e6);
  check_range("angular damping", definition.angular_damping, 0.0, 1e6);
  for (const GeometryDefinition& geometry : definition.geometries) {
    if (const std::string problem = check_shape(geometry.shape); !problem.empty()) {
      refuse(fmt::format("geometry '{}': {}", geometry.name, problem));
    }
    check_pose("geometry pose", "geometry pose", geometry.X_LS);
    check_material(geometry.material);
    if (definition.type != BodyType::fixed && is_static_only(geometry.shape)) {
      refuse(fmt::format("geometry '{}': a {} belongs to a static body only", geometry.name,
                         shape_name(geometry.shape)));
    }
  }
}

/// The body's own inertia, or that of its geometries, in the link frame.
Inertia body_inertia(const BodyDefinition& definition) {
  if (definition.inertia) return *definition.inertia;
  if (definition.geometries.empty()) refuse("inertia: a body that moves needs an inertia or a geometry");
  std::vector<Inertia> parts;
  for (const GeometryDefinition& geometry : definition.geometries) {
    parts.push_back(transformed(compute_inertia(geometry.shape, geometry.material.density), geometry.X_LS));
  }
  return combined(parts);
}

}  // namespace

World::World(const Options& options) : options_(options) {
  if (const std::string problem = check_options(options); !problem.empty()) refuse(problem);
}

std::uint32_t World::take_slot() {
  if (!free_bodies_.empty()) {
    const std::uint32_t slot = free_bodies_.back();
    free_bodies_.pop_back();
    return slot;
  }
  const auto slot = static_cast<std::uint32_t>(bodies_.size());
  bodies_.emplace_back();
  masses_.emplace_back();
  motions_.emplace_back();
  flight_state_.push_back(FlightState::none);
  way_.push_back(0);
  free_.emplace_back();
  awake_flag_.push_back(0);
  pushed_.push_back(0);
  paired_.push_back(0);
  calm_for_.push_back(0.0);
  rest_next_.push_back(slot);
  scratch_.load.emplace_back();
  scratch_.local.push_back(kWorld);
  return slot;
}

BodyId World::create_body(const BodyDefinition& definition) {
  check_definition(definition);
  if (names_.contains(definition.name)) refuse(fmt::format("name: already taken ('{}')", definition.name));
  Vec3 p_LB = Vec3::Zero();
  MassProperties mass;
  if (definition.type == BodyType::dynamic) {
    const Inertia inertia = body_inertia(definition);
    if (const std::string problem = check_inertia(inertia); !problem.empty()) refuse("inertia: " + problem);
    mass = compute_mass_properties(inertia);
    p_LB = inertia.center;
  }

  const std::uint32_t slot = take_slot();
  const std::uint32_t generation = bodies_[slot].generation + 1;
  bodies_[slot] = Body{.exists = true,
                       .generation = generation,
                       .type = definition.type,
                       .p_LB = p_LB,
                       .linear_damping = definition.linear_damping,
                       .angular_damping = definition.angular_damping,
                       .gravity = definition.gravity,
                       .geometries = {},
                       .definition = definition};
  masses_[slot] = mass;
  Motion& motion = motions_[slot];
  motion.q = normalized(definition.X_WL.q);
  motion.x = definition.X_WL.p + motion.q * p_LB;
  const bool moves = definition.type != BodyType::fixed;
  motion.v = moves ? definition.v_WB : Vec3::Zero();
  motion.w = moves ? definition.w_WB : Vec3::Zero();
  motion.L = angular_momentum(mass, motion.q, motion.w);
  awake_flag_[slot] = moves;
  flight_state_[slot] = FlightState::none;
  pushed_[slot] = 0;
  paired_[slot] = 0;
  calm_for_[slot] = 0.0;
  rest_next_[slot] = slot;
  names_.emplace(definition.name, slot);
  for (const GeometryDefinition& geometry : definition.geometries) {
    bodies_[slot].geometries.push_back(add_geometry(slot, geometry));
  }
  ++body_count_;
  dynamic_count_ += definition.type == BodyType::dynamic;
  ++model_epoch_;
  active_stale_ = true;
  return {slot, generation};
}

std::uint32_t World::add_geometry(std::uint32_t slot, const GeometryDefinition& definition) {
  std::uint32_t index = static_cast<std::uint32_t>(geometries_.size());
  if (free_geometries_.empty()) {
    geometries_.emplace_back();
  } else {
    index = free_geometries_.back();
    free_geometries_.pop_back();
  }
  Geometry& geometry = geometries_[index];
  geometry.body = slot;
  geometry.shape = definition.shape;
  geometry.X_BS = {normalized(definition.X_LS.q), definition.X_LS.p - bodies_[slot].p_LB};
  geometry.material = definition.material;
  geometry.radius = bounding_radius(definition.shape);
  geometry.reach = geometry.X_BS.p.norm() + geometry.radius;
  // Slack in proportion to small things, so that gravel does not pair with everything in a hand's breadth.
  geometry.fat_margin = std::min(options_.fat_margin, 0.2 * geometry.radius);
  geometry.contact_margin = std::min(options_.contact_margin, 0.2 * geometry.radius);
  add_box(index);
  return index;
}

void World::add_box(std::uint32_t index) {
  const Geometry& geometry = geometries_[index];
  const Aabb bounds = contact_bounds(geometry, options_.time_step);
  broad_phase_.add(index, bounds.swept(options_.time_step * motions_[geometry.body].v), geometry.fat_margin,
                   bodies_[geometry.body].type != BodyType::fixed);
}

void World::renew_boxes(std::uint32_t slot) {
  for (const std::uint32_t index : bodies_[slot].geometries) {
    broad_phase_.remove(index);
    add_box(index);
  }
}

bool World::destroy_body(BodyId id) {
  if (!is_valid(id)) return false;
  const std::uint32_t slot = id.index;
  for (const Contact& contact : contacts_) {
    if (contact.body_a == slot || contact.body_b == slot) {
      wake_slot(contact.body_a);
      wake_slot(contact.body_b);
    }
  }
  contacts_.remove_if([slot](const Contact& c) { return c.body_a == slot || c.body_b == slot; });
  clear_pairs_.forget(slot);
  for (const Tie& tie : ties_) {
    if (tie.a == slot && tie.b != kWorld) wake_slot(tie.b);
    if (tie.b == slot && tie.a != kWorld) wake_slot(tie.a);
  }
  wake_slot(slot);
  land(slot);
  std::erase_if(ties_, [slot](const Tie& tie) { return tie.a == slot || tie.b == slot; });
  find_jointed();
  std::erase_if(pushes_, [slot](const ActivePush& active) { return active.push.body.index == slot; });
  for (const std::uint32_t geometry : bodies_[slot].geometries) {
    broad_phase_.remove(geometry);
    free_geometries_.push_back(geometry);
  }
  names_.erase(bodies_[slot].definition.name);
  dynamic_count_ -= movable(slot);
  const std::uint32_t generation = bodies_[slot].generation;
  bodies_[slot] = Body{};
  bodies_[slot].generation = generation;
  awake_flag_[slot] = 0;
  free_bodies_.push_back(slot);
  --body_count_;
  ++model_epoch_;
  active_stale_ = true;
  return true;
}

void World::resolve_anchor(const Anchor& anchor, std::uint32_t& slot, Vec3& p) const {
  check_finite("anchor", anchor.p);
  slot = kWorld;
  p = anchor.p;
  if (!anchor.body) return;
  check_live(*anchor.body, "anchor");
  slot = anchor.body->index;
  p -= bodies_[slot].p_LB;
}

World::Tie World::make_tie(const std::string& name, const Anchor& a, const Anchor& b) const {
  check_name(name);
  Tie tie{.a = kWorld, .b = kWorld, .pA = {}, .pB = {}, .law = {}, .lambda = {}};
  resolve_anchor(a, tie.a, tie.pA);
  resolve_anchor(b, tie.b, tie.pB);
  const bool moves = (tie.a != kWorld && movable(tie.a)) || (tie.b != kWorld && movable(tie.b));
  if (!moves || tie.a == tie.b)
    refuse("anchor: a spring, rope or joint needs two different ends, one on a dynamic body");
  return tie;
}

void World::add_tie(const Tie& tie) {
  for (const std::uint32_t slot : {tie.a, tie.b}) {
    if (slot == kWorld) continue;
    wake_slot(slot);
    land(slot);
  }
  ties_.push_back(tie);
}

void World::create_spring(const SpringDefinition& definition) {
  check_range("rest length", definition.spring.rest_length, 0.0, kMaxCoordinate);
  check_range("stiffness", definition.spring.stiffness, 0.0, 1e15);
  check_range("damping", definition.spring.damping, 0.0, 1e15);
  Tie tie = make_tie(definition.name, definition.a, definition.b);
  tie.law = definition.spring;
  add_tie(tie);
}

void World::create_rope(const RopeDefinition& definition) {
  check_range("length", definition.rope.length, 1e-9, kMaxCoordinate);
  check_range("restitution", definition.rope.restitution, 0.0, 1.0);
  Tie tie = make_tie(definition.name, definition.a, definition.b);
  tie.law = definition.rope;
  add_tie(tie);
}

void World::create_joint(const JointDefinition& definition) {
  Tie tie = make_tie(definition.name, definition.a, definition.b);
  tie.law = make_joint(definition.kind, tie);
  add_tie(tie);
  find_jointed();
}

Joint World::make_joint(JointKind kind, const Tie& tie) const {
  if (kind == JointKind::ball) return make_ball_joint(tie.pA, tie.pB);
  double arm = kInfinity;
  Quat q_WA = Quat::Identity(), q_WB = Quat::Identity();
  for (const auto& [slot, q] : {std::pair{tie.a, &q_WA}, std::pair{tie.b, &q_WB}}) {
    if (slot == kWorld) continue;
    *q = motion(slot).q;
    const MassProperties& mass = masses_[slot];
    if (movable(slot)) arm = std::min(arm, std::sqrt(mass.I.maxCoeff() * mass.inv_mass));
  }
  return make_fixed_joint(tie.pA, tie.pB, normalized(q_WA.conjugate() * q_WB), arm);
}

void World::find_jointed() {
  jointed_.clear();
  for (const Tie& tie : ties_) {
    if (std::holds_alternative<Joint>(tie.law) && tie.a != kWorld && tie.b != kWorld) {
      jointed_.push_back(std::minmax(tie.a, tie.b));
    }
  }
  std::sort(jointed_.begin(), jointed_.end());
}

bool World::jointed(std::uint32_t a, std::uint32_t b) const {
  if (jointed_.empty()) return false;
  const std::pair<std::uint32_t, std::uint32_t> pair = std::minmax(a, b);
  return std::binary_search(jointed_.begin(), jointed_.end(), pair);
}

void World::check_live(BodyId id, const char* field) const {
  if (!is_valid(id))
    refuse(fmt::format("{}: no such body (index {}, generation {})", field, id.index, id.generation));
}

void World::push(const Push& push) {
  check_live(push.body, "body");
  if (!movable(push.body.index)) {
    refuse(fmt::format("body: only a dynamic body can be pushed ('{}')",
                       bodies_[push.body.index].definition.name));
  }
  check_finite("force", push.force);
  check_finite("torque", push.torque);
  check_finite("point", push.point_B);
  check_range("force", push.force.norm(), 0.0, kMaxForce);
  check_range("torque", push.torque.norm(), 0.0, kMaxForce);
  check_range("point", push.point_B.norm(), 0.0, kMaxCoordinate);
  check_range("duration", push.duration, 0.0, 1e9);
  double steps = push.duration == 0.0 ? 1.0 : push.duration / options_.time_step;
  // A duration of whole steps must not leave a sliver for one more.
  if (const double whole = std::nearbyint(steps); whole > 0.0 && std::abs(steps - whole) < 1e-9 * whole)
    steps = whole;
  pushes_.push_back({push, steps});
  wake_slot(push.body.index);
}

void World::set_motion(BodyId id, const Pose& X_WL, const Vec3& v_WB, const Vec3& w_WB) {
  check_live(id, "body");
  check_place("pose", X_WL);
  check_velocity("linear velocity", v_WB);
  check_velocity("angular velocity", w_WB);
  const std::uint32_t slot = id.index;
  if (bodies_[slot].type == BodyType::fixed) {
    refuse(fmt::format("body: a static body cannot be moved ('{}')", bodies_[slot].definition.name));
  }
  wake(id);
  land(slot);
  for (const Contact& contact : contacts_) {
    if (contact.body_a == slot) wake_slot(contact.body_b);
    if (contact.body_b == slot) wake_slot(contact.body_a);
  }
  contacts_.remove_if([slot](const Contact& c) { return c.body_a == slot || c.body_b == slot; });
  Motion& motion = motions_[slot];
  motion.q = normalized(X_WL.q);
  motion.x = X_WL.p + motion.q * bodies_[slot].p_LB;
  motion.v = v_WB;
  motion.w = w_WB;
  motion.L = angular_momentum(masses_[slot], motion.q, w_WB);
  // Its pairs are forgotten: a teleport has no past to warm-start from.
  renew_boxes(slot);
  active_stale_ = true;
}

void World::wake(BodyId id) {
  check_live(id, "body");
  wake_slot(id.index);
}

void World::set_time_step(double time_step) {
  Options options = options_;
  options.time_step = time_step;
  if (const std::string problem = check_options(options); !problem.empty()) refuse(problem);
  const double ratio = time_step / options_.time_step;
  for (std::uint32_t slot = 0; slot < body_capacity(); ++slot) {
    if (bodies_[slot].exists) land(slot);  // flights count in steps of one length
  }
  time_before_ = time();
  steps_before_ = step_count_;
  options_ = options;
  for (ActivePush& active : pushes_) active.steps_left /= ratio;
  for (Contact& contact : contacts_) {
    for (Vec3& impulse : contact.impulse) impulse *= ratio;
    for (Vec3& moment : contact.moment) moment *= ratio;
  }
  for (Tie& tie : ties_) {
    for (double& lambda : tie.lambda) lambda *= ratio;
  }
  // Boxes hold what moves until the end of the next step.
  for (std::uint32_t slot = 0; slot < body_capacity(); ++slot) {
    if (bodies_[slot].exists && bodies_[slot].type != BodyType::fixed) renew_boxes(slot);
  }
}

void World::wake_slot(std::uint32_t slot) {
  if (!movable(slot) || awake(slot)) return;
  ++counters_.wakes;
  active_stale_ = true;
  for (std::uint32_t next = slot; !awake(next);) {
    awake_flag_[next] = 1;
    ++way_[next];
    calm_for_[next] = 0.0;
    const std::uint32_t after = rest_next_[next];
    rest_next_[next] = next;
    next = after;
  }
}

bool World::is_valid(BodyId id) const {
  return id.index < bodies_.size() && bodies_[id.index].exists &&
         bodies_[id.index].generation == id.generation;
}

std::optional<BodyId> World::find(std::string_view name) const {
  const auto it = names_.find(name);
  if (it == names_.end()) return std::nullopt;
  return id(it->second);
}

Pose World::link_pose(std::uint32_t slot) const {
  const Motion motion = this->motion(slot);
  return {motion.q, motion.x - motion.q * bodies_[slot].p_LB};
}

}  // namespace tumble
