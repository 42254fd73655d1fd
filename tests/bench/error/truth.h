// What a scene's bodies truly do: closed forms, long series in long double, or our own exact way in tiny steps.
#pragma once

#include <vector>

#include "peers/solids.h"

namespace tumble::bench {

/// Motions (x, q, v, w) of the dynamic solids at times k interval, k = 0 .. count.
struct Truth {
  std::vector<std::vector<Motion>> samples;
  double doubt = 0.0;  ///< [m] how far points of the bodies may truly be from there; rounding apart.
};

using ComputeTruth = Truth (*)(const Scene& scene, double interval, std::size_t count);

/// Free flight. Orientations by Taylor series at two step sizes: doubt is their difference.
Truth flying(const Scene& scene, double interval, std::size_t count);
/// Balls of any C_r dropped at rest on the ground z = 0.
Truth bouncing(const Scene& scene, double interval, std::size_t count);
/// On the plane z = 0, from rest: a box slides or sticks, a ball rolls (its mu must suffice).
Truth on_slope(const Scene& scene, double interval, std::size_t count);
/// Balls on the plane z = 0 that slide until they roll; they turn about the axis normal to their way, or not at all.
Truth sliding_to_roll(const Scene& scene, double interval, std::size_t count);
/// Bodies at rest on each other that fall together, as far as the lowest of them is above z = 0, and stop for ever.
Truth dropped(const Scene& scene, double interval, std::size_t count);

/// Whatever the scene: our own exact level at 1e-5 s. Doubt is its distance from the same at 2e-5 s.
Truth by_tiny_steps(const Scene& scene, double interval, std::size_t count);

/// Farthest that a point of the solid's bounding ball may be from where `truth` has it [m].
double distance(const Solid& solid, const Motion& motion, const Motion& truth);

}  // namespace tumble::bench
