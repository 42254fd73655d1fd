// See direction_descent.h. k: furthest point of A - B along n; t = n . k.
#include "collision/direction_descent.h"

#include <algorithm>
#include <cmath>

#include "collision/segment.h"

namespace tumble {
namespace {

/// Of the shapes' size: second derivatives of a reach below this are none.
constexpr double kFlatCurvature = 1e-13;
/// ... and an optimum may bend down by this much along a level direction.
constexpr double kBendsDown = 1e-9;
constexpr int kDescentSteps = 20;
/// Three points seen along a direction span no triangle if it is this share of what their distances allow.
constexpr double kNoArea = 1e-9;
constexpr double kLongestStep = 0.3, kLeap = 0.2;  // [rad]
/// Newton's method squares its error: a step this short is the last [rad].
constexpr double kConverged = 1e-8;

}  // namespace

/// To the minimum where the curve bends up. Where it doesn't, downhill, from the very top to either side; and not at all
/// where one place is as good as the next, as all round a common axis.
double DirectionDescent::newton_step(double slope, double second) const {
  if (second > kFlatCurvature * size_) return std::clamp(-slope / second, -kLongestStep, kLongestStep);
  if (std::abs(slope) > kLevelSlope * size_) return -std::copysign(kLongestStep, slope);
  return second < -kBendsDown * size_ ? kLongestStep : 0.0;
}

/// Minimum of a smooth piece on the sphere of directions: gradient k - t n, Hessian W - t across n.
bool DirectionDescent::step_on_surface(CandidateDirection& c) const {
  const Vec3 k = point(c.pieces[0], c.n);
  const double t = c.n.dot(k);
  const Vec3 u = perpendicular_to(c.n), v = c.n.cross(u);
  const Curvature W = curvature(c.pieces[0], c.n, u, v);
  const double uu = W.uu - t, vv = W.vv - t, uv = W.uv;
  const double middle = 0.5 * (uu + vv), apart = std::sqrt(0.25 * (uu - vv) * (uu - vv) + uv * uv);
  const double steep = middle + apart, level = middle - apart;
  if (!(steep > kFlatCurvature * size_)) return false;
  // The eigenvector of `steep`, from the better conditioned row.
  const Vec3 along_u = uu > vv ? Vec3((steep - vv) * u + uv * v) : Vec3(uv * u + (steep - uu) * v);
  const Vec3 e1 = direction_or(along_u, u), e2 = c.n.cross(e1);
  const Vec3 step = newton_step(e1.dot(k), steep) * e1 + newton_step(e2.dot(k), level) * e2;
  const double length = step.norm();
  c.n = (c.n + step * (length > kLongestStep ? kLongestStep / length : 1.0)).normalized();
  return true;
}

/// Along the direction nearest by the two pieces reach equally far: across e = k1 - k0 as seen from n_near.
std::optional<Vec3> DirectionDescent::onto_ridge(const CandidateDirection& c, const Vec3& n_near) const {
  const Vec3 e = point(c.pieces[1], n_near) - point(c.pieces[0], n_near);
  const double ee = e.squaredNorm();
  if (!(ee > 0.0)) return std::nullopt;
  const Vec3 level = n_near - e * (e.dot(n_near) / ee);
  const double length = level.norm();
  if (!(length > 0.1)) return std::nullopt;
  return Vec3(level / length);
}

/// Two pieces reach equally far on a curve across e = k1 - k0; along it, u, the reach of the mixture with the weights of
/// the edge's point nearest to the origin has the derivatives u . k and u W u - t. Both are taken on the curve: beside it,
/// where a long step ends, the curvature of a rim can have the other sign.
std::optional<DirectionDescent::Ridge> DirectionDescent::ridge_at(const CandidateDirection& c,
                                                                  const Vec3& n_near) const {
  const std::optional<Vec3> foot = onto_ridge(c, n_near), on = foot ? onto_ridge(c, *foot) : foot;
  if (!on) return std::nullopt;
  Ridge ridge;
  ridge.n = *on;
  const Vec3 k0 = point(c.pieces[0], ridge.n), e = point(c.pieces[1], ridge.n) - k0;
  ridge.u = direction_or(ridge.n.cross(e), perpendicular_to(ridge.n));
  const double weight = std::clamp(-k0.dot(e) / e.squaredNorm(), 0.0, 1.0);
  const double uu = (1.0 - weight) * curvature(c.pieces[0], ridge.n, ridge.u, ridge.u).uu +
                    weight * curvature(c.pieces[1], ridge.n, ridge.u, ridge.u).uu;
  ridge.slope = ridge.u.dot(k0);
  ridge.second = uu - ridge.n.dot(k0);
  return ridge;
}

bool DirectionDescent::step_on_ridge(CandidateDirection& c) const {
  const std::optional<Ridge> ridge = ridge_at(c, c.n);
  if (!ridge) return false;
  const double step = newton_step(ridge->slope, ridge->second);
  c.n = (ridge->n + step * ridge->u).normalized();
  return true;
}

/// Three pieces reach equally far along the normal of the plane through their points.
bool DirectionDescent::step_to_face(CandidateDirection& c) const {
  const Vec3 k0 = point(c.pieces[0], c.n);
  const Vec3 e1 = point(c.pieces[1], c.n) - k0, e2 = point(c.pieces[2], c.n) - k0;
  const Vec3 cross = e1.cross(e2);
  const double length = cross.norm();
  if (!(length > 1e-12 * e1.norm() * e2.norm())) return false;
  c.n = cross.dot(c.n) < 0.0 ? Vec3(-cross / length) : Vec3(cross / length);
  return true;
}

std::array<double, 3> DirectionDescent::weights(const CandidateDirection& c) const {
  if (c.count == 1) return {1.0, 0.0, 0.0};
  const Vec3 k0 = point(c.pieces[0], c.n), e1 = point(c.pieces[1], c.n) - k0;
  if (c.count == 2) {
    const double w1 = -k0.dot(e1) / e1.squaredNorm();
    return {1.0 - w1, w1, 0.0};
  }
  const Vec3 e2 = point(c.pieces[2], c.n) - k0, foot = c.n.dot(k0) * c.n - k0;
  const double all = c.n.dot(e1.cross(e2));
  const double w1 = c.n.dot(foot.cross(e2)) / all, w2 = c.n.dot(e1.cross(foot)) / all;
  return {1.0 - w1 - w2, w1, w2};
}

void DirectionDescent::find_points(CandidateDirection& c) const {
  const std::array<double, 3> w = weights(c);
  c.p_A = c.p_B = Vec3::Zero();
  for (std::size_t i = 0; i < static_cast<std::size_t>(c.count); ++i) {
    c.p_A += w[i] * a_.point(c.pieces[i].a, c.n);
    c.p_B += w[i] * b_.point(c.pieces[i].b, -c.n);
  }
}

/// Whether no other pieces reach further along the candidate's direction.
bool DirectionDescent::is_furthest(const CandidateDirection& candidate) const {
  return candidate.holds({a_.furthest(candidate.n).piece, b_.furthest(-candidate.n).piece});
}

/// Stops where a leap has come to other pieces: their ridge or corner may be the optimum, and that of the candidate's own
/// pieces lie far behind it.
DirectionDescent::End DirectionDescent::converge(CandidateDirection& candidate) const {
  for (int i = 0; i < kDescentSteps; ++i) {
    const Vec3 before = candidate.n;
    const bool good = candidate.count == 1   ? step_on_surface(candidate)
                      : candidate.count == 2 ? step_on_ridge(candidate)
                                             : step_to_face(candidate);
    if (!good || !candidate.n.allFinite()) return End::nowhere;
    const double turned2 = (candidate.n - before).squaredNorm();
    if (turned2 < kConverged * kConverged) return End::arrived;
    if (candidate.count <= 2 && turned2 > kLeap * kLeap && !is_furthest(candidate)) return End::under_way;
  }
  return End::nowhere;
}

bool DirectionDescent::include(CandidateDirection& c, PiecePair further, const Vec3& k_further) const {
  if (c.holds(further)) return false;
  if (c.count == 2) {
    const Vec3 k0 = point(c.pieces[0], c.n), edge = point(c.pieces[1], c.n) - k0, beside = k_further - k0;
    if (std::abs(c.n.dot(edge.cross(beside))) <= kNoArea * edge.norm() * beside.norm()) {
      const Vec3 along = edge - c.n * c.n.dot(edge);
      c.pieces[along.dot(k_further) > 0.0 ? 1 : 0] = further;
      return true;
    }
  }
  if (c.count < 3) {
    c.add(further);
    return true;
  }
  std::size_t out = 3;
  double most = -kInfinity;
  for (std::size_t i = 0; i < 3; ++i) {
    std::array<Vec3, 3> k;
    for (std::size_t j = 0; j < 3; ++j) k[j] = j == i ? k_further : point(c.pieces[j], c.n);
    const std::array<double, 3> w = {c.n.dot(k[1].cross(k[2])), c.n.dot(k[2].cross(k[0])),
                                     c.n.dot(k[0].cross(k[1]))};
    const double least =
        std::min({w[0] / (w[0] + w[1] + w[2]), w[1] / (w[0] + w[1] + w[2]), w[2] / (w[0] + w[1] + w[2])});
    if (least > most) most = least, out = i;
  }
  if (out == 3) return false;
  c.pieces[out] = further;
  return true;
}

bool DirectionDescent::is_minimum(const CandidateDirection& c) const {
  if (c.count == 3) return true;
  if (c.count == 2) {
    const std::optional<Ridge> ridge = ridge_at(c, c.n);
    return ridge && ridge->second >= -kBendsDown * size_;
  }
  return bends_up(c.pieces[0], c.n, kBendsDown * size_);
}

bool DirectionDescent::bends_up(PiecePair pair, const Vec3& n, double slack) const {
  const Vec3 u = perpendicular_to(n), v = n.cross(u);
  return curvature(pair, n, u, v).is_positive(n.dot(point(pair, n)) - slack);
}

}  // namespace tumble
