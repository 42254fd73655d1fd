// Proof that an overlap is as deep as it looks along one direction, without looking along any other: a ball of that radius
// about the origin lies in A - B, so every way out is at least as long.
#pragma once

#include "collision/direction_descent.h"

namespace tumble {

/// True only if no direction separates the cores by more than `tolerance` [m] more than the optimum found.
bool is_proven(const ConvexPieces& a, const ConvexPieces& b, const CandidateDirection& optimum,
               double tolerance);

}  // namespace tumble
