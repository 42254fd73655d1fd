// See reflection.h. Per pass, on the violated set V with A = J_V M^-1 J_V^T and u the velocities before it:
//   compression  0 <= p_n  perp  u_n + (A p)_n >= 0, Coulomb friction;   expansion  p_n = e p_n,c, friction in mu p_n;
//   dE = p.u + p.A p / 2; if compression and expansion together gain, the expansion is shortened until dE = 0.
#include "dynamics/reflection.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>

#include "dynamics/alm_newton.h"
#include "dynamics/best_impulses.h"
#include "dynamics/cone_newton.h"
#include "dynamics/interior_point.h"
#include "dynamics/linkage.h"
#include "dynamics/point_impact.h"
#include "dynamics/solver.h"

namespace tumble {
namespace {

/// Approach [m/s] relative to the speeds involved below which a contact counts as at rest: rounding without friction,
/// the accuracy of the impulses with it.
constexpr double kAtRest = 1e-13, kAtRestWithFriction = 1e-10;
/// More contacts than this at once are no longer solved by active sets.
constexpr std::size_t kDense = 64;
constexpr int kFrictionSweeps = 100;
constexpr std::uint32_t kNowhere = UINT32_MAX;
/// Of single contacts, hardest first, at the bound of the passes. Points of one box need some dozens.
constexpr int kMostStops = 1000;

Vec3 contact_velocity(const ContactProblem& problem, const PointContact& c) {
  const Vec3 u = relative_velocity(problem.bodies[c.a], problem.bodies[c.b], c.rA, c.rB);
  return {u.dot(c.n), u.dot(c.t1), u.dot(c.t2)};
}

void apply(ContactProblem& problem, const PointContact& c, const Vec3& p) {
  apply_impulse(problem.bodies[c.a], problem.bodies[c.b], c.rA, c.rB, in_world(c, p));
}

/// One pass over the contacts that approach.
class Pass {
 public:
  Pass(ContactProblem& problem, const Linkage& linkage, std::size_t first_rope,
       const std::vector<std::uint32_t>& violated)
      : problem_(problem),
        linkage_(linkage),
        first_rope_(first_rope),
        violated_(violated),
        p_(violated.size(), Vec3::Zero()) {
    for (const std::uint32_t i : violated) {
      u_before_.push_back(contact_velocity(problem, problem.contacts[i]));
      frictionless_ = frictionless_ && !(problem.contacts[i].friction > 0.0);
    }
  }

  /// Returns whether energy had to be clamped.
  bool reflect() {
    if (violated_.size() == 1) {
      take(0, point_impact(contact(0).restitution));
      return false;
    }
    compress();
    return expand();
  }

  /// Of a single contact, without restitution.
  void stop() { take(0, point_impact(0.0)); }

  void compress() {
    if (frictionless_ && violated_.size() <= kDense) {
      compress_frictionless();
    } else {
      compress_with_friction();
    }
  }

 private:
  Vec3 point_impact(double restitution) const {
    const PointContact& c = contact(0);
    const Vec3& u = u_before_[0];
    const double factor = -(1.0 + restitution) * u.x();
    if (frictionless_ && linkage_.empty()) return {factor * c.mass_n, 0.0, 0.0};
    const Mat3 K = inverse_mass_of(c);
    if (frictionless_) return {factor / K(0, 0), 0.0, 0.0};
    return solve_point_impact(K, u, c.friction, restitution);
  }

  Mat3 inverse_mass_of(const PointContact& c) const {
    return linkage_.empty() ? inverse_mass(problem_.bodies[c.a], problem_.bodies[c.b], c)
                            : linkage_.inverse_mass(problem_, c);
  }

  const PointContact& contact(std::size_t k) const { return problem_.contacts[violated_[k]]; }

  void take(std::size_t k, const Vec3& p) {
    PointContact& c = problem_.contacts[violated_[k]];
    p_[k] += p;
    c.lambda += p;
    apply(problem_, c, p);
    linkage_.hold(problem_.bodies);
  }

