// The names of the solvers and their dispatch.
#include "dynamics/solver.h"

#include "dynamics/rival.h"

namespace tumble {
namespace {

constexpr std::array<Rival<Solver, SolveFunction>, 8> kSolvers{{
    {Solver::course_impulse, "course_impulse", &solve_course_impulse},
    {Solver::pgs, "pgs", &solve_pgs},
    {Solver::nncg, "nncg", &solve_nncg},
    {Solver::soft_step, "soft_step", &solve_soft_step},
    {Solver::alm_newton, "alm_newton", &solve_alm_newton},
    {Solver::interior_point, "interior_point", &solve_interior_point},
    {Solver::exact, "exact", &solve_exact},
    {Solver::automatic, "automatic", &solve_automatic},
}};

}  // namespace

SolveFunction solve_function(Solver solver) {
  return rival(kSolvers, solver).function;
}

bool solves_exactly(Solver solver) {
  return solver == Solver::alm_newton || solver == Solver::interior_point || solver == Solver::exact ||
         solver == Solver::automatic;
}

const char* solver_name(Solver solver) {
  return rival(kSolvers, solver).name;
}

std::optional<Solver> solver_from_name(std::string_view name) {
  return kind_from_name(kSolvers, name);
}

}  // namespace tumble
