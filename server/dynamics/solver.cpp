// The names of the solvers and their dispatch.
#include "dynamics/solver.h"

#include <array>

namespace tumble {
namespace {

struct Rival {
  Solver solver;
  const char* name;
  SolveFunction solve;
};

constexpr std::array<Rival, 6> kRivals{{
    {Solver::course_impulse, "course_impulse", &solve_course_impulse},
    {Solver::pgs, "pgs", &solve_pgs},
    {Solver::nncg, "nncg", &solve_nncg},
    {Solver::soft_step, "soft_step", &solve_soft_step},
    {Solver::exact, "exact", &solve_exact},
    {Solver::automatic, "automatic", &solve_automatic},
}};

const Rival& rival(Solver solver) {
  return kRivals[static_cast<std::size_t>(solver)];
}

static_assert(kRivals[static_cast<std::size_t>(Solver::automatic)].solver == Solver::automatic);

}  // namespace

SolveFunction solve_function(Solver solver) {
  return rival(solver).solve;
}

const char* solver_name(Solver solver) {
  return rival(solver).name;
}

std::optional<Solver> solver_from_name(std::string_view name) {
  for (const Rival& r : kRivals) {
    if (name == r.name) return r.solver;
  }
  return std::nullopt;
}

}  // namespace tumble