  /// Normal rows of A.
  Eigen::MatrixXd normal_matrix() const {
    return linkage_.empty() ? normal_matrix_of_free_bodies() : normal_matrix_of_linked_bodies();
  }

  Eigen::MatrixXd normal_matrix_of_linked_bodies() const {
    const auto n = static_cast<Eigen::Index>(violated_.size());
    Eigen::MatrixXd A(n, n);
    for (Eigen::Index j = 0; j < n; ++j) {
      const PointContact& cj = contact(static_cast<std::size_t>(j));
      const std::vector<SolverBody> bodies = linkage_.answer(problem_, cj, cj.n);
      for (Eigen::Index i = 0; i < n; ++i) {
        const PointContact& ci = contact(static_cast<std::size_t>(i));
        A(i, j) = ci.n.dot(relative_velocity(bodies[ci.a], bodies[ci.b], ci.rA, ci.rB));
      }
    }
    return 0.5 * (A + A.transpose());
  }

  Eigen::MatrixXd normal_matrix_of_free_bodies() const {
    const auto n = static_cast<Eigen::Index>(violated_.size());
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(n, n);
    for (Eigen::Index j = 0; j < n; ++j) {
      const PointContact& cj = contact(static_cast<std::size_t>(j));
      for (Eigen::Index i = j; i < n; ++i) {
        const PointContact& ci = contact(static_cast<std::size_t>(i));
        double sum = 0.0;
        for (const bool i_on_b : {false, true}) {
          for (const bool j_on_b : {false, true}) {
            const std::uint32_t body = i_on_b ? ci.b : ci.a;
            if (body != (j_on_b ? cj.b : cj.a)) continue;
            const SolverBody& B = problem_.bodies[body];
            const Vec3 arm_i = (i_on_b ? ci.rB : ci.rA).cross(ci.n);
            const Vec3 arm_j = (j_on_b ? cj.rB : cj.rA).cross(cj.n);
            const double part = B.inv_mass * ci.n.dot(cj.n) + arm_i.dot(B.inv_I_W * arm_j);
            sum += i_on_b == j_on_b ? part : -part;
          }
        }
        A(i, j) = A(j, i) = sum;
      }
    }
    return A;
  }

  /// min p.A p / 2 + u.p over p >= 0 by active sets (Lawson, Hanson 1974, ch. 23): exact up to rounding. A contact whose
  /// velocity the acting ones already take away never joins, so the acting rows stay independent.
  void compress_frictionless() {
    const Eigen::MatrixXd A = normal_matrix();
    const Eigen::Index n = A.rows();
    Eigen::VectorXd u(n), p = Eigen::VectorXd::Zero(n);
    for (Eigen::Index i = 0; i < n; ++i) u[i] = u_before_[static_cast<std::size_t>(i)].x();
    const double rest = kAtRest * u.cwiseAbs().maxCoeff();
    std::vector<Eigen::Index> acting;
    for (Eigen::Index round = 0; round < 3 * n; ++round) {
      const Eigen::VectorXd left = u + A * p;
      Eigen::Index worst = -1;
      for (Eigen::Index i = 0; i < n; ++i) {
        const bool acts = std::find(acting.begin(), acting.end(), i) != acting.end();
        if (!acts && left[i] < (worst < 0 ? -rest : left[worst])) worst = i;
      }
      if (worst < 0) break;
      acting.push_back(worst);
      while (!acting.empty()) {
        const Eigen::VectorXd wanted = solve_acting(A, u, acting);
        const auto pulls =
            std::find_if(acting.begin(), acting.end(), [&](Eigen::Index i) { return wanted[i] <= 0.0; });
        if (pulls == acting.end()) {
          p = wanted;
          break;
        }
        // As far towards it as no impulse pulls; whoever is at zero then acts no more.
        double share = 1.0;
        for (const Eigen::Index i : acting) {
          if (wanted[i] <= 0.0) share = std::min(share, p[i] / (p[i] - wanted[i]));
        }
        p += share * (wanted - p);
        std::erase_if(acting, [&](Eigen::Index i) {
          if (wanted[i] > 0.0 || p[i] > 1e-15 * p.maxCoeff()) return false;
          p[i] = 0.0;
          return true;
        });
      }
    }
    for (Eigen::Index i = 0; i < n; ++i) take(static_cast<std::size_t>(i), Vec3(p[i], 0.0, 0.0));
  }

