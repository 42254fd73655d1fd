// The step, as a table of contents, and its stages up to the islands. World frame, SI units.
#include <algorithm>
#include <cmath>
#include <utility>

#include "dynamics/time_of_impact.h"
#include "world/world.h"

namespace tumble {
namespace {

/// Neighbouring triangles of a surface name a point on their common edge or corner alike. It counts once for each normal
/// (equal up to 1e-6 rad), for the first triangle in order.
void drop_repeated_points(ContactGraph& contacts, std::uint32_t index) {
  Contact& contact = contacts[index];
  Manifold& manifold = contact.manifold;
  for (std::uint32_t i = index; i-- > 0 && manifold.count > 0;) {
    const Contact& before = contacts[i];
    if (before.pair.a != contact.pair.a || before.pair.b != contact.pair.b) return;
    if ((before.normal_W - contact.normal_W).squaredNorm() > 1e-12) continue;
    const auto named_before = [&](const ManifoldPoint& point) {
      const auto begin = before.manifold.points.begin(), end = begin + before.manifold.count;
      return std::any_of(begin, end, [&](const ManifoldPoint& p) { return p.feature == point.feature; });
    };
    const auto begin = manifold.points.begin();
    manifold.count = static_cast<int>(std::remove_if(begin, begin + manifold.count, named_before) - begin);
  }
}

/// [B] of a contact that a visit reads: its manifold; all of it.
constexpr std::size_t kHead = 256, kWhole = sizeof(Contact);

/// [steps] A pair is left to its ways for no less, which would cost more than to look at it, and for no more, so that it is
/// soon forgotten once its boxes have come apart.
constexpr double kShortestClear = 4.0, kLongestClear = 64.0;

/// Of the geometry's furthest point about the centre of mass [m/s].
double turning_speed(const Geometry& geometry, const Motion& motion) {
  // What does not turn may be infinite.
  return motion.w.isZero(0.0) ? 0.0 : motion.w.norm() * geometry.reach;
}

}  // namespace

void World::step() {
  step([](Stage) {});
}

void World::step(const std::function<void(Stage)>& stage_done) {
  StepContext step{.h = options_.time_step,
                   .integrate = integrate_function(options_.integrator),
                   .integrate_in_contact = options_.integrator == Integrator::closed_form
                                               ? integrate_in_contact
                                               : integrate_function(options_.integrator),
                   .solve = solve_function(options_.solver),
                   .solver_settings = options_.solver_settings,
                   .bounds = options_.bounds};
  step.solver_settings.gravity = options_.gravity;
  step.impact_events = options_.impact_events && options_.solver != Solver::course_impulse &&
                       options_.integrator != Integrator::course &&
                       options_.integrator != Integrator::semi_implicit_euler;
  if (solves_exactly(options_.solver)) step.bounds.push_fraction = 0.0;  // but by remove_overlaps
  if (options_.solver == Solver::pgs || options_.solver == Solver::nncg) {
    step.bounds.slop = std::max(step.bounds.slop, options_.sweep_slop);
  }
  save_work();
  apply_pushes(step);
  stage_done(Stage::commands);
  update_pairs(step);
  stage_done(Stage::broad_phase);
  update_contacts(step);
  stage_done(Stage::narrow_phase);
  build_islands(step);
  stage_done(Stage::islands);
  advance_islands(step);
  stage_done(Stage::solve);
  update_boxes(step);
  stage_done(Stage::broad_phase);
  ++step_count_;
  scratch_.patterns.end_step();
  counters_.patterns_kept = scratch_.patterns.found();
  counters_.patterns_made = scratch_.patterns.made();
  update_report();
  stage_done(Stage::report);
}

void World::save_work() {
  constexpr double kSavedFor = 0.25;  // [s]
  work_saved_ =
      std::min(work_saved_ + options_.time_step * options_.work_rate, kSavedFor * options_.work_rate);
}

void World::apply_pushes(const StepContext& step) {
  for (const std::uint32_t slot : scratch_.loaded) {
    scratch_.load[slot] = Load{};
    pushed_[slot] = 0;
  }
  scratch_.loaded.clear();
  for (ActivePush& active : pushes_) {
    const Push& push = active.push;
    const std::uint32_t slot = push.body.index;
    const double share = std::min(1.0, active.steps_left);
    Load& load = scratch_.load[slot];
    if (push.frame == Push::Frame::body) {
      load.add_body_force(share * push.force, push.point_B);
      load.add_body_torque(share * push.torque);
    } else {
      load.add_world_force(share * push.force, push.point_B);
      load.add_world_torque(share * push.torque);
    }
    pushed_[slot] = 1;
    ++way_[slot];
    scratch_.loaded.push_back(slot);
    descend(slot, step_count_);
    wake_slot(slot);
    active.steps_left -= share;
  }
  std::erase_if(pushes_, [](const ActivePush& active) { return active.steps_left <= 0.0; });
  contain_overloaded(step);
}

void World::contain_overloaded(const StepContext& step) {
  contained_.clear();
  scratch_.held.clear();
  for (const std::uint32_t slot : scratch_.loaded) {
    Motion next = motions_[slot];
    velocities_after_forces(slot, step.h, next.v, next.L);
    next.x += step.h * next.v;
    next.w = angular_velocity(masses_[slot], next.q, next.L);
    if (is_finite(next)) continue;
    scratch_.load[slot] = Load{};
    scratch_.held.emplace_back(slot, motions_[slot]);
    contain(slot, motions_[slot]);
  }
}

Pose World::geometry_pose(const Geometry& geometry) const {
  const std::uint32_t slot = geometry.body;
  const auto pose = [&](const Motion& motion) { return Pose{motion.q, motion.x} * geometry.X_BS; };
  return aloft(slot) ? pose(motion_in_flight(slot, step_count_)) : pose(motions_[slot]);
}

Aabb World::contact_bounds(const Geometry& geometry, double h) const {
  const Aabb bounds = compute_aabb(geometry.shape, geometry_pose(geometry));
  if (bodies_[geometry.body].type == BodyType::fixed) return bounds;
  const double arm = geometry.reach;
  const double turn = std::min(motions_[geometry.body].w.norm() * h * arm, 2.0 * arm);
  return bounds.grown(geometry.contact_margin + turn);
}

/// After the motion, so that queries between steps find every box about its geometry, and already for the next step.
void World::update_boxes(const StepContext& step) {
  const auto update = [&](std::uint32_t slot) {
    for (const std::uint32_t index : bodies_[slot].geometries) {
      const Geometry& geometry = geometries_[index];
      broad_phase_.move(index, contact_bounds(geometry, step.h), geometry.fat_margin,
                        step.h * motions_[slot].v);
    }
  };
  for (const std::uint32_t slot : awake_) {  // what came to rest in this step is still listed
    const bool boxed = flight_state_[slot] == FlightState::flying && free_[slot].boxed > step_count_ + 1;
    if (!try_lift(slot, step) && !boxed) update(slot);
  }
  for (const std::uint32_t slot : kinematic_) update(slot);
  renew_flights(step);
  clear_pairs_.settle();
  counters_.boxes_renewed = broad_phase_.boxes_renewed();
}

void World::update_pairs(const StepContext& step) {
  refresh_active();
  find_pairs();
  recall_clear_pairs();
  scratch_.lost.clear();
  for (const std::uint32_t index : active_contacts_) {
    if (is_lost(contacts_.pair(index))) scratch_.lost.push_back(index);
  }
  if (!scratch_.lost.empty()) {
    contacts_.remove(scratch_.lost);
    active_stale_ = true;
  }
  leave_clear_pairs(step);
  if (contacts_.insert(scratch_.pairs, [this](GeometryPair pair) { return make_contact(pair); }) > 0) {
    active_stale_ = true;
  }
  refresh_active();
}

void World::recall_clear_pairs() {
  const auto found = static_cast<std::ptrdiff_t>(scratch_.pairs.size());
  clear_pairs_.take_due(step_count_, way_, scratch_.pairs);
  const auto recalled = scratch_.pairs.begin() + found;
  scratch_.pairs.erase(
      std::remove_if(recalled, scratch_.pairs.end(), [this](GeometryPair pair) { return is_lost(pair); }),
      scratch_.pairs.end());
  std::inplace_merge(scratch_.pairs.begin(), scratch_.pairs.begin() + found, scratch_.pairs.end());
}

void World::leave_clear_pairs(const StepContext& step) {
  counters_.pairs_skipped_clear += clear_pairs_.size();
  if (!options_.skip_flying) return;
  std::erase_if(scratch_.pairs, [&](GeometryPair pair) {
    if (!keeps_its_way(geometries_[pair.a].body) || !keeps_its_way(geometries_[pair.b].body)) return false;
    if (contacts_.holds(pair)) return false;
    Contact contact = make_contact(pair);
    return leave_if_clear(contact, pair_margin(contact, step, step_count_), step_count_);
  });
  clear_pairs_.settle();
}

void World::find_pairs() {
  scratch_.pairs.clear();
  broad_phase_.update_pairs(scratch_.pairs);
  std::erase_if(scratch_.pairs, [this](const GeometryPair& pair) {
    const std::uint32_t a = geometries_[pair.a].body;
    const std::uint32_t b = geometries_[pair.b].body;
    return a == b || !(movable(a) || movable(b)) || jointed(a, b) || clear_pairs_.holds(pair);
  });
  split_surface_pairs();
}

void World::split_surface_pairs() {
  std::swap(scratch_.pairs, scratch_.whole_pairs);
  scratch_.pairs.clear();
  scratch_.split_pairs.clear();
  for (const GeometryPair pair : scratch_.whole_pairs) {
    const TriangleSurface* surface = surface_of(geometries_[pair.a].shape);
    const std::uint32_t fixed = surface ? pair.a : pair.b, other = surface ? pair.b : pair.a;
    if (!surface) surface = surface_of(geometries_[pair.b].shape);
    if (!surface) {
      scratch_.pairs.push_back(pair);
      continue;
    }
    scratch_.split_pairs.push_back(pair);
    scratch_.triangles.clear();
    const Pose X_SW = geometry_pose(geometries_[fixed]).inverse();
    surface->query(broad_phase_.fat_bounds(other).transformed(X_SW), scratch_.triangles);
    for (const std::uint32_t part : scratch_.triangles) scratch_.pairs.push_back({pair.a, pair.b, part});
  }
}

bool World::is_lost(GeometryPair pair) const {
  if (!broad_phase_.overlaps(pair) || jointed(geometries_[pair.a].body, geometries_[pair.b].body))
    return true;
  const std::vector<GeometryPair>&whole = scratch_.split_pairs, &pairs = scratch_.pairs;
  return !whole.empty() && std::binary_search(whole.begin(), whole.end(), GeometryPair{pair.a, pair.b}) &&
         !std::binary_search(pairs.begin(), pairs.end(), pair);
}

Contact World::make_contact(GeometryPair pair) const {
  const Geometry& a = geometries_[pair.a];
  const Geometry& b = geometries_[pair.b];
  Contact contact;
  contact.pair = pair;
  contact.body_a = a.body;
  contact.body_b = b.body;
  contact.friction = std::sqrt(a.material.friction * b.material.friction);
  contact.rolling = std::max(a.material.rolling_friction, b.material.rolling_friction);
  contact.torsional = std::max(a.material.torsional_friction, b.material.torsional_friction);
  contact.restitution = std::max(a.material.restitution, b.material.restitution);
  contact.threshold = std::max(a.material.restitution_threshold.value_or(options_.restitution_threshold),
                               b.material.restitution_threshold.value_or(options_.restitution_threshold));
  contact.flies = true;
  contact.impulse.fill(Vec3::Zero());
  contact.moment.fill(Vec3::Zero());
  return contact;
}

double World::pair_margin(Contact& contact, const StepContext& step, std::uint64_t now) const {
  const Geometry& a = geometries_[contact.pair.a];
  const Geometry& b = geometries_[contact.pair.b];
  const Motion A = motion_at(contact.body_a, now), B = motion_at(contact.body_b, now);
  // What could close within the step must be seen before it does.
  double way = step.h * Vec3(A.v - B.v).norm();
  if (step.impact_events) {
    const double turning = step.h * (turning_speed(a, A) + turning_speed(b, B));
    contact.fast = way + turning > std::min(a.radius, b.radius);
    if (contact.fast || contact.restitution > 0.0) way += turning;
  }
  const double margin = std::min(a.contact_margin, b.contact_margin);
  if (contact.flies && step.impact_events && contact.restitution > 0.0 && keeps_its_way(contact.body_a) &&
      keeps_its_way(contact.body_b)) {
    // In an impact, if at all, and seen when it is due: twice the way of the step is far enough.
    const Vec3 a_AB = acceleration_on_way(contact.body_b) - acceleration_on_way(contact.body_a);
    return std::min(margin + way, 2.0 * way + step.h * step.h * a_AB.norm() + 0.005 * margin);
  }
  return margin + way;
}

void World::update_contacts(const StepContext& step) {
  scratch_.lost.clear();
  contacts_.visit<kWhole>(active_contacts_, [&](std::uint32_t index) {
    const double margin = update_contact(index, step);
    const Contact& contact = contacts_[index];
    if (options_.skip_flying && contact.manifold.count == 0 && leave_if_clear(contact, margin, step_count_))
      scratch_.lost.push_back(index);
  });
  if (!scratch_.lost.empty()) {
    contacts_.remove(scratch_.lost);
    clear_pairs_.settle();
    active_stale_ = true;
  }
  refresh_active();
}

bool World::keeps_its_way(std::uint32_t slot) const {
  if (!movable(slot)) return bodies_[slot].type == BodyType::fixed;
  if (flight_state_[slot] == FlightState::none) return !awake(slot);
  return !pushed_[slot] && free_[slot].flight.load().linear_damping == 0.0;
}

Vec3 World::acceleration_on_way(std::uint32_t slot) const {
  return movable(slot) && awake(slot) ? free_[slot].flight.load().acceleration : Vec3(Vec3::Zero());
}

/// From balls about the centres of mass that hold the shapes, or such a ball and a plane.
bool World::leave_if_clear(const Contact& contact, double margin, std::uint64_t now) {
  if (!keeps_its_way(contact.body_a) || !keeps_its_way(contact.body_b) || contact.pair.part > 0) return false;
  const Geometry &a = geometries_[contact.pair.a], &b = geometries_[contact.pair.b];
  const Motion A = motion_at(contact.body_a, now), B = motion_at(contact.body_b, now);
  const Vec3 g = acceleration_on_way(contact.body_b) - acceleration_on_way(contact.body_a);
  const bool plane_a = std::holds_alternative<HalfSpace>(a.shape);
  double time = 0.0;
  if (plane_a || std::holds_alternative<HalfSpace>(b.shape)) {
    const Geometry &plane = plane_a ? a : b, &other = plane_a ? b : a;
    const Pose X_WS = geometry_pose(plane);
    const Vec3 n = rotation_matrix(X_WS.q).col(2);
    const double sign = plane_a ? 1.0 : -1.0,
                 gap = n.dot((plane_a ? B : A).x - X_WS.p) - other.reach - margin;
    time = time_above(gap, sign * n.dot(B.v - A.v), sign * n.dot(g));
  } else {
    time = time_apart(B.x - A.x, B.v - A.v, g, a.reach + b.reach + margin);
  }
  const double steps = time / options_.time_step;
  if (steps < kShortestClear) return false;
  clear_pairs_.add({.a = contact.pair.a,
                    .b = contact.pair.b,
                    .body_a = contact.body_a,
                    .body_b = contact.body_b,
                    .way_a = way_[contact.body_a],
                    .way_b = way_[contact.body_b],
                    .until = now + static_cast<std::uint64_t>(std::min(kLongestClear, steps))});
  return true;
}

double World::update_contact(std::uint32_t index, const StepContext& step) {
  Contact& contact = contacts_[index];
  const Geometry& a = geometries_[contact.pair.a];
  const Geometry& b = geometries_[contact.pair.b];
  const Manifold old_manifold = contact.manifold;
  const Pose X_WA = geometry_pose(a);
  const double margin = pair_margin(contact, step, step_count_);
  update_manifold(a.shape, X_WA, b.shape, geometry_pose(b), margin, options_.narrow_phase, contact.cache,
                  counters_.narrow_phase, contact.manifold, contact.pair.part);
  contact.normal_W = X_WA.q * contact.manifold.normal_A;
  if (contact.pair.part > 0) drop_repeated_points(contacts_, index);
  if (contact.manifold.count == 0) return margin;
  transport_impulses(old_manifold, contact.manifold, contact.normal_W, a.contact_margin, contact.impulse,
                     contact.moment);
  wake_slot(contact.body_a);
  wake_slot(contact.body_b);
  return margin;
}

void World::refresh_active() {
  if (!active_stale_) return;
  std::fill(paired_.begin(), paired_.end(), std::uint8_t{0});
  for (const Contact& contact : contacts_) {
    for (const std::uint32_t slot : {contact.body_a, contact.body_b}) {
      paired_[slot] = 1;
      descend(slot, step_count_);
    }
  }
  active_stale_ = false;
  awake_.clear();
  kinematic_.clear();
  for (std::uint32_t slot = 0; slot < body_capacity(); ++slot) {
    if (!bodies_[slot].exists) continue;
    if (bodies_[slot].type == BodyType::kinematic) kinematic_.push_back(slot);
    if (movable(slot) && awake(slot) && !aloft(slot)) awake_.push_back(slot);
  }
  active_contacts_.clear();
  resting_points_ = 0;
  resting_penetration_ = 0.0;
  for (std::uint32_t index = 0; index < contacts_.size(); ++index) {
    const Contact& contact = contacts_[index];
    if (takes_part(contact.body_a) || takes_part(contact.body_b)) {
      active_contacts_.push_back(index);
      continue;
    }
    resting_points_ += static_cast<std::uint32_t>(contact.manifold.count);
    resting_penetration_ = std::max(resting_penetration_, deepest(contact.manifold));
  }
}

bool World::takes_part(std::uint32_t slot) const {
  if (movable(slot)) return awake(slot);
  return bodies_[slot].type == BodyType::kinematic &&
         !(motions_[slot].v.isZero(0.0) && motions_[slot].w.isZero(0.0));
}

void World::build_islands(const StepContext& step) {
  scratch_.flying.clear();
  scratch_.edges.clear();
  scratch_.edge_source.clear();
  const auto end = [this](std::uint32_t slot) {
    return slot != kWorld && movable(slot) ? slot : IslandEdge::kImmovable;
  };
  contacts_.visit<kHead>(active_contacts_, [&](std::uint32_t index) {
    Contact& contact = contacts_[index];
    const bool may_strike = contact.manifold.count == 0 || contact.restitution > 0.0 || contact.fast;
    contact.flies = step.impact_events && may_strike && flies(contact, step.h);
    if (contact.manifold.count == 0) return;
    if (contact.flies) {
      contact.impulse.fill(Vec3::Zero());
      scratch_.flying.push_back(index);
      return;
    }
    scratch_.edges.push_back({end(contact.body_a), end(contact.body_b)});
    scratch_.edge_source.push_back(index);
  });
  for (std::uint32_t index = 0; index < ties_.size(); ++index) {
    const IslandEdge edge{end(ties_[index].a), end(ties_[index].b)};
    const bool a = edge.a != IslandEdge::kImmovable && awake(edge.a);
    const bool b = edge.b != IslandEdge::kImmovable && awake(edge.b);
    if (!a && !b) continue;
    scratch_.edges.push_back(edge);
    scratch_.edge_source.push_back(static_cast<std::uint32_t>(contacts_.size()) + index);
  }
  scratch_.builder.build(body_capacity(), awake_, scratch_.edges, scratch_.islands);
}

void World::advance_islands(const StepContext& whole_step) {
  step_residual_ = 0.0;
  step_push_work_ = 0.0;
  StepContext step = whole_step;
  step.ways_only = !scratch_.flying.empty();
  if (step.ways_only) begin_impacts();
  const Islands& islands = scratch_.islands;
  for (std::size_t island = 0; island < islands.count(); ++island) {
    if (islands.edge_begin[island] == islands.edge_begin[island + 1]) {
      advance_free(islands.bodies[islands.body_begin[island]], step);
    } else if (step.ways_only && !meets_flying(island)) {
      // What strikes elsewhere is not to change a bit of it, but somebody may still be thrown into it.
      draw_way(island, step, &World::advance_connected);
    } else {
      advance_connected(island, step);
    }
  }
  if (step.ways_only) advance_impacts(step);
  for (const auto& [slot, motion] : scratch_.held) hold(slot, motion);
  for (const std::uint32_t slot : kinematic_) move_kinematic(motions_[slot], step.h);
  counters_.bodies_stepped += awake_.size();
  counters_.bodies_skipped_flying += aloft_count_;
}

void World::update_report() {
  refresh_active();
  report_ = StepReport{};
  report_.bodies_awake = static_cast<std::uint32_t>(awake_.size()) + aloft_count_;
  report_.bodies_resting = dynamic_count_ - report_.bodies_awake;
  report_.pairs = static_cast<std::uint32_t>(contacts_.size() + clear_pairs_.size());
  report_.islands = static_cast<std::uint32_t>(scratch_.islands.count()) + aloft_count_;
  report_.contacts = resting_points_;
  report_.deepest_penetration = resting_penetration_;
  report_.max_residual = step_residual_;
  report_.push_work = step_push_work_;
  contacts_.visit<kHead>(active_contacts_, [this](std::uint32_t index) {
    const Manifold& manifold = contacts_[index].manifold;
    report_.contacts += static_cast<std::uint32_t>(manifold.count);
    report_.deepest_penetration = std::max(report_.deepest_penetration, deepest(manifold));
  });
  counters_.bodies_skipped_resting += report_.bodies_resting;
}

}  // namespace tumble
