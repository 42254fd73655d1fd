// See alm_newton.h. With y_n = l_n - m_n (u_n - b), y_t = l_t - m_t u_t, L = |y_t|, e = y_t/L, c = mu y_n/L (Alart,
// Curnier 1991), every contact is taken for what its y says and answers a change du of its velocity with new impulses
//   open  (y_n <= 0):       l = 0
//   stick (L <= mu y_n):    l = l_old - R m (u + du - b)          R large: the multipliers' step to u = b
//   slip:  l_n as in stick; l_t = mu l_n e - c/(1 - c) P (l_old + m_t du),   P = 1 - e e^T
// all of the form p0 - G du. A turning is taken likewise, within what the normal impulse of its contact allows now. The changes of v and l found together are scaled back until the law is met better.
#include "dynamics/alm_newton.h"

#include <algorithm>
#include <cmath>

namespace tumble {
namespace {

/// R: a step leaves the inverse of it of what a single contact lacks, times the ratio of the mass that it carries to its
/// own; and noise of 1e-16 R of the speeds. The first is right for nearly all; a step that does not help is followed by the
/// next, once towards less noise, once towards heavier loads.
constexpr double kRigidities[] = {1e6, 1e4, 1e8};
constexpr int kLineHalvings = 8;
constexpr int kMostStalls = 3;

struct Law {
  Coupling joins;
  enum class Kind { contact, half_line, line, spring, turning } kind;
  double bound, friction, mass_n, mass_t;
  double softness;          // spring
  Vec3* contact = nullptr;  // where the impulse goes: one of the two
  double* row = nullptr;
  Turning* turning = nullptr;
  std::size_t presses = 0;    // turning: the law of its contact
  Vec3 l, u, answer, dl, du;  // impulse, velocity; p0; changes of a step
  Mat3 G;
};

class AlmNewton {
 public:
  AlmNewton(ContactProblem& problem, VelocitySystem& system, double tolerance, BestImpulses& best);
  int solve(int max_iterations);

 private:
  void add_rows(ContactProblem& problem);
  void add_turnings(ContactProblem& problem);
  void load();
  void linearize(Law& law) const;
  void linearize_contact(Law& law) const;
  void linearize_turning(Law& law) const;
  static double defect(const Law& law, double step);
  double turning_defect(const Law& law, double step) const;
  double defect(double step) const;
  bool find_changes();
  double choose_step() const;
  void store(double step);

