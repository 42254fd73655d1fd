// The list of stress cases: one list for the test program (short) and for `./run stress` (whole, every way). A family of
// cases has a file. Each case says in words what must hold, who promises it, and measures it.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "stability/trial.h"

namespace tumble::stability {

struct Case {
  std::string name;                 ///< One word: what --case takes.
  std::string claim;                ///< What must hold.
  Claimants claimants;              ///< Nobody: what is wanted and not held yet by any way.
  std::function<void(Trial&)> act;  ///< Builds, runs and expects.
  bool own_steps = false;  ///< Goes through steps of its own: of the ways only those of 1/240 s count.
  bool costly = false;     ///< The test program leaves the other ways than the default to `./run stress`.
};

std::vector<Case> standing_cases();   // standing.cpp
std::vector<Case> structure_cases();  // structures.cpp
std::vector<Case> heap_cases();       // heaps.cpp
std::vector<Case> slope_cases();      // slopes.cpp
std::vector<Case> overlap_cases();    // overlaps.cpp
std::vector<Case> impact_cases();     // impacts.cpp
std::vector<Case> jam_cases();        // jams.cpp
std::vector<Case> extreme_cases();    // extremes.cpp
std::vector<Case> change_cases();     // changes.cpp
std::vector<Case> joint_cases();      // joints.cpp

/// Every case, family by family. Names are unique.
std::vector<Case> all_cases();

/// Tries the case one way. A check that fails is no exception; TooSlow is one.
std::vector<Check> try_case(const Case& stress, const Way& way, const Extent& extent);

}  // namespace tumble::stability
