// Every stress case in short, the default way and the others that promise it; `./run stress` runs them every way, and whole.
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <ostream>

#include "stability/case.h"

namespace tumble::stability {
namespace {

struct Attempt {
  Case stress;
  Way way;
  friend void PrintTo(const Attempt& attempt, std::ostream* out) { *out << attempt.stress.claim; }
};

std::vector<Way> tested_ways(const Case& stress) {
  if (stress.costly || stress.own_steps) return {Way{}};
  return {Way{}, Way{Solver::exact, 1.0 / 60.0}, Way{Solver::soft_step, 1.0 / 240.0},
          Way{Solver::pgs, 1.0 / 1000.0, Accuracy::exact}};
}

std::vector<Attempt> attempts() {
  std::vector<Attempt> all;
  for (const Case& stress : all_cases()) {
    for (const Way& way : tested_ways(stress)) {
      if (stress.claimants.include(way)) all.push_back({stress, way});
    }
  }
  return all;
}

class Stress : public ::testing::TestWithParam<Attempt> {};

TEST_P(Stress, Holds) {
  const auto& [stress, way] = GetParam();
  for (const Check& check : try_case(stress, way, {})) {
    EXPECT_LE(check.value, check.bound) << stress.claim << "\n" << describe(way) << ": " << check.what;
  }
}

std::string test_name(const ::testing::TestParamInfo<Attempt>& info) {
  std::string name = info.param.stress.name + "_" + describe(info.param.way);
  std::replace_if(
      name.begin(), name.end(), [](unsigned char c) { return std::isalnum(c) == 0; }, '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(Cases, Stress, ::testing::ValuesIn(attempts()), test_name);

}  // namespace
}  // namespace tumble::stability
