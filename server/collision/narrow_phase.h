// Pairs of shapes -> manifolds. One visible matrix of pair functions, one place that swaps A and B (narrow_phase.cpp).
// Sees shapes and poses, never bodies. Pipeline of one pair: motion bound against the cached gap, closed forms,
// cached-axis test, certified GJK, exact features, clipping.
#pragma once

#include <cstdint>

#include "collision/manifold.h"
#include "collision/pair_cache.h"
#include "collision/shape.h"

namespace tumble {

struct NarrowPhaseOptions {
  bool use_kept_manifold =
      true;  ///< Off: a pair whose relative pose is the same to the bit is computed again.
  bool use_motion_bound = true;  ///< Off: every pair is queried again although it cannot have come near.
  bool use_cached_axis = true;   ///< Off: no early end on last step's separating axis.
  bool use_cached_facet =
      true;  ///< Off: every contact of hulls is searched afresh instead of kept while it leads.
  bool use_gjk =
      true;  ///< Off: straight to the exact features (same contacts, other cost), as boxes always go.
};

struct NarrowPhaseCounters {
  /// Where pairs ended; the last six add up to `queries`. A triangle of a surface and a body are a pair.
  std::uint64_t queries = 0, unmoved = 0, motion_bound = 0, cached_axis = 0, gjk = 0, exact = 0,
                closed_form = 0;
  /// On the way: "apart" answers of libccd without proof, runs stopped by the call budget, facets kept without
  /// search.
  std::uint64_t triangles = 0;  ///< Queries of which one side was a triangle of a surface.
  std::uint64_t gjk_uncertified = 0, gjk_budget_hit = 0, facet_kept = 0;
};

/// Makes `manifold` that of shape A at X_WA and shape B at X_WB: every point with separation <= margin [m], none if the
/// shapes are further apart. Finite for any finite input; deterministic in (shapes, poses, cache). If one of them is a
/// surface, `part` is the triangle of it that is meant. With a memory that is not new, `manifold` must be what the last
/// call with it left: it may still hold.
void update_manifold(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB, double margin,
                     const NarrowPhaseOptions& options, PairCache& cache, NarrowPhaseCounters& counters,
                     Manifold& manifold, std::uint32_t part = 0);

/// The same for those who keep no manifold.
Manifold collide(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB, double margin,
                 const NarrowPhaseOptions& options, PairCache& cache, NarrowPhaseCounters& counters,
                 std::uint32_t part = 0);

/// B in A. The difference of positions comes first: far from the origin it is exact, products with it are not.
Pose relative_pose(const Pose& X_WA, const Pose& X_WB);

/// What is said of (A, B) in A, said of (B, A) in B. Of `collide(A, B)` and `collide(B, A)`, each with a new memory, one
/// is the other turned round by this, to the bit.
void swap_shapes(Manifold& manifold, const Pose& X_AB);

}  // namespace tumble
