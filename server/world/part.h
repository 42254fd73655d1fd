// A step or a part of it, and what is noted of an island to take a trial back, to find its points of contact again once the
// bodies have moved, and to move it by the forces of the middle of a part. World frame.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "collision/manifold.h"
#include "dynamics/contact_problem.h"
#include "dynamics/integrator.h"
#include "dynamics/solver.h"

namespace tumble {

/// The options of a step made ready, and which part of it is meant.
struct StepContext {
  double h;  // [s]
  IntegrateFunction integrate;
  IntegrateFunction integrate_in_contact;
  SolveFunction solve;
  SolverSettings solver_settings;
  BoundSettings bounds;
  double whole = h;            // [s] of the step, where this is a part of it
  double begin = 0.0;          // [s] of this part of the step
  bool impact_events = false;  // times of impact are found
  bool ways_only = false;      // bodies get a trajectory through the step instead of being moved at once
  bool airborne = false;       // open contacts are left out of the problem: they do not close in this part
};

/// Of a movable body of a problem: what forces alone make of its momentum, and its inertia in W.
struct AfterForces {
  Vec3 L;
  Mat3 I_W;
  Vec3 w0;  ///< Of the momentum at the start of the step, by this inertia.
};

/// Where a row of a problem comes from: a contact and one of its points.
struct ContactSource {
  std::uint32_t contact, point;
};

/// What a trial changes of an island: its motions, its contacts, and its solved problem.
struct IslandState {
  struct Touching {
    Manifold manifold;
    Vec3 normal_W;
    Impulses impulse, moment;
  };
  std::vector<Motion> motions;     // of the problem's movable bodies
  std::vector<Touching> contacts;  // of the island, in its order
  ContactProblem problem;
  std::vector<ContactSource> contact_source;
  std::vector<AfterForces> after_forces;
  double residual = 0.0;
};

/// A row of a solved problem, to be found again when the bodies have moved.
struct Touch {
  std::uint32_t contact, feature;
  double gap;      // [m] at the start of the part
  Vec3 n, rA, rB;  // W
  Vec3 u0;         // velocity of b relative to a at the start of the part [m/s]
  bool open;       // apart, and on the way to meet if at all
  bool pressed;    // carries an impulse
  bool sticks;     // and friction has not reached its limit
};

/// How far an island was moved.
enum class Advance : std::uint8_t { none, part, whole };

/// A part of a step by the forces of its middle: from where, and to where.
struct Midpoint {
  std::vector<Touch> touches;       // at the start
  std::vector<VelocityPath> paths;  // by the forces of the start, through the rest of the step
  std::vector<Vec3> shifts, turns;  // [m], [rad] beyond the drift, likewise
  double h = 0.0;                   // of that rest [s]
  std::vector<Motion> ends;
  double push_work = 0.0;                      // [J]
  bool ends_slide = false;                     // of the points that slid at the start one would be sent back
  std::vector<std::size_t> ending;             // rows whose slide ends with the part
  double slip_before = 0.0, slip_after = 0.0;  // [m/s] of the point that is nearest to its end
};

}  // namespace tumble
