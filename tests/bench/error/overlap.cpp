// See overlap.h.
#include "error/overlap.h"

#include <algorithm>

#include "collision/narrow_phase.h"

namespace tumble::bench {

double deepest_overlap(const std::vector<Solid>& solids, const std::vector<Motion>& motions) {
  std::vector<Pose> poses;
  std::vector<Aabb> boxes;
  std::size_t next = 0;
  for (const Solid& solid : solids) {
    if (solid.dynamic) {
      poses.push_back({motions[next].q, motions[next].x});
      ++next;
    } else {
      poses.push_back(solid.X_WS);
    }
    boxes.push_back(compute_aabb(solid.shape, poses.back()));
  }
  double depth = 0.0;
  NarrowPhaseCounters counters;
  for (std::size_t i = 0; i < solids.size(); ++i) {
    for (std::size_t j = i + 1; j < solids.size(); ++j) {
      if (!(solids[i].dynamic || solids[j].dynamic) || !boxes[i].overlaps(boxes[j])) continue;
      PairCache cache;
      depth = std::max(depth, deepest(collide(solids[i].shape, poses[i], solids[j].shape, poses[j], 0.0, {},
                                              cache, counters)));
    }
  }
  return depth;
}

}  // namespace tumble::bench
