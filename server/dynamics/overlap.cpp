// See overlap.h. Newton's method on a convex, piecewise quadratic function: the quadratic of those that press now is
// minimized, and the step is shortened until the whole function falls. It ends at the exact minimum, mostly after two or
// three factorizations, since what carries an impulse is taken to press at first.
#include "dynamics/overlap.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "dynamics/velocity_system.h"

namespace tumble {
namespace {

/// [m] what is less is no overlap, and that many last digits of a coordinate.
constexpr double kOverlapTolerance = 1e-10, kDigits = 16.0 * 0x1p-52;
/// Stiffness over the mass that a contact moves, and over that of the whole island, which it may have to lift: the inverse
/// of the share of a gap that is left.
constexpr double kRigidity = 1e6, kLifting = 1e3;
/// [rad] longest turn: beyond it the gaps' linearization says nothing.
constexpr double kMostTurn = 0.2;
/// Of bodies that something immovable holds up none weighs more than so many times the lightest: by kinetic energy a light
/// one goes any way before one of a million times its mass is lifted, up to being drawn out of the tower that it carries.
constexpr double kHeaviest = 10.0;
constexpr int kMostSteps = 20;
constexpr double kLeastShare = 1e-3;  // of the way to a target

struct Gap {
  Coupling joins;
  double lacks;  // d [m]
  double stiffness;
  bool two_sided;
  bool presses;
};

class Projection {
 public:
  Projection(ContactProblem& problem, std::shared_ptr<const BlockPattern> pattern, double most);
  OverlapReport solve();

 private:
  void add_contact(const PointContact& c);
  void add_row(const ScalarRow& row);
  double stiffness(double mass) const { return kRigidity * std::min(mass, mass_) + kLifting * mass_; }
  double missing(const Gap& gap, const std::vector<Vec6>& dx) const;
  bool find_target();
  double energy(const std::vector<Vec6>& dx) const;
  double step_to_target(double& least);
  bool update_pressing();
  void store(OverlapReport& report);

