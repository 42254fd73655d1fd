// See trial.h.
#include "stability/trial.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ctime>

#include "support/world_builder.h"

namespace tumble::stability {
namespace {

double cpu_seconds() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

double energy(const Conserved& sums) {
  return sums.kinetic_energy + sums.potential_energy;
}

bool all_finite(const Motion& motion) {
  return motion.x.allFinite() && motion.q.coeffs().allFinite() && motion.v.allFinite() &&
         motion.w.allFinite();
}

/// Calls f(slot) for every body that forces move.
template <typename F>
void for_each_dynamic(const World& world, F f) {
  for (std::uint32_t slot = 0; slot < world.body_capacity(); ++slot) {
    if (world.body(slot).exists && world.body(slot).type == BodyType::dynamic) f(slot);
  }
}

double reach(const World& world, std::uint32_t slot) {
  double largest = 0.0;
  for (const std::uint32_t index : world.body(slot).geometries) {
    largest = std::max(largest, world.geometries()[index].reach);
  }
  return largest;
}

}  // namespace

World& Trial::begin(World world) {
  if (cpu_start_ == 0.0) cpu_start_ = cpu_seconds();
  world_ = std::move(world);
  start_ = world_;
  const Conserved sums = world_.compute_conserved();
  double lift = 0.0, momenta = 0.0;
  for_each_dynamic(world_, [&](std::uint32_t slot) {
    const double mass = 1.0 / world_.mass_properties(slot).inv_mass;
    lift += mass * world_.options().gravity.norm() * reach(world_, slot);
    momenta += mass * world_.motion(slot).v.norm();
  });
  const double scale = sums.kinetic_energy + lift;
  energy_scale_ = scale > 0.0 ? scale : 1.0;
  lowest_energy_ = energy(sums);
  momentum_ = sums.momentum;
  momentum_scale_ = momenta > 0.0 ? momenta : 1.0;
  energy_gain_ = momentum_change_ = deepest_ = fastest_ = 0.0;
  return world_;
}

void Trial::run(double seconds, const std::function<void(World&)>& before_step) {
  for (const double end = world_.time() + seconds; world_.time() < end - 0.5 * world_.options().time_step;) {
    if (before_step) before_step(world_);
    step();
  }
}

double Trial::run_to_rest(double limit) {
  const double begin = world_.time();
  do {
    step();
  } while (world_.time() - begin < limit && world_.report().bodies_awake > 0);
  return world_.time() - begin;
}

void Trial::step() {
  world_.step();
  watch();
  if (cpu_seconds() - cpu_start_ > extent_.cpu_seconds) {
    throw TooSlow(fmt::format("given up at {:.3g} s of its time", world_.time()));
  }
}

void Trial::watch() {
  if (world_.report().bodies_awake == 0) return;  // it stands as it stood
  const Conserved sums = world_.compute_conserved();
  const double now = energy(sums);
  finite_ = finite_ && std::isfinite(now) && sums.momentum.allFinite();
  energy_gain_ = std::max(energy_gain_, now - lowest_energy_);
  lowest_energy_ = std::min(lowest_energy_, now);
  momentum_change_ = std::max(momentum_change_, (sums.momentum - momentum_).norm());
  deepest_ = std::max(deepest_, world_.report().deepest_penetration);
  fastest_ = std::max(fastest_, fastest_now());
}

double Trial::drift() const {
  return test::largest_displacement(start_, world_);
}

double Trial::fastest_now() const {
  double fastest = 0.0;
  for_each_dynamic(world_,
                   [&](std::uint32_t slot) { fastest = std::max(fastest, world_.motion(slot).v.norm()); });
  return fastest;
}

std::vector<Check> Trial::finish() {
  for_each_dynamic(world_, [&](std::uint32_t slot) { finite_ = finite_ && all_finite(world_.motion(slot)); });
  expect_true("finite", finite_);
  if (!containment_allowed_) {
    expect("bodies contained", static_cast<double>(world_.counters().non_finite_contained), 0.0);
  }
  return checks_;
}

}  // namespace tumble::stability