  static Eigen::VectorXd solve_acting(const Eigen::MatrixXd& A, const Eigen::VectorXd& u,
                                      const std::vector<Eigen::Index>& acting) {
    const auto m = static_cast<Eigen::Index>(acting.size());
    Eigen::MatrixXd S(m, m);
    Eigen::VectorXd r(m);
    for (Eigen::Index i = 0; i < m; ++i) {
      r[i] = -u[acting[static_cast<std::size_t>(i)]];
      for (Eigen::Index j = 0; j < m; ++j) {
        S(i, j) = A(acting[static_cast<std::size_t>(i)], acting[static_cast<std::size_t>(j)]);
      }
    }
    const Eigen::VectorXd x = S.llt().solve(r);
    Eigen::VectorXd p = Eigen::VectorXd::Zero(A.rows());
    for (Eigen::Index i = 0; i < m; ++i) p[acting[static_cast<std::size_t>(i)]] = x[i];
    return p;
  }

  /// The violated contacts, all joints, and the bodies that they act on, in an instant without forces.
  ContactProblem make_part() const {
    ContactProblem part;
    part.h = 1.0;
    std::vector<std::uint32_t> places(problem_.bodies.size(), kNowhere);
    const auto place = [&](std::uint32_t body) {
      if (places[body] == kNowhere) {
        places[body] = static_cast<std::uint32_t>(part.bodies.size());
        SolverBody& placed = part.bodies.emplace_back(problem_.bodies[body]);
        placed.v0 = placed.v;
        placed.w0 = placed.w;
      }
      return places[body];
    };
    for (std::size_t k = 0; k < violated_.size(); ++k) {
      PointContact& c = part.contacts.emplace_back(contact(k));
      c.a = place(c.a);
      c.b = place(c.b);
      c.separation = 0.0;
      c.lambda.setZero();
    }
    for (const ScalarRow& joint : problem_.rows) {
      if (!joint.is_two_sided()) continue;
      ScalarRow& row = part.rows.emplace_back(joint);
      row.a = place(row.a);
      row.b = place(row.b);
      row.bound = row.lambda = 0.0;
    }
    prepare(part, {.slop = 0.0, .push_fraction = 0.0, .push_speed = 0.0});
    return part;
  }

  /// Newton's methods end in a few steps, hardly ever not; then the interior point method is next.
  void compress_with_friction() {
    constexpr int kReflectionSteps = 20, kConeSteps = 10, kSweeps = 100;
    double speed = 0.0;
    for (const Vec3& u : u_before_) speed = std::max(speed, std::sqrt(u.squaredNorm()));
    const double wanted = 0.1 * kAtRestWithFriction * speed;
    ContactProblem part = make_part();
    BestImpulses best(part);
    VelocitySystem system(part, VelocitySystem::find_pattern(part));
    run_alm_newton(part, system, wanted, kReflectionSteps, best);
    if (best.residual() > wanted) run_cone_newton(part, system, wanted, kConeSteps, best);
    if (best.residual() > wanted) run_interior_point(part, system, wanted, best);
    if (best.residual() > wanted) run_alm_newton(part, system, wanted, kReflectionSteps, best);
    best.restore();
    if (best.residual() > wanted) {
      SolverSettings settings;
      settings.max_sweeps = kSweeps;
      settings.tolerance = wanted;
      solve_pgs(part, settings);
      best.offer();
      best.restore();
    }
    for (std::size_t k = 0; k < violated_.size(); ++k) take(k, into_cone(part.contacts[k]));
  }

  /// The impulse, made to pull nothing and rub no more than it may.
  static Vec3 into_cone(const PointContact& c) {
    const double p_n = std::max(0.0, c.lambda.x()), limit = c.friction * p_n;
    const double p_t = std::sqrt(c.lambda.y() * c.lambda.y() + c.lambda.z() * c.lambda.z());
    const double share = p_t > limit ? limit / p_t : 1.0;
    return {p_n, share * c.lambda.y(), share * c.lambda.z()};
  }

