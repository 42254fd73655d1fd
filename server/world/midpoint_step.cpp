// Smooth motion in contact, of second order. The step of island_step.cpp takes arms and normals where the step starts, which
// is wrong by terms of h where they turn. Here the contacts are looked at in the middle of the way, and Coulomb's law is
// asked of the mean velocities there:
//   v1 = v0 + h M^-1 f + M^-1 J_m^T p,   gap + h J_m (v0 + v1)/2 >= 0  perp  p_n >= 0,   friction against J_m (v0 + v1)/2,
// so that contacts do no work but that of friction (the implicit midpoint rule with the law of Moreau). The mean velocity
// of turning is moved by the little that makes its power what the turning really gains. Points that slide get the bound with
// which they neither approach nor part at the end; the others' velocities are held to the contacts as they are there. The
// end of a slide cuts the part; a contact that closes is not smooth, and left to landing_step.cpp. World frame.
#include <algorithm>
#include <cmath>

#include "world/world.h"

namespace tumble {
namespace {

/// [m] by which arms, or a whole by which normals, have not turned.
constexpr double kUnturned = 1e-12;
/// [s] nothing happens in shorter parts.
constexpr double kShortest = 1e-12;
/// Of the speed that one step of forces and turning explains: points that are pressed do not approach or part with more.
constexpr double kSettled = 1.0;
/// [m] by which a load may be lifted, as in choose_drift.
constexpr double kLift = 1e-8;
/// [m] the same, of what a further pass could still mend.
constexpr double kBalanced = 1e-11;
constexpr int kMostPasses = 5;
/// Of a step, however fast a body turns.
constexpr double kMostParts = 32.0;
/// [rad] what turns farther in a part is not smooth.
constexpr double kRoughTurn = 0.5;
/// [m/s] slower ones have stopped.
constexpr double kStill = 1e-9;
/// Of the speed before: sent back by as much, a point sticks all the way.
constexpr double kSaturated = 1.0 - 1e-6;
/// Of the part: a slip that still has a tenth of its speed at both ends of so short a time jumps, and does not end.
constexpr double kNarrow = 1e-2, kJump = 0.1;
constexpr int kMostSlips = 16;

bool turned(const Vec3& r, const Vec3& from) {
  return (r - from).cwiseAbs().maxCoeff() > kUnturned;
}

/// When a slip passes through zero: the Illinois method (Dowell, Jarratt 1971). Slips in [m/s], negative if sent back.
class SlipBracket {
 public:
  SlipBracket(double whole, double start) : whole_(whole), start_(start), high_(whole) {}

  void add(double h, double slip) {
    const bool after = slip < 0.0;
    if (!after) {
      earlier_ = low_;
      slip_earlier_ = slip_low_;
    }
    (after ? high_ : low_) = h;
    (after ? slip_high_ : slip_low_) = slip;
    (after ? weight_high_ : weight_low_) = 1.0;
    if (after == last_after_) (after ? weight_low_ : weight_high_) *= 0.5;
    last_after_ = after;
  }

  bool jumps() const {
    return high_ - low_ < kNarrow * whole_ && std::min(slip_low_, -slip_high_) > kJump * start_;
  }

  double next() const {
    double h = 0.0;
    if (slip_high_ > -start_ * kSaturated) {
      const double before = weight_low_ * slip_low_, after = weight_high_ * slip_high_;
      h = low_ + (high_ - low_) * before / (before - after);
    } else if (low_ > 0.0) {  // it sticks already, which says nothing of when: as it slowed down before
      h = low_ + (low_ - earlier_) * slip_low_ / (slip_earlier_ - slip_low_);
    } else {
      h = 0.25 * high_;
    }
    return h > low_ && h < high_ ? h : 0.5 * (low_ + high_);
  }