  VelocitySystem& system_;
  const double tolerance_;
  BestImpulses& best_;
  std::vector<Law> laws_;
  std::vector<Vec6> v_, dv_;
  double rigidity_ = kRigidities[0];
};

AlmNewton::AlmNewton(ContactProblem& problem, VelocitySystem& system, double tolerance, BestImpulses& best)
    : system_(system), tolerance_(tolerance), best_(best) {
  laws_.reserve(problem.contacts.size() + problem.rows.size() + problem.turnings.size());
  for (PointContact& c : problem.contacts) {
    if (c.mass_n == 0.0) continue;
    Law& law = laws_.emplace_back();
    law.joins = system.make_coupling(c);
    law.kind = Law::Kind::contact;
    law.friction = c.friction > kFrictionless ? c.friction : 0.0;
    law.bound = c.bound;
    law.mass_n = c.mass_n;
    law.mass_t = c.mass_t;
    law.contact = &c.lambda;
  }
  add_rows(problem);
  add_turnings(problem);
}

void AlmNewton::add_turnings(ContactProblem& problem) {
  for (Turning& turning : problem.turnings) {
    if (problem.contacts[turning.contact].mass_n == 0.0) continue;
    const auto presses = std::find_if(laws_.begin(), laws_.end(), [&](const Law& law) {
      return law.contact == &problem.contacts[turning.contact].lambda;
    });
    const auto index = static_cast<std::size_t>(presses - laws_.begin());
    Law& law = laws_.emplace_back();
    law.presses = index;
    law.joins = system_.make_coupling(turning);
    law.kind = Law::Kind::turning;
    law.mass_n = turning.mass_n;
    law.mass_t = turning.mass_t;
    law.turning = &turning;
  }
}

void AlmNewton::add_rows(ContactProblem& problem) {
  for (ScalarRow& row : problem.rows) {
    if (row.mass == 0.0) continue;
    Law& law = laws_.emplace_back();
    law.joins = system_.make_coupling(row);
    law.kind = row.is_soft()        ? Law::Kind::spring
               : row.is_two_sided() ? Law::Kind::line
                                    : Law::Kind::half_line;
    law.friction = 0.0;
    law.bound = row.is_soft() ? -row.bias : row.bound;
    law.mass_n = law.mass_t = row.mass;
    law.softness = row.softness;
    law.row = &row.lambda;
  }
}

/// The problem's impulses and the velocities that follow from them.
void AlmNewton::load() {
  system_.load_velocities(v_);
  for (Law& law : laws_) {
    law.l = law.contact ? *law.contact : law.turning ? law.turning->lambda : Vec3(*law.row, 0.0, 0.0);
    law.u = system_.velocity(law.joins, v_) + law.joins.offset;
  }
}

void AlmNewton::linearize_contact(Law& law) const {
  const double stiffness = rigidity_ * law.mass_n;
  law.G(0, 0) = stiffness;
  law.answer.x() = law.l.x() - stiffness * (law.u.x() - law.bound);
  const double y1 = law.l.y() - law.mass_t * law.u.y(), y2 = law.l.z() - law.mass_t * law.u.z();
  const double radius = law.friction * (law.l.x() - law.mass_n * (law.u.x() - law.bound));
  const double length = std::sqrt(y1 * y1 + y2 * y2);
  if (length <= radius) {
    law.G(1, 1) = law.G(2, 2) = rigidity_ * law.mass_t;
    law.answer.y() = law.l.y() - rigidity_ * law.mass_t * law.u.y();
    law.answer.z() = law.l.z() - rigidity_ * law.mass_t * law.u.z();
    return;
  }
  const double e1 = y1 / length, e2 = y2 / length;
  const double share = std::min(rigidity_, radius / (length - radius));  // c/(1 - c)
  const double turn = share * law.mass_t;
  law.G(1, 0) = law.friction * stiffness * e1;
  law.G(2, 0) = law.friction * stiffness * e2;
  law.G(1, 1) = turn * e2 * e2;
  law.G(2, 2) = turn * e1 * e1;
  law.G(1, 2) = law.G(2, 1) = -turn * e1 * e2;
  const double across = share * (e1 * law.l.z() - e2 * law.l.y());  // P l = (-e2, e1) (...)
  law.answer.y() = law.friction * law.answer.x() * e1 + across * e2;
  law.answer.z() = law.friction * law.answer.x() * e2 - across * e1;
}

void AlmNewton::linearize_turning(Law& law) const {
  law.G.setZero();
  const Law& contact = laws_[law.presses];
  const double l_n = contact.l.x() - contact.mass_n * (contact.u.x() - contact.bound);
  const Vec3 mass(law.mass_n, law.mass_t, law.mass_t), y = law.l - mass.cwiseProduct(law.u);
  law.answer = nearest_moment(*law.turning, y, l_n);
  if (law.answer.x() == y.x()) {  // it sticks
    law.G(0, 0) = rigidity_ * law.mass_n;
    law.answer.x() = law.l.x() - law.G(0, 0) * law.u.x();
  }
  const double length = std::sqrt(y.y() * y.y() + y.z() * y.z());
  const double radius = law.turning->rolling * std::max(0.0, l_n);
  const double share = length <= radius ? rigidity_ : std::min(rigidity_, radius / (length - radius));
  if (length <= radius) {
    law.G(1, 1) = law.G(2, 2) = share * law.mass_t;
    law.answer.tail<2>() = law.l.tail<2>() - share * law.mass_t * law.u.tail<2>();
    return;
  }
  const double e1 = y.y() / length, e2 = y.z() / length, turn = share * law.mass_t;
  law.G(1, 1) = turn * e2 * e2;
  law.G(2, 2) = turn * e1 * e1;
  law.G(1, 2) = law.G(2, 1) = -turn * e1 * e2;
  const double across = share * (e1 * law.l.z() - e2 * law.l.y());
  law.answer.y() = radius * e1 + across * e2;
  law.answer.z() = radius * e2 - across * e1;
}

void AlmNewton::linearize(Law& law) const {
  law.G.setZero();
  law.answer.setZero();
  if (law.kind == Law::Kind::spring) {
    law.G(0, 0) = law.softness;
    law.answer.x() = -law.softness * (law.u.x() - law.bound);
  } else if (law.kind == Law::Kind::line || law.l.x() - law.mass_n * (law.u.x() - law.bound) > 0.0) {
    if (law.friction > 0.0) {
      linearize_contact(law);
    } else {
      law.G(0, 0) = rigidity_ * law.mass_n;
      law.answer.x() = law.l.x() - law.G(0, 0) * (law.u.x() - law.bound);
    }
  }
}

bool AlmNewton::find_changes() {
  system_.set_mass();
  dv_.assign(v_.size(), Vec6::Zero());
  for (Law& law : laws_) {
    law.kind == Law::Kind::turning ? linearize_turning(law) : linearize(law);
    system_.add_stiffness(law.joins, law.G);
    system_.add_impulse(law.joins, law.answer - law.l, dv_);
  }
  if (!system_.factorize()) return false;
  system_.solve(dv_);
  for (Law& law : laws_) {
    law.du = system_.velocity(law.joins, dv_);
    law.dl = law.answer - law.G * law.du - law.l;
  }
  return true;
}

/// Mass times the square of what the law lacks after the step, as in compute_residual [kg m^2/s^2].
double AlmNewton::defect(const Law& law, double step) {
  const Vec3 l = law.l + step * law.dl, u = law.u + step * law.du;
  const double m = law.mass_n;
  if (law.kind == Law::Kind::spring) {
    const double r = (l.x() + law.softness * (u.x() - law.bound)) / (m + law.softness);
    return m * r * r;
  }
  const double y = l.x() - m * (u.x() - law.bound);
  const double r_n = ((law.kind == Law::Kind::line ? y : std::max(0.0, y)) - l.x()) / m;
  if (law.kind != Law::Kind::contact) return m * r_n * r_n;
  double y1 = l.y() - law.mass_t * u.y(), y2 = l.z() - law.mass_t * u.z();
  const double radius = law.friction * std::max(0.0, l.x()), square = y1 * y1 + y2 * y2;
  if (square > radius * radius) {
    const double shrink = radius / std::sqrt(square);
    y1 *= shrink;
    y2 *= shrink;
  }
  const double d1 = y1 - l.y(), d2 = y2 - l.z();
  return m * r_n * r_n + (d1 * d1 + d2 * d2) / law.mass_t;
}

double AlmNewton::turning_defect(const Law& law, double step) const {
  const Law& contact = laws_[law.presses];
  const Vec3 mass(law.mass_n, law.mass_t, law.mass_t), l = law.l + step * law.dl, u = law.u + step * law.du;
  const Vec3 change =
      nearest_moment(*law.turning, l - mass.cwiseProduct(u), contact.l.x() + step * contact.dl.x()) - l;
  return change.cwiseProduct(change).cwiseQuotient(mass).sum();
}

double AlmNewton::defect(double step) const {
  double sum = 0.0;
  for (const Law& law : laws_)
    sum += law.kind == Law::Kind::turning ? turning_defect(law, step) : defect(law, step);
  return sum;
}

/// The longest of 1, 1/2, 1/4... that brings the law closer; if none does, the best of them.
double AlmNewton::choose_step() const {
  const double before = defect(0.0);
  double best = 1.0, least = kInfinity, step = 1.0;
  for (int i = 0; i <= kLineHalvings; ++i, step *= 0.5) {
    const double after = defect(step);
    if (after < (1.0 - 0.1 * step) * before) return step;
    if (after < least) {
      least = after;
      best = step;
    }
  }
  return best;
}

void AlmNewton::store(double step) {
  for (const Law& law : laws_) {
    Vec3 l = law.l + step * law.dl;
    if (law.kind == Law::Kind::contact || law.kind == Law::Kind::half_line) {
      l.x() = std::max(0.0, l.x());
      const double radius = law.friction * l.x(), length = std::sqrt(l.y() * l.y() + l.z() * l.z());
      if (length > radius) l.tail<2>() *= radius / length;
    }
    if (law.turning) {
      law.turning->lambda = nearest_moment(*law.turning, l, laws_[law.presses].contact->x());
    } else if (law.contact) {
      *law.contact = l;
    } else {
      *law.row = l.x();
    }
  }
}

int AlmNewton::solve(int max_iterations) {
  double least = best_.residual();
  int iterations = 0, stalls = 0;
  while (iterations < max_iterations && stalls < kMostStalls) {
    load();
    const bool solved = find_changes();
    ++iterations;
    if (!solved) break;
    store(choose_step());
    const double residual = best_.offer();
    if (residual < tolerance_ || !(residual < kInfinity)) break;
    if (!(residual < 0.8 * least)) rigidity_ = kRigidities[++stalls % 3];
    least = std::min(least, residual);
  }
  return iterations;
}

}  // namespace

int run_alm_newton(ContactProblem& problem, VelocitySystem& system, double tolerance, int max_iterations,
                   BestImpulses& best) {
  best.restore();
  return AlmNewton(problem, system, tolerance, best).solve(max_iterations);
}

}  // namespace tumble
