// Sub-steps with soft contacts and a relax pass (TGS-soft; Macklin et al. 2019 "Small steps", Catto 2023 "Solver2D").
// Each sub-step: forces, stored impulses, one sweep with the overlap as a spring of given frequency and damping, move,
// one sweep without it, so that the push leaves no speed behind. Directions and arms stay those of the start pose.
// Restitution is not in here: resolve_impacts comes before. Stored impulses are those of whole steps: the sum over the
// sub-steps, so v = v* + M^-1 J^T lambda holds as for every solver.
#include <numbers>

#include "dynamics/force_spring.h"
#include "dynamics/solver.h"
#include "dynamics/sweep.h"
#include "math/rotation.h"

namespace tumble {
namespace {

constexpr double kMostSoftSubSteps =
    400.0;  // the longest step allowed, 0.1 s, by the sub-step of the exact level
constexpr double kSweepRounding = 1e-9;  // of a step that is meant to be a whole number of sub-steps
constexpr double kPushSpeed = 3.0;       // [m/s] as BoundSettings::push_speed by default

/// A damped spring of the contact's own mass, discretised implicitly.
struct Softness {
  double rate, scale, give;  // [1/s], 1, 1

  Softness(double frequency, double damping, double h) {
    const double omega = 2.0 * std::numbers::pi * frequency;
    const double a1 = 2.0 * damping + h * omega, a2 = h * omega * a1, a3 = 1.0 / (1.0 + a2);
    rate = omega / a1;
    scale = a2 * a3;
    give = a3;
  }
};

/// Contact frequency an eighth of the sub-step rate, overdamped. Against immovable bodies twice as stiff.
struct SoftPair {
  Softness between, against_fixed;
  explicit SoftPair(double h) : between(0.125 / h, 10.0, h), against_fixed(0.25 / h, 5.0, h) {}
};

class SoftStep {
 public:
  SoftStep(ContactProblem& problem, int sub_steps);
  void solve();

 private:
  struct BodyPath {
    SweptBody kick;                    // one sub-step of forces
    Vec3 turned = Vec3::Zero();        // sum of h w
    Quat rotation = Quat::Identity();  // product of the turns
  };
  /// Since the start of the step: how far the centre has moved, and R - 1 by columns.
  struct Displacement {
    Lanes moved, x, y, z;

    Lanes::Four of(const Vec3& r) const { return moved.e + (r.x() * x.e + r.y() * y.e + r.z() * z.e); }
  };
  struct ContactPath {
    double separation;
    Vec3 rA, rB;
    double l_n = 0.0, l_1 = 0.0, l_2 = 0.0;  // sums over the sub-steps
  };
  struct RowPath {
    double moved = 0.0;  // along n
    double l = 0.0;
  };

  void kick_and_warm_start();
  void sweep(bool push);
  void soften_rows(double share);
  void move();
  void add_impulses();
  void store();
  void store_way();
  double power() const;
  void take_gain_back(double power_before);
  double gap(const SweptContact& c, const ContactPath& path) const;

