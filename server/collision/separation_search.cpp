// See separation_search.h. h: reach of A - B along n, to be made least; k: its furthest point; t = n . k.
#include "collision/separation_search.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "collision/depth_proof.h"
#include "collision/direction_descent.h"
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
/// Pieces exchanged on the way to one optimum.
constexpr int kPivots = 12;
/// A weight this little below 0 is 0: where four pieces meet, as between boxes and cones in line, three carry all of it.
constexpr double kNoWeight = 1e-9;
/// The deepest points lie across from each other within this share of the size. Where a rim is seen nearly along its axis,
/// curvature is so large that Newton's steps are short anywhere.
constexpr double kMeeting = 1e-9;
/// cos of 0.35 rad: how far around an optimum a positive curvature on the way says that there is none in between, and how
/// wide what lies behind a face may be that is judged by one direction.
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

class Search {
 public:
  Search(const ConvexPieces& a, const ConvexPieces& b, double enough, bool use_proof)
      : a_(a),
        b_(b),
        rounding_(a.rounding() + b.rounding()),
        enough_(enough),
        use_proof_(use_proof),
        size_(a.radius() + b.radius()),
        descent_(a, b),
        hull_(size_) {}

  Separation run(const Vec3& guess) {
    reach(guess);
    if (use_proof_) look_near(guess);
    if (!done()) try_caps(a_);
    if (!done()) try_caps(b_);
    if (!done() && start(guess)) expand();
    return finish();
  }

 private:
  /// The furthest points along n; remembers the direction if it is the best so far.
  Reach reach(const Vec3& n) {
    const ConvexPieces::Point a = a_.furthest(n), b = b_.furthest(-n);
    Reach reach{n, a.p_A, b.p_A, {a.piece, b.piece}};
    if (reach.h() < best_.h - (best_.optimal ? kReachRounding * size_ : 0.0)) {
      best_ = {n, reach.h(), 0, {}, false};
      best_.add(reach.pieces);
    }
    return reach;
  }
  bool beyond() const { return -best_.h - rounding_ > enough_; }
  bool done() const { return proven_ || beyond(); }
  double tolerance() const { return kTolerance * size_; }
  void try_caps(const ConvexPieces& body) {
    for (const double side : {-1.0, 1.0}) {
      if (body.has_cap(side)) reach(side * body.R().col(2));
    }
  }

  void look_near(const Vec3& guess);
  void try_face(const ConvexPieces& body, double outward, const Vec3& guess);
  bool start(const Vec3& guess);
  void expand();
  bool meets_best_only(const DifferenceHull::Face& face) const;
  bool is_narrow(const DifferenceHull::Face& face) const;
  bool explains(const DifferenceHull::Face& face, const Reach& reach) const;
  bool falls_towards_best(PiecePair pair, const Vec3& n) const;
  bool has_no_own_minimum(PiecePair pair, const Vec3& n) const;
  template <typename Bends>
  bool is_one_valley(const Vec3& n, const Bends& bends) const;
  bool is_of_best_valley(const Vec3& n) const;
  enum class Ending { nowhere, same_optimum, better_optimum };
  Ending polish(CandidateDirection candidate);
  void grow_to_best();
  void find_points(Separation& result) const;
  Separation finish();

