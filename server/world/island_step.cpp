// One island through one step: its forces, its contact problem, its impacts, its solution, its rest, its motion.
// World frame; x, r at the start of the step.
#include <algorithm>
#include <cmath>

#include "dynamics/balance.h"
#include "dynamics/impact.h"
#include "dynamics/overlap.h"
#include "world/world.h"

namespace tumble {
namespace {

/// [m/s, rad/s] slower islands are on their way to rest, which asks for less.
constexpr double kMoving = 1e-3;
/// [m + rad] a shift of overlaps that a rest may leave out. Tenfold what is taken for an overlap.
constexpr double kShifted = 1e-9;

}  // namespace

bool World::is_finite(const Motion& motion) {
  constexpr double kLargest =
      1e100;  // [SI units] beyond it, products of three of what is computed next overflow
  const auto within = [](const Vec3& v) { return v.allFinite() && v.cwiseAbs().maxCoeff() <= kLargest; };
  return within(motion.x) && within(motion.v) && within(motion.L) && within(motion.w) &&
         motion.q.coeffs().allFinite();
}

Vec3 World::acceleration_of(std::uint32_t slot) const {
  const Vec3 a = masses_[slot].inv_mass * scratch_.load[slot].force_W();
  return bodies_[slot].gravity ? Vec3(a + options_.gravity) : a;
}

void World::velocities_after_forces(std::uint32_t slot, double h, Vec3& v, Vec3& L) const {
  const Motion& motion = motions_[slot];
  const Body& body = bodies_[slot];
  const Load& load = scratch_.load[slot];
  Vec3 a = acceleration_of(slot), torque = load.torque_W();
  if (load.follows_body()) {
    const Mat3 R_WB = rotation_matrix(motion.q);
    a += masses_[slot].inv_mass * (load.force(R_WB) - load.force_W());
    torque = load.torque(R_WB);
  }
  // Exact for v' = a - c v over the step: v e^{-ch} + a (1 - e^{-ch})/c.
  const double cv = body.linear_damping * h;
  const double cL = body.angular_damping * h;
  v = exp_decay(-cv) * motion.v + (h * mean_decay(cv)) * a;
  L = exp_decay(-cL) * motion.L + (h * mean_decay(cL)) * torque;
}

void World::advance_connected(std::size_t island, const StepContext& step) {
  if (advance_springs(island, step)) return;
  build_problem(island, step);
  ContactProblem& problem = scratch_.problem;
  prepare(problem, step.bounds);
  // With events, impacts have their own times. The slides' solver bounces as taught, inside its own passes.
  if (!step.impact_events && options_.solver != Solver::course_impulse) bounce(problem);
  StepContext rest = step;
  // What moves for long adds up what is wrong with its forces.
  if (may_be_cut(step, options_.midpoint_bodies) && island_speed(problem) > kMoving)
    rest.solver_settings.tolerance = std::min(step.solver_settings.tolerance, kSharp);
  solve_problem(rest);
  if (is_taut()) {
    return step.ways_only ? draw_way(island, step, &World::advance_taut) : advance_taut(island, step);
  }
  int cuts = 0;
  while (!try_rest(scratch_.residual)) {
    const bool may_cut = cuts < options_.max_cuts;
    const Advance advance =
        may_cut && advance_landing(island, rest) ? Advance::part : advance_until_cut(island, rest, may_cut);
    if (advance == Advance::whole) return;
    if (advance == Advance::none) {
      move_bodies(rest);
      return hold_joints(island, rest);
    }
    counters_.cuts_capped += ++cuts == options_.max_cuts;
  }
}

void World::solve_problem(const StepContext& step) {
  scratch_.shifted = 0.0;
  if (solve_velocities(step)) shift_apart(step);
  store_impulses();
}

/// True if to rounding.
bool World::solve_velocities(const StepContext& step) {
  const bool refines = refines_joints();
  if (refines) scratch_.free_bodies = scratch_.problem.bodies;
  for (int pass = 1;; ++pass) {
    const SolverReport solved = solve(step);
    step_residual_ = std::max(step_residual_, solved.residual);
    scratch_.residual = solved.residual;
    const bool last = !refines || !solved.exact || pass == options_.joint_passes;
    if (last || !update_joint_arms(step, scratch_.free_bodies)) return solved.exact;
    ++counters_.joint_passes;
  }
}

SolverReport World::solve(const StepContext& step, double tolerance) {
  SolverSettings settings = step.solver_settings;
  settings.tolerance = std::min(settings.tolerance, tolerance);
  if (options_.work_rate > 0.0) settings.work_left = work_saved_;
  const SolverReport report = step.solve(scratch_.problem, settings);
  count_solution(report);
  return report;
}

void World::count_solution(const SolverReport& report) {
  work_saved_ -= report.work;
  counters_.sweeps += static_cast<std::uint64_t>(report.sweeps);
  counters_.solver_iterations += static_cast<std::uint64_t>(report.iterations + report.newton_steps);
  counters_.newton_steps += static_cast<std::uint64_t>(report.newton_steps);
  counters_.exact_work += static_cast<std::uint64_t>(report.work);
  counters_.islands_exact += report.exact && !report.accepted ? 1 : 0;
  counters_.solver_fallbacks += report.fallback ? 1 : 0;
  ++(report.accepted ? counters_.islands_accepted : counters_.islands_solved);
}

void World::shift_apart(const StepContext& step) {
  OverlapSettings settings{.speed = options_.bounds.push_speed};
  const SolverSettings& solver = step.solver_settings;
  if (options_.solver == Solver::automatic)
    settings.work = static_cast<std::uint64_t>(solver.exact_work * solver.exact_calm_factor);
  const OverlapReport report = remove_overlaps(scratch_.problem, settings);
  scratch_.shifted = report.largest;
  counters_.overlaps_removed += report.factorizations > 0 ? 1 : 0;
  counters_.overlap_steps += static_cast<std::uint64_t>(report.factorizations);
}

void World::bounce(ContactProblem& problem) {
  const ImpactReport report = resolve_impacts(
      problem, {.threshold_speed = options_.restitution_threshold, .max_impacts = options_.max_impacts});
  counters_.impacts += report.impacts;
  counters_.impacts_capped += report.capped;
}

void World::build_problem(std::size_t island, const StepContext& step) {
  const Islands& islands = scratch_.islands;
  begin_problem(step.h);
  for (std::uint32_t i = islands.body_begin[island]; i < islands.body_begin[island + 1]; ++i) {
    land(islands.bodies[i]);
    problem_body(islands.bodies[i], step.h);
  }
  scratch_.problem_movable = static_cast<std::uint32_t>(scratch_.problem.bodies.size());
  for (const std::uint32_t contact : contacts_of_island(island)) add_contact_rows(contact, step.h);
  const auto contact_count = static_cast<std::uint32_t>(contacts_.size());
  for (std::uint32_t i = islands.edge_begin[island]; i < islands.edge_begin[island + 1]; ++i) {
    const std::uint32_t source = scratch_.edge_source[islands.edges[i]];
    if (source >= contact_count) add_tie_rows(source - contact_count, step);
  }
  end_problem();
}

void World::begin_problem(double h) {
  scratch_.problem.clear();
  scratch_.problem.h = h;
  scratch_.impulse_share = 1.0;
  scratch_.problem.patterns = options_.keep_patterns ? &scratch_.patterns : nullptr;
  scratch_.problem_slot.clear();
  scratch_.after_forces.clear();
  scratch_.contact_source.clear();
  scratch_.row_source.clear();
}

void World::end_problem() {
  for (const std::uint32_t slot : scratch_.problem_slot) {
    if (slot != kWorld) scratch_.local[slot] = kWorld;
  }
}

std::uint32_t World::problem_body(std::uint32_t slot, double h) {
  if (slot != kWorld && scratch_.local[slot] != kWorld) return scratch_.local[slot];
  const auto index = static_cast<std::uint32_t>(scratch_.problem.bodies.size());
  SolverBody& body = scratch_.problem.bodies.emplace_back();
  scratch_.problem_slot.push_back(slot);
  if (slot == kWorld) return index;
  scratch_.local[slot] = index;
  const Motion& motion = motions_[slot];
  body.x = motion.x;
  body.q = motion.q;
  body.v0 = body.v = motion.v;
  body.w0 = body.w = motion.w;
  if (!movable(slot)) return index;
  const MassProperties& mass = masses_[slot];
  body.inv_mass = mass.inv_mass;
  body.inv_I_W = world_inertia(mass.inv_I, mass.q_BP, motion.q);
  AfterForces& after = scratch_.after_forces.emplace_back();
  velocities_after_forces(slot, h, body.v, after.L);
  after.I_W = world_inertia(mass.I, mass.q_BP, motion.q);
  after.w0 = motion.w;
  body.w = body.inv_I_W * after.L;
  return index;
}

void World::add_contact_rows(std::uint32_t contact_index, double h) {
  const Contact& contact = contacts_[contact_index];
  const std::uint32_t a = problem_body(contact.body_a, h);
  const std::uint32_t b = problem_body(contact.body_b, h);
  const Motion& A = motions_[contact.body_a];
  const Motion& B = motions_[contact.body_b];
  const Pose& X_AS = geometries_[contact.pair.a].X_BS;
  const Vec3 x_BA = A.x - B.x;
  for (int i = 0; i < contact.manifold.count; ++i) {
    const ManifoldPoint& point = contact.manifold.points[static_cast<std::size_t>(i)];
    PointContact row;
    row.a = a;
    row.b = b;
    row.n = contact.normal_W;
    row.rA = A.q * (X_AS * point.p_A);
    row.rB = row.rA + x_BA;
    row.separation = point.separation;
    row.friction = contact.friction;
    row.restitution = contact.restitution;
    set_tangents(row);
    row.lambda.setZero();
    if (options_.warm_start) {
      const Vec3& impulse = contact.impulse[static_cast<std::size_t>(i)];
      row.lambda = Vec3(impulse.dot(row.n), impulse.dot(row.t1), impulse.dot(row.t2));
    }
    if (contact.rolling > 0.0 || contact.torsional > 0.0)
      add_turning(row, contact, contact.moment[static_cast<std::size_t>(i)]);
    scratch_.problem.contacts.push_back(row);
    scratch_.contact_source.push_back({contact_index, static_cast<std::uint32_t>(i)});
  }
}

void World::add_turning(const PointContact& row, const Contact& contact, const Vec3& moment) {
  Turning turning{.contact = static_cast<std::uint32_t>(scratch_.problem.contacts.size()),
                  .rolling = contact.rolling,
                  .torsional = contact.torsional};
  if (options_.warm_start) turning.lambda = Vec3(moment.dot(row.n), moment.dot(row.t1), moment.dot(row.t2));
  scratch_.problem.turnings.push_back(turning);
}

void World::add_tie_rows(std::uint32_t tie_index, const StepContext& step) {
  const double h = step.h;
  const Tie& tie = ties_[tie_index];
  ScalarRow row;
  row.a = problem_body(tie.a, h);
  row.b = problem_body(tie.b, h);
  const SolverBody& A = scratch_.problem.bodies[row.a];
  const SolverBody& B = scratch_.problem.bodies[row.b];
  if (const Joint* joint = std::get_if<Joint>(&tie.law)) {
    for (std::uint32_t i = 0; i < joint->rows; ++i)
      add_row(make_joint_row(joint->held[i], row.a, row.b, A, B, h, step.bounds), tie_index, i);
    return;
  }
  row.rA = A.q * tie.pA;
  row.rB = B.q * tie.pB;
  const Spring* spring = std::get_if<Spring>(&tie.law);
  const bool acts = spring ? make_spring_row(*spring, A, B, h, row)
                           : make_rope_row(std::get<Rope>(tie.law), A, B, h, options_.bounds, row);
  if (acts) add_row(row, tie_index, 0);
}

void World::add_row(ScalarRow row, std::uint32_t tie_index, std::uint32_t index) {
  if (options_.warm_start) row.lambda = ties_[tie_index].lambda[index];
  scratch_.problem.rows.push_back(row);
  scratch_.row_source.push_back({tie_index, index});
}

void World::store_impulses() {
  for (std::size_t i = 0; i < scratch_.problem.contacts.size(); ++i) {
    const PointContact& row = scratch_.problem.contacts[i];
    const ContactSource source = scratch_.contact_source[i];
    const Vec3 impulse = in_world(row, row.lambda) / scratch_.impulse_share;
    contacts_[source.contact].impulse[source.point] = impulse.allFinite() ? impulse : Vec3(Vec3::Zero());
  }
  for (const Turning& turning : scratch_.problem.turnings) {
    const ContactSource source = scratch_.contact_source[turning.contact];
    const Vec3 moment =
        in_world(scratch_.problem.contacts[turning.contact], turning.lambda) / scratch_.impulse_share;
    contacts_[source.contact].moment[source.point] = moment.allFinite() ? moment : Vec3(Vec3::Zero());
  }
  for (std::size_t i = 0; i < scratch_.problem.rows.size(); ++i) {
    const double lambda = scratch_.problem.rows[i].lambda / scratch_.impulse_share;
    const Scratch::RowSource source = scratch_.row_source[i];
    ties_[source.tie].lambda[source.row] = std::isfinite(lambda) ? lambda : 0.0;
  }
}

bool World::try_rest(double residual) {
  const auto begin = scratch_.problem_slot.begin();
  const auto movable_end = begin + scratch_.problem_movable;
  double calm_for = calm_for_[*begin];
  for (auto slot = begin; slot != movable_end; ++slot) calm_for = std::min(calm_for, calm_for_[*slot]);
  bool rests = check_rest(scratch_.problem, residual, options_.rest, calm_for) && scratch_.shifted < kShifted;
  for (auto slot = begin; slot != movable_end; ++slot) {
    calm_for_[*slot] = calm_for;
    rests = rests && !pushed_[*slot];
  }
  // A moving kinematic partner will not leave it in peace.
  for (auto slot = movable_end; slot != scratch_.problem_slot.end(); ++slot) {
    rests = rests && (*slot == kWorld || !takes_part(*slot));
  }
  if (!rests || !options_.skip_resting) return false;
  const double limit = options_.rest.residual;
  if (residual < limit && balance_impulses(scratch_.problem, limit)) store_impulses();
  for (auto slot = begin; slot != movable_end; ++slot) {
    motions_[*slot].v.setZero();
    motions_[*slot].L.setZero();
    motions_[*slot].w.setZero();
    awake_flag_[*slot] = 0;
    ++way_[*slot];
    const auto next = slot + 1 == movable_end ? begin : slot + 1;
    rest_next_[*slot] = *next;
  }
  ++counters_.rests;
  active_stale_ = true;
  return true;
}

void World::move_bodies(const StepContext& step) {
  const bool mean = scratch_.problem.drift == ContactProblem::Drift::average;
  const double share = mean ? gainless_share(step) : 0.0;
  for (const PointContact& c : scratch_.problem.contacts)
    step_push_work_ += c.lambda.x() * std::max(0.0, c.bound);
  if (scratch_.shifted > 0.0) count_shifts();
  for (std::uint32_t i = 0; i < scratch_.problem_movable; ++i) {
    const SolverBody& solved = scratch_.problem.bodies[i];
    move_body(scratch_.problem_slot[i], velocity_path(i, share), solved.shift, solved.turn, step);
  }
}

void World::count_shifts() {
  double work = 0.0;
  for (std::uint32_t i = 0; i < scratch_.problem_movable; ++i) {
    const SolverBody& body = scratch_.problem.bodies[i];
    const std::uint32_t slot = scratch_.problem_slot[i];
    work +=
        work_of_shift(slot, motions_[slot].q, scratch_.after_forces[i].I_W * body.w, body.shift, body.turn);
  }
  step_push_work_ += std::max(0.0, work);
}

double World::work_of_shift(std::uint32_t slot, const Quat& q, const Vec3& L, const Vec3& shift,
                            const Vec3& turn) const {
  const MassProperties& mass = masses_[slot];
  const Quat turned = normalized(exp_map(turn) * q);
  // L stays: w . L changes with the moments of inertia that it meets.
  return 0.5 * L.dot(angular_velocity(mass, turned, L) - angular_velocity(mass, q, L)) -
         mass.mass * acceleration_of(slot).dot(shift);
}

VelocityPath World::velocity_path(std::uint32_t i, double share) const {
  const SolverBody& solved = scratch_.problem.bodies[i];
  // Momentum after the forces plus what the impulses changed, so that a body no impulse met keeps its bits.
  const AfterForces& after = scratch_.after_forces[i];
  const Vec3 L1 = after.L + after.I_W * (solved.w - solved.inv_I_W * after.L);
  VelocityPath path{.v0 = solved.v, .v1 = solved.v, .L0 = L1, .L1 = L1};
  if (share == 0.0) return path;
  const Motion& motion = motions_[scratch_.problem_slot[i]];
  path.v0 = solved.v0;
  path.L0 = motion.L + after.I_W * (solved.w0 - after.w0);
  if (share < 1.0) {
    path.v0 = path.v1 + share * (path.v0 - path.v1);
    path.L0 = path.L1 + share * (path.L0 - path.L1);
  }
  return path;
}

/// The mean velocity, (v0 + v)/2, moves a body further against gravity than the end velocity that the contacts allow, and
/// turns it while its momentum changes: both can lift the energy by terms of h^2. The bodies drift with as much of
/// (v0 - v)/2 as gains nothing but the work by which overlaps are pushed apart; without it the impulses take energy away,
///   dE(share) = sum lambda.(u0 + u)/2 + what turning adds to L.w/2 - (1 - share) sum h F.(v - v0)/2 .
double World::gainless_share(const StepContext& step) const {
  constexpr double kSlack = 1e-8;      // [m] by which a load may be lifted, as in choose_drift
  constexpr double kInside = 0.999;    // of the limit, so that the next trial is not decided by rounding
  constexpr double kRounding = 1e-14;  // of the energy of turning
  constexpr int kTrials = 4;
  const ContactProblem& problem = scratch_.problem;
  if (problem.contacts.empty()) return 1.0;
  double work = 0.0, allowed = 0.0, given_up = 0.0;
  for (const PointContact& c : problem.contacts) {
    const SolverBody &A = problem.bodies[c.a], &B = problem.bodies[c.b];
    const Vec3 u = relative_start_velocity(A, B, c.rA, c.rB) + relative_velocity(A, B, c.rA, c.rB);
    work += 0.5 * in_world(c, c.lambda).dot(u);
    allowed += c.lambda.x() * (kSlack / step.h + std::max(0.0, c.bound));
  }
  for (std::uint32_t i = 0; i < scratch_.problem_movable; ++i) {
    const std::uint32_t slot = scratch_.problem_slot[i];
    const SolverBody& solved = problem.bodies[i];
    given_up += 0.5 * step.h * masses_[slot].mass * acceleration_of(slot).dot(solved.v - solved.v0);
    allowed += kRounding * std::abs(motions_[slot].L.dot(motions_[slot].w));
  }
  const double least = work - given_up;
  double share = 1.0;
  for (int trial = 0; trial < kTrials; ++trial) {
    const double gain = work + turning_gain(share, step) - (1.0 - share) * given_up;
    if (gain <= allowed) return share;
    if (least >= kInside * allowed) break;
    share *= (kInside * allowed - least) / (gain - least);
  }
  return 0.0;
}

/// What the drift adds to L.w/2 of all bodies while L goes from its start to its end [J].
double World::turning_gain(double share, const StepContext& step) const {
  double gain = 0.0;
  for (std::uint32_t i = 0; i < scratch_.problem_movable; ++i) {
    const std::uint32_t slot = scratch_.problem_slot[i];
    const MassProperties& mass = masses_[slot];
    if (mass.I.x() == mass.I.y() && mass.I.y() == mass.I.z()) continue;
    const VelocityPath path = velocity_path(i, share);
    Motion moved = motions_[slot];
    step.integrate_in_contact(mass, path, step.h, moved);
    const Mat3& inv_I_W = scratch_.problem.bodies[i].inv_I_W;
    gain += 0.5 * path.L1.dot(moved.w - inv_I_W * path.L1);
    const Motion& start = motions_[scratch_.problem_slot[i]];
    gain -=
        0.5 * start.L.dot(start.w - scratch_.after_forces[i].w0);  // inertia of the middle: joint_step.cpp
  }
  return gain;
}

void World::move_body(std::uint32_t slot, const VelocityPath& path, const Vec3& shift, const Vec3& turn,
                      const StepContext& step) {
  const MassProperties& mass = masses_[slot];
  Motion& motion = motions_[slot];
  const Motion last_good = motion;
  if (step.ways_only) {
    scratch_.events.set_trajectory(slot, Trajectory(mass, motion, step.begin, step.begin + step.h, path,
                                                    step.integrate_in_contact, shift, turn));
    return;
  }
  step.integrate_in_contact(mass, path, step.h, motion);
  displace(mass, shift, turn, motion);
  if (!is_finite(motion)) contain(slot, last_good);
}

void World::contain(std::uint32_t slot, const Motion& last_good) {
  hold(slot, last_good);
  contained_.push_back(id(slot));
  ++counters_.non_finite_contained;
}

void World::hold(std::uint32_t slot, const Motion& at) {
  land(slot);
  Motion& motion = motions_[slot];
  motion = at;
  motion.v.setZero();
  motion.L.setZero();
  motion.w.setZero();
}

}  // namespace tumble
