// See case.h.
#include "stability/case.h"

#include <iterator>

namespace tumble::stability {

std::vector<Case> all_cases() {
  std::vector<Case> all;
  for (const auto family : {standing_cases, structure_cases, heap_cases, slope_cases, overlap_cases,
                            impact_cases, jam_cases, extreme_cases, change_cases, joint_cases}) {
    std::vector<Case> cases = family();
    all.insert(all.end(), std::make_move_iterator(cases.begin()), std::make_move_iterator(cases.end()));
  }
  return all;
}

std::vector<Check> try_case(const Case& stress, const Way& way, const Extent& extent) {
  Trial trial(way, extent);
  stress.act(trial);
  return trial.finish();
}

}  // namespace tumble::stability