 private:
  double whole_, start_;
  double low_ = 0.0, high_;
  double slip_low_ = start_, slip_high_ = -start_;
  double earlier_ = 0.0, slip_earlier_ = start_;  // than the low end
  double weight_low_ = 1.0, weight_high_ = 1.0;
  bool last_after_ = true;
};

}  // namespace

/// Asked first, since most islands of a crowded scene are too large.
bool World::may_step_by_midpoint(const StepContext& part) const {
  return may_be_cut(part, options_.midpoint_bodies) && part.h >= kShortest &&
         options_.integrator != Integrator::course &&
         options_.integrator != Integrator::semi_implicit_euler && solves_exactly(options_.solver);
}

bool World::suits_midpoint(const StepContext& part, const std::vector<Touch>& touches) const {
  bool pressed = false, turns = false;
  for (std::size_t i = 0; i < touches.size(); ++i) {
    const Touch& touch = touches[i];
    if (!touch.pressed) continue;
    pressed = true;
    const double limit = kSettled * part.whole * acceleration_at(scratch_.problem.contacts[i]);
    if (touch.open || std::abs(touch.n.dot(touch.u0)) > limit) return false;
    turns = turns || may_turn(touch, part);
  }
  return pressed && turns;
}

/// Not so on a plane: balls, and what does not turn. Known before the contacts are looked at in the middle.
bool World::may_turn(const Touch& touch, const StepContext& part) const {
  const Contact& contact = contacts_[touch.contact];
  const Geometry &a = geometries_[contact.pair.a], &b = geometries_[contact.pair.b];
  const bool plane_a = std::holds_alternative<HalfSpace>(a.shape);
  if (!plane_a && !std::holds_alternative<HalfSpace>(b.shape)) return true;
  const Geometry& other = plane_a ? b : a;
  if (std::holds_alternative<Sphere>(other.shape)) return other.X_BS.p != Vec3::Zero();
  const std::uint32_t slot = other.body;
  for (std::uint32_t i = 0; i < scratch_.problem_movable; ++i) {
    const SolverBody& body = scratch_.problem.bodies[i];
    if (scratch_.problem_slot[i] == slot)
      return std::max(body.w0.cwiseAbs().maxCoeff(), body.w.cwiseAbs().maxCoeff()) * part.h > kUnturned;
  }
  return false;
}

/// Of the bodies of the solved problem, at either end [rad/s].
double World::fastest_turning() const {
  double square = 0.0;
  for (std::uint32_t i = 0; i < scratch_.problem_movable; ++i) {
    const SolverBody& body = scratch_.problem.bodies[i];
    square = std::max({square, body.w0.squaredNorm(), body.w.squaredNorm()});
  }
  return std::sqrt(square);
}

/// Parts of the step in which no body that turns so fast [rad/s] turns further than it may.
double World::length_of_part(const StepContext& rest, double turning) const {
  const double parts = std::ceil(turning * rest.h / options_.midpoint_turn);
  return rest.h / std::clamp(parts, 1.0, kMostParts);
}

Advance World::advance_midpoint(std::size_t island, StepContext& rest, bool may_cut) {
  if (!may_step_by_midpoint(rest)) return Advance::none;
  Midpoint way;
  way.touches = note_touches(rest);
  if (!suits_midpoint(rest, way.touches)) return Advance::none;
  StepContext part = rest;
  const double turning = fastest_turning();
  if (may_cut) part.h = length_of_part(rest, turning);
  if (part.h * turning > kRoughTurn) return Advance::none;
  IslandState& start = scratch_.part_start;
  note_island(island, start);
  for (std::uint32_t i = 0; i < scratch_.problem_movable; ++i) {
    const SolverBody& body = scratch_.problem.bodies[i];
    way.paths.push_back(velocity_path(i, 1.0));
    way.shifts.push_back(body.shift);
    way.turns.push_back(body.turn);
  }
  way.h = rest.h;
  bool solved = try_midpoint(island, part, way);
  if (solved && way.ends_slide) solved = may_cut && shorten_to_end_of_slide(island, part, way);
  if (!solved) {
    restore_island(island, start);
    return Advance::none;
  }
  finish_midpoint(island, part, way);
  if (!(part.h < rest.h)) return Advance::whole;
  rest.h -= part.h;
  rest.begin += part.h;
  solve_part(island, rest);
  return Advance::part;
}

/// Leaves the mean problem of the part solved, the bodies in its middle, and where they end in `way`.
bool World::try_midpoint(std::size_t island, const StepContext& part, Midpoint& way) {
  place_in_middle(way, part);
  update_island_contacts(island, part);
  build_mean_problem(island, part, way.touches);
  return has_turned(way.touches) && solve_mean_problem(part, way) && is_smooth(part, way);
}

/// Shortens the part to where the first of the slides that would end in it does. False: it was not found.
bool World::shorten_to_end_of_slide(std::size_t island, StepContext& part, Midpoint& way) {
  SlipBracket bracket(part.h, way.slip_before);
  part.h *= 0.5;
  for (int trial = 0; trial < kMostSlips && !bracket.jumps(); ++trial) {
    restore_island(island, scratch_.part_start);
    if (!try_midpoint(island, part, way)) return false;
    if (std::abs(way.slip_after) <= kStill) {
      way.ends_slide = true;
      return true;
    }
    bracket.add(part.h, way.slip_after);
    part.h = bracket.next();
  }
  return false;
}

void World::finish_midpoint(std::size_t island, const StepContext& part, const Midpoint& way) {
  double shift_work = 0.0;
  for (std::uint32_t i = 0; i < scratch_.problem_movable; ++i) {
    const std::uint32_t slot = scratch_.problem_slot[i];
    const double share = part.h / way.h;
    Motion& motion = motions_[slot];
    motion = way.ends[i];
    const Vec3 shift = share * way.shifts[i], turn = share * way.turns[i];
    shift_work += work_of_shift(slot, motion.q, motion.L, shift, turn);
    displace(masses_[slot], shift, turn, motion);
    if (!is_finite(motion)) contain(slot, scratch_.part_start.motions[i]);
  }
  ++counters_.islands_by_midpoint;
  counters_.slides_ended += way.ends_slide;
  scratch_.impulse_share = part.h / options_.time_step;
  step_push_work_ += way.push_work + std::max(0.0, shift_work);
  for (PointContact& c : scratch_.problem.contacts) c.lambda *= 2.0;  // of the whole part
  store_impulses();
  std::vector<Touch> touches = note_touches(part);
  for (std::size_t i = 0; i < touches.size(); ++i) {
    const PointContact& c = scratch_.problem.contacts[i];
    touches[i].pressed = touches[i].pressed && (c.friction == 0.0 || !slides(part, c));
  }
  for (const std::size_t i : way.ending) touches[i].sticks = touches[i].pressed = true;
  update_island_contacts(island, part);
  hold_touches(island, touches, part);
}

/// Half of the way there, with the velocities of the start.
void World::place_in_middle(const Midpoint& way, const StepContext& part) {
  const double share = 0.5 * part.h / way.h;
  for (std::uint32_t i = 0; i < scratch_.problem_movable; ++i) {
    const std::uint32_t slot = scratch_.problem_slot[i];
    VelocityPath half = way.paths[i];
    half.v1 = half.v0 + share * (half.v1 - half.v0);
    half.L1 = half.L0 + share * (half.L1 - half.L0);
    Motion middle = motions_[slot];
    part.integrate_in_contact(masses_[slot], half, 0.5 * part.h, middle);
    motions_[slot].x = middle.x;
    motions_[slot].q = middle.q;
  }
}

/// For mean velocities: half of the forces, and half of the impulses. Gaps are those of the start, since those in the
/// middle are less by what arms turn in half a step.
void World::build_mean_problem(std::size_t island, const StepContext& part,
                               const std::vector<Touch>& touches) {
  build_problem(island, part);
  ContactProblem& problem = scratch_.problem;
  for (std::uint32_t i = 0; i < scratch_.problem_movable; ++i) {
    SolverBody& body = problem.bodies[i];
    AfterForces& after = scratch_.after_forces[i];
    body.v = 0.5 * (body.v0 + body.v);
    after.L = 0.5 * (motions_[scratch_.problem_slot[i]].L + after.L);
    body.w = body.inv_I_W * after.L;
  }
  const double share = 0.5 * part.h / options_.time_step;
  for (std::size_t i = 0; i < problem.contacts.size(); ++i) {
    PointContact& c = problem.contacts[i];
    const Touch* touch = find_touch(touches, scratch_.contact_source[i]);
    if (touch != nullptr) {
      c.separation = touch->gap;
    } else {
      const Vec3 u = relative_start_velocity(problem.bodies[c.a], problem.bodies[c.b], c.rA, c.rB);
      c.separation -= 0.5 * part.h * c.n.dot(u);
    }
    c.lambda *= share;
  }
  if (part.airborne) leave_out_open_contacts(part);
  prepare(problem, part.bounds);
}

bool World::has_turned(const std::vector<Touch>& touches) const {
  const ContactProblem& problem = scratch_.problem;
  if (problem.contacts.size() != touches.size()) return true;
  for (std::size_t i = 0; i < problem.contacts.size(); ++i) {
    const PointContact& c = problem.contacts[i];
    const Touch* touch = find_touch(touches, scratch_.contact_source[i]);
    if (touch == nullptr || turned(c.n, touch->n)) return true;
    if (problem.bodies[c.a].inv_mass > 0.0 && turned(c.rA, touch->rA)) return true;
    if (problem.bodies[c.b].inv_mass > 0.0 && turned(c.rB, touch->rB)) return true;
  }
  return false;
}

/// Ends are those of the last pass. False: there is no exact solution, or it would give energy.
bool World::solve_mean_problem(const StepContext& part, Midpoint& way) {
  const std::vector<Motion>& start = scratch_.part_start.motions;
  ContactProblem& problem = scratch_.problem;
  const std::vector<SolverBody> free = problem.bodies;
  const double tolerance = kSharp * part.h / options_.time_step;
  std::vector<Vec3> balance(scratch_.problem_movable, Vec3::Zero());
  way.ends = start;
  std::vector<double> bounds;
  for (const PointContact& c : problem.contacts) bounds.push_back(c.bound);
  bool corrected = true;  // bounds of points that slide; the law without gives no energy, whatever the motion
  for (int pass = 1;; ++pass) {
    problem.bodies = free;
    for (std::uint32_t i = 0; i < scratch_.problem_movable; ++i) problem.bodies[i].w += balance[i];
    const SolverReport report = solve(part, tolerance);
    bool gainless = false, settled = false;
    if (report.exact) {
      double work = 0.0, load = 0.0;
      way.push_work = 0.0;
      for (std::size_t i = 0; i < problem.contacts.size(); ++i) {
        const PointContact& c = problem.contacts[i];
        const Vec3 u = relative_velocity(problem.bodies[c.a], problem.bodies[c.b], c.rA, c.rB);
        work += 2.0 * in_world(c, c.lambda).dot(u);
        load += 2.0 * c.lambda.x() / part.h;
        way.push_work += 2.0 * c.lambda.x() * std::max(0.0, bounds[i]);
        if (!slides(part, c)) problem.contacts[i].bound = bounds[i];
      }
      const double gain = update_ends(part, start, free, way.ends, balance);
      gainless = work + gain <= way.push_work + kLift * load;
      settled = std::abs(gain) <= kBalanced * load && (!corrected || correct_bounds(part, way) <= kStill);
    }
    if (gainless && (settled || pass == kMostPasses)) return true;
    if (report.exact && !settled && pass < kMostPasses) continue;
    if (!corrected) return false;
    corrected = false;
    pass = 0;
    for (std::size_t i = 0; i < bounds.size(); ++i) problem.contacts[i].bound = bounds[i];
    std::fill(balance.begin(), balance.end(), Vec3(Vec3::Zero()));
  }
}

/// Of b relative to a where the part ends, with the arms that those of start and middle lead to [m/s].
Vec3 World::velocity_at_end(std::size_t row, const Midpoint& way, Vec3& n) const {
  const PointContact& c = scratch_.problem.contacts[row];
  const Touch* touch = find_touch(way.touches, scratch_.contact_source[row]);
  n = touch != nullptr ? Vec3((2.0 * c.n - touch->n).normalized()) : c.n;
  const auto of = [&](std::uint32_t body, const Vec3& r, const Vec3* r0) {
    if (body >= scratch_.problem_movable) {
      const SolverBody& partner = scratch_.problem.bodies[body];
      return Vec3(partner.v + partner.w.cross(r));
    }
    const Vec3 r1 = r0 != nullptr ? Vec3(2.0 * r - *r0) : r;
    return Vec3(way.ends[body].v + way.ends[body].w.cross(r1));
  };
  return of(c.b, c.rB, touch != nullptr ? &touch->rB : nullptr) -
         of(c.a, c.rA, touch != nullptr ? &touch->rA : nullptr);
}

/// Points that slide neither approach nor part at the end, up to second order: holding them there instead would change
/// the pressure without its friction. Returns by how much they do now [m/s].
double World::correct_bounds(const StepContext& part, const Midpoint& way) {
  double worst = 0.0;
  for (std::size_t i = 0; i < scratch_.problem.contacts.size(); ++i) {
    PointContact& c = scratch_.problem.contacts[i];
    if (c.friction == 0.0 || c.lambda.x() <= 0.0 || !slides(part, c)) continue;
    Vec3 n;
    const Vec3 u = velocity_at_end(i, way, n);
    const double closing = 0.5 * std::max(c.separation, -kOpen) / part.h;  // what earlier parts left
    worst = std::max(worst, std::abs(u.dot(n) + closing));
    c.bound -= 0.5 * (u.dot(n) + closing);
  }
  return worst;
}

/// Where the mean velocities lead, and what turning gains beyond the power of the contacts [J], which a change of the mean
/// velocities of turning, `balance`, takes away.
double World::update_ends(const StepContext& part, const std::vector<Motion>& start,
                          const std::vector<SolverBody>& free, std::vector<Motion>& ends,
                          std::vector<Vec3>& balance) const {
  double gain = 0.0;
  for (std::uint32_t i = 0; i < scratch_.problem_movable; ++i) {
    const MassProperties& mass = masses_[scratch_.problem_slot[i]];
    const SolverBody& mean = scratch_.problem.bodies[i];
    const AfterForces& after = scratch_.after_forces[i];
    const Vec3 L_mean = after.L + after.I_W * (mean.w - balance[i] - free[i].w);
    const VelocityPath path{
        .v0 = start[i].v, .v1 = 2.0 * mean.v - start[i].v, .L0 = start[i].L, .L1 = 2.0 * L_mean - start[i].L};
    ends[i] = start[i];
    part.integrate_in_contact(mass, path, part.h, ends[i]);
    const Vec3 change = path.L1 - path.L0;
    const double square = change.squaredNorm();
    if (square == 0.0) continue;
    const double missing = 0.5 * (path.L1.dot(ends[i].w) - path.L0.dot(start[i].w)) - mean.w.dot(change);
    gain += missing;
    balance[i] += (missing / square) * change;
  }
  return gain;
}

/// [m/s] with which a point may slide that sticks: what its arm turns within a step is not held between steps.
double World::slowest_slide(const StepContext& part, const PointContact& c) const {
  double fastest = 0.0;
  for (const std::uint32_t body : {c.a, c.b})
    fastest = std::max(fastest, scratch_.problem.bodies[body].w0.squaredNorm());
  return kStill + std::sqrt(fastest) * part.whole * part.whole * acceleration_at(c);
}

/// In the mean.
bool World::slides(const StepContext& part, const PointContact& c) const {
  const Vec3 u = relative_velocity(scratch_.problem.bodies[c.a], scratch_.problem.bodies[c.b], c.rA, c.rB);
  return std::sqrt(Vec3(u - u.dot(c.n) * c.n).squaredNorm()) > slowest_slide(part, c);
}

/// Nothing has closed. What slid and sticks in the mean would be sent back: its slide ends.
bool World::is_smooth(const StepContext& part, Midpoint& way) const {
  const ContactProblem& problem = scratch_.problem;
  const std::vector<Touch> now = note_touches(part);
  way.ends_slide = false;
  way.slip_after = kInfinity;
  way.ending.clear();
  for (std::size_t i = 0; i < now.size(); ++i) {
    if (!now[i].pressed) continue;
    if (now[i].open) return false;
    const PointContact& c = problem.contacts[i];
    if (c.friction == 0.0) continue;
    const Touch* before = find_touch(way.touches, scratch_.contact_source[i]);
    const Touch& touch = before != nullptr ? *before : now[i];
    const Vec3 slide = touch.u0 - touch.n.dot(touch.u0) * touch.n;
    const double speed = std::sqrt(slide.squaredNorm());
    if (speed <= slowest_slide(part, c)) continue;
    Vec3 n;
    const Vec3 u = velocity_at_end(i, way, n), slip = u - u.dot(n) * n;
    const double after = now[i].sticks ? -speed : slip.dot(slide) / speed;
    if (after < 0.0) way.ends_slide = true;
    if (slip.cwiseAbs().maxCoeff() <= 2.0 * kStill) way.ending.push_back(i);
    if (after < way.slip_after) {
      way.slip_after = after;
      way.slip_before = speed;
    }
  }
  return true;
}

}  // namespace tumble
