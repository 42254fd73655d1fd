// Steps of an island in parts: what the files that cut them share. A part is solved for from where the island is, moved
// through, and its contacts are looked at where it ends; a trial is taken back. World frame.
#include <algorithm>
#include <cmath>

#include "world/world.h"

namespace tumble {
namespace {

/// Share of the friction limit that is not all of it.
constexpr double kOfLimit = 1e-6;

void add_held_row(ContactProblem& problem, const PointContact& c, const Vec3& n) {
  ScalarRow& row = problem.rows.emplace_back();
  row.a = c.a;
  row.b = c.b;
  row.n = n;
  row.rA = c.rA;
  row.rB = c.rB;
  row.lower = -kInfinity;
}

}  // namespace

bool World::may_be_cut(const StepContext& step, int most_bodies) const {
  if (step.ways_only || scratch_.problem_movable > static_cast<std::uint32_t>(most_bodies)) return false;
  if (!scratch_.problem.rows.empty() || !scratch_.problem.turnings.empty()) return false;
  if (scratch_.problem_movable > 1 && fastest_turning() > options_.crowd_turning) return false;
  // Driven partners stand at the start of the whole step.
  return std::none_of(scratch_.problem_slot.begin() + scratch_.problem_movable, scratch_.problem_slot.end(),
                      [this](std::uint32_t slot) { return slot != kWorld && takes_part(slot); });
}

void World::build_part(std::size_t island, const StepContext& part) {
  build_problem(island, part);
  const double share = scratch_.impulse_share = part.h / options_.time_step;
  for (PointContact& c : scratch_.problem.contacts) c.lambda *= share;
  for (ScalarRow& row : scratch_.problem.rows) row.lambda *= share;
  for (Turning& turning : scratch_.problem.turnings) turning.lambda *= share;
}

void World::solve_part(std::size_t island, const StepContext& part) {
  build_part(island, part);
  if (part.airborne) leave_out_open_contacts(part);
  prepare(scratch_.problem, part.bounds);
  StepContext sharp = part;
  sharp.solver_settings.tolerance = std::min(part.solver_settings.tolerance, kSharp * scratch_.impulse_share);
  solve_problem(sharp);
}

void World::leave_out_open_contacts(const StepContext& part) {
  ContactProblem& problem = scratch_.problem;
  for (std::size_t i = problem.contacts.size(); i-- > 0;) {
    if (!is_open(problem.contacts[i], part)) continue;
    problem.contacts.erase(problem.contacts.begin() + static_cast<std::ptrdiff_t>(i));
    scratch_.contact_source.erase(scratch_.contact_source.begin() + static_cast<std::ptrdiff_t>(i));
  }
}

/// What forces and turning explain of the acceleration of the two points [m/s^2].
double World::acceleration_at(const PointContact& c) const {
  const auto of = [this](std::uint32_t body, const Vec3& r) {
    if (body >= scratch_.problem_movable) return 0.0;
    return std::sqrt(acceleration_of(scratch_.problem_slot[body]).squaredNorm()) +
           scratch_.problem.bodies[body].w0.squaredNorm() * std::sqrt(r.squaredNorm());
  };
  return of(c.a, c.rA) + of(c.b, c.rB);
}

bool World::is_open(const PointContact& c, const StepContext& part) const {
  if (c.separation <= kOpen) return false;
  const double speed = part.whole * acceleration_at(c);
  const SolverBody &A = scratch_.problem.bodies[c.a], &B = scratch_.problem.bodies[c.b];
  return c.separation > 0.5 * part.whole * speed ||
         std::abs(c.n.dot(relative_start_velocity(A, B, c.rA, c.rB))) > speed;
}

Advance World::advance_until_cut(std::size_t island, StepContext& rest, bool may_cut) {
  const Advance advance = advance_midpoint(island, rest, may_cut);
  if (advance != Advance::none || !may_cut) return advance;
  return advance_slide(island, rest) ? Advance::part : Advance::none;
}

const std::vector<std::uint32_t>& World::contacts_of_island(std::size_t island) {
  const Islands& islands = scratch_.islands;
  std::vector<std::uint32_t>& found = scratch_.island_contacts;
  found.clear();
  for (std::uint32_t i = islands.edge_begin[island]; i < islands.edge_begin[island + 1]; ++i) {
    const std::uint32_t source = scratch_.edge_source[islands.edges[i]];
    if (source < contacts_.size()) found.push_back(source);
  }
  const std::size_t touching = found.size();
  for (std::size_t i = 0; i < touching; ++i) {
    if (contacts_[found[i]].pair.part > 0) add_other_triangles(found[i], touching);
  }
  return found;
}

/// Contacts are sorted by pairs, so those with the same surface stand side by side.
void World::add_other_triangles(std::uint32_t index, std::size_t touching) {
  std::vector<std::uint32_t>& found = scratch_.island_contacts;
  const auto is_same_pair = [&](std::uint32_t i) {
    return contacts_[i].pair.a == contacts_[index].pair.a && contacts_[i].pair.b == contacts_[index].pair.b;
  };
  const auto is_known = [&](std::uint32_t i) {
    return std::find(found.begin(), found.end(), i) != found.end();
  };
  if (found.size() > touching && is_same_pair(found.back())) return;  // by an earlier triangle
  std::uint32_t i = index;
  while (i > 0 && is_same_pair(i - 1)) --i;
  for (; i < contacts_.size() && is_same_pair(i); ++i) {
    if (contacts_[i].restitution == 0.0 && !contacts_[i].fast && !is_known(i)) found.push_back(i);
  }
}

void World::update_island_contacts(std::size_t island, const StepContext& part) {
  for (const std::uint32_t index : contacts_of_island(island)) update_contact(index, part);
}

void World::note_island(std::size_t island, IslandState& state) {
  state.motions.clear();
  for (std::uint32_t i = 0; i < scratch_.problem_movable; ++i)
    state.motions.push_back(motions_[scratch_.problem_slot[i]]);
  state.contacts.clear();
  for (const std::uint32_t index : contacts_of_island(island)) {
    const Contact& contact = contacts_[index];
    state.contacts.push_back({contact.manifold, contact.normal_W, contact.impulse, contact.moment});
  }
  state.problem = scratch_.problem;
  state.contact_source = scratch_.contact_source;
  state.after_forces = scratch_.after_forces;
  state.residual = scratch_.residual;
}

void World::restore_island(std::size_t island, const IslandState& state) {
  for (std::uint32_t i = 0; i < scratch_.problem_movable; ++i)
    motions_[scratch_.problem_slot[i]] = state.motions[i];
  std::size_t next = 0;
  for (const std::uint32_t index : contacts_of_island(island)) {
    Contact& contact = contacts_[index];
    const IslandState::Touching& touching = state.contacts[next++];
    contact.manifold = touching.manifold;
    contact.normal_W = touching.normal_W;
    contact.impulse = touching.impulse;
    contact.moment = touching.moment;
  }
  scratch_.problem = state.problem;
  scratch_.contact_source = state.contact_source;
  scratch_.after_forces = state.after_forces;
  scratch_.residual = state.residual;
  scratch_.impulse_share = state.problem.h / options_.time_step;
}

std::vector<Touch> World::note_touches(const StepContext& part) const {
  const ContactProblem& problem = scratch_.problem;
  std::vector<Touch> touches;
  for (std::size_t i = 0; i < problem.contacts.size(); ++i) {
    const PointContact& c = problem.contacts[i];
    const ContactSource source = scratch_.contact_source[i];
    const double friction = std::sqrt(c.lambda.y() * c.lambda.y() + c.lambda.z() * c.lambda.z());
    touches.push_back(
        {.contact = source.contact,
         .feature = contacts_[source.contact].manifold.points[source.point].feature,
         .gap = c.separation,
         .n = c.n,
         .rA = c.rA,
         .rB = c.rB,
         .u0 = relative_start_velocity(problem.bodies[c.a], problem.bodies[c.b], c.rA, c.rB),
         .open = is_open(c, part),
         .pressed = c.lambda.x() > 0.0,
         .sticks = c.friction > 0.0 && friction < (1.0 - kOfLimit) * c.friction * c.lambda.x()});
  }
  return touches;
}

const Touch* World::find_touch(const std::vector<Touch>& touches, ContactSource source) const {
  const auto pair = [this](std::uint32_t contact) { return contacts_[contact].pair; };
  const GeometryPair meant = pair(source.contact);
  const std::uint32_t feature = contacts_[source.contact].manifold.points[source.point].feature;
  const Touch* found = nullptr;
  for (const Touch& touch : touches) {
    if (touch.feature != feature) continue;
    if (touch.contact == source.contact) return &touch;
    if (pair(touch.contact).a == meant.a && pair(touch.contact).b == meant.b) found = &touch;
  }
  return found;
}

void World::build_instant_problem(std::size_t island, const StepContext& part) {
  StepContext instant = part;
  instant.h = 0.0;
  build_problem(island, instant);
  scratch_.problem.h = options_.time_step;
}

void World::hold_touches(std::size_t island, const std::vector<Touch>& touches, const StepContext& part) {
  build_instant_problem(island, part);
  ContactProblem& problem = scratch_.problem;
  double worst = 0.0;
  for (std::size_t i = 0; i < problem.contacts.size(); ++i) {
    const PointContact& c = problem.contacts[i];
    const Touch* touch = find_touch(touches, scratch_.contact_source[i]);
    if (touch == nullptr || !touch->pressed) continue;
    const Vec3 u = relative_velocity(problem.bodies[c.a], problem.bodies[c.b], c.rA, c.rB);
    worst = std::max(worst, std::abs(c.n.dot(u)));
    add_held_row(problem, c, c.n);
    if (!touch->sticks) continue;
    worst = std::max(worst, std::sqrt(u.squaredNorm()));
    add_held_row(problem, c, c.t1);
    add_held_row(problem, c, c.t2);
  }
  if (worst <= kHeld) return;
  problem.contacts.clear();
  problem.turnings.clear();
  prepare(problem, part.bounds);
  if (solve(part, kHeld).exact) store_blow();
}

}  // namespace tumble
