// The velocity problem of one island: bodies, Coulomb contacts and scalar rows (springs, ropes), built once a step and
// handed to any solver. All vectors in W. n points from a to b, u = velocity of b relative to a at the point,
// impulses lambda [N s] act with + on b and - on a. Conditions per contact, with the velocity bound b_i:
//   0 <= lambda_n  perp  u_n - b_i >= 0,   |lambda_t| <= mu lambda_n,   lambda_t opposite to u_t where it slides.
#pragma once

#include <cstdint>
#include <vector>

#include "dynamics/body.h"

namespace tumble {

/// One body as the solvers see it. Immovable bodies have inv_mass = 0 and inv_I_W = 0: impulses leave them unchanged.
struct SolverBody {
  /// In: after external forces (v*, w*). Out: at the end of the step.
  Vec3 v = Vec3::Zero(), w = Vec3::Zero();
  /// At the start of the step (after impacts), before forces.
  Vec3 v0 = Vec3::Zero(), w0 = Vec3::Zero();
  double inv_mass = 0.0;
  Mat3 inv_I_W = Mat3::Zero();
  Vec3 x = Vec3::Zero();  ///< Centre of mass at the start of the step [m].
  Quat q = Quat::Identity();
  Vec3 shift = Vec3::Zero();  ///< Out: extra displacement beyond the drift [m] (overlap resolved, sub-steps).
  Vec3 turn = Vec3::Zero();   ///< Out: extra rotation vector [rad], world axes, applied after the drift.
};

/// Contacts with smaller coefficients have no friction for the exact solvers: dividing by them would drown the normal
/// condition. Of the sweeping solvers each takes them as they are.
constexpr double kFrictionless = 1e-6;

struct PointContact {
  std::uint32_t a, b;  ///< Indices into `bodies`.
  Vec3 n, t1, t2;      ///< Right-handed: t2 = n x t1.
  Vec3 rA, rB;         ///< Contact point (middle of the gap) from each centre of mass [m].
  double separation;   ///< Gap at the start of the step [m]; < 0 overlap.
  double friction, restitution;
  Vec3 lambda = Vec3::Zero();  ///< (n, t1, t2) [N s]. In: warm start. Out: the solution.
  double un0 = 0.0;    ///< Normal velocity at the start of the step [m/s], < 0 closing; set by `prepare`.
  double bound = 0.0;  ///< b_i [m/s]; set by `prepare`.
  double mass_n = 0.0, mass_t = 0.0;  ///< 1/k_nn and 1/lambda_max(K_tt) [kg]; set by `prepare`.
};

/// Friction of a contact against turning, of materials that ask for it: moments about its n, t1, t2 that work against the
/// relative angular velocity w = w_b - w_a like friction against sliding, with + on b and - on a:
///   |lambda_n| <= torsional l_n,   |lambda_t| <= rolling l_n   (l_n of the contact).
struct Turning {
  std::uint32_t contact;              ///< Index into `contacts`.
  double rolling, torsional;          ///< [m], >= 0.
  Vec3 lambda = Vec3::Zero();         ///< (n, t1, t2) [N m s]. In: warm start. Out: the solution.
  double mass_n = 0.0, mass_t = 0.0;  ///< 1/k_nn and 1/lambda_max(K_tt) [kg m^2]; set by `prepare`.
};

/// The moment nearest to `moment` (n, t1, t2) that a normal impulse l_n [N s] lets the contact exert [N m s].
Vec3 nearest_moment(const Turning& turning, const Vec3& moment, double l_n);

/// One direction: u = n . (velocity of b's anchor - a's anchor). Made by make_spring_row, make_rope_row, make_joint_row.
///   soft:  lambda = -softness (u + bias), unbounded (springs);   rigid (softness = inf): u >= bound, lambda >= 0 (rope:
///   n from a to b reversed, so that lambda >= 0 pulls the bodies together), or with lower = -inf u = bound (joint).
struct ScalarRow {
  std::uint32_t a, b;
  Vec3 n, rA, rB;
  double softness = kInfinity;  ///< [kg]
  double bias = 0.0;            ///< [m/s]
  double stiffness =
      0.0;  ///< k [N/m], soft rows: with damping and extension it can be softened for a shorter step.
  double damping = 0.0;    ///< c [N s/m], soft rows.
  double extension = 0.0;  ///< [m] at the start of the step, soft rows.
  double gap =
      0.0;  ///< [m] way left against n before the row is taut, rigid rows; < 0 over-long; joint: distance.
  double bound = 0.0;    ///< [m/s], rigid rows only.
  double closing = 0.0;  ///< [m/s] joint: the part of `bound` that takes the gap back.
  double lower = 0.0;    ///< Smallest lambda: 0 or -infinity.
  double lambda = 0.0;   ///< [N s]
  double mass = 0.0;     ///< 1/k [kg]; set by `prepare`.