  const ConvexPieces &a_, &b_;
  double rounding_, enough_;
  bool use_proof_;
  double size_;
  DirectionDescent descent_;
  DifferenceHull hull_;
  CandidateDirection best_;
  std::optional<DifferenceHull::Face> nearest_;  ///< To the origin, while that is outside.
  bool proven_ = false;  ///< No direction separates more than the best by more than the tolerance.
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

/// Most shapes touch where they face each other, or the way down from there leads to it.
void Search::look_near(const Vec3& guess) {
  const CandidateDirection guessed = best_;
  try_face(a_, 1.0, guess);
  if (!done()) try_face(b_, -1.0, guess);
  if (!done()) polish(best_);
  if (!best_.optimal && !beyond() && best_.n != guess) polish(guessed);
}

/// The flat face that looks at the other shape is where they touch if the other's furthest point has its foot there and, in
/// an overlap, is no nearer to the body's other faces. Or the face's own point to the other shape.
void Search::try_face(const ConvexPieces& body, double outward, const Vec3& guess) {
  const std::optional<Vec3> face = body.face_towards(outward * guess);
  if (!face) return;
  const Vec3 n = outward * *face;
  const Reach reached = reach(n);
  if (best_.n != n) return;
  const double h = reached.h();
  const auto meets = [&](const ConvexPieces& one, const Vec3& furthest, const Vec3& foot) {
    return h > tolerance() ? one.depth(furthest) >= h - tolerance() : one.depth(foot) >= -tolerance();
  };
  const Vec3 foot_a = reached.b + h * n, foot_b = reached.a - h * n;
  const bool on_a = meets(a_, reached.b, foot_a);
  if (!on_a && !meets(b_, reached.a, foot_b)) return;
  best_.optimal = proven_ = true;
  best_.p_A = on_a ? foot_a : reached.a;
  best_.p_B = on_a ? reached.b : foot_b;
}

/// The optimum near the candidate: pieces that don't hold it are dropped, those that reach further taken in. Remembered if
/// it is better than the best.
Search::Ending Search::polish(CandidateDirection candidate) {
  for (int pivot = 0; pivot < kPivots; ++pivot) {
    const DirectionDescent::End end = descent_.converge(candidate);
    if (end == DirectionDescent::End::nowhere) break;
    const CandidateDirection before = best_;
    const Reach reached = reach(candidate.n);
    const double t = candidate.n.dot(descent_.point(candidate.pieces[0], candidate.n));
    if (reached.h() > t + kReachRounding * size_) {
      if (!descent_.include(candidate, reached.pieces, reached.k())) break;
      continue;
    }
    if (end == DirectionDescent::End::under_way) continue;
    const std::array<double, 3> w = descent_.weights(candidate);
    const auto least =
        static_cast<std::size_t>(std::min_element(w.begin(), w.begin() + candidate.count) - w.begin());
    if (w[least] < -kNoWeight) {
      candidate.pieces[least] = candidate.pieces[static_cast<std::size_t>(--candidate.count)];
      continue;
    }
    descent_.find_points(candidate);
    if (!((candidate.p_A - candidate.p_B - t * candidate.n).norm() <= kMeeting * size_)) continue;
    if (!descent_.is_minimum(candidate)) break;
    if (before.optimal && candidate.n.dot(before.n) > kSameDirection) {
      best_ = before;
      return Ending::same_optimum;
    }
    if (reached.h() > before.h) break;
    best_ = candidate;
    best_.h = reached.h();
    best_.optimal = true;
    proven_ = use_proof_ && is_proven(a_, b_, best_, tolerance());
    return Ending::better_optimum;
  }
  return Ending::nowhere;
}

void Search::grow_to_best() {
  for (int i = 0; i < best_.count; ++i) {
    const PiecePair pair = best_.pieces[static_cast<std::size_t>(i)];
    hull_.grow({descent_.point(pair, best_.n), a_.point(pair.a, best_.n), pair});
  }
}

/// Its corners are points of the pieces that meet in the best direction.
bool Search::meets_best_only(const DifferenceHull::Face& face) const {
  return std::all_of(face.corners.begin(), face.corners.end(),
                     [&](std::uint16_t corner) { return best_.holds(hull_.corner(corner).pieces); });
}

/// Whether what could be better behind the face lies near its normal: at an angle phi from it the difference reaches
/// bound / cos(phi) or further.
bool Search::is_narrow(const DifferenceHull::Face& face) const {
  return !face.outside && face.bound >= kBasin * best_.h;
}

/// True if no better direction hides behind the face, since it lies near the best one, all of it is of one pair of pieces,
/// and curvature leaves room for one minimum only, or for none. Of a ridge only a search from there can say so.
bool Search::explains(const DifferenceHull::Face& face, const Reach& reach) const {
  if (!best_.optimal || best_.count > 2 || !is_narrow(face) || reach.n.dot(best_.n) < kBasin ||
      !best_.holds(reach.pieces))
    return false;
  const auto is_of_reach = [&](std::uint16_t corner) { return hull_.corner(corner).pieces == reach.pieces; };
  if (!std::all_of(face.corners.begin(), face.corners.end(), is_of_reach)) return false;
  return is_one_valley(reach.n, [&](const Vec3& n) { return descent_.bends_up(reach.pieces, n); }) &&
         (best_.count == 1 || falls_towards_best(reach.pieces, reach.n));
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
  if (best_.count == 1) {
    return is_one_valley(n, [&](const Vec3& m) { return descent_.bends_up(best_.pieces[0], m); });
  }
  return is_one_valley(n,
                       [&](const Vec3& m) {
                         const auto ridge = descent_.ridge_at(best_, m);
                         return ridge && ridge->second > 0.0;
                       }) &&
         has_no_own_minimum(best_.pieces[0], n) && has_no_own_minimum(best_.pieces[1], n);
}

/// A best direction on a ridge is no minimum of its pieces. One of them has none beside it, towards n, if it bends up nowhere
/// there, or everywhere and falls to the ridge.
bool Search::has_no_own_minimum(PiecePair pair, const Vec3& n) const {
  const auto bends_up = [&](const Vec3& m) { return descent_.bends_up(pair, m); };
  if (is_one_valley(n, [&](const Vec3& m) { return !bends_up(m); })) return true;
  return is_one_valley(n, bends_up) && falls_towards_best(pair, n);
}

/// If a piece does not bend up in the best direction, or falls away from there towards n, it may have a minimum of its own in
/// between.
bool Search::falls_towards_best(PiecePair pair, const Vec3& n) const {
  const Vec3 onward = best_.n * best_.n.dot(n) - n;
  return descent_.bends_up(pair, best_.n) && descent_.point(pair, best_.n).dot(onward) <= kLevelSlope * size_;
}

void Search::expand() {
  for (int round = 0; round < kMaxRounds && !done() && !hull_.full(); ++round) {
    DifferenceHull::Face* face = hull_.least();
    if (face == nullptr || (!face->outside && face->bound >= best_.h - tolerance())) return;
    nearest_.reset();
    if (face->outside) nearest_ = *face;
    CandidateDirection candidate;
    for (std::size_t i = 0; i < 3; ++i) {
      if (face->weights[i] > 0.0) candidate.add(hull_.corner(face->corners[i]).pieces);
    }
    const Reach reached = reach(candidate.n = face->direction);
    if (face->outside && best_.h <= face->bound + tolerance()) return;  // no direction separates more
    if (explains(*face, reached)) {
      face->closed = true;
      continue;
    }
    const bool settled = candidate.holds(reached.pieces) && reached.h() > face->bound + tolerance();
    const bool near = candidate.n.dot(best_.n) > kBasin;
    const Ending ending = settled ? polish(candidate) : Ending::nowhere;
    if (ending == Ending::same_optimum && near && is_narrow(*face) && meets_best_only(*face) &&
        is_of_best_valley(reached.n)) {
      face->closed = true;
      continue;
    }
    if (!hull_.grow(reached.corner())) face->closed = true;
    if (ending == Ending::better_optimum) grow_to_best();
  }
}

/// The deepest points.
void Search::find_points(Separation& result) const {
  if (best_.optimal) {
    result.exact = true;
    result.p_A = best_.p_A;
    result.p_B = best_.p_B;
    return;
  }
  if (hull_.empty()) {
    result.p_A = a_.furthest(best_.n).p_A;
    result.p_B = b_.furthest(-best_.n).p_A;
    return;
  }
  result.p_A = result.p_B = Vec3::Zero();
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
  // The search's last guess may already be the best direction; which pieces meet there is then not known yet.
  if (!beyond() && !best_.optimal) polish(best_);
  Separation result;
  result.normal_A = best_.n;
  result.separation = -best_.h - rounding_;
  result.proven = proven_;
  if (!beyond()) find_points(result);
  return result;
}

}  // namespace

Separation find_separation(const ConvexPieces& a, const ConvexPieces& b, const Vec3& guess, double enough,
                           bool use_proof) {
  return Search(a, b, enough, use_proof).run(guess);
}

}  // namespace tumble
