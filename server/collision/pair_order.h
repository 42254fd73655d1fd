// Which of two shapes of one type is computed first. Decided from the data, not from the order of the call, so that A
// against B and B against A are the same computation and give the same contact, seen from the other side, to the bit.
#pragma once

#include "collision/shape.h"

namespace tumble {

/// True if B comes first: the larger shape does; of equal ones that which lies further back along a fixed direction, of
/// coinciding ones that with the smaller orientation. False for two equal shapes at one pose, which nothing tells apart.
/// Both shapes have the same type.
bool comes_second(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB);

}  // namespace tumble
