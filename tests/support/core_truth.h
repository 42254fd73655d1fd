// Ground truth for shapes that are a polytope grown by a radius (half-space, sphere, capsule, box, hull): an exhaustive
// search over all features in 80-bit arithmetic. Apart, the closest pair of features; overlapping, the axis of least
// depth among all face normals and all crossings of edges. It checks itself: a closest pair must separate by its own
// distance (primal = dual), and `brute` tries edges that cannot cross, too. The other shortcuts are proofs: a lower bound of
// a distance or an upper bound of a separation rules out what they leave out.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "collision/box_polytope.h"
#include "collision/polytope.h"
#include "math/pose.h"

namespace tumble::test {

using Real = long double;
using Vec3L = Eigen::Matrix<Real, 3, 1>;
using Mat3L = Eigen::Matrix<Real, 3, 3>;

inline Mat3L matrix_of(const Quat& q) {
  return Eigen::Quaternion<Real>(q.cast<Real>()).normalized().toRotationMatrix();
}

/// The polytope inside a shape, placed in A's frame. A sphere's has one vertex, a capsule's one edge without faces.
struct Core {
  struct Edge {
    Vec3L tail, head;
    int left = -1, right = -1;  // faces
  };
  struct Face {
    Vec3L normal;  // rebuilt from the vertices: the polytope's own are rounded to 64 bits
    std::vector<Vec3L> loop;
  };
  bool half_space = false;
  Vec3L plane_normal, plane_point;
  Real radius = 0;
  std::vector<Vec3L> vertices;
  std::vector<Edge> edges;
  std::vector<Face> faces;

  static Core of(const Shape& shape, const Mat3L& R, const Vec3L& p) {
    Core core;
    const auto place = [&](const Vec3& v) -> Vec3L { return R * v.cast<Real>() + p; };
    if (std::holds_alternative<HalfSpace>(shape)) {
      core.half_space = true;
      core.plane_normal = R.col(2);
      core.plane_point = p;
    } else if (const auto* sphere = std::get_if<Sphere>(&shape)) {
      core.radius = sphere->radius;
      core.vertices = {p};
    } else if (const auto* capsule = std::get_if<Capsule>(&shape)) {
      core.radius = capsule->radius;
      core.vertices = {place(Vec3(0, 0, -capsule->half_length)), place(Vec3(0, 0, capsule->half_length))};
      core.edges = {{core.vertices[0], core.vertices[1]}};
    } else if (const auto* box = std::get_if<Box>(&shape)) {
      core.add(BoxPolytope(*box), place);
    } else {
      core.add(**std::get_if<HullPointer>(&shape), place);
    }
    return core;
  }

  /// Of the core alone.
  Real highest(const Vec3L& n) const {
    if (half_space) return plane_normal.dot(plane_point) * (n.dot(plane_normal) > 0 ? 1 : -1);
    Real top = -std::numeric_limits<Real>::infinity();
    for (const Vec3L& v : vertices) top = std::max(top, n.dot(v));
    return top;
  }

 private:
  template <typename Place>
  void add(const Polytope& polytope, const Place& place) {
    for (const Vec3& v : polytope.vertices) vertices.push_back(place(v));
    for (const Polytope::Face& face : polytope.faces) {
      Face placed;
      for (const std::uint32_t v : polytope.loop(face)) placed.loop.push_back(vertices[v]);
      Vec3L sum = Vec3L::Zero();
      for (std::size_t i = 0; i < placed.loop.size(); ++i) {
        sum += (placed.loop[i] - placed.loop[0])
                   .cross(placed.loop[(i + 1) % placed.loop.size()] - placed.loop[0]);
      }
      placed.normal = sum.normalized();
      faces.push_back(placed);
    }
    for (const Polytope::Edge& e : polytope.edges) {
      edges.push_back({vertices[e.tail], vertices[e.head], static_cast<int>(e.left_face),
                       static_cast<int>(e.right_face)});
    }
  }
};

class CoreTruth {
 public:
  /// `brute`: every pair of edges is tried in full, whether or not their arcs cross.
  CoreTruth(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB, bool brute = false) {
    const Mat3L R_AW = matrix_of(X_WA.q).transpose();
    a_ = Core::of(a, Mat3L::Identity(), Vec3L::Zero());
    b_ = Core::of(b, R_AW * matrix_of(X_WB.q), R_AW * (X_WB.p.cast<Real>() - X_WA.p.cast<Real>()));
    if (a_.half_space || b_.half_space) {
      offer_axis(a_.half_space ? a_.plane_normal : Vec3L(-b_.plane_normal), 1);
      return;
    }
    for (const Core::Face& f : a_.faces) offer_axis(f.normal, 1);
    for (const Core::Face& f : b_.faces) offer_axis(-f.normal, 1);
    cross_edges(brute);
    if (best_ > 0 || (a_.faces.empty() && b_.faces.empty())) find_distance();
  }

