// The separating axis of two polytopes among all facets of their Minkowski difference: faces of A, faces of B, and pairs
// of edges whose arcs on the Gauss sphere cross (Gregorius, The Separating Axis Test, GDC 2013). In A's frame.
#pragma once

#include "collision/pair_cache.h"
#include "collision/polytope.h"

namespace tumble {

struct PolytopePair {
  const Polytope &a, &b;
  Mat3 R_AB;
  Vec3 p_AB;
};

struct Facet {
  enum class Kind : std::uint32_t { none, face_a, face_b, edges };
  Kind kind = Kind::none;
  std::uint32_t a = 0, b = 0;     ///< Face of A or B, or both edges.
  double separation = 0.0;        ///< [m]
  Vec3 normal_A = Vec3::UnitZ();  ///< Unit, from A to B.
};

struct FacetAnswer {
  Facet facet;
  /// As long as no point of B moves by more than a quarter of this in A's frame, the same facet wins [m]; < 0: it may
  /// not even win now, since one beyond the margin was enough.
  double lead = -1.0;
};

/// The facet that separates most (or, if one is beyond the margin, some such one). A function of the pose alone: facet,
/// axis and vertices remembered in the cache, which are updated, only save work.
FacetAnswer find_facet(const PolytopePair& pair, double margin, PairCache& cache);

/// The facet in the cache, evaluated at the pair's pose; kind none if there is none.
Facet recall_facet(const PolytopePair& pair, PairCache& cache);

}  // namespace tumble
