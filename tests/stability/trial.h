// One case tried one way: owns the world, steps it, watches it at every step, and keeps what was expected and measured.
#pragma once

#include <functional>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

#include "stability/way.h"
#include "world/world.h"

namespace tumble::stability {

/// How much of a case is run.
struct Extent {
  bool full = false;               ///< Whole sizes and times; else those of the test program.
  double hours = 0.0;              ///< Simulated time of what must last, instead of its own; 0: its own.
  double cpu_seconds = kInfinity;  ///< After so many a trial is given up: TooSlow.
};

struct TooSlow : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// `value` must be at most `bound`. NaN never is.
struct Check {
  std::string what;
  double value, bound;
  bool holds() const { return value <= bound; }
};

class Trial {
 public:
  Trial(const Way& way, const Extent& extent) : way_(way), extent_(extent) {}

  Options options() const { return options_of(way_); }
  const Way& way() const { return way_; }
  /// Of a size or time: what the test program takes, or the stress program.
  template <typename T>
  T extent(T short_one, std::type_identity_t<T> full_one) const {
    return extent_.full ? full_one : short_one;
  }
  /// The same of the time [s] of something that must last; `--hours` of the stress program replace it.
  double lasting(double short_one, double full_one) const {
    return extent_.hours > 0.0 ? 3600.0 * extent_.hours : extent(short_one, full_one);
  }

  /// From here on this world is watched; drift, energy and momentum count from here.
  World& begin(World world);
  World& world() { return world_; }
  /// Whole steps; `before_step` may push, create and remove.
  void run(double seconds, const std::function<void(World&)>& before_step = {});
  /// Until nobody is awake, at most `limit`; returns the time that took [s].
  double run_to_rest(double limit);

  // Since `begin`:
  /// Largest way of a body [m].
  double drift() const;
  /// Largest rise of kinetic and potential energy over what it had been, relative to the kinetic energy at the start plus
  /// that of lifting every body by its own size.
  double energy_gain() const { return energy_gain_ / energy_scale_; }
  /// Largest change of momentum [N s] relative to the largest sum of masses times speeds.
  double momentum_change() const { return momentum_change_ / momentum_scale_; }
  double deepest() const { return deepest_; }  ///< [m] of all steps
  double deepest_now() const { return world_.report().deepest_penetration; }
  double fastest() const { return fastest_; }  ///< [m/s] of all steps
  double fastest_now() const;                  ///< [m/s]

  void expect(const std::string& what, double value, double bound) {
    checks_.push_back({what, value, bound});
  }
  void expect_true(const std::string& what, bool so) { expect(what, so ? 0.0 : 1.0, 0.0); }
  /// Bodies that the case itself makes non-finite.
  void allow_containment() { containment_allowed_ = true; }
  /// All checks, and that everything stayed finite.
  std::vector<Check> finish();

 private:
  void step();
  void watch();

  Way way_;
  Extent extent_;
  World world_, start_;
  std::vector<Check> checks_;
  double energy_scale_ = 1.0, lowest_energy_ = 0.0, energy_gain_ = 0.0;
  Vec3 momentum_ = Vec3::Zero();
  double momentum_scale_ = 1.0, momentum_change_ = 0.0;
  double deepest_ = 0.0, fastest_ = 0.0;
  double cpu_start_ = 0.0;
  bool finite_ = true, containment_allowed_ = false;
};

}  // namespace tumble::stability