  /// Distance, or minus the least depth [m].
  Real separation() const { return best_ - a_.radius - b_.radius; }
  Real core_separation() const { return best_; }
  /// |n - the nearest of the axes that are best to within `tie` [m]|, times how well that axis is determined: the sine
  /// between its edges, or, of the axis through the closest pair, the distance of the cores as a share of `size`. Apart, the
  /// separation is a concave function of the axis: between the way through the closest pair and another axis that is as good
  /// all are, where a corner hangs over an edge by so little that the way past it is no longer.
  Real normal_error(const Vec3& n, Real tie, Real size) const {
    const Vec3L found = n.cast<Real>();
    Real least = 4;
    for (const Axis& axis : axes_) {
      if (axis.separation < best_ - tie) continue;
      least = std::min(least, (found - axis.n).norm() * weight(axis, size));
      const Axis& pair = axes_.back();
      if (!apart_ || &pair == &axis || pair.separation < best_ - tie) continue;
      const Vec3L across = pair.n - axis.n;
      const Real share = std::clamp<Real>((found - axis.n).dot(across) / across.squaredNorm(), 0, 1);
      const Vec3L between = (axis.n + share * across).normalized();
      if (across.squaredNorm() > 0)
        least = std::min(least, (found - between).norm() * std::max(weight(axis, size), weight(pair, size)));
    }
    return least;
  }
  /// By all supports: a lower bound of the distance for any n.
  Real separation_along(const Vec3L& n) const { return core_separation_along(n) - a_.radius - b_.radius; }
  /// Closest pair against the plane across it; 0 but for rounding.
  Real duality_gap() const { return apart_ ? best_ - core_separation_along(axes_.back().n) : 0; }

  /// How far the corners of a face lie beside its plane [m].
  Real unevenness() const {
    Real worst = 0;
    for (const Core* core : {&a_, &b_}) {
      for (const Core::Face& face : core->faces) {
        for (const Vec3L& v : face.loop) worst = std::max(worst, std::abs(face.normal.dot(v - face.loop[0])));
      }
    }
    return worst;
  }

  /// How far outside of A (or B) p_A lies [m], by planes (a lower bound) or by the distance from the core.
  Real outside(const Core& core, const Vec3L& p) const {
    if (core.half_space) return std::max<Real>(0, core.plane_normal.dot(p - core.plane_point));
    if (core.faces.empty()) return std::max<Real>(0, point_core_distance(core, p) - core.radius);
    Real height = 0;
    for (const Core::Face& f : core.faces) height = std::max(height, f.normal.dot(p - f.loop[0]));
    return height;
  }
  const Core& a() const { return a_; }
  const Core& b() const { return b_; }

 private:
  struct Axis {
    Vec3L n;
    Real separation, sine;
  };
  /// How well an axis is determined.
  Real weight(const Axis& axis, Real size) const {
    const bool of_pair = apart_ && &axis == &axes_.back();
    return of_pair ? std::min<Real>(1, best_ / size) : axis.sine;
  }

  /// Every vertex can only lower it: below `least` it need not be known to the end.
  Real core_separation_along(const Vec3L& n, Real least = -kEndless) const {
    if (a_.half_space || b_.half_space) return -b_.highest(-n) - a_.highest(n);
    Real top = -kEndless, bottom = kEndless;
    for (std::size_t i = 0; i < std::max(a_.vertices.size(), b_.vertices.size()); ++i) {
      if (i < a_.vertices.size()) top = std::max(top, n.dot(a_.vertices[i]));
      if (i < b_.vertices.size()) bottom = std::min(bottom, n.dot(b_.vertices[i]));
      if (bottom - top < least) break;
    }
    return bottom - top;
  }

