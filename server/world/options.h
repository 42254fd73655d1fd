// Every knob of the engine: meaning, unit, reason of its default, cost of changing it. This file is the tuning manual.
#pragma once

#include <optional>
#include <string_view>

#include "collision/narrow_phase.h"
#include "dynamics/integrator.h"
#include "dynamics/rest.h"
#include "dynamics/solver.h"

namespace tumble {

enum class Accuracy { fast, balanced, exact };

struct Options {
  double time_step = 1.0 / 240.0;        ///< [s], 1e-6..0.1. Smaller: better contacts, proportionally slower.
  Vec3 gravity = Vec3(0.0, 0.0, -9.81);  ///< [m/s^2]
  Integrator integrator = Integrator::closed_form;
  Solver solver = Solver::automatic;

  // Collision
  double contact_margin = 0.02;  ///< [m] contacts start at this gap. Smaller: fewer rows, later warm start.
  double fat_margin = 0.05;      ///< [m] slack of broad-phase boxes. Larger: fewer renewals, more pairs.
  NarrowPhaseOptions narrow_phase;

  // Contact
  SolverSettings solver_settings;
  BoundSettings bounds = {.slop = 0.0, .push_fraction = 0.2, .push_speed = 3.0};
  /// [m] slop of pgs and nncg at least: unfinished sweeps chase an overlap they push at for ever. With 0 stacks of 5 to 20
  /// tremble at residuals of 1e-3..3e-2 m/s, with 1e-3 they settle to 1e-6.
  double sweep_slop = 1e-3;
  /// [m/s] impacts slower than it end the bouncing. 1e-4: a bounce of 5e-10 m, and a ball with C_r = 0.8 comes to rest
  /// within 0.1 ms of the limit of its bounces.
  double restitution_threshold = 1e-4;
  /// Impacts per body and step; what it meets in the rest of the step is resting contact. (Without events: per contact.)
  int max_impacts = 64;
  /// Off: restitution acts at the start of the step, on velocities alone, and fast bodies are held by their contacts'
  /// bounds. Always off with the solver and the integrators of the course, whose motion is no parabola.
  bool impact_events = true;
  /// Largest island, in movable bodies, whose slides end (stop, or turn into rolling) at their own time within a step; of
  /// larger ones they end with the step, which is wrong by mu g h^2/2 at most. Two or three solutions each. 0: none.
  int slide_bodies = 8;
  /// The same of contacts that close without restitution: the island's step is cut where they do. Larger islands close them
  /// at the end of the step. Three or four solutions each. 0: none.
  int landing_bodies = 8;
  /// Such cuts an island and step, those where bodies have turned far (midpoint_turn) included; what is left ends with the
  /// step.
  int max_cuts = 32;
  /// Largest island, in movable bodies, whose forces of contact are those of the middle of the step, as far as its motion
  /// is smooth: second order where arms or normals turn (a coin that rolls, a rod that falls). One or two solutions and two
  /// looks at its contacts more. 0: none, and the forces are those of the start of the step.
  int midpoint_bodies = 8;
  /// [rad] a body turns at most in a part of such a step; errors go with its square, cost with its inverse.
  double midpoint_turn = 0.05;
  /// [rad/s] Slides, landings and midpoints of islands of two movable bodies and more: only while nothing in them turns
  /// faster. What tumbles in a crowd strikes somebody soon, and then again: a heap that is dropped would spend most of its
  /// time on them, and its bodies dip into each other as much (./run bench error: heap).
  double crowd_turning = 3.0;
  /// Most parts into which the step of an island is cut whose joints or ropes pull so hard that what they hold swings by more
  /// than a radian in a step; uncut it would gain energy without bound. 1: never.
  int taut_parts = 64;
  /// Most times that an island with joints is solved for in a step, each with the arms that the solution before has in the
  /// middle; then the velocities are projected on what the joints allow. 1: by the forces alone and without projection.
  int joint_passes = 12;
  bool warm_start = true;  ///< Off: every solve starts from zero impulses.
  /// Off: patterns of factorization are made anew for every solve, with the same results.
  bool keep_patterns = true;

  /// Work of exact solutions that the solver `automatic` may take a simulated second, in products of 6 x 6 blocks (some
  /// 0.1 us each); what is not taken is saved up for a quarter of a second. What exceeds it is solved by soft_step. For a
  /// server that has to keep pace; counted, never timed, so the same on every machine. 0: no limit.
  double work_rate = 0.0;

  // Rest
  RestSettings rest;
  bool skip_resting = true;  ///< Off: resting islands are stepped like all others.

  // Flight
  /// Off: a body in free flight is visited at every step also while it can meet nobody, and so is a pair whose flights
  /// keep it apart. They move the same.
  bool skip_flying = true;
};

/// Options for a level of accuracy: budgets and tolerances together. dynamics/README.md says what each does and costs.
///   fast: warm starts from 1e-6 m/s on, only small islands exact, 4 sub-steps a step for the others; no landings cut, no
///         forces of the middle of the step.
///   balanced: the defaults.
///   exact: 1e-10 m/s, islands of up to a million products of blocks exact at any speed, sub-steps of 1/3840 s.
void set_accuracy(Options& options, Accuracy accuracy);
std::optional<Accuracy> accuracy_from_name(std::string_view name);

/// Empty if every field is in its range, else "field: reason (value)".
std::string check_options(const Options& options);

}  // namespace tumble
