// Ropes as rigid rows. n runs from B's anchor to A's, so u < 0 stretches and lambda >= 0 pulls the anchors together.
// Direction and arms are taken where free motion would have the anchors at half the step, as for springs: then
// distance^2 changes by -2 h u_mean |middle| exactly, u_mean = (u0 + u)/2, for bodies that move with the average velocity.
// A taut rope that swings is held by u_mean >= -gap/h: its length is kept and the rope does no work. A rope that snaps
// taut in the step is a closing contact: u >= -gap/h, or what restitution asks for.
#include "dynamics/joint_rope.h"

#include <algorithm>
#include <cmath>

namespace tumble {
namespace {

/// Way that may be used up in this step; < 0: the share of the over-length that is taken back.
double allowed_way(double gap, double h, const BoundSettings& settings) {
  if (gap >= 0.0) return gap;
  return -std::min(h * settings.push_speed, settings.push_fraction * std::max(0.0, -gap - settings.slop));
}

}  // namespace

bool make_rope_row(const Rope& rope, const SolverBody& A, const SolverBody& B, double h,
                   const BoundSettings& settings, ScalarRow& row) {
  const Vec3 start = A.x + row.rA - B.x - row.rB;
  const Vec3 u_start = relative_start_velocity(A, B, row.rA, row.rB),
             u_free = relative_velocity(A, B, row.rA, row.rB);
  const Vec3 middle = start - 0.25 * h * (u_start + u_free);
  const double distance = std::sqrt(start.squaredNorm()), length = std::sqrt(middle.squaredNorm());
  if (!(distance > 0.0 && length > 0.0)) return false;
  row.lower = 0.0;
  row.n = middle / length;
  row.gap = (rope.length * rope.length - distance * distance) / (2.0 * length);
  const double u0 = row.n.dot(u_start), u1 = row.n.dot(u_free);
  if (row.gap + h * std::min(u0, u1) > 0.0) return false;

  // What stretches at the start of the step beyond the turn of the rope in half a step and one step of forces, or uses up
  // what was left of its length, is not swinging but a snap. Bodies move with the end velocity then, to which the
  // direction and arms of the start belong.
  constexpr double kSlack = 1e-8;  // [m] as choose_drift allows
  const double stretching = -start.dot(u_start) / distance;
  const double way = allowed_way(row.gap, h, settings);
  const bool uses_up = row.gap > 0.0 && h * stretching > row.gap + kSlack;
  if (uses_up || stretching > std::abs(u0 + stretching) + std::abs(u1 - u0)) {
    row.n = start / distance;
    row.gap = rope.length - distance;
    const bool bounces = rope.restitution > 0.0 && stretching > std::abs(u1 - u0);  // else a microcollision
    row.bound = bounces ? rope.restitution * stretching : -way / h;
    return true;
  }
  row.rA += 0.25 * h * (A.w0 + A.w).cross(row.rA);
  row.rB += 0.25 * h * (B.w0 + B.w).cross(row.rB);
  // A remainder of stretching is stopped: to mirror it, as u = -u0 would, keeps the rope humming.
  row.bound =
      -2.0 * way / h - (row.n.dot(relative_start_velocity(A, B, row.rA, row.rB)) + std::max(0.0, stretching));
  return true;
}

bool make_taut_rope_row(const Rope& rope, const SolverBody& A, const SolverBody& B, double slack,
                        ScalarRow& row) {
  const Vec3 line = A.x + row.rA - B.x - row.rB;
  const double distance = std::sqrt(line.squaredNorm());
  if (!(distance > 0.0) || rope.length - distance > slack) return false;
  row.lower = 0.0;
  row.n = line / distance;
  return true;
}

}  // namespace tumble
