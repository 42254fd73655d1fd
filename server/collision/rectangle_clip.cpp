// See rectangle_clip.h. t: share of an edge from its start.
#include "collision/rectangle_clip.h"

#include "collision/manifold_builder.h"

namespace tumble {
namespace {

/// Share of a parallelogram's size by which a corner of the rectangle may lie beside it, from rounding.
constexpr double kBeside = 1e-12;

constexpr Four kCornerX = {1.0, -1.0, -1.0, 1.0}, kCornerY = {1.0, 1.0, -1.0, -1.0};

FourFlags of_next_corner(const FourFlags& flags) {
  return (FourFlags)rotated<1>((Four)flags);
}

/// The edges, which gain dx, against the sides across one axis: `side` at +h and `side` + 2 at -h.
struct SideCrossings {
  SideCrossings(const Four& x, const Four& dx, double h, double tolerance, int side) {
    const Four to_upper = h - x, to_lower = -h - x, per_dx = 1.0 / dx;
    const FourFlags above = to_upper<four(-tolerance), below = to_lower> four(tolerance);
    const FourFlags next_above = of_next_corner(above), next_below = of_next_corner(below);
    const FourFlags is_long = absolute(dx) > four(ContactTolerance::kNoCrossing);
    const FourFlags falls_in = above & ~next_above & is_long, rises_in = below & ~next_below & is_long;
    const FourFlags rises_out = next_above & ~above & is_long, falls_out = next_below & ~below & is_long;
    const Four t_upper = to_upper * per_dx, t_lower = to_lower * per_dx;
    const FourFlags upper = FourFlags{} + side, lower = FourFlags{} + (side + 2);
    beside = above | below;
    missed = (above & next_above) | (below & next_below);
    t_entry = falls_in ? t_upper : (rises_in ? t_lower : four(-kInfinity));
    t_exit = rises_out ? t_upper : (falls_out ? t_lower : four(kInfinity));
    entry_side = falls_in ? upper : lower;
    exit_side = rises_out ? upper : lower;
  }

  FourFlags beside, missed;  ///< Corner i; all of edge i, on one side.
  Four t_entry, t_exit;      ///< -infinity, infinity: none.
  FourFlags entry_side, exit_side;
};

FourVectors on_edges(const FourVectors& tail, const FourVectors& along, const Four& t) {
  return {tail.x + t * along.x, tail.y + t * along.y, tail.z + t * along.z};
}

/// Puts the rectangle's corners on the parallelogram's plane and says which are within it.
FourFlags put_rectangle_corners(const Parallelogram& p, double h1, double h2, FourVectors& corners) {
  corners.x = h1 * kCornerX;
  corners.y = h2 * kCornerY;
  const Four x = corners.x - p.m.x(), y = corners.y - p.m.y();  // = s e1 + t e2
  const double per_det = 1.0 / (p.e1.x() * p.e2.y() - p.e1.y() * p.e2.x());
  const Four s = (x * p.e2.y() - y * p.e2.x()) * per_det, t = (y * p.e1.x() - x * p.e1.y()) * per_det;
  corners.z = p.m.z() + s * p.e1.z() + t * p.e2.z();
  return (absolute(s) <= four(1.0 + kBeside)) & (absolute(t) <= four(1.0 + kBeside));
}

/// Takes the corners of the rectangle out of `corners` at which some of `places` lie.
void leave_out(const FourVectors& places, const FourFlags& there, FourFlags& corners) {
  for (int i = 0; i < 4; ++i) {
    if (there[i] == 0) continue;
    corners &= ~((kCornerX * places.x[i] > four(0.0)) & (kCornerY * places.y[i] > four(0.0)));
  }
}

}  // namespace

RectangleClip::RectangleClip(const Parallelogram& p, double h1, double h2, double tolerance) {
  constexpr Four kAlong1 = {-1.0, 1.0, 1.0, -1.0}, kAlong2 = {-1.0, -1.0, 1.0, 1.0};
  const auto corner_at = [&](int k) { return p.m[k] + kAlong1 * p.e1[k] + kAlong2 * p.e2[k]; };
  const auto edge_along = [&](int k) {
    return Four{2.0 * p.e1[k], 2.0 * p.e2[k], -2.0 * p.e1[k], -2.0 * p.e2[k]};
  };
  const FourVectors corners = {corner_at(0), corner_at(1), corner_at(2)};
  const FourVectors along = {edge_along(0), edge_along(1), edge_along(2)};
  const SideCrossings x(corners.x, along.x, h1, tolerance, 0), y(corners.y, along.y, h2, tolerance, 1);
  const Four t_entry = larger(x.t_entry, y.t_entry), t_exit = smaller(x.t_exit, y.t_exit);
  const FourFlags visible = ~(x.missed | y.missed) & (t_entry < t_exit);
  places[corner] = corners;
  places[entry] = on_edges(corners, along, t_entry);
  places[exit] = on_edges(corners, along, t_exit);
  is_left[corner] = ~(x.beside | y.beside);
  // A crossing before the edge's start or after its end is one of a corner within the tolerance.
  is_left[entry] = visible & (t_entry > four(0.0)) & (t_entry < four(1.0));
  is_left[exit] = visible & (t_exit > four(0.0)) & (t_exit < four(1.0));
  is_left[rectangle_corner] = put_rectangle_corners(p, h1, h2, places[rectangle_corner]);
  on = {FourFlags{8, 8, 8, 8}, y.t_entry > x.t_entry ? y.entry_side : x.entry_side,
        y.t_exit < x.t_exit ? y.exit_side : x.exit_side, FourFlags{4, 5, 6, 7}};
  for (const Kind kind : {corner, entry, exit}) {
    const FourFlags there = is_left[kind] & (absolute(absolute(places[kind].x) - h1) <= four(tolerance)) &
                            (absolute(absolute(places[kind].y) - h2) <= four(tolerance));
    if (any(there)) leave_out(places[kind], there, is_left[rectangle_corner]);
  }
}

RectangleClip::Set RectangleClip::corners_below(double height) const {
  FourFlags bits{};
  for (std::size_t kind = 0; kind < kKinds; ++kind) {
    const FourFlags bit = FourFlags{1, 2, 4, 8} << static_cast<long long>(4 * kind);
    bits |= is_left[kind] & (places[kind].z <= four(height)) & bit;
  }
  return static_cast<Set>(bits[0] | bits[1] | bits[2] | bits[3]);
}

}  // namespace tumble
