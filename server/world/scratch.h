// What a step works with and forgets: kept in the world, so that a step allocates nothing after warm-up. World frame.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "collision/broad_phase.h"
#include "dynamics/island.h"
#include "dynamics/pattern_store.h"
#include "dynamics/smooth_motion.h"
#include "world/impact_events.h"
#include "world/part.h"

namespace tumble {

/// May be thrown away between any two steps.
struct Scratch {
  std::vector<Load> load;  // by slot, nothing between steps
  std::vector<std::uint32_t> loaded;
  std::vector<GeometryPair> pairs;
  std::vector<GeometryPair> whole_pairs, split_pairs;  // pairs as found; those of them with a surface
  std::vector<std::uint32_t> triangles;
  std::vector<std::uint32_t> near;  // geometries in the box of a flight
  std::vector<std::uint32_t> lost;  // contacts whose boxes came apart, or that are clear, ascending
  std::vector<IslandEdge> edges;
  std::vector<std::uint32_t> edge_source;  // contact index, or contacts().size() + tie index
  IslandBuilder builder;
  Islands islands;
  SmoothSystem smooth;
  ContactProblem problem;
  PatternStore patterns;
  std::vector<std::uint32_t> problem_slot;    // slot of each body of the problem
  std::vector<std::uint32_t> local;           // by slot: index in the problem, or none
  std::vector<ContactSource> contact_source;  // also of turnings, by their contacts
  struct RowSource {
    std::uint32_t tie, row;
  };
  std::vector<RowSource> row_source;
  std::vector<AfterForces> after_forces;  // of the problem's movable bodies, before the impulses
  ImpactEvents events;
  std::vector<std::uint32_t> flying;                    // contacts that may strike in this step
  std::vector<std::uint8_t> meets_flying;               // by slot: has one of them
  std::vector<std::vector<std::uint32_t>> contacts_of;  // by slot; filled at the first impact of a step
  bool contacts_indexed = false;
  std::vector<std::pair<std::uint32_t, Motion>> held;  // slots that pushes would carry beyond all numbers
  std::vector<SolverBody> free_bodies;                 // before joints are solved for
  std::vector<double> opened;                          // by contact of a taut island [m]
  std::vector<double> swing_square;                    // by body of the problem [1/s^2]
  double residual = 0.0;                               // [m/s] of the problem's solution
  IslandState part_start, landing_start;               // to go back to from a trial
  std::vector<Motion> way_starts;                      // of an island that goes its way undisturbed
  std::vector<std::uint32_t> island_contacts;
  double shifted = 0.0;               // [m + rad] longest way by which it takes its overlaps back
  double impulse_share = 1.0;         // of a whole step's impulses that the problem's are
  std::uint32_t problem_movable = 0;  // the first bodies of the problem; the rest are immovable partners
};

}  // namespace tumble
