// What must hold of a contact, whatever the shapes: checked against itself and against supports in 20 000 directions.
#pragma once

#include <limits>
#include <string>

#include "shape_pair.h"

namespace tumble::test {

enum class Outcome { apart, touching, overlapping };

struct Verdict {
  std::string broken;  ///< The claim that does not hold, with values; empty: all hold.
  Outcome outcome = Outcome::apart;
};

Verdict check_contact(const ShapePair& pair);

}  // namespace tumble::test
