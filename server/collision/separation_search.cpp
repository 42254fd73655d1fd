// See separation_search.h. h: reach of A - B along n, to be made least; k: its furthest point; t = n . k.
#include "collision/separation_search.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "collision/segment.h"

namespace tumble {
namespace {

/// Faces of the difference closer to the best depth than this, of the shapes' size, hide nothing worth finding.
constexpr double kTolerance = 1e-11;
/// Furthest points asked before a search ends with what it has: only where a whole circle or sphere of directions is
/// equally good, as between coaxial shapes, is the best never proven best. Others need 10 to 60.
constexpr int kMaxRounds = 120;
/// Of one reach, of the shapes' size.
constexpr double kReachRounding = 1e-14;
/// Of the shapes' size: second derivatives of a reach below this are none, slopes below this don't matter.
constexpr double kFlatCurvature = 1e-13, kLevelSlope = 1e-11;
/// ... and an optimum may bend down by this much along a level direction.
constexpr double kBendsDown = 1e-9;
constexpr int kNewtonSteps = 20;
/// Pieces exchanged on the way to one optimum.
constexpr int kPivots = 12;
/// A weight this little below 0 is 0: where four pieces meet, as between boxes and cones in line, three carry all of it.
constexpr double kNoWeight = 1e-9;
/// Three points seen along a direction span no triangle if it is this share of what their distances allow.
constexpr double kNoArea = 1e-9;
constexpr double kLongestStep = 0.3, kLeap = 0.2;  // [rad]
/// Newton's method squares its error: a step this short is the last [rad].
constexpr double kConverged = 1e-8;
/// cos of 0.35 rad: how far around an optimum a positive curvature on the way says that there is none in between.
constexpr double kBasin = 0.94;
/// Share of the size by which the polytope may lie inside the shapes where its points still say where they meet.
constexpr double kCoarse = 1e-6;
/// cos of 1e-5 rad: two searches that end so near each other ended at the same optimum.
constexpr double kSameDirection = 1.0 - 5e-11;

struct Reach {
  Vec3 n, a, b;
  PiecePair pieces;
  Vec3 k() const { return a - b; }
  DifferenceHull::Corner corner() const { return {a - b, a, pieces}; }
  double h() const { return n.dot(a - b); }
};

/// A direction that could be the best, with the pieces believed to be furthest there.
struct CandidateDirection {
  Vec3 n = Vec3::UnitZ();
  double h = kInfinity;
  int count = 0;
  std::array<PiecePair, 3> pieces;
  bool optimal = false;  ///< Newton's method ended here and no other piece reaches further.

  void add(PiecePair pair) {
    const auto end = pieces.begin() + count;
    if (std::find(pieces.begin(), end, pair) == end && count < 3)
      pieces[static_cast<std::size_t>(count++)] = pair;
  }
  bool holds(PiecePair pair) const {
    const auto end = pieces.begin() + count;
    return std::find(pieces.begin(), end, pair) != end;
  }
};

class Search {
 public:
  Search(const ConvexPieces& a, const ConvexPieces& b, double enough)
      : a_(a),
        b_(b),
        rounding_(a.rounding() + b.rounding()),
        enough_(enough),
        size_(a.radius() + b.radius()),
        hull_(size_) {}

  Separation run(const Vec3& guess) {
    reach(guess);
    if (!beyond()) try_caps(a_, 1.0);
    if (!beyond()) try_caps(b_, -1.0);
    if (!beyond() && start(guess)) expand();
    return finish();
  }

 private:
  /// The furthest points along n; remembers the direction if it is the best so far.
  Reach reach(const Vec3& n) {
    ++evaluations_;
    const ConvexPieces::Point a = a_.furthest(n), b = b_.furthest(-n);
    Reach reach{n, a.p_A, b.p_A, {a.piece, b.piece}};
    if (reach.h() < best_.h - (best_.optimal ? kReachRounding * size_ : 0.0)) {
      best_ = {n, reach.h(), 0, {}, false};
      best_.add(reach.pieces);
    }
    return reach;
  }
  bool beyond() const { return -best_.h - rounding_ > enough_; }
  /// Along a cap one piece, the rim, reaches equally far all around: no curvature tells that an optimum may be there.
  void try_caps(const ConvexPieces& body, double side) {
    if (body.has_cap_below()) reach(-side * body.R().col(2));
    if (body.has_cap_above()) reach(side * body.R().col(2));
  }