  bool is_soft() const { return softness < kInfinity; }
  bool is_two_sided() const { return lower < 0.0; }
};

class PatternStore;

struct ContactProblem {
  /// Average: bodies move with (v0 + v)/2, exact for constant acceleration. End: with v, right in a step in which a
  /// contact closes.
  enum class Drift { average, end };

  double h = 0.0;  ///< Step [s].
  std::vector<SolverBody> bodies;
  std::vector<PointContact> contacts;
  std::vector<ScalarRow> rows;
  std::vector<Turning> turnings;     ///< Of some of the contacts, in their order.
  Drift drift = Drift::end;          ///< Out.
  PatternStore* patterns = nullptr;  ///< Where patterns of factorization are kept; null: they are made anew.

  void clear() {
    bodies.clear();
    contacts.clear();
    rows.clear();
    turnings.clear();
  }
};

/// Fills t1, t2 (a fixed function of n).
void set_tangents(PointContact& contact);

/// (n, t1, t2) of the contact -> W.
inline Vec3 in_world(const PointContact& c, const Vec3& p) {
  return p.x() * c.n + p.y() * c.t1 + p.z() * c.t2;
}
/// Change of the relative velocity at the contact for a unit impulse at it, both in (n, t1, t2) [1/kg].
Mat3 inverse_mass(const SolverBody& A, const SolverBody& B, const PointContact& c);

/// Velocity of b's point at rB relative to a's at rA, at (v, w) and at (v0, w0) [m/s].
Vec3 relative_velocity(const SolverBody& A, const SolverBody& B, const Vec3& rA, const Vec3& rB);
Vec3 relative_start_velocity(const SolverBody& A, const SolverBody& B, const Vec3& rA, const Vec3& rB);

/// Fills the masses, un0 and the bounds: gap > 0: b = -gap/h (may close, not cross); gap <= 0: b = min(push_speed,
/// push_fraction (-gap - slop)/h). With push_fraction 0 overlap.h removes what overlaps: b = (d - gap)/h then, d <= 0 the
/// deepest gap of the contacts with the same bodies and normal, so that none gets deeper than that.
struct BoundSettings {
  double slop;           ///< [m] overlap that is not pushed out.
  double push_fraction;  ///< Share of the overlap removed per step, 0..1.
  double push_speed;     ///< [m/s] upper limit of that push.
};
void prepare(ContactProblem& problem, const BoundSettings& settings);

/// `impulse` [N s] on B at rB, its opposite on A at rA.
void apply_impulse(SolverBody& A, SolverBody& B, const Vec3& rA, const Vec3& rB, const Vec3& impulse);

/// The same of a moment [N m s] on B, its opposite on A.
void apply_moment(SolverBody& A, SolverBody& B, const Vec3& moment);

/// w += M^-1 J^T lambda of every turning.
void apply_stored_moments(ContactProblem& problem);
/// v, w += M^-1 J^T lambda of every contact, row and turning.
void apply_stored_impulses(ContactProblem& problem);

/// Largest violation of the conditions at the current (v, lambda) [m/s], the natural map of the Coulomb problem:
///   r_n = |max(0, l_n - m_n (u_n - b)) - l_n| / m_n,   r_t = |P_disc(l_t - m_t u_t) - l_t| / m_t.
/// Turning: as friction, in rad/s. Rigid row: the same with its lower limit; soft row: |l + s (u + bias)| / (m + s), the velocity change by which the
/// row would correct itself. NaN if anything is not finite.
double compute_residual(const ContactProblem& problem);

/// Of b relative to a along n, with which the gap of the contact changes over the step [m/s].
double drift_speed(const ContactProblem& problem, const PointContact& c);

/// Average if with it every contact and rigid row keeps gap + h u_n >= min(gap, gap + h b, 0) - 1e-8 m, else end.
ContactProblem::Drift choose_drift(const ContactProblem& problem);

}  // namespace tumble
