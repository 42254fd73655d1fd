// What the world says of itself: conserved quantities, violations, and what each stage did and skipped. Counters count
// from the world's creation; times belong to the caller's clock (the world has none).
#pragma once

#include <cstdint>

#include "collision/narrow_phase.h"
#include "math/types.h"

namespace tumble {

struct Counters {
  NarrowPhaseCounters narrow_phase;
  std::uint64_t boxes_renewed = 0;  ///< Broad-phase boxes that a body left.
  std::uint64_t bodies_stepped = 0, bodies_skipped_resting = 0;
  std::uint64_t bodies_skipped_flying = 0;  ///< Not visited while they met nobody.
  std::uint64_t pairs_skipped_clear = 0;    ///< Not looked at, since their flights keep them apart.
  std::uint64_t islands_solved = 0, islands_accepted = 0, islands_free = 0;
  std::uint64_t islands_smooth = 0;  ///< Of springs only, by collocation.
  std::uint64_t sweeps = 0;
  std::uint64_t solver_iterations = 0;  ///< Factorizations of the exact solver: interior point and Newton.
  std::uint64_t newton_steps = 0;       ///< Those of Newton's method.
  std::uint64_t exact_work = 0;         ///< Products of 6 x 6 blocks in them: what options.work_rate limits.
  std::uint64_t islands_exact = 0;  ///< Solved without sub-steps: by sweeps, Newton or the interior point.
  std::uint64_t patterns_kept = 0, patterns_made = 0;  ///< Patterns of factorization found again, and made.
  std::uint64_t solver_fallbacks = 0;                  ///< Islands without a trustworthy exact solution.
  std::uint64_t slides_ended = 0;                      ///< Within a step, at times of their own.
  std::uint64_t overlaps_removed = 0;  ///< Islands whose bodies were shifted apart at the end of their step.
  std::uint64_t overlap_steps = 0;     ///< Factorizations for that.
  std::uint64_t joint_passes = 0;      ///< Further solutions with arms of joints that the ones before moved.
  std::uint64_t taut_parts = 0;        ///< Parts of steps of islands whose joints pull hard.
  std::uint64_t landings = 0;          ///< Contacts that closed without restitution, likewise.
  std::uint64_t cuts_capped = 0;       ///< Steps of islands that were cut as often as they may be.
  std::uint64_t islands_by_midpoint = 0;  ///< Parts of steps with the forces of their middle.
  std::uint64_t impacts = 0;              ///< Pairs that struck.
  std::uint64_t impacts_capped = 0;       ///< Bodies and islands whose impacts reached the bound of a step.
  std::uint64_t impacts_micro = 0;        ///< Impacts below the threshold: resting contact from then on.
  std::uint64_t impacts_ended = 0;  ///< Bouncing that came to its end (all that was left fitted in the step).
  std::uint64_t impacts_clamped = 0;  ///< Restitution shortened, since it would have raised kinetic energy.
  std::uint64_t impacts_gained = 0;   ///< Impacts that raised kinetic energy beyond rounding: always 0.
  std::uint64_t impact_passes = 0;    ///< Reflections of simultaneous impacts.
  std::uint64_t impact_searches = 0,
                impact_looks = 0;             ///< Times of impact looked for; poses looked at for them.
  std::uint64_t impact_searches_bounded = 0;  ///< Searches that ended early, at their bound.
  std::uint64_t rests = 0, wakes = 0;
  std::uint64_t non_finite_contained = 0;  ///< Bodies held at their last good state.
};

/// Of the last step.
struct StepReport {
  std::uint32_t bodies_awake = 0, bodies_resting = 0;
  std::uint32_t pairs = 0, contacts = 0, islands = 0;
  double deepest_penetration = 0.0;  ///< [m], >= 0
  double max_residual = 0.0;         ///< [m/s]
  /// [J] by which overlaps were pushed apart. With inelastic contacts kinetic and potential energy rise by no more.
  double push_work = 0.0;
};

/// Sums over all movable bodies, about W's origin.
struct Conserved {
  double kinetic_energy = 0.0,
         potential_energy = 0.0;         ///< [J]; gravity (0 at the origin's height) and springs
  Vec3 momentum = Vec3::Zero();          ///< [N s]
  Vec3 angular_momentum = Vec3::Zero();  ///< [N m s]
};

/// Called at the border between stages, so that a caller with a clock can time them.
enum class Stage { commands, broad_phase, narrow_phase, islands, solve, report, count };

}  // namespace tumble
