// Joints of second order that do no work. Their arms are those of the middle of the step, turned by half of what the
// solution turns the bodies, so the problem is solved again with them until they stay: then they hold the mean velocity, and
// what they do to the energy is what rounding does. Where the step ends the velocities are projected on what the joints
// allow there, which takes a little energy and never gives any (projection methods: Hairer, Lubich, Wanner, Geometric
// Numerical Integration, section VII.2). World frame.
#include <algorithm>
#include <cmath>

#include "world/world.h"

namespace tumble {
namespace {

/// [m] by which an arm may still move.
constexpr double kArmStays = 1e-11;
/// [m/s] with which joints may part or close where a step ends.
constexpr double kJointHeld = 1e-12;

}  // namespace

bool World::refines_joints(const StepContext& step) const {
  const std::vector<ScalarRow>& rows = scratch_.problem.rows;
  return options_.joint_passes > 1 && solves_exactly(options_.solver) && !step.ways_only &&
         std::any_of(rows.begin(), rows.end(),
                     [](const ScalarRow& row) { return row.is_two_sided() && !row.is_soft(); });
}

/// Arms as the solved velocities have them in the middle, velocities as they were. False: no arm has moved.
bool World::update_joint_arms(const StepContext& step, const std::vector<SolverBody>& free) {
  ContactProblem& problem = scratch_.problem;
  double moved = 0.0;
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
    row = now;
    update_mass(problem, row);
  }
  if (moved <= kArmStays) return false;
  problem.bodies = free;
  return true;
}

void World::hold_joints(std::size_t island, const StepContext& part) {
  if (!refines_joints(part)) return;
  const Islands& islands = scratch_.islands;
  const auto contact_count = static_cast<std::uint32_t>(contacts_.all().size());
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
  double fastest = 0.0;
  for (ScalarRow& row : problem.rows) {
    row.lambda = 0.0;
    const Vec3 u = relative_velocity(problem.bodies[row.a], problem.bodies[row.b], row.rA, row.rB);
    fastest = std::max(fastest, std::abs(row.n.dot(u)));
  }
  if (fastest <= kJointHeld) return;
  prepare(problem, part.bounds);
  SolverSettings settings = part.solver_settings;
  settings.tolerance = std::min(settings.tolerance, kJointHeld);
  const SolverReport report = part.solve(problem, settings);
  count_solution(report);
  if (report.exact) store_blow();
}

}  // namespace tumble