  bool expand() {
    const std::vector<Vec3> compression = p_;
    for (std::size_t k = 0; k < violated_.size(); ++k) {
      take(k, Vec3(contact(k).restitution * compression[k].x(), 0.0, 0.0));
    }
    pull_ropes();
    if (!frictionless_) {
      rub(compression);
      pull_ropes();
    }
    return clamp_energy(compression);
  }

  /// The ropes hold against the expansion as they did against the compression.
  void pull_ropes() {
    std::vector<std::uint32_t> ropes;
    std::copy_if(violated_.begin(), violated_.end(), std::back_inserter(ropes),
                 [this](std::uint32_t i) { return i >= first_rope_; });
    if (ropes.empty()) return;
    Pass pass(problem_, linkage_, first_rope_, ropes);
    pass.compress();
    // They stand behind the contacts.
    for (std::size_t k = 0; k < ropes.size(); ++k) p_[p_.size() - ropes.size() + k] += pass.p_[k];
  }

  /// Friction of the expansion in discs of fixed size: a convex problem, one contact at a time.
  void rub(const std::vector<Vec3>& compression) {
    std::vector<Mat3> K;
    for (std::size_t k = 0; k < violated_.size(); ++k) K.push_back(inverse_mass_of(contact(k)));
    for (int sweep = 0; sweep < kFrictionSweeps; ++sweep) {
      double change = 0.0, size = 0.0;
      for (std::size_t k = 0; k < violated_.size(); ++k) {
        const PointContact& c = contact(k);
        const Eigen::Matrix2d K_t = K[k].bottomRightCorner<2, 2>();
        const Eigen::Vector2d old = (p_[k] - compression[k]).tail<2>();
        const Eigen::Vector2d u = contact_velocity(problem_, c).tail<2>() - K_t * old;
        const double radius = c.friction * c.restitution * compression[k].x();
        const Eigen::Vector2d p_t = solve_friction_disc(K_t, u, radius);
        take(k, Vec3(0.0, p_t.x() - old.x(), p_t.y() - old.y()));
        change = std::max(change, (p_t - old).cwiseAbs().maxCoeff());
        size = std::max(size, radius);
      }
      if (change <= 1e-15 * size) break;
    }
  }

  /// p.(u before + u after) / 2 summed up: what the impulses did to the kinetic energy [J].
  double energy_change(const std::vector<Vec3>& p, const std::vector<Vec3>& u0) const {
    double sum = 0.0;
    for (std::size_t k = 0; k < violated_.size(); ++k) {
      sum += 0.5 * p[k].dot(u0[k] + contact_velocity(problem_, contact(k)));
    }
    return sum;
  }

  bool clamp_energy(const std::vector<Vec3>& compression) {
    double scale = 0.0;
    for (std::size_t k = 0; k < violated_.size(); ++k) scale += std::abs(p_[k].dot(u_before_[k]));
    const double whole = energy_change(p_, u_before_);
    if (whole <= 1e-14 * scale) return false;
    // dE(s) = c + b s + a s^2 for the share s of the expansion, from its values at 0 and 1 and the work of u_c.
    std::vector<Vec3> expansion;
    for (std::size_t k = 0; k < violated_.size(); ++k) expansion.push_back(p_[k] - compression[k]);
    for (std::size_t k = 0; k < violated_.size(); ++k) take(k, -expansion[k]);
    const double c = std::min(0.0, energy_change(compression, u_before_));
    double b = 0.0;
    for (std::size_t k = 0; k < violated_.size(); ++k) {
      b += expansion[k].dot(contact_velocity(problem_, contact(k)));
    }
    const double a = whole - b - c;
    const double root = (-b + std::sqrt(std::max(0.0, b * b - 4.0 * a * c))) / (2.0 * a);
    const double share = a > 0.0 ? std::clamp(root, 0.0, 1.0) : 0.0;
    for (std::size_t k = 0; k < violated_.size(); ++k) take(k, share * expansion[k]);
    return true;
  }

