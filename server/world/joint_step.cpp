// Joints of second order that do no work. Their arms are the mean of those at both ends of the step, and moments of inertia
// those of its middle, as the solution turns the bodies; so the problem is solved again with them until they stay, and the
// joints hold the mean velocities. Where the step ends their gaps are closed and the velocities projected on what they
// allow there, which takes a little energy and never gives any (Hairer, Lubich, Wanner, Geometric Numerical Integration:
// the implicit midpoint rule, and the projection methods of chapter IV.4). World frame.
#include <algorithm>
#include <cmath>

#include "math/rotation.h"
#include "world/world.h"

namespace tumble {
namespace {

/// [m, rad] by which an arm or what a body turns may still change.
constexpr double kStays = 1e-11;

}  // namespace

bool World::refines_joints() const {
  const std::vector<ScalarRow>& rows = scratch_.problem.rows;
  return may_refine_joints() && std::any_of(rows.begin(), rows.end(), [](const ScalarRow& row) {
           return row.is_two_sided() && !row.is_soft();
         });
}

/// Moments of inertia and arms as the solved velocities have them in the middle, velocities as they were, held so that their
/// mean is. False: nothing has moved.
bool World::update_joint_arms(const StepContext& step, std::vector<SolverBody>& free) {
  ContactProblem& problem = scratch_.problem;
  double moved = 0.0;
  for (std::uint32_t i = 0; i < scratch_.problem_movable; ++i)
    moved = std::max(moved, step.h * turn_inertia(i, step.h, free[i]));
  for (std::size_t i = 0; i < problem.rows.size(); ++i) {
    ScalarRow& row = problem.rows[i];
    const Scratch::RowSource source = scratch_.row_source[i];
    const Joint* joint = std::get_if<Joint>(&ties_[source.tie].law);
    if (joint == nullptr) continue;
    ScalarRow now = make_joint_row(joint->held[source.row], row.a, row.b, problem.bodies[row.a],
                                   problem.bodies[row.b], step.h, step.bounds);
    moved =
        std::max({moved, (now.rA - row.rA).cwiseAbs().maxCoeff(), (now.rB - row.rB).cwiseAbs().maxCoeff()});
    now.lambda = row.lambda;
    now.bound = -now.n.dot(relative_start_velocity(free[row.a], free[row.b], now.rA, now.rB));
    row = now;
  }
  if (moved <= kStays) return false;
  problem.bodies = free;
  prepare(problem, step.bounds);
  return true;
}

/// Angular momenta stay, so that the mean angular velocity is that of the mean momentum in the middle. Returns by how much
/// that of the start changes [rad/s].
double World::turn_inertia(std::uint32_t i, double h, SolverBody& free) {
  const SolverBody& solved = scratch_.problem.bodies[i];
  const std::uint32_t slot = scratch_.problem_slot[i];
  const MassProperties& mass = masses_[slot];
  AfterForces& after = scratch_.after_forces[i];
  const Vec3 L0 = after.I_W * free.w0, L = after.I_W * free.w, w0 = free.w0;
  const Quat middle = normalized(exp_map(0.25 * h * (solved.w0 + solved.w)) * free.q);
  free.inv_I_W = world_inertia(mass.inv_I, mass.q_BP, middle);
  after.I_W = world_inertia(mass.I, mass.q_BP, middle);
  free.w0 = free.inv_I_W * L0;
  free.w = free.inv_I_W * L;
  after.w0 = free.inv_I_W * motions_[slot].L;
  return (free.w0 - w0).cwiseAbs().maxCoeff();
}

void World::hold_joints(std::size_t island, const StepContext& part) {
  if (!part.ways_only && refines_joints()) project_joints(island, part);
}

void World::project_joints(std::size_t island, const StepContext& part) {
  build_joint_problem(island, part);
  if (scratch_.problem.rows.empty()) return;
  if (close_joints(part)) build_joint_problem(island, part);
  ContactProblem& problem = scratch_.problem;
  double fastest = 0.0;
  for (const ScalarRow& row : problem.rows) {
    const Vec3 u = relative_velocity(problem.bodies[row.a], problem.bodies[row.b], row.rA, row.rB);
    fastest = std::max(fastest, std::abs(row.n.dot(u)));
  }
  if (fastest <= kHeld) return;
  if (solve(part, kHeld).exact) store_blow();
}

/// The joints of the island alone, as they are now.
void World::build_joint_problem(std::size_t island, const StepContext& part) {
  const Islands& islands = scratch_.islands;
  const auto contact_count = static_cast<std::uint32_t>(contacts_.size());
  StepContext instant = part;
  instant.h = 0.0;
  begin_problem(instant.h);
  for (std::uint32_t i = islands.body_begin[island]; i < islands.body_begin[island + 1]; ++i)
    problem_body(islands.bodies[i], instant.h);
  for (std::uint32_t i = islands.edge_begin[island]; i < islands.edge_begin[island + 1]; ++i) {
    const std::uint32_t source = scratch_.edge_source[islands.edges[i]];
    if (source >= contact_count && std::holds_alternative<Joint>(ties_[source - contact_count].law))
      add_tie_rows(source - contact_count, instant);
  }
  end_problem();
  ContactProblem& problem = scratch_.problem;
  problem.h = options_.time_step;
  for (ScalarRow& row : problem.rows) row.lambda = 0.0;
  prepare(problem, part.bounds);
}

/// Takes the gaps of the joints back, without a velocity. False: there are none.
bool World::close_joints(const StepContext& part) {
  shift_apart(part);
  if (scratch_.shifted == 0.0) return false;
  count_shifts();
  for (std::uint32_t i = 0; i < scratch_.problem_movable; ++i) {
    const std::uint32_t slot = scratch_.problem_slot[i];
    const SolverBody& body = scratch_.problem.bodies[i];
    displace(masses_[slot], body.shift, body.turn, motions_[slot]);
  }
  return true;
}

}  // namespace tumble
