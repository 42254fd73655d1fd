// A way to step a world: solver, step and accuracy. The stress table has a column for each, a case says who promises it.
#pragma once

#include <string>
#include <vector>

#include "world/options.h"

namespace tumble::stability {

struct Way {
  Solver solver = Solver::automatic;
  double time_step = 1.0 / 240.0;  ///< [s]
  Accuracy accuracy = Accuracy::balanced;
};

Options options_of(const Way& way);
const char* accuracy_name(Accuracy accuracy);
/// "soft_step 1/60 fast"
std::string describe(const Way& way);
/// "1/60", or seconds where the step is no such fraction.
std::string describe_step(double time_step);

/// Every solver with every step of 1/60, 1/240, 1/1000 s; at every level of accuracy if `full`, else only at 1/240 s.
std::vector<Way> all_ways(bool full);

/// Who promises a case.
struct Claimants {
  std::vector<Solver> solvers;
  double longest_step = 0.1;  ///< [s]
  Accuracy coarsest = Accuracy::fast;
  bool include(const Way& way) const;
};

/// Solvers whose solution is the law of contact to rounding, if they may iterate to it.
inline Claimants precise(double longest_step = 0.1) {
  return {{Solver::automatic, Solver::exact}, longest_step, Accuracy::balanced};
}
/// What a world does as it comes.
inline Claimants by_default(double longest_step = 0.1) {
  return {{Solver::automatic}, longest_step, Accuracy::balanced};
}
/// The precise ones and the sub-steps, which large islands get.
inline Claimants sturdy(double longest_step = 0.1) {
  return {{Solver::automatic, Solver::exact, Solver::soft_step}, longest_step};
}
inline Claimants nobody() {
  return {};
}
/// All but the scheme of the course, which is there to be compared with.
inline Claimants engines(double longest_step = 0.1) {
  return {{Solver::automatic, Solver::exact, Solver::soft_step, Solver::pgs, Solver::nncg}, longest_step};
}
inline Claimants everyone(double longest_step = 0.1) {
  return {{Solver::automatic, Solver::exact, Solver::soft_step, Solver::pgs, Solver::nncg,
           Solver::course_impulse},
          longest_step};
}

}  // namespace tumble::stability