  void offer_axis(const Vec3L& n, Real sine) {
    const Real separation = core_separation_along(n, best_ - kKept);
    best_ = std::max(best_, separation);
    if (separation >= best_ - kKept) axes_.push_back({n, separation, sine});
  }

  void cross_edges(bool brute) {
    // Signs in 64 bits: their error is 1e-15, and whatever is closer to zero counts as crossing.
    std::vector<double> of_a, of_b;
    const bool by_arcs = !brute && !a_.faces.empty() && !b_.faces.empty();
    if (by_arcs) {
      of_a = products(a_, b_);
      of_b = products(b_, a_);
    }
    for (std::size_t i = 0; i < a_.edges.size(); ++i) {
      const Core::Edge& ea = a_.edges[i];
      const Vec3L da = ea.head - ea.tail;
      for (std::size_t j = 0; j < b_.edges.size(); ++j) {
        const Core::Edge& eb = b_.edges[j];
        if (by_arcs) {
          const double* row = &of_b[i * b_.faces.size()];  // faces of B along edge i of A
          if (row[eb.left] * row[eb.right] > 1e-24) continue;
          const double* column = &of_a[j * a_.faces.size()];
          if (column[ea.left] * column[ea.right] > 1e-24) continue;
        }
        const Vec3L db = eb.head - eb.tail;
        const Vec3L n = da.cross(db);
        const Real length = n.norm(), sine = length / (da.norm() * db.norm());
        if (!(sine > 1e-12L)) continue;
        const Vec3L unit = n / length;
        for (const int sign : {1, -1}) {
          // The true separation is at most that of these two points.
          const Vec3L along = sign * unit;
          if (along.dot(eb.tail - ea.tail) >= best_ - kKept) offer_axis(along, sine);
        }
      }
    }
  }
  /// Unit normals of `of` times unit edges of `other`, edge by edge.
  static std::vector<double> products(const Core& of, const Core& other) {
    std::vector<double> all;
    all.reserve(of.faces.size() * other.edges.size());
    std::vector<Vec3> normals;
    for (const Core::Face& f : of.faces) normals.push_back(f.normal.cast<double>());
    for (const Core::Edge& e : other.edges) {
      const Vec3 d = (e.head - e.tail).normalized().cast<double>();
      for (const Vec3& n : normals) all.push_back(n.dot(d));
    }
    return all;
  }

  struct Pair {
    Real distance = std::numeric_limits<Real>::infinity();
    Vec3L p_a = Vec3L::Zero(), p_b = Vec3L::Zero();
    void offer(const Vec3L& a, const Vec3L& b) {
      const Real d = (b - a).norm();
      if (d < distance) distance = d, p_a = a, p_b = b;
    }
  };

  /// How far each feature reaches along a direction.
  struct Reaches {
    std::vector<Real> vertices, edges, faces;
    Reaches(const Core& core, const Vec3L& n) {
      for (const Vec3L& v : core.vertices) vertices.push_back(n.dot(v));
      for (const Core::Edge& e : core.edges) edges.push_back(std::max(n.dot(e.tail), n.dot(e.head)));
      for (const Core::Face& f : core.faces) {
        faces.push_back(-kEndless);
        for (const Vec3L& v : f.loop) faces.back() = std::max(faces.back(), n.dot(v));
      }
    }
  };