  Vec3 point(PiecePair pair, const Vec3& n) const { return a_.point(pair.a, n) - b_.point(pair.b, -n); }
  Curvature curvature(PiecePair pair, const Vec3& n, const Vec3& u, const Vec3& v) const {
    return a_.curvature(pair.a, n, u, v) + b_.curvature(pair.b, -n, u, v);
  }

  bool start(const Vec3& guess);
  void expand();
  bool meets_best_only(const DifferenceHull::Face& face) const;
  bool explains(const DifferenceHull::Face& face, const Reach& reach) const;
  bool bends_up(PiecePair pair, const Vec3& n, double slack = 0.0) const;
  bool falls_towards_best(const Reach& reach) const;
  template <typename Bends>
  bool is_one_valley(const Vec3& n, const Bends& bends) const;
  bool is_of_best_valley(const Vec3& n) const;
  bool is_furthest(const CandidateDirection& candidate) const;
  enum class Descent { nowhere, under_way, arrived };
  Descent converge(CandidateDirection& candidate) const;
  enum class Ending { nowhere, same_optimum, better_optimum };
  Ending polish(CandidateDirection candidate);
  bool is_minimum(const CandidateDirection& c) const;
  void grow_to_best();
  double newton_step(double slope, double second) const;
  bool step_on_surface(CandidateDirection& c) const;
  struct Ridge {
    Vec3 n, u;
    double slope, second;
  };
  std::optional<Vec3> onto_ridge(const CandidateDirection& c, const Vec3& n_near) const;
  std::optional<Ridge> ridge_at(const CandidateDirection& c, const Vec3& n_near) const;
  bool step_on_ridge(CandidateDirection& c) const;
  bool step_to_face(CandidateDirection& c) const;
  bool include(CandidateDirection& c, const Reach& further) const;
  std::array<double, 3> weights(const CandidateDirection& c) const;
  void find_points(Separation& result) const;
  Separation finish();