  ContactProblem& problem_;
  const int sub_steps_;
  const double h_;
  const SoftPair soft_;
  /// Nothing can close within the step: the midpoint rule of the springs may be followed exactly.
  const ContactProblem::Drift drift_;
  Sweep sweep_;
  std::vector<BodyPath> bodies_;
  std::vector<Displacement> displaced_;
  std::vector<ContactPath> contacts_;
  std::vector<RowPath> rows_;
  std::vector<Vec3> moments_;     // of the turnings, sums over the sub-steps
  std::vector<SweptBody> start_;  // of the sub-step
};

bool only_springs(const ContactProblem& problem) {
  return problem.contacts.empty() && std::all_of(problem.rows.begin(), problem.rows.end(),
                                                 [](const ScalarRow& row) { return row.is_soft(); });
}

SoftStep::SoftStep(ContactProblem& problem, int sub_steps)
    : problem_(problem),
      sub_steps_(sub_steps),
      h_(problem.h / sub_steps),
      soft_(h_),
      drift_(only_springs(problem) ? ContactProblem::Drift::average : ContactProblem::Drift::end),
      sweep_(make_sweep(problem)),
      displaced_(problem.bodies.size()),
      rows_(sweep_.rows.size()),
      moments_(sweep_.turnings.size(), Vec3::Zero()) {
  const double share = 1.0 / sub_steps;
  for (std::size_t i = 0; i < problem.bodies.size(); ++i) {
    const SolverBody& body = problem.bodies[i];
    bodies_.push_back({{Lanes(share * (body.v - body.v0)), Lanes(share * (body.w - body.w0))}});
    sweep_.bodies[i] = {Lanes(body.v0), Lanes(body.w0)};
  }
  for (const PointContact& c : problem.contacts) {
    if (c.mass_n > 0.0) contacts_.push_back({c.separation, c.rA, c.rB});
  }
  for (SweptContact& c : sweep_.contacts) {
    c.l_n *= share;
    c.l_1 *= share;
    c.l_2 *= share;
  }
  for (SweptRow& row : sweep_.rows) row.l *= share;
  for (SweptTurning& turning : sweep_.turnings) turning.law.lambda *= share;
}

void SoftStep::kick_and_warm_start() {
  start_ = sweep_.bodies;
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    sweep_.bodies[i].v.e += bodies_[i].kick.v.e;
    sweep_.bodies[i].w.e += bodies_[i].kick.w.e;
  }
  for (const SweptRow& row : sweep_.rows) {
    row.n.apply(row.l, row.inv_mass_A, row.inv_mass_B, sweep_.bodies[row.a], sweep_.bodies[row.b]);
  }
  for (const SweptContact& c : sweep_.contacts) {
    SweptBody &A = sweep_.bodies[c.a], &B = sweep_.bodies[c.b];
    apply(c, c.l_n, c.l_1, c.l_2, A, B);
  }
  for (const SweptTurning& turning : sweep_.turnings) {
    const SweptContact& c = sweep_.contacts[turning.contact];
    const Vec3& l = turning.law.lambda;
    turning.n.apply(l.x(), 0.0, 0.0, sweep_.bodies[c.a], sweep_.bodies[c.b]);
    turning.t1.apply(l.y(), 0.0, 0.0, sweep_.bodies[c.a], sweep_.bodies[c.b]);
    turning.t2.apply(l.z(), 0.0, 0.0, sweep_.bodies[c.a], sweep_.bodies[c.b]);
  }
}

/// Springs from their length at the start of the sub-step; ropes from the way that is left; joints
/// from their bound at the end of the step, `share` of which is over with this sub-step.
void SoftStep::soften_rows(double share) {
  auto swept = sweep_.rows.begin();
  auto path = rows_.begin();
  for (const ScalarRow& given : problem_.rows) {
    if (given.mass == 0.0) continue;
    if (given.is_soft()) {
      ScalarRow row = given;
      soften_row(row, h_, given.extension + path->moved,
                 swept->n.velocity(start_[swept->a], start_[swept->b]), drift_);
      swept->softness = row.softness;
      swept->bias = row.bias;
    } else if (given.is_two_sided()) {
      // With arms fixed at the middle of the step, what turns has the opposite speed at its start as at its end.
      const double closing = -std::clamp(given.gap / problem_.h, -kPushSpeed, kPushSpeed);
      swept->bound = closing + (2.0 * share - 1.0) * (given.bound - given.closing);
    } else if (given.bound <= 0.0) {
      swept->bound = -std::max(0.0, -given.bound * problem_.h + path->moved) / h_;
    }
    ++swept;
    ++path;
  }
}

double SoftStep::gap(const SweptContact& c, const ContactPath& path) const {
  const Lanes::Four along = c.n.d.e * (displaced_[c.b].of(path.rB) - displaced_[c.a].of(path.rA));
  return path.separation + ((along[0] + along[1]) + (along[2] + along[3]));
}

void SoftStep::sweep(bool push) {
  for (SweptRow& row : sweep_.rows) visit_row(row, sweep_.bodies[row.a], sweep_.bodies[row.b]);
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    SweptContact& c = sweep_.contacts[i];
    const double s = gap(c, contacts_[i]);
    NormalRule rule{.push = 0.0};
    if (s > 0.0) {
      rule.push = s / h_;
    } else if (push) {
      const bool fixed = c.inv_mass_A == 0.0 || c.inv_mass_B == 0.0;
      const Softness& soft = fixed ? soft_.against_fixed : soft_.between;
      rule = {
          .push = std::max(soft.scale * soft.rate * s, -kPushSpeed), .scale = soft.scale, .give = soft.give};
    }
    SweptBody &A = sweep_.bodies[c.a], &B = sweep_.bodies[c.b];
    visit_contact(c, rule, A, B);
  }
  visit_turnings(sweep_);
}

void SoftStep::move() {
  const double before = drift_ == ContactProblem::Drift::average ? 0.5 : 0.0, after = 1.0 - before;
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    BodyPath& path = bodies_[i];
    Displacement& displaced = displaced_[i];
    displaced.moved.e += h_ * (before * start_[i].v.e + after * sweep_.bodies[i].v.e);
    const Vec3 turn = h_ * (before * start_[i].w.vec3() + after * sweep_.bodies[i].w.vec3());
    path.turned += turn;
    const Quat half(0.0, 0.5 * turn.x(), 0.5 * turn.y(), 0.5 * turn.z());
    const Quat change = half * path.rotation;
    path.rotation = normalized(Quat(path.rotation.coeffs() + change.coeffs()));
    const Mat3 R = rotation_matrix(path.rotation);
    displaced.x = Lanes(R.col(0) - Vec3::UnitX());
    displaced.y = Lanes(R.col(1) - Vec3::UnitY());
    displaced.z = Lanes(R.col(2) - Vec3::UnitZ());
  }
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    const SweptRow& row = sweep_.rows[i];
    rows_[i].moved += h_ * (before * row.n.velocity(start_[row.a], start_[row.b]) +
                            after * row.n.velocity(sweep_.bodies[row.a], sweep_.bodies[row.b]));
  }
}

