// Free bodies. A body on which only constant forces act follows its Flight from where it took off: a step evaluates it
// where it is looked at, and ends with the same bits whether it does or not. A body that can meet nobody before some
// later step is aloft: no step visits it until then, nor does it cost anything unless somebody reads its motion. Its boxes
// hold its way; with whom they overlap it is a clear pair.
#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>

#include "world/world.h"

namespace tumble {
namespace {

/// How many steps ahead the box of a body aloft reaches: much farther whenever it was left without having met anybody,
/// nearer while it holds somebody that it may meet, or too many to keep an eye on.
constexpr std::uint64_t kNearest = 8, kFarther = 64, kNearer = 4, kFarthest = std::uint64_t{1} << 19;
/// The same while it holds others, of whom it is clear. Long boxes are kept only by who is aloft.
constexpr std::uint64_t kFarthestInCompany = 32;
constexpr std::size_t kMostCompany = 32;

/// Phases [rad] within which a flight keeps its digits; then it is started anew.
constexpr double kLargestPhase = 1e6;

}  // namespace

Motion World::motion(std::uint32_t slot) const {
  return motion_at(slot, step_count_);
}

Motion World::motion_in_flight(std::uint32_t slot, std::uint64_t step) const {
  const FreeBody& body = free_[slot];
  return body.flight.at(static_cast<double>(step - body.takeoff) * options_.time_step);
}

void World::advance_free(std::uint32_t slot, const StepContext& step) {
  if (step.ways_only) return note_way(slot, step);
  const Motion last_good = motions_[slot];
  calm_for_[slot] = 0.0;
  ++counters_.islands_free;
  const bool exact = options_.integrator == Integrator::closed_form;
  const Load& load = scratch_.load[slot];
  const bool spun_and_damped = !load.torque_W().isZero(0.0) && bodies_[slot].angular_damping > 0.0;
  if (exact && !load.follows_body() && !spun_and_damped) {
    follow_flight(slot);
  } else {
    land(slot);
    if (!exact || !advance_smooth_body(slot, step)) integrate_free(slot, step);
  }
  if (!is_finite(motions_[slot])) contain(slot, last_good);
}

void World::integrate_free(std::uint32_t slot, const StepContext& step) {
  Motion& motion = motions_[slot];
  VelocityPath path{.v0 = motion.v, .v1 = {}, .L0 = motion.L, .L1 = {}};
  velocities_after_forces(slot, step.h, path.v1, path.L1);
  step.integrate(masses_[slot], path, step.h, motion);
}

/// What only constant forces act on, undamped, follows its flight; of all else the end of this step is found as ever, and
/// the way there is drawn between.
void World::note_way(std::uint32_t slot, const StepContext& step) {
  const Motion start = motions_[slot];
  const Load& load = scratch_.load[slot];
  const bool damped = bodies_[slot].linear_damping > 0.0 || bodies_[slot].angular_damping > 0.0;
  const bool flies = options_.integrator == Integrator::closed_form && !damped && !load.follows_body() &&
                     load.torque_W().isZero(0.0);
  StepContext whole = step;
  whole.ways_only = false;
  if (flies && step.begin > 0.0) {
    const Flight flight(masses_[slot], start, acceleration_of(slot));
    scratch_.events.set_trajectory(slot, Trajectory(masses_[slot], start, step.begin, flight, 0.0));
  } else if (flies) {
    take_off(slot);
    if (scratch_.events.has_trajectory(slot)) set_flight_trajectory(slot);  // struck at the very start
  } else if (step.begin > 0.0) {
    integrate_free(slot, whole);
    note_end(slot, start, step);
  } else {
    advance_free(slot, whole);
    note_end(slot, start, step);
  }
}

void World::draw_way(std::size_t island, const StepContext& step, AdvanceIsland advance) {
  const Islands& islands = scratch_.islands;
  const std::uint32_t begin = islands.body_begin[island], end = islands.body_begin[island + 1];
  std::vector<Motion>& starts = scratch_.way_starts;
  starts.clear();
  for (std::uint32_t i = begin; i < end; ++i) starts.push_back(motions_[islands.bodies[i]]);
  StepContext whole = step;
  whole.ways_only = false;
  (this->*advance)(island, whole);
  for (std::uint32_t i = begin; i < end; ++i) {
    const std::uint32_t slot = islands.bodies[i];
    if (awake(slot)) note_end(slot, starts[i - begin], step);
  }
}

void World::note_end(std::uint32_t slot, const Motion& start, const StepContext& step) {
  const Motion end = motions_[slot];
  motions_[slot] = start;
  scratch_.events.set_trajectory(
      slot, Trajectory(masses_[slot], start, step.begin, step.begin + step.h, end, step.integrate));
}

void World::follow_flight(std::uint32_t slot) {
  take_off(slot);
  const FreeBody& body = free_[slot];
  if (body.flight.turns_freely()) {
    motions_[slot] = motion_in_flight(slot, step_count_ + 1);
  } else {
    const double h = options_.time_step, steps = static_cast<double>(step_count_ - body.takeoff);
    motions_[slot] = body.flight.stepped(masses_[slot], motions_[slot].q, steps * h, (steps + 1.0) * h);
  }
}

void World::take_off(std::uint32_t slot) {
  FreeBody& body = free_[slot];
  const FlightLoad load{.acceleration = acceleration_of(slot),
                        .torque = scratch_.load[slot].torque_W(),
                        .linear_damping = bodies_[slot].linear_damping,
                        .angular_damping = bodies_[slot].angular_damping};
  if (flight_state_[slot] != FlightState::none && step_count_ < body.last && body.flight.load() == load)
    return;
  body.flight = Flight(masses_[slot], motions_[slot], load);
  ++way_[slot];
  body.takeoff = step_count_;
  const double steps = kLargestPhase / (body.flight.phase_rate() * options_.time_step);
  body.last = step_count_ + static_cast<std::uint64_t>(std::max(1.0, std::min(0x1p60, steps)));
  body.due = body.boxed = step_count_;
  body.reach = kNearest;
  flight_state_[slot] = FlightState::flying;
}

std::optional<std::size_t> World::reach_ahead(std::uint32_t slot, std::uint64_t now, std::uint64_t until,
                                              const StepContext& step) {
  const FreeBody& body = free_[slot];
  const double h = options_.time_step;
  const Aabb path = body.flight.path_bounds(static_cast<double>(now - body.takeoff) * h,
                                            static_cast<double>(until - body.takeoff) * h);
  const auto box = [&](const Geometry& geometry) {
    return path.grown(geometry.reach + geometry.contact_margin);
  };
  std::size_t company = 0;
  for (const std::uint32_t index : bodies_[slot].geometries) {
    const Aabb bounds = box(geometries_[index]);
    if (!bounds.lower.allFinite() || !bounds.upper.allFinite()) return std::nullopt;
    scratch_.near.clear();
    broad_phase_.query(bounds, scratch_.near);
    std::erase_if(scratch_.near, [&](std::uint32_t other) { return geometries_[other].body == slot; });
    company += scratch_.near.size();
    if (company > kMostCompany) return std::nullopt;
    for (const std::uint32_t other : scratch_.near) {
      const GeometryPair pair{std::min(index, other), std::max(index, other)};
      if (jointed(slot, geometries_[other].body) || clear_pairs_.holds(pair)) continue;
      if (surface_of(geometries_[other].shape) || contacts_.holds(pair)) return std::nullopt;
      Contact contact = make_contact(pair);
      if (!leave_if_clear(contact, pair_margin(contact, step, now), now)) return std::nullopt;
    }
  }
  for (const std::uint32_t index : bodies_[slot].geometries)
    broad_phase_.place(index, box(geometries_[index]));
  return company;
}

bool World::lift(std::uint32_t slot, std::uint64_t now, const StepContext& step) {
  FreeBody& body = free_[slot];
  for (; body.reach >= kNearest; body.reach /= kNearer) {
    // Bodies thrown together do not all end together.
    const std::uint64_t until = std::min(now + body.reach - slot % (body.reach / 2), body.last);
    if (until <= now) continue;
    const std::optional<std::size_t> company = reach_ahead(slot, now, until, step);
    if (!company) continue;
    body.reach = *company == 0 ? std::min(kFarthest, kFarther * body.reach)
                               : std::min(kFarthestInCompany, 2 * body.reach);
    body.boxed = until;
    due_.push_back({until, slot});
    std::push_heap(due_.begin(), due_.end(), std::greater<>());
    return true;
  }
  body.reach = kNearest;
  body.due = now + kNearest;  // try again then
  return false;
}

bool World::try_lift(std::uint32_t slot, const StepContext& step) {
  const FreeBody& body = free_[slot];
  const std::uint64_t now = step_count_ + 1;
  if (flight_state_[slot] != FlightState::flying || !body.flight.turns_freely() || !options_.skip_flying ||
      paired_[slot] || pushed_[slot]) {
    return false;
  }
  if (now >= body.boxed && (now < body.due || !lift(slot, now, step))) return false;
  flight_state_[slot] = FlightState::aloft;
  ++aloft_count_;
  active_stale_ = true;
  return true;
}

void World::renew_flights(const StepContext& step) {
  const std::uint64_t now = step_count_ + 1;
  while (!due_.empty() && due_.front().step <= now) {
    std::pop_heap(due_.begin(), due_.end(), std::greater<>());
    const std::uint32_t slot = due_.back().slot;
    due_.pop_back();
    if (!aloft(slot) || free_[slot].boxed > now) continue;  // it came down before, or went up again since
    if (lift(slot, now, step)) continue;
    descend(slot, now);
  }
}

void World::descend(std::uint32_t slot, std::uint64_t now) {
  FreeBody& body = free_[slot];
  if (flight_state_[slot] != FlightState::aloft) return;
  motions_[slot] = motion_in_flight(slot, now);
  flight_state_[slot] = FlightState::flying;
  --aloft_count_;
  active_stale_ = true;
  if (body.boxed > now && body.boxed <= now + kFarthestInCompany) return;  // and may go aloft again in them
  body.boxed = now;
  body.reach = kNearest;
  body.due = now + kNearest;
  renew_boxes(slot);
}

void World::land(std::uint32_t slot) {
  descend(slot, step_count_);
  flight_state_[slot] = FlightState::none;
  ++way_[slot];
}

}  // namespace tumble
