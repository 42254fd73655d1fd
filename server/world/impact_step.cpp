// The impacts of one step in order of time. Bodies have trajectories through the step, from forces and from the smooth
// problem of those in resting contact; pairs left out of that problem are followed to their times of impact. At an impact
// its bodies and all that rests against them are moved there, struck (reflection.h), and go on with new trajectories
// through the rest of the step. World frame; times from the start of the step.
#include <algorithm>
#include <cmath>

#include "dynamics/reflection.h"
#include "dynamics/time_of_impact.h"
#include "world/world.h"

namespace tumble {
namespace {

/// [m] Contacts nearer than this take part in a blow: what follows within a microsecond at 1 m/s.
constexpr double kTouching = 1e-6;
/// [m] The same for pairs that come flying, whose gap the search for the impact has closed to round-off.
constexpr double kStruck = 1e-9;
/// [s] Impacts of common bodies this near in time are one.
constexpr double kSimultaneous = 1e-12;
/// [s] A shorter rest of a step is flown through: no force does anything in it.
constexpr double kInstant = 1e-9;

/// How a pair approaches at its points, and how fast it will meet.
struct Approach {
  double closing = 0.0;        // [m/s] fastest now
  double opening = kInfinity;  // [m/s] slowest
  double impact_speed = 0.0;   // [m/s] with which the gaps will close, at most
  double gap = kInfinity;      // [m] least
  double acceleration = 0.0;   // [m/s^2] towards each other, by forces
};

Approach compute_approach(const Contact& contact, const Pose& X_WA, const Motion& A, const Motion& B,
                          const Vec3& acceleration) {
  Approach approach{.acceleration = -contact.normal_W.dot(acceleration)};
  for (int i = 0; i < contact.manifold.count; ++i) {
    const ManifoldPoint& point = contact.manifold.points[static_cast<std::size_t>(i)];
    const Vec3 p = X_WA * point.p_A;
    const double u = contact.normal_W.dot(point_velocity(B, p - B.x) - point_velocity(A, p - A.x));
    const double square = u * u + 2.0 * approach.acceleration * std::max(0.0, point.separation);
    const bool meets = square >= 0.0 && (u < 0.0 || approach.acceleration > 0.0);
    if (meets) approach.impact_speed = std::max(approach.impact_speed, std::sqrt(square));
    approach.closing = std::max(approach.closing, -u);
    approach.opening = std::min(approach.opening, u);
    approach.gap = std::min(approach.gap, point.separation);
  }
  return approach;
}

/// Work of the blow on the bodies, seen from its contacts: sum p.(u before + u after) / 2, a moving wall's own work left out.
bool gains_energy(const ContactProblem& problem, const std::vector<SolverBody>& before) {
  double work = 0.0, size = 0.0;
  for (const PointContact& c : problem.contacts) {
    const Vec3 p = in_world(c, c.lambda);
    const Vec3 u0 = relative_velocity(before[c.a], before[c.b], c.rA, c.rB);
    const Vec3 u1 = relative_velocity(problem.bodies[c.a], problem.bodies[c.b], c.rA, c.rB);
    work += 0.5 * p.dot(u0 + u1);
    size += std::abs(p.dot(u0)) + std::abs(p.dot(u1));
  }
  constexpr double kImpactRounding = 1e-12;
  return work > kImpactRounding * size;
}

bool is_loaded(const Contact& contact) {
  const auto begin = contact.impulse.begin();
  return std::any_of(begin, begin + contact.manifold.count, [](const Vec3& p) { return !p.isZero(0.0); });
}

}  // namespace

Vec3 World::relative_acceleration(const Contact& contact) const {
  const auto of = [this](std::uint32_t slot) {
    return movable(slot) ? acceleration_of(slot) : Vec3(Vec3::Zero());
  };
  return of(contact.body_b) - of(contact.body_a);
}

bool World::flies(const Contact& contact, double h) const {
  if (contact.manifold.count == 0) return true;
  if (contact.restitution == 0.0 && !contact.fast) return false;
  const Approach approach =
      compute_approach(contact, geometry_pose(geometries_[contact.pair.a]), motions_[contact.body_a],
                       motions_[contact.body_b], relative_acceleration(contact));
  const bool loaded = is_loaded(contact);
  if (contact.restitution == 0.0) return !loaded && approach.gap > kTouching;
  if (approach.opening > contact.threshold) return true;
  // What lies there is pressed together by one step of forces: no reason to bounce.
  if (loaded) return approach.closing > std::max(contact.threshold, approach.acceleration * h);
  return approach.impact_speed > contact.threshold || approach.gap > kTouching;
}

void World::begin_impacts() {
  ImpactEvents& events = scratch_.events;
  events.begin_step(body_capacity());
  for (const std::uint32_t slot : kinematic_)
    events.set_trajectory(slot, Trajectory::driven(motions_[slot], 0.0));
  const Islands& islands = scratch_.islands;
  for (std::size_t island = 0; island < islands.count(); ++island) {
    if (islands.body_begin[island + 1] - islands.body_begin[island] < 2) continue;
    const std::uint32_t* bodies = islands.bodies.data();
    events.form_group({bodies + islands.body_begin[island], bodies + islands.body_begin[island + 1]});
  }
  scratch_.contacts_indexed = false;
  scratch_.meets_flying.assign(body_capacity(), 0);
  for (const std::uint32_t index : scratch_.flying) {
    const Contact& contact = contacts_[index];
    scratch_.meets_flying[contact.body_a] = scratch_.meets_flying[contact.body_b] = 1;
  }
}

bool World::meets_flying(std::size_t island) const {
  const Islands& islands = scratch_.islands;
  const auto begin = islands.bodies.begin() + islands.body_begin[island],
             end = islands.bodies.begin() + islands.body_begin[island + 1];
  return std::any_of(begin, end, [this](std::uint32_t slot) { return scratch_.meets_flying[slot] != 0; });
}

const Trajectory& World::way(std::uint32_t slot) {
  if (!scratch_.events.has_trajectory(slot)) {
    if (flight_state_[slot] == FlightState::none) {
      scratch_.events.set_trajectory(slot, Trajectory(motions_[slot]));
    } else {
      set_flight_trajectory(slot);
    }
  }
  return scratch_.events.trajectory(slot);
}

void World::advance_impacts(const StepContext& step) {
  ImpactEvents& events = scratch_.events;
  for (const std::uint32_t index : scratch_.flying) foresee(contacts_[index], step);
  while (const ImpactEvent* next = events.next()) {
    const ImpactEvent event = *next;
    events.pop();
    strike(event, step);
  }
  contacts_.settle();
  for (const std::uint32_t slot : kinematic_) motions_[slot] = events.trajectory(slot).start();
  for (std::uint32_t slot = 0; slot < body_capacity(); ++slot) {
    if (!bodies_[slot].exists || !movable(slot)) continue;
    const bool undisturbed = flight_state_[slot] == FlightState::flying &&
                             (!events.has_trajectory(slot) || events.trajectory(slot).flies());
    if (!undisturbed && (!events.has_trajectory(slot) || events.trajectory(slot).stays())) continue;
    const Motion last_good = motions_[slot];
    motions_[slot] =
        undisturbed ? motion_in_flight(slot, step_count_ + 1) : events.trajectory(slot).at(step.h);
    if (!is_finite(motions_[slot])) contain(slot, last_good);
  }
  hold_struck_joints(step);
}

void World::hold_struck_joints(const StepContext& step) {
  if (ties_.empty() || !may_refine_joints()) return;
  for (std::size_t island = 0; island < scratch_.islands.count(); ++island) {
    if (meets_flying(island)) project_joints(island, step);
  }
}

void World::strike(const ImpactEvent& event, const StepContext& step) {
  StepContext rest = step;
  rest.begin = event.time;
  rest.h = step.h - event.time;
  Blow blow = gather_blow(event);
  absorb_tired(blow);
  for (const std::uint32_t slot : blow.members) scratch_.meets_flying[slot] = 1;
  move_to(blow, event.time);
  update_contacts_of(blow, rest);
  resolve_blow(blow, rest);
  continue_from(blow, rest);
  foresee(blow, rest);
}

World::Blow World::gather_blow(const ImpactEvent& event) {
  Blow blow;
  std::vector<ImpactEvent> others = scratch_.events.take_until(event.time + kSimultaneous);
  blow.struck = {event.pair};
  join(blow, event.body_a, event.body_b);
  for (bool found = true; found;) {
    found = std::erase_if(others, [&](const ImpactEvent& other) {
              if (!blow.has(other.body_a) && !blow.has(other.body_b)) return false;
              blow.struck.push_back(other.pair);
              join(blow, other.body_a, other.body_b);
              return true;
            }) > 0;
  }
  for (const ImpactEvent& other : others) scratch_.events.give_back(other);
  std::sort(blow.struck.begin(), blow.struck.end());
  return blow;
}

void World::join(Blow& blow, std::uint32_t a, std::uint32_t b) {
  for (const std::uint32_t slot : {a, b}) {
    if (!movable(slot)) continue;
    for (std::uint32_t next = rest_next_[slot]; !awake(slot) && next != slot; next = rest_next_[next]) {
      scratch_.events.join(slot, next);
    }
    wake_slot(slot);
    if (!blow.members.empty()) scratch_.events.join(blow.members.front(), slot);
    blow.members = scratch_.events.group(slot);
  }
}

void World::absorb_tired(Blow& blow) {
  if (!scratch_.contacts_indexed) index_contacts();
  const std::vector<std::uint32_t> members = blow.members;
  for (const std::uint32_t slot : members) {
    if (scratch_.events.count(slot) < options_.max_impacts) continue;
    blow.tired = true;
    for (const std::uint32_t index : scratch_.contacts_of[slot]) {
      const Contact& contact = contacts_[index];
      join(blow, contact.body_a, contact.body_b);
    }
  }
}

void World::move_to(const Blow& blow, double time) {
  for (const std::uint32_t slot : blow.members) {
    const Motion last_good = motions_[slot];
    const Motion moved = way(slot).at(time);
    land(slot);
    motions_[slot] = moved;
    if (!is_finite(motions_[slot])) contain(slot, last_good);
  }
  for (const std::uint32_t slot : kinematic_) motions_[slot] = scratch_.events.trajectory(slot).at(time);
}

void World::update_contacts_of(Blow& blow, const StepContext& rest) {
  for (const std::uint32_t slot : blow.members) {
    for (const std::uint32_t index : scratch_.contacts_of[slot]) {
      const Contact& contact = contacts_[index];
      const std::uint32_t other = contact.body_a == slot ? contact.body_b : contact.body_a;
      const bool second_visit = other < slot && blow.has(other);
      if (second_visit || (movable(other) && !blow.has(other))) continue;
      if (contact.flies && !blow.tired && !blow.strikes(contact.pair)) continue;
      update_contact(index, rest);
      blow.inner.push_back(index);
    }
  }
  std::sort(blow.inner.begin(), blow.inner.end());
}

void World::build_blow_problem(const Blow& blow) {
  ContactProblem& problem = scratch_.problem;
  begin_problem(options_.time_step);
  for (const std::uint32_t slot : blow.members) problem_body(slot, 0.0);
  scratch_.problem_movable = static_cast<std::uint32_t>(problem.bodies.size());
  for (const std::uint32_t index : blow.inner) {
    const Contact& contact = contacts_[index];
    const bool strikes = blow.strikes(contact.pair);
    if (contact.flies && !strikes) continue;
    const std::size_t first = problem.contacts.size();
    add_contact_rows(index, 0.0);
    for (std::size_t i = problem.contacts.size(); i-- > first;) {
      if (problem.contacts[i].separation <= (strikes ? kStruck : kTouching)) continue;
      problem.contacts.erase(problem.contacts.begin() + static_cast<std::ptrdiff_t>(i));
      scratch_.contact_source.erase(scratch_.contact_source.begin() + static_cast<std::ptrdiff_t>(i));
    }
  }
  for (const std::uint32_t index : ties_of(blow)) add_held_rows(index);
  problem.turnings.clear();  // a blow is over before anything turns
  end_problem();
  if (!blow.tired) return;
  for (PointContact& c : problem.contacts) c.restitution = 0.0;
}

std::vector<std::uint32_t> World::ties_of(const Blow& blow) const {
  std::vector<std::uint32_t> ties;
  for (std::uint32_t index = 0; index < ties_.size(); ++index) {
    const Tie& tie = ties_[index];
    if ((tie.a != kWorld && blow.has(tie.a)) || (tie.b != kWorld && blow.has(tie.b))) ties.push_back(index);
  }
  return ties;
}

/// Joints and taut ropes hold while a blow lasts; springs give way.
void World::add_held_rows(std::uint32_t tie_index) {
  const Tie& tie = ties_[tie_index];
  if (std::holds_alternative<Spring>(tie.law)) return;
  ScalarRow row;
  row.a = problem_body(tie.a, 0.0);
  row.b = problem_body(tie.b, 0.0);
  const SolverBody& A = scratch_.problem.bodies[row.a];
  const SolverBody& B = scratch_.problem.bodies[row.b];
  if (const Joint* joint = std::get_if<Joint>(&tie.law)) {
    for (std::size_t i = 0; i < joint->rows; ++i)
      scratch_.problem.rows.push_back(make_joint_row(joint->held[i], row.a, row.b, A, B));
    return;
  }
  row.rA = A.q * tie.pA;
  row.rB = B.q * tie.pB;
  if (make_taut_rope_row(std::get<Rope>(tie.law), A, B, kTouching, row)) scratch_.problem.rows.push_back(row);
}

void World::resolve_blow(const Blow& blow, const StepContext& rest) {
  build_blow_problem(blow);
  ContactProblem& problem = scratch_.problem;
  prepare(problem, rest.bounds);
  bool bounces = false;
  for (std::size_t i = 0; i < problem.contacts.size(); ++i) {
    const Contact& contact = contacts_[scratch_.contact_source[i].contact];
    const double threshold = contact.restitution > 0.0 ? contact.threshold : 0.0;
    bounces = bounces || (blow.strikes(contact.pair) && problem.contacts[i].un0 < -threshold);
  }
  for (const GeometryPair pair : blow.struck) {
    for (const std::uint32_t slot : {geometries_[pair.a].body, geometries_[pair.b].body}) {
      scratch_.events.add_impact(slot);
      counters_.impacts_capped += movable(slot) && scratch_.events.count(slot) == options_.max_impacts;
    }
  }
  if (!bounces) {
    counters_.impacts_micro += blow.struck.size();
    return;
  }
  counters_.impacts += blow.struck.size();
  const std::vector<SolverBody> before = problem.bodies;
  ReflectionReport report = reflect(problem);
  bool ended = false;
  for (std::size_t i = 0; i < problem.contacts.size(); ++i) {
    PointContact& c = problem.contacts[i];
    const std::uint32_t index = scratch_.contact_source[i].contact;
    if (c.restitution == 0.0 || !blow.strikes(contacts_[index].pair) || !ends_bouncing(index, rest)) continue;
    ended = true;
    c.restitution = 0.0;
  }
  if (ended) {
    ++counters_.impacts_ended;
    problem.bodies = before;
    report = reflect(problem);
  }
  counters_.impact_passes += static_cast<std::uint64_t>(report.passes);
  counters_.impacts_clamped += static_cast<std::uint64_t>(report.clamped);
  counters_.impacts_capped += report.capped;
  counters_.impacts_gained += gains_energy(problem, before);
  store_blow();
}

bool World::ends_bouncing(std::uint32_t contact_index, const StepContext& rest) const {
  const Contact& contact = contacts_[contact_index];
  double rebound = 0.0;
  for (std::size_t i = 0; i < scratch_.problem.contacts.size(); ++i) {
    if (scratch_.contact_source[i].contact != contact_index) continue;
    const PointContact& c = scratch_.problem.contacts[i];
    const SolverBody &A = scratch_.problem.bodies[c.a], &B = scratch_.problem.bodies[c.b];
    rebound = std::max(rebound, c.n.dot(relative_velocity(A, B, c.rA, c.rB)));
  }
  // Flights of 2 w / a, 2 e w / a, 2 e^2 w / a ... after the rebound w: their sum.
  return rebound > 0.0 && 2.0 * rebound <= -contact.normal_W.dot(relative_acceleration(contact)) *
                                               (1.0 - contact.restitution) * rest.h;
}

void World::store_blow() {
  for (std::uint32_t i = 0; i < scratch_.problem_movable; ++i) {
    const SolverBody& struck = scratch_.problem.bodies[i];
    const std::uint32_t slot = scratch_.problem_slot[i];
    Motion& motion = motions_[slot];
    const AfterForces& after = scratch_.after_forces[i];
    motion.v = struck.v;
    motion.L = after.L + after.I_W * (struck.w - struck.inv_I_W * after.L);
    motion.w = angular_velocity(masses_[slot], motion.q, motion.L);
  }
}

void World::continue_from(const Blow& blow, const StepContext& rest) {
  std::vector<std::uint32_t> held;  // contacts that go on as resting contact
  for (const std::uint32_t index : blow.inner) {
    Contact& contact = contacts_[index];
    contact.flies = !blow.tired && flies(contact, rest.h);
    if (contact.flies) contact.impulse.fill(Vec3::Zero());
    if (!contact.flies && contact.manifold.count > 0) held.push_back(index);
  }
  const std::vector<std::uint32_t> ties = ties_of(blow);
  std::vector<std::uint32_t> bound;  // slots that a contact or tie holds
  for (const std::uint32_t index : held) {
    bound.push_back(contacts_[index].body_a);
    bound.push_back(contacts_[index].body_b);
  }
  for (const std::uint32_t index : ties) {
    bound.push_back(ties_[index].a);
    bound.push_back(ties_[index].b);
  }
  std::sort(bound.begin(), bound.end());
  if (rest.h < kInstant) bound.clear();
  begin_problem(rest.h);
  for (const std::uint32_t slot : blow.members) {
    if (std::binary_search(bound.begin(), bound.end(), slot)) {
      problem_body(slot, rest.h);
    } else {
      advance_free(slot, rest);
    }
  }
  if (bound.empty()) return;
  scratch_.problem_movable = static_cast<std::uint32_t>(scratch_.problem.bodies.size());
  for (const std::uint32_t index : held) add_contact_rows(index, rest.h);
  for (const std::uint32_t index : ties) add_tie_rows(index, rest);
  end_problem();
  prepare(scratch_.problem, rest.bounds);
  solve_problem(rest);
  move_bodies(rest);
}

void World::foresee(const Blow& blow, const StepContext& rest) {
  renew_boxes_within(blow, rest);
  for (const std::uint32_t slot : blow.members) {
    for (const std::uint32_t index : scratch_.contacts_of[slot]) {
      const Contact& contact = contacts_[index];
      const std::uint32_t other = contact.body_a == slot ? contact.body_b : contact.body_a;
      if (other < slot && blow.has(other)) continue;
      foresee(contact, rest);
    }
  }
}

void World::foresee(const Contact& contact, const StepContext& rest) {
  if (!contact.flies) return;
  const Trajectory &way_a = way(contact.body_a), &way_b = way(contact.body_b);
  if (way_a.stays() && way_b.stays()) return;
  const Geometry &a = geometries_[contact.pair.a], &b = geometries_[contact.pair.b];
  ++counters_.impact_searches;
  const auto impact = find_impact({way_a, a.shape, a.X_BS}, {way_b, b.shape, b.X_BS},
                                  {.from = rest.begin, .to = options_.time_step, .part = contact.pair.part});
  if (!impact) return;
  counters_.impact_looks += static_cast<std::uint64_t>(impact->iterations);
  counters_.impact_searches_bounded += impact->bounded;
  scratch_.events.push(impact->time, contact.pair, contact.body_a, contact.body_b);
}

void World::renew_boxes_within(const Blow& blow, const StepContext& rest) {
  bool left = false;
  for (const std::uint32_t slot : blow.members) {
    const Vec3 way = scratch_.events.trajectory(slot).position(options_.time_step) - motions_[slot].x;
    for (const std::uint32_t index : bodies_[slot].geometries) {
      const Geometry& geometry = geometries_[index];
      left |= broad_phase_.move(index, contact_bounds(geometry, rest.h), geometry.fat_margin, way);
    }
  }
  scratch_.pairs.clear();
  if (left) find_pairs();
  recall_clear_pairs();
  if (scratch_.pairs.empty()) return;
  const auto known = static_cast<std::uint32_t>(contacts_.size());
  const std::size_t added =
      contacts_.insert_late(scratch_.pairs, [this](GeometryPair pair) { return make_contact(pair); });
  if (added == 0) return;
  active_stale_ = true;
  index_contacts_from(known);
  follow_those_aloft();
}

/// Who meets somebody is looked at again, on the flight that it had.
void World::follow_those_aloft() {
  for (const GeometryPair pair : scratch_.pairs) {
    for (const std::uint32_t slot : {geometries_[pair.a].body, geometries_[pair.b].body}) {
      if (!aloft(slot)) continue;
      descend(slot, step_count_);
      set_flight_trajectory(slot);
    }
  }
}

void World::set_flight_trajectory(std::uint32_t slot) {
  const FreeBody& body = free_[slot];
  const double flown = static_cast<double>(step_count_ - body.takeoff) * options_.time_step;
  scratch_.events.set_trajectory(slot, Trajectory(masses_[slot], motions_[slot], 0.0, body.flight, flown));
}

void World::index_contacts() {
  scratch_.contacts_of.resize(body_capacity());
  for (std::vector<std::uint32_t>& contacts : scratch_.contacts_of) contacts.clear();
  scratch_.contacts_indexed = true;
  index_contacts_from(0);
}

void World::index_contacts_from(std::uint32_t first) {
  for (std::uint32_t index = first; index < contacts_.size(); ++index) {
    const Contact& contact = contacts_[index];
    scratch_.contacts_of[contact.body_a].push_back(index);
    scratch_.contacts_of[contact.body_b].push_back(index);
  }
}

}  // namespace tumble
