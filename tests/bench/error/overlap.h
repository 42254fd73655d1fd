// How deep solids overlap, wherever an engine has put them: by the closed forms of our narrow phase, every pair that is
// near looked at anew.
#pragma once

#include <vector>

#include "peers/solids.h"

namespace tumble::bench {

/// Deepest overlap of all pairs with a dynamic solid [m], >= 0; `motions` of the dynamic ones in order, all finite.
double deepest_overlap(const std::vector<Solid>& solids, const std::vector<Motion>& motions);

}  // namespace tumble::bench
