// Pairs of shapes -> manifolds. One visible matrix of pair functions, one place that swaps A and B (narrow_phase.cpp).
// Sees shapes and poses, never bodies. Pipeline of one pair: motion bound against the cached gap, closed forms,
// cached-axis test, certified GJK, exact features, clipping.
#pragma once

#include <cstdint>

#include "collision/manifold.h"
#include "collision/shape.h"

namespace tumble {

/// What the pair remembers between steps. Part of the state (snapshots hold it): a cache decides which of two equal
/// optima is kept. Frame A is the frame of the pair's first shape.
struct PairCache {
  Vec3 axis_A = Vec3::Zero();    ///< Last separating axis, from A to B, unit; zero: none.
  double gap = 0.0;              ///< Certified lower bound of the distance at the last query [m]; <= 0: none.
  Vec3 p_AB = Vec3::Zero();      ///< Relative pose at the last query, for the motion bound.
  Quat q_AB = Quat::Identity();
  std::uint32_t feature = 0;     ///< Facet or axis that gave the last contact.
  std::uint32_t vertex_A = 0, vertex_B = 0;  ///< Start of hill climbing on hulls.
};

struct NarrowPhaseOptions {
  bool use_motion_bound = true;  ///< Off: every pair is queried again although it cannot have come near.
  bool use_cached_axis = true;   ///< Off: no early end on last step's separating axis.
  bool use_gjk = true;           ///< Off: straight to the exact features (same contacts, other cost).
};

/// Where pairs ended. Sums to `queries`, but for gjk_uncertified, which counts "apart" answers that had no proof.
struct NarrowPhaseCounters {
  std::uint64_t queries = 0, motion_bound = 0, cached_axis = 0, gjk = 0, exact = 0, closed_form = 0;
  std::uint64_t gjk_uncertified = 0, gjk_budget_hit = 0;
};

/// The manifold of shape A at X_WA and shape B at X_WB: every point with separation <= margin [m], none if the shapes
/// are further apart. Finite for any finite input; deterministic in (shapes, poses, cache).
Manifold collide(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB, double margin,
                 const NarrowPhaseOptions& options, PairCache& cache, NarrowPhaseCounters& counters);

}  // namespace tumble