  void find_distance() {
    Pair best;
    // Features need no look if they lie too far apart along the best axis already.
    const auto at_best = [&](const Axis& axis) { return axis.separation == best_; };
    const auto axis = std::find_if(axes_.begin(), axes_.end(), at_best);
    const Vec3L n = axis == axes_.end() ? Vec3L(Vec3L::Zero()) : axis->n;
    const Reaches of_a(a_, n), of_b(b_, -n);
    const auto may_be_closest = [&](Real reach_a, Real reach_b) {
      return -reach_b - reach_a <= best.distance;
    };
    for (std::size_t i = 0; i < a_.vertices.size(); ++i) {
      const Vec3L& v = a_.vertices[i];
      const Real reach = of_a.vertices[i];
      for (std::size_t j = 0; j < b_.vertices.size(); ++j) {
        if (may_be_closest(reach, of_b.vertices[j])) best.offer(v, b_.vertices[j]);
      }
      for (std::size_t j = 0; j < b_.edges.size(); ++j) {
        if (may_be_closest(reach, of_b.edges[j])) best.offer(v, nearest_on(b_.edges[j], v));
      }
      for (std::size_t j = 0; j < b_.faces.size(); ++j) {
        if (!may_be_closest(reach, of_b.faces[j])) continue;
        offer_face(b_.faces[j], v, [&](const Vec3L& foot) { best.offer(v, foot); });
      }
    }
    for (std::size_t j = 0; j < b_.vertices.size(); ++j) {
      const Vec3L& w = b_.vertices[j];
      const Real reach = of_b.vertices[j];
      for (std::size_t i = 0; i < a_.edges.size(); ++i) {
        if (may_be_closest(of_a.edges[i], reach)) best.offer(nearest_on(a_.edges[i], w), w);
      }
      for (std::size_t i = 0; i < a_.faces.size(); ++i) {
        if (!may_be_closest(of_a.faces[i], reach)) continue;
        offer_face(a_.faces[i], w, [&](const Vec3L& foot) { best.offer(foot, w); });
      }
    }
    for (std::size_t i = 0; i < a_.edges.size(); ++i) {
      for (std::size_t j = 0; j < b_.edges.size(); ++j) {
        if (may_be_closest(of_a.edges[i], of_b.edges[j])) offer_edges(a_.edges[i], b_.edges[j], best);
      }
    }
    apart_ = true;
    // Axes that are equal but for rounding are as good.
    std::erase_if(axes_, [&](const Axis& a) { return a.separation < best.distance - kKept; });
    best_ = best.distance;
    const Vec3L d = best.p_b - best.p_a;
    axes_.push_back({best.distance > 0 ? Vec3L(d / best.distance) : Vec3L(Vec3L::UnitZ()), best_, 1});
  }
  static Vec3L nearest_on(const Core::Edge& e, const Vec3L& p) {
    const Vec3L d = e.head - e.tail;
    return e.tail + std::clamp<Real>(d.dot(p - e.tail) / d.squaredNorm(), 0, 1) * d;
  }
  template <typename Offer>
  static void offer_face(const Core::Face& f, const Vec3L& p, const Offer& offer) {
    const Vec3L foot = p - f.normal.dot(p - f.loop[0]) * f.normal;
    for (std::size_t i = 0; i < f.loop.size(); ++i) {
      const Vec3L along = f.loop[(i + 1) % f.loop.size()] - f.loop[i];
      if (f.normal.cross(along).dot(foot - f.loop[i]) < 0) return;
    }
    offer(foot);
  }
  /// Where both parameters are free; the ends are vertices against edges.
  static void offer_edges(const Core::Edge& e, const Core::Edge& f, Pair& best) {
    const Vec3L u = e.head - e.tail, v = f.head - f.tail, w = e.tail - f.tail;
    const Real uu = u.dot(u), uv = u.dot(v), vv = v.dot(v), cross = u.cross(v).squaredNorm();
    if (!(cross > 0)) return;
    // Edges nearly side by side lose digits here: what is left of the equations is solved again.
    Real s = 0, t = 0;
    for (int round = 0; round < 3; ++round) {
      const Vec3L r = w + s * u - t * v;
      s += (uv * v.dot(r) - vv * u.dot(r)) / cross;
      t += (uu * v.dot(r) - uv * u.dot(r)) / cross;
    }
    if (s > 0 && s < 1 && t > 0 && t < 1) best.offer(e.tail + s * u, f.tail + t * v);
  }
  static Real point_core_distance(const Core& core, const Vec3L& p) {
    if (core.edges.empty()) return (p - core.vertices[0]).norm();
    return (p - nearest_on(core.edges[0], p)).norm();
  }

  static constexpr Real kEndless = std::numeric_limits<Real>::infinity();
  static constexpr Real kKept = 1e-9L;  // axes this near to the best may be ties [m]
  Core a_, b_;
  Real best_ = -kEndless;
  bool apart_ = false;
  std::vector<Axis> axes_;
};

}  // namespace tumble::test