  const ConvexPieces &a_, &b_;
  double rounding_, enough_, size_;
  DifferenceHull hull_;
  CandidateDirection best_;
  std::optional<DifferenceHull::Face> nearest_;  ///< To the origin, while that is outside.
  double lead_ = 0.0;
  int evaluations_ = 0;
};

/// A tetrahedron as wide as supports along a few perpendicular directions make it.
bool Search::start(const Vec3& guess) {
  std::array<DifferenceHull::Corner, 4> corners;
  corners[0] = reach(guess).corner();
  corners[1] = reach(-guess).corner();
  const Vec3 origin = corners[0].k, along = corners[1].k - origin;
  const auto furthest_across = [&](const Vec3& across) {
    const Reach ahead = reach(across), back = reach(-across);
    return (across.dot(ahead.k() - origin) >= across.dot(origin - back.k()) ? ahead : back).corner();
  };
  corners[2] = furthest_across(perpendicular_to(along));
  corners[3] = furthest_across(direction_or(along.cross(corners[2].k - origin), Vec3::UnitZ()));
  return hull_.start(corners);
}

/// To the minimum where the curve bends up. Where it doesn't, downhill, from the very top to either side; and not at all
/// where one place is as good as the next, as all round a common axis.
double Search::newton_step(double slope, double second) const {
  if (second > kFlatCurvature * size_) return std::clamp(-slope / second, -kLongestStep, kLongestStep);
  if (std::abs(slope) > kLevelSlope * size_) return -std::copysign(kLongestStep, slope);
  return second < -kBendsDown * size_ ? kLongestStep : 0.0;
}

/// Minimum of a smooth piece on the sphere of directions: gradient k - t n, Hessian W - t across n.
bool Search::step_on_surface(CandidateDirection& c) const {
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
std::optional<Vec3> Search::onto_ridge(const CandidateDirection& c, const Vec3& n_near) const {
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
std::optional<Search::Ridge> Search::ridge_at(const CandidateDirection& c, const Vec3& n_near) const {
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

bool Search::step_on_ridge(CandidateDirection& c) const {
  const std::optional<Ridge> ridge = ridge_at(c, c.n);
  if (!ridge) return false;
  const double step = newton_step(ridge->slope, ridge->second);
  c.n = (ridge->n + step * ridge->u).normalized();
  return true;
}

/// Three pieces reach equally far along the normal of the plane through their points.
bool Search::step_to_face(CandidateDirection& c) const {
  const Vec3 k0 = point(c.pieces[0], c.n);
  const Vec3 e1 = point(c.pieces[1], c.n) - k0, e2 = point(c.pieces[2], c.n) - k0;
  const Vec3 cross = e1.cross(e2);
  const double length = cross.norm();
  if (!(length > 1e-12 * e1.norm() * e2.norm())) return false;
  c.n = cross.dot(c.n) < 0.0 ? Vec3(-cross / length) : Vec3(cross / length);
  return true;
}

/// Of the furthest points of its pieces, for the point of their plane that lies behind the origin along n.
std::array<double, 3> Search::weights(const CandidateDirection& c) const {
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

/// Whether no other pieces reach further along the candidate's direction.
bool Search::is_furthest(const CandidateDirection& candidate) const {
  return candidate.holds({a_.furthest(candidate.n).piece, b_.furthest(-candidate.n).piece});
}

/// Newton's method on the candidate's pieces. On a ridge it stops where a leap has come to other pieces: their corner may be
/// the optimum, and the ridge's own lie far behind it.
Search::Descent Search::converge(CandidateDirection& candidate) const {
  for (int i = 0; i < kNewtonSteps; ++i) {
    const Vec3 before = candidate.n;
    const bool good = candidate.count == 1   ? step_on_surface(candidate)
                      : candidate.count == 2 ? step_on_ridge(candidate)
                                             : step_to_face(candidate);
    if (!good || !candidate.n.allFinite()) return Descent::nowhere;
    const double turned2 = (candidate.n - before).squaredNorm();
    if (turned2 < kConverged * kConverged) return Descent::arrived;
    if (candidate.count == 2 && turned2 > kLeap * kLeap && !is_furthest(candidate)) return Descent::under_way;
  }
  return Descent::nowhere;
}

/// Takes a piece in that reaches further. Of four, the one is left out without which the ray along n passes best through
/// the triangle of the others; of three in one plane with n, as round a common axis, the one on the same side of the ray.
bool Search::include(CandidateDirection& c, const Reach& further) const {
  if (c.holds(further.pieces)) return false;
  if (c.count == 2) {
    const Vec3 k0 = point(c.pieces[0], c.n), edge = point(c.pieces[1], c.n) - k0, beside = further.k() - k0;
    if (std::abs(c.n.dot(edge.cross(beside))) <= kNoArea * edge.norm() * beside.norm()) {
      const Vec3 along = edge - c.n * c.n.dot(edge);
      c.pieces[along.dot(further.k()) > 0.0 ? 1 : 0] = further.pieces;
      return true;
    }
  }
  if (c.count < 3) {
    c.add(further.pieces);
    return true;
  }
  std::size_t out = 3;
  double most = -kInfinity;
  for (std::size_t i = 0; i < 3; ++i) {
    std::array<Vec3, 3> k;
    for (std::size_t j = 0; j < 3; ++j) k[j] = j == i ? further.k() : point(c.pieces[j], c.n);
    const std::array<double, 3> w = {c.n.dot(k[1].cross(k[2])), c.n.dot(k[2].cross(k[0])),
                                     c.n.dot(k[0].cross(k[1]))};
    const double least =
        std::min({w[0] / (w[0] + w[1] + w[2]), w[1] / (w[0] + w[1] + w[2]), w[2] / (w[0] + w[1] + w[2])});
    if (least > most) most = least, out = i;
  }
  if (out == 3) return false;
  c.pieces[out] = further.pieces;
  return true;
}

/// The optimum near the candidate: pieces that don't hold it are dropped, those that reach further taken in. Remembered if it is better than the best.
Search::Ending Search::polish(CandidateDirection candidate) {
  for (int pivot = 0; pivot < kPivots; ++pivot) {
    const Descent descent = converge(candidate);
    if (descent == Descent::nowhere) break;
    const CandidateDirection before = best_;
    const Reach reached = reach(candidate.n);
    const double t = candidate.n.dot(point(candidate.pieces[0], candidate.n));
    if (reached.h() > t + kReachRounding * size_) {
      if (!include(candidate, reached)) break;
      continue;
    }
    if (descent == Descent::under_way) continue;
    const std::array<double, 3> w = weights(candidate);
    const auto least =
        static_cast<std::size_t>(std::min_element(w.begin(), w.begin() + candidate.count) - w.begin());
    if (w[least] < -kNoWeight) {
      candidate.pieces[least] = candidate.pieces[static_cast<std::size_t>(--candidate.count)];
      continue;
    }
    if (!is_minimum(candidate)) break;
    if (before.optimal && candidate.n.dot(before.n) > kSameDirection) {
      best_ = before;
      return Ending::same_optimum;
    }
    if (reached.h() > before.h) break;
    best_ = candidate;
    best_.h = reached.h();
    best_.optimal = true;
    return Ending::better_optimum;
  }
  return Ending::nowhere;
}

/// Tells a saddle, on which Newton's method may end in a symmetric pose, from a minimum.
bool Search::is_minimum(const CandidateDirection& c) const {
  if (c.count == 3) return true;
  if (c.count == 2) {
    const std::optional<Ridge> ridge = ridge_at(c, c.n);
    return ridge && ridge->second >= -kBendsDown * size_;
  }
  return bends_up(c.pieces[0], c.n, kBendsDown * size_);
}

void Search::grow_to_best() {
  for (int i = 0; i < best_.count; ++i) {
    const PiecePair pair = best_.pieces[static_cast<std::size_t>(i)];
    hull_.grow({point(pair, best_.n), a_.point(pair.a, best_.n), pair});
  }
}

/// Its corners are points of the pieces that meet in the best direction.
bool Search::meets_best_only(const DifferenceHull::Face& face) const {
  return std::all_of(face.corners.begin(), face.corners.end(),
                     [&](std::uint16_t corner) { return best_.holds(hull_.corner(corner).pieces); });
}

/// True if no better direction hides behind the face, since it lies near the best one, all of it is of one pair of pieces,
/// and curvature leaves room for one minimum only, or for none. Of a ridge only a search from there can say so.
bool Search::explains(const DifferenceHull::Face& face, const Reach& reach) const {
  if (!best_.optimal || best_.count > 2 || face.outside || reach.n.dot(best_.n) < kBasin ||
      !best_.holds(reach.pieces))
    return false;
  const auto is_of_reach = [&](std::uint16_t corner) { return hull_.corner(corner).pieces == reach.pieces; };
  if (!std::all_of(face.corners.begin(), face.corners.end(), is_of_reach)) return false;
  return is_one_valley(reach.n, [&](const Vec3& n) { return bends_up(reach.pieces, n); }) &&
         (best_.count == 1 || falls_towards_best(reach));
}

/// Whether the reach bends up along n and on the way from there to the best direction. A positive curvature at both ends does
/// not do: where shapes are thin, two optima may lie near each other, narrow both, with a wide top between them.
template <typename Bends>
bool Search::is_one_valley(const Vec3& n, const Bends& bends) const {
  for (const double share : {1.0, 0.75, 0.5, 0.25}) {
    if (!bends(Vec3((share * n + (1.0 - share) * best_.n).normalized()))) return false;
  }
  return true;
}

/// From n to the best direction, which a search from there has found again.
bool Search::is_of_best_valley(const Vec3& n) const {
  if (best_.count > 2) return true;
  return is_one_valley(n, [&](const Vec3& m) {
    if (best_.count == 1) return bends_up(best_.pieces[0], m);
    const std::optional<Ridge> ridge = ridge_at(best_, m);
    return ridge && ridge->second > 0.0;
  });
}

/// Whether the reach of a piece has a minimum's curvature along n, up to the slack [m].
bool Search::bends_up(PiecePair pair, const Vec3& n, double slack) const {
  const Vec3 u = perpendicular_to(n), v = n.cross(u);
  return curvature(pair, n, u, v).is_positive(n.dot(point(pair, n)) - slack);
}

/// A best direction on a ridge is no minimum of its pieces: if one of them does not bend up there, or falls away from there
/// towards a direction, it may have a minimum of its own in between.
bool Search::falls_towards_best(const Reach& reach) const {
  const Vec3 onward = best_.n * best_.n.dot(reach.n) - reach.n;
  return bends_up(reach.pieces, best_.n) && point(reach.pieces, best_.n).dot(onward) <= kLevelSlope * size_;
}

void Search::expand() {
  const double tolerance = kTolerance * size_;
  for (int round = 0; round < kMaxRounds && !beyond() && !hull_.full(); ++round) {
    DifferenceHull::Face* face = hull_.least();
    if (face == nullptr) {
      lead_ = kInfinity;
      return;
    }
    lead_ = face->outside ? 0.0 : face->bound - best_.h;
    if (!face->outside && lead_ >= -tolerance) return;
    nearest_.reset();
    if (face->outside) nearest_ = *face;
    CandidateDirection candidate;
    for (std::size_t i = 0; i < 3; ++i) {
      if (face->weights[i] > 0.0) candidate.add(hull_.corner(face->corners[i]).pieces);
    }
    const Reach reached = reach(candidate.n = face->direction);
    if (face->outside && best_.h <= face->bound + tolerance) return;  // no direction separates more
    if (explains(*face, reached)) {
      face->closed = true;
      continue;
    }
    const bool settled = candidate.holds(reached.pieces) && reached.h() > face->bound + tolerance;
    const bool near = candidate.n.dot(best_.n) > kBasin;
    const Ending ending = settled ? polish(candidate) : Ending::nowhere;
    if (ending == Ending::same_optimum && near && !face->outside && meets_best_only(*face) &&
        is_of_best_valley(reached.n)) {
      face->closed = true;
      continue;
    }
    if (!hull_.grow(reached.corner())) face->closed = true;
    if (ending == Ending::better_optimum) grow_to_best();
  }
}

/// The deepest points, as the mixture of those that the origin lies behind.
void Search::find_points(Separation& result) const {
  if (!best_.optimal && hull_.empty()) {
    result.p_A = a_.furthest(best_.n).p_A;
    result.p_B = b_.furthest(-best_.n).p_A;
    return;
  }
  result.p_A = result.p_B = Vec3::Zero();
  if (best_.optimal) {
    result.exact = true;
    const std::array<double, 3> w = weights(best_);
    for (std::size_t i = 0; i < static_cast<std::size_t>(best_.count); ++i) {
      result.p_A += w[i] * a_.point(best_.pieces[i].a, best_.n);
      result.p_B += w[i] * b_.point(best_.pieces[i].b, -best_.n);
    }
    return;
  }
  const DifferenceHull::Face face = nearest_ ? *nearest_ : hull_.pierced_by(best_.n);
  for (std::size_t i = 0; i < 3; ++i) {
    const DifferenceHull::Corner& corner = hull_.corner(face.corners[i]);
    result.p_A += face.weights[i] * corner.p_A;
    result.p_B += face.weights[i] * (corner.p_A - corner.k);
  }
  // The polytope lies inside the difference: out to the planes that touch the shapes.
  const double out_a = best_.n.dot(a_.furthest(best_.n).p_A - result.p_A),
               out_b = best_.n.dot(b_.furthest(-best_.n).p_A - result.p_B);
  result.p_A += out_a * best_.n;
  result.p_B += out_b * best_.n;
  result.exact = std::max(std::abs(out_a), std::abs(out_b)) <= kCoarse * size_;
}

Separation Search::finish() {
  // The first guess may already be the best direction; which pieces meet there is then not known yet.
  if (!beyond() && !best_.optimal) polish(best_);
  Separation result;
  result.normal_A = best_.n;
  result.separation = -best_.h - rounding_;
  result.count = best_.count;
  result.pieces = best_.pieces;
  result.lead = lead_;
  if (!beyond()) find_points(result);
  result.evaluations = evaluations_;
  return result;
}

}  // namespace

Separation find_separation(const ConvexPieces& a, const ConvexPieces& b, const Vec3& guess, double enough) {
  return Search(a, b, enough).run(guess);
}

}  // namespace tumble
