// The linear algebra of one island's contact problem: the velocities of its movable bodies are the unknowns, and every
// contact or row couples those of two of them. Shared by the interior point and the Newton method, which linearize the
// law of each coupling as  p = p0 - G du  (p impulse, u velocity in the coupling's own frame) and so arrive at
//   (M + J^T G J) dv = J^T (p0 - p).
// All vectors in W; bodies by position in the elimination order.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "dynamics/block_lu.h"
#include "dynamics/contact_problem.h"

namespace tumble {

/// What a contact, a row or a turning joins. u = D (velocity of b's point - of a's) + offset, the offset from immovable
/// bodies; of a turning D (w_b - w_a) + offset.
struct Coupling {
  static constexpr std::uint32_t kImmovable = ~0u;
  std::uint32_t a = kImmovable, b = kImmovable;  ///< Positions.
  std::uint32_t block = 0;                       ///< Of the matrix, if both can move.
  Vec3 rA, rB;
  Mat3 D;  ///< Rows: directions. Zero where the coupling has fewer than three.
  Vec3 offset;
  bool turns = false;
};

class VelocitySystem {
 public:
  /// Null if a factorization would take more than `limit` products of blocks.
  static std::shared_ptr<const BlockPattern> find_pattern(const ContactProblem& problem,
                                                          std::uint64_t limit = BlockPattern::kNoLimit);
  VelocitySystem(const ContactProblem& problem, std::shared_ptr<const BlockPattern> pattern);

  std::size_t size() const { return masses_.size(); }
  /// Of a body of the problem that can move.
  std::uint32_t position(std::size_t body) const { return position_[body]; }
  /// Of those contacts, then rows, that can be moved at all, in their order.
  Coupling make_coupling(const PointContact& c) const;
  Coupling make_coupling(const ScalarRow& row) const;
  Coupling make_coupling(const Turning& turning) const;

  /// v, w of the problem's bodies; v0, w0 of them.
  void load_velocities(std::vector<Vec6>& v) const;
  void load_start_velocities(std::vector<Vec6>& v) const;
  /// M v of one body.
  Vec6 momentum(std::size_t position, const Vec6& v) const;
  /// M^-1 p of one body.
  Vec6 answer(std::size_t position, const Vec6& p) const;
  /// D (relative velocity), without the offset.
  Vec3 velocity(const Coupling& c, const std::vector<Vec6>& v) const;
  /// sum <- sum + J^T p.
  void add_impulse(const Coupling& c, const Vec3& p, std::vector<Vec6>& sum) const;

  /// From now on no body weighs more than `ratio` times the lightest; moments of inertia are scaled alike. Returns the sum
  /// of the masses [kg].
  double limit_masses(double ratio);
  /// H <- scale M.
  void set_mass(double scale = 1.0);
  /// H <- H + J^T G J.
  void add_stiffness(const Coupling& c, const Mat3& G);
  bool factorize() { return matrix_.factorize(); }
  /// x <- H^-1 x.
  void solve(std::vector<Vec6>& x) const { matrix_.solve(x); }

 private:
  struct Mass {
    double mass;
    Mat3 I_W, inv_I_W;
  };
  void place(std::uint32_t a, std::uint32_t b, const Vec3& rA, const Vec3& rB, Coupling& c) const;

  const ContactProblem& problem_;
  std::vector<std::uint32_t> position_;  // of every body of the problem
  BlockLu matrix_;
  std::vector<Mass> masses_;
};

}  // namespace tumble