  ContactProblem& problem_;
  VelocitySystem system_;
  double mass_ = 0.0;  // [kg] of all bodies
  const double most_;  // [m] a gap is corrected by
  std::vector<Gap> gaps_;
  std::vector<Vec6> dx_, target_, trial_;  // by position
};

double largest_coordinate(const ContactProblem& problem) {
  double largest = 0.0;
  for (const SolverBody& body : problem.bodies) largest = std::max(largest, body.x.cwiseAbs().maxCoeff());
  return largest;
}

double tolerance_of(const ContactProblem& problem) {
  return kOverlapTolerance + kDigits * largest_coordinate(problem);
}

/// [m] at the end of the step, by the velocities.
double end_gap(const ContactProblem& problem, const PointContact& c) {
  return c.separation + problem.h * drift_speed(problem, c);
}

bool overlaps(const ContactProblem& problem) {
  const double tolerance = tolerance_of(problem);
  const auto overlapped = [&](const PointContact& c) {
    return c.mass_n > 0.0 && c.separation < -tolerance && end_gap(problem, c) < -tolerance;
  };
  const auto apart = [&](const ScalarRow& row) {
    return row.mass > 0.0 && row.is_two_sided() && row.closing == 0.0 && std::abs(row.gap) > tolerance;
  };
  return std::any_of(problem.contacts.begin(), problem.contacts.end(), overlapped) ||
         std::any_of(problem.rows.begin(), problem.rows.end(), apart);
}

bool is_held(const ContactProblem& problem) {
  const auto holds = [&](const auto& joins) {
    return problem.bodies[joins.a].inv_mass == 0.0 || problem.bodies[joins.b].inv_mass == 0.0;
  };
  return std::any_of(problem.contacts.begin(), problem.contacts.end(), holds) ||
         std::any_of(problem.rows.begin(), problem.rows.end(), holds);
}

Projection::Projection(ContactProblem& problem, std::shared_ptr<const BlockPattern> pattern, double most)
    : problem_(problem), system_(problem, std::move(pattern)), most_(most) {
  mass_ = system_.limit_masses(is_held(problem) ? kHeaviest : kInfinity);
  gaps_.reserve(problem.contacts.size() + problem.rows.size());
  for (const PointContact& c : problem.contacts) {
    if (c.mass_n > 0.0) add_contact(c);
  }
  for (const ScalarRow& row : problem.rows) {
    if (row.mass > 0.0 && !row.is_soft()) add_row(row);
  }
  dx_.assign(system_.size(), Vec6::Zero());
}

void Projection::add_contact(const PointContact& c) {
  const double lacks = std::min(most_, -end_gap(problem_, c));
  gaps_.push_back({.joins = system_.make_coupling(c),
                   .lacks = lacks,
                   .stiffness = stiffness(c.mass_n),
                   .two_sided = false,
                   .presses = lacks > 0.0 || c.lambda.x() > 0.0});
}

void Projection::add_row(const ScalarRow& row) {
  const bool joint = row.is_two_sided();                   // else a rope, which gets no longer
  const double left = row.closing == 0.0 ? row.gap : 0.0;  // by the velocities
  const double gap = joint ? std::clamp(-left, -most_, most_) : std::min(0.0, -row.gap);
  gaps_.push_back({.joins = system_.make_coupling(row),
                   .lacks = gap,
                   .stiffness = stiffness(row.mass),
                   .two_sided = joint,
                   .presses = joint || row.lambda > 0.0});
}

/// d - J dx [m].
double Projection::missing(const Gap& gap, const std::vector<Vec6>& dx) const {
  return gap.lacks - system_.velocity(gap.joins, dx).x();
}

/// The minimum of the quadratic of those that press.
bool Projection::find_target() {
  system_.set_mass();
  target_.assign(dx_.size(), Vec6::Zero());
  Mat3 G = Mat3::Zero();
  for (const Gap& gap : gaps_) {
    if (!gap.presses) continue;
    G(0, 0) = gap.stiffness;
    system_.add_stiffness(gap.joins, G);
    system_.add_impulse(gap.joins, Vec3(gap.stiffness * gap.lacks, 0.0, 0.0), target_);
  }
  if (!system_.factorize()) return false;
  system_.solve(target_);
  return true;
}

double Projection::energy(const std::vector<Vec6>& dx) const {
  double sum = 0.0;
  for (std::size_t i = 0; i < dx.size(); ++i) sum += 0.5 * dx[i].dot(system_.momentum(i, dx[i]));
  for (const Gap& gap : gaps_) {
    const double lacks = missing(gap, dx);
    if (gap.two_sided || lacks > 0.0) sum += 0.5 * gap.stiffness * lacks * lacks;
  }
  return sum;
}

/// False if the same press as before.
bool Projection::update_pressing() {
  bool changed = false;
  for (Gap& gap : gaps_) {
    const bool presses = gap.two_sided || missing(gap, dx_) > 0.0;
    changed = changed || presses != gap.presses;
    gap.presses = presses;
  }
  return changed;
}

/// Halves the way to the target until the energy falls below `least`; 0 if it does not.
double Projection::step_to_target(double& least) {
  for (double share = 1.0; share > kLeastShare; share *= 0.5) {
    trial_ = dx_;
    for (std::size_t k = 0; k < dx_.size(); ++k) trial_[k] += share * (target_[k] - dx_[k]);
    const double found = energy(trial_);
    if (!(found < least)) continue;
    least = found;
    std::swap(dx_, trial_);
    return share;
  }
  return 0.0;
}

OverlapReport Projection::solve() {
  OverlapReport report;
  double least = energy(dx_);
  while (report.factorizations < kMostSteps) {
    ++report.factorizations;
    if (!find_target()) break;
    const double share = step_to_target(least);
    const bool changed = update_pressing();
    // Those that carry an impulse were taken to press at first: if that leads nowhere, those that overlap are.
    if (share == 0.0 && (report.factorizations > 1 || !changed)) break;
    if (share == 1.0 && !changed) break;
  }
  store(report);
  return report;
}

void Projection::store(OverlapReport& report) {
  double turn = 0.0;
  for (const Vec6& dx : dx_) turn = std::max(turn, dx.tail<3>().norm());
  const double share = turn > kMostTurn ? kMostTurn / turn : 1.0;
  for (std::size_t i = 0; i < problem_.bodies.size(); ++i) {
    SolverBody& body = problem_.bodies[i];
    if (body.inv_mass == 0.0) continue;
    const Vec6& dx = dx_[system_.position(i)];
    body.shift += share * dx.head<3>();
    body.turn += share * dx.tail<3>();
    report.largest = std::max(report.largest, share * (dx.head<3>().norm() + dx.tail<3>().norm()));
  }
}

}  // namespace

OverlapReport remove_overlaps(ContactProblem& problem, const OverlapSettings& settings) {
  if (!overlaps(problem)) return {};
  auto pattern = VelocitySystem::find_pattern(problem, settings.work);
  if (!pattern) return {};
  return Projection(problem, std::move(pattern), settings.speed * problem.h).solve();
}

}  // namespace tumble