void SoftStep::add_impulses() {
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    contacts_[i].l_n += sweep_.contacts[i].l_n;
    contacts_[i].l_1 += sweep_.contacts[i].l_1;
    contacts_[i].l_2 += sweep_.contacts[i].l_2;
  }
  for (std::size_t i = 0; i < rows_.size(); ++i) rows_[i].l += sweep_.rows[i].l;
  for (std::size_t i = 0; i < moments_.size(); ++i) moments_[i] += sweep_.turnings[i].law.lambda;
}

/// The problem's velocities are still v* with nothing applied; so are its impulses made here.
void SoftStep::store() {
  for (ScalarRow& row : problem_.rows) row.lambda = 0.0;
  for (PointContact& c : problem_.contacts) c.lambda.setZero();
  for (Turning& turning : problem_.turnings) turning.lambda.setZero();
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    sweep_.contacts[i].l_n = contacts_[i].l_n;
    sweep_.contacts[i].l_1 = contacts_[i].l_1;
    sweep_.contacts[i].l_2 = contacts_[i].l_2;
  }
  for (std::size_t i = 0; i < rows_.size(); ++i) sweep_.rows[i].l = rows_[i].l;
  for (std::size_t i = 0; i < moments_.size(); ++i) sweep_.turnings[i].law.lambda = moments_[i];
  const double before = power();
  update_impulses(sweep_, problem_);
  store_way();
  take_gain_back(before);
}

void SoftStep::store_way() {
  const double before = drift_ == ContactProblem::Drift::average ? 0.5 : 0.0, after = 1.0 - before;
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    SolverBody& body = problem_.bodies[i];
    if (body.inv_mass == 0.0) continue;
    body.shift = displaced_[i].moved.vec3() - problem_.h * (before * body.v0 + after * body.v);
    body.turn = bodies_[i].turned - problem_.h * (before * body.w0 + after * body.w);
  }
  problem_.drift = drift_;
}

/// Sum p . u of the contacts at the velocities that the problem has now [J].
double SoftStep::power() const {
  double sum = 0.0;
  auto swept = contacts_.begin();
  for (const PointContact& c : problem_.contacts) {
    if (c.mass_n == 0.0) continue;
    const Vec3 u = relative_velocity(problem_.bodies[c.a], problem_.bodies[c.b], c.rA, c.rB);
    sum += in_world(c, Vec3(swept->l_n, swept->l_1, swept->l_2)).dot(u);
    ++swept;
  }
  return sum;
}

/// What turns by a radian in a sub-step meets forces on arms that it has long left. Where the contacts would give energy,
///   s a + s^2 (e - a)/2 > push,   a, e sums p . u before and after, s = 1,
/// beyond what pushes overlaps apart, their impulses are shortened to the s that gives none.
void SoftStep::take_gain_back(double power_before) {
  constexpr double kNoise = 1e-3;  // of a and e: relaxed contacts end a little off
  const double half = 0.5 * (power() - power_before);
  double push = kNoise * (std::abs(power_before) + std::abs(half));
  for (const PointContact& c : problem_.contacts)
    push += c.lambda.x() * std::min(kPushSpeed, std::max(0.0, -c.separation) / problem_.h);
  if (!(power_before + half > push) || !(half > 0.0)) return;
  const double share =
      (std::sqrt(power_before * power_before + 4.0 * half * push) - power_before) / (2.0 * half);
  const double taken = 1.0 - std::min(1.0, share);
  for (PointContact& c : problem_.contacts) {
    const Vec3 back = -taken * c.lambda;
    apply_impulse(problem_.bodies[c.a], problem_.bodies[c.b], c.rA, c.rB, in_world(c, back));
    c.lambda += back;
  }
  for (SolverBody& body : problem_.bodies) body.shift = body.turn = Vec3::Zero();
}

void SoftStep::solve() {
  for (int i = 0; i < sub_steps_; ++i) {
    kick_and_warm_start();
    soften_rows((i + 1.0) / sub_steps_);
    sweep(true);
    move();
    sweep(false);
    add_impulses();
  }
  store();
}

}  // namespace

SolverReport solve_soft_step(ContactProblem& problem, const SolverSettings& settings) {
  const double shortest = std::ceil(problem.h / settings.longest_sub_step - kSweepRounding);
  const int sub_steps = std::max(settings.sub_steps, static_cast<int>(std::min(shortest, kMostSoftSubSteps)));
  SoftStep(problem, sub_steps).solve();
  SolverReport report;
  report.sweeps = 2 * sub_steps;
  report.residual = compute_residual(problem);
  return report;
}

}  // namespace tumble
