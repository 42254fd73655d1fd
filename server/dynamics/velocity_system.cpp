// See velocity_system.h. With S = D^T G D and u = v + w x r, the block between bodies with arms r and r' is
//   [ S, -S [r'] ; [r] S, -[r] S [r'] ],   [r] y = r x y.
#include "dynamics/velocity_system.h"

#include <algorithm>
#include <utility>

#include "dynamics/pattern_store.h"

namespace tumble {
namespace {

std::vector<std::uint32_t> number_movable(const ContactProblem& problem) {
  std::vector<std::uint32_t> number;
  number.reserve(problem.bodies.size());
  std::uint32_t count = 0;
  for (const SolverBody& body : problem.bodies)
    number.push_back(body.inv_mass > 0.0 ? count++ : Coupling::kImmovable);
  return number;
}

/// Between movable bodies, sorted, without repetitions.
std::vector<BlockPattern::Edge> find_edges(const ContactProblem& problem,
                                           const std::vector<std::uint32_t>& number) {
  std::vector<BlockPattern::Edge> edges;
  const auto add = [&](std::uint32_t a, std::uint32_t b) {
    if (a == b || number[a] == Coupling::kImmovable || number[b] == Coupling::kImmovable) return;
    const BlockPattern::Edge edge = std::minmax(number[a], number[b]);
    if (edges.empty() || edges.back() != edge) edges.push_back(edge);
  };
  for (const PointContact& c : problem.contacts) add(c.a, c.b);
  for (const ScalarRow& row : problem.rows) add(row.a, row.b);
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  return edges;
}

/// H <- H + [S, -S [r']; [r] S, -[r] S [r']].
void add_block(const Mat3& S, const Vec3& r, const Vec3& other, Mat6& H) {
  const auto add = [&](int column, const Vec3& d) {
    H.col(column).head<3>() += d;
    H.col(column).tail<3>() += r.cross(d);
  };
  for (int j = 0; j < 3; ++j) add(j, S.col(j));
  add(3, other.y() * S.col(2) - other.z() * S.col(1));
  add(4, other.z() * S.col(0) - other.x() * S.col(2));
  add(5, other.x() * S.col(1) - other.y() * S.col(0));
}

}  // namespace

std::shared_ptr<const BlockPattern> VelocitySystem::find_pattern(const ContactProblem& problem,
                                                                 std::uint64_t limit) {
  const std::vector<std::uint32_t> number = number_movable(problem);
  const auto immovable = std::count(number.begin(), number.end(), Coupling::kImmovable);
  const auto size = static_cast<std::uint32_t>(number.size() - static_cast<std::size_t>(immovable));
  const std::vector<BlockPattern::Edge> edges = find_edges(problem, number);
  auto pattern = problem.patterns ? problem.patterns->find(size, edges, limit)
                                  : std::make_shared<const BlockPattern>(size, edges, limit);
  return pattern->complete() ? pattern : nullptr;
}

VelocitySystem::VelocitySystem(const ContactProblem& problem, std::shared_ptr<const BlockPattern> pattern)
    : problem_(problem), position_(number_movable(problem)), matrix_(std::move(pattern)) {
  masses_.resize(matrix_.pattern().size());
  for (std::size_t i = 0; i < problem.bodies.size(); ++i) {
    if (position_[i] == Coupling::kImmovable) continue;
    position_[i] = matrix_.pattern().position(position_[i]);
    const SolverBody& body = problem.bodies[i];
    masses_[position_[i]] = {1.0 / body.inv_mass, body.inv_I_W.inverse(), body.inv_I_W};
  }
}

void VelocitySystem::place(std::uint32_t a, std::uint32_t b, const Vec3& rA, const Vec3& rB,
                           Coupling& c) const {
  c.a = position_[a];
  c.b = position_[b];
  c.rA = rA;
  c.rB = rB;
  if (c.a != Coupling::kImmovable && c.b != Coupling::kImmovable) c.block = matrix_.pattern().block(c.a, c.b);
  const SolverBody &A = problem_.bodies[a], &B = problem_.bodies[b];
  Vec3 u = Vec3::Zero();
  if (c.b == Coupling::kImmovable) u += B.v + B.w.cross(rB);
  if (c.a == Coupling::kImmovable) u -= A.v + A.w.cross(rA);
  c.offset = c.D * u;
}

Coupling VelocitySystem::make_coupling(const PointContact& contact) const {
  Coupling c;
  c.D << contact.n.transpose(), contact.t1.transpose(), contact.t2.transpose();
  place(contact.a, contact.b, contact.rA, contact.rB, c);
  return c;
}

Coupling VelocitySystem::make_coupling(const ScalarRow& row) const {
  Coupling c;
  c.D << row.n.transpose(), Mat3::Zero().topRows<2>();
  place(row.a, row.b, row.rA, row.rB, c);
  return c;
}

Coupling VelocitySystem::make_coupling(const Turning& turning) const {
  const PointContact& contact = problem_.contacts[turning.contact];
  Coupling c = make_coupling(contact);
  c.turns = true;
  Vec3 w = Vec3::Zero();
  if (c.b == Coupling::kImmovable) w += problem_.bodies[contact.b].w;
  if (c.a == Coupling::kImmovable) w -= problem_.bodies[contact.a].w;
  c.offset = c.D * w;
  return c;
}

void VelocitySystem::load_velocities(std::vector<Vec6>& v) const {
  v.resize(masses_.size());
  for (std::size_t i = 0; i < problem_.bodies.size(); ++i) {
    if (position_[i] != Coupling::kImmovable) v[position_[i]] << problem_.bodies[i].v, problem_.bodies[i].w;
  }
}

void VelocitySystem::load_start_velocities(std::vector<Vec6>& v) const {
  v.resize(masses_.size());
  for (std::size_t i = 0; i < problem_.bodies.size(); ++i) {
    if (position_[i] != Coupling::kImmovable) v[position_[i]] << problem_.bodies[i].v0, problem_.bodies[i].w0;
  }
}

Vec6 VelocitySystem::momentum(std::size_t position, const Vec6& v) const {
  const Mass& mass = masses_[position];
  Vec6 p;
  p << mass.mass * v.head<3>(), mass.I_W * v.tail<3>();
  return p;
}

Vec6 VelocitySystem::answer(std::size_t position, const Vec6& p) const {
  const Mass& mass = masses_[position];
  Vec6 v;
  v << p.head<3>() / mass.mass, mass.inv_I_W * p.tail<3>();
  return v;
}

Vec3 VelocitySystem::velocity(const Coupling& c, const std::vector<Vec6>& v) const {
  Vec3 u = Vec3::Zero();
  if (c.turns) {
    if (c.b != Coupling::kImmovable) u += v[c.b].tail<3>();
    if (c.a != Coupling::kImmovable) u -= v[c.a].tail<3>();
    return c.D * u;
  }
  if (c.b != Coupling::kImmovable) u += v[c.b].head<3>() + v[c.b].tail<3>().cross(c.rB);
  if (c.a != Coupling::kImmovable) u -= v[c.a].head<3>() + v[c.a].tail<3>().cross(c.rA);
  return c.D * u;
}

void VelocitySystem::add_impulse(const Coupling& c, const Vec3& p, std::vector<Vec6>& sum) const {
  const Vec3 p_W = c.D.transpose() * p;
  if (c.turns) {
    if (c.b != Coupling::kImmovable) sum[c.b].tail<3>() += p_W;
    if (c.a != Coupling::kImmovable) sum[c.a].tail<3>() -= p_W;
    return;
  }
  if (c.b != Coupling::kImmovable) {
    sum[c.b].head<3>() += p_W;
    sum[c.b].tail<3>() += c.rB.cross(p_W);
  }
  if (c.a != Coupling::kImmovable) {
    sum[c.a].head<3>() -= p_W;
    sum[c.a].tail<3>() -= c.rA.cross(p_W);
  }
}

double VelocitySystem::limit_masses(double ratio) {
  double lightest = kInfinity, sum = 0.0;
  for (const Mass& body : masses_) lightest = std::min(lightest, body.mass);
  for (Mass& body : masses_) {
    const double share = std::min(1.0, ratio * lightest / body.mass);
    body.mass *= share;
    body.I_W *= share;
    body.inv_I_W /= share;
    sum += body.mass;
  }
  return sum;
}

void VelocitySystem::set_mass(double scale) {
  matrix_.set_zero();
  for (std::uint32_t i = 0; i < masses_.size(); ++i) {
    Mat6& H = matrix_.diagonal(i);
    H.diagonal().head<3>().setConstant(scale * masses_[i].mass);
    H.bottomRightCorner<3, 3>() = scale * masses_[i].I_W;
  }
}

void VelocitySystem::add_stiffness(const Coupling& c, const Mat3& G) {
  const Mat3 S = c.D.transpose() * G * c.D;
  const bool moves_a = c.a != Coupling::kImmovable, moves_b = c.b != Coupling::kImmovable;
  if (c.turns) {
    if (moves_a) matrix_.diagonal(c.a).bottomRightCorner<3, 3>() += S;
    if (moves_b) matrix_.diagonal(c.b).bottomRightCorner<3, 3>() += S;
    if (!moves_a || !moves_b) return;
    matrix_.lower(c.block).bottomRightCorner<3, 3>() -= S;  // S is symmetric
    matrix_.upper(c.block).bottomRightCorner<3, 3>() -= S;
    return;
  }
  if (moves_a) add_block(S, c.rA, c.rA, matrix_.diagonal(c.a));
  if (moves_b) add_block(S, c.rB, c.rB, matrix_.diagonal(c.b));
  if (!moves_a || !moves_b) return;
  Mat6& lower = matrix_.lower(c.block);
  Mat6& upper = matrix_.upper(c.block);
  add_block(-S, c.rA, c.rB, c.a > c.b ? lower : upper);
  add_block(-S, c.rB, c.rA, c.a > c.b ? upper : lower);
}

}  // namespace tumble