  ContactProblem& problem_;
  const Linkage& linkage_;
  const std::size_t first_rope_;  // contacts from here on are ropes
  const std::vector<std::uint32_t>& violated_;
  std::vector<Vec3> p_, u_before_;  // contact frames: impulses so far, velocities before the pass
  bool frictionless_ = true;
};

/// A taut rope is a contact without friction and restitution along its line.
PointContact as_contact(const ScalarRow& rope) {
  PointContact contact{.a = rope.a,
                       .b = rope.b,
                       .n = rope.n,
                       .t1 = {},
                       .t2 = {},
                       .rA = rope.rA,
                       .rB = rope.rB,
                       .separation = 0.0,
                       .friction = 0.0,
                       .restitution = 0.0};
  set_tangents(contact);
  contact.mass_n = rope.mass;
  return contact;
}

/// The blow on a problem whose ropes stand behind its contacts.
class Blow {
 public:
  Blow(ContactProblem& problem, std::size_t first_rope)
      : problem_(problem), linkage_(problem), first_rope_(first_rope) {
    linkage_.hold(problem_.bodies);
    double speed = 0.0;
    bool friction = false;
    for (PointContact& c : problem_.contacts) {
      c.lambda.setZero();
      speed = std::max(speed, std::sqrt(contact_velocity(problem_, c).squaredNorm()));
      friction = friction || c.friction > 0.0;
    }
    rest_ = (friction ? kAtRestWithFriction : kAtRest) * speed;
  }

  ReflectionReport run(const ReflectionSettings& settings) {
    ReflectionReport report;
    while (find_violated()) {
      if (report.passes == settings.max_passes) {
        report.capped = true;
        end_inelastically();
        break;
      }
      ++report.passes;
      if (Pass(problem_, linkage_, first_rope_, violated_).reflect()) ++report.clamped;
    }
    return report;
  }

 private:
  /// All at once, and what that leaves, where friction has no common solution, one by one: each takes energy away.
  void end_inelastically() {
    violated_.clear();
    for (std::uint32_t i = 0; i < problem_.contacts.size(); ++i) {
      if (problem_.contacts[i].mass_n > 0.0) violated_.push_back(i);
    }
    Pass(problem_, linkage_, first_rope_, violated_).compress();
    for (int i = 0; i < kMostStops && find_violated(); ++i) {
      const auto approach = [this](std::uint32_t k) {
        return contact_velocity(problem_, problem_.contacts[k]).x();
      };
      const std::vector<std::uint32_t> hardest = {
          *std::min_element(violated_.begin(), violated_.end(),
                            [&](std::uint32_t k, std::uint32_t l) { return approach(k) < approach(l); })};
      Pass(problem_, linkage_, first_rope_, hardest).stop();
    }
  }

  /// Contacts that approach, and with them the ropes that hold against them in the same instant.
  bool find_violated() {
    violated_.clear();
    bool any = false;
    for (std::uint32_t i = 0; i < problem_.contacts.size(); ++i) {
      const PointContact& c = problem_.contacts[i];
      if (!(c.mass_n > 0.0)) continue;
      const double u_n = contact_velocity(problem_, c).x();
      any = any || u_n < -rest_;
      if (u_n < (i < first_rope_ ? -rest_ : rest_)) violated_.push_back(i);
    }
    return any;
  }

  ContactProblem& problem_;
  Linkage linkage_;
  std::size_t first_rope_;
  std::vector<std::uint32_t> violated_;
  double rest_ = 0.0;  // [m/s]
};

}  // namespace

ReflectionReport reflect(ContactProblem& problem, const ReflectionSettings& settings) {
  const std::size_t contacts = problem.contacts.size();
  for (const ScalarRow& row : problem.rows) {
    if (!row.is_soft() && !row.is_two_sided()) problem.contacts.push_back(as_contact(row));
  }
  const ReflectionReport report = Blow(problem, contacts).run(settings);
  problem.contacts.erase(problem.contacts.begin() + static_cast<std::ptrdiff_t>(contacts),
                         problem.contacts.end());
  return report;
}

}  // namespace tumble
