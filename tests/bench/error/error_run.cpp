// See error_run.h.
#include "error/error_run.h"

#include <algorithm>
#include <cmath>
#include <ctime>

#include "error/overlap.h"
#include "scene/sdf.h"

namespace tumble::bench {
namespace {

constexpr int kRepeats = 5;

double cpu_time() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

struct Sums {
  double energy = 0.0;           // [J]
  Vec3 momentum = Vec3::Zero();  // [N s]
  Vec3 spin = Vec3::Zero();      // [N m s]
  double mass = 0.0, inertia = 0.0;
};

Sums sums_of(const std::vector<Solid>& dynamic, const std::vector<Motion>& motions, const Vec3& gravity) {
  Sums sums;
  for (std::size_t i = 0; i < dynamic.size(); ++i) {
    const MassProperties& mass = dynamic[i].mass;
    const Motion& motion = motions[i];
    const Vec3 L = angular_momentum(mass, motion.q, motion.w);
    sums.energy +=
        0.5 * mass.mass * motion.v.squaredNorm() + 0.5 * L.dot(motion.w) - mass.mass * gravity.dot(motion.x);
    sums.momentum += mass.mass * motion.v;
    sums.spin += L;
    sums.mass += mass.mass;
    sums.inertia += mass.I.mean();
  }
  return sums;
}

bool is_finite(const std::vector<Motion>& motions) {
  return std::ranges::all_of(motions, [](const Motion& motion) {
    return motion.x.allFinite() && motion.q.coeffs().allFinite() && motion.v.allFinite() &&
           motion.w.allFinite();
  });
}

/// Looks at the state at the times of measurement.
class Meter {
 public:
  explicit Meter(const PreparedScene& prepared)
      : prepared_(prepared), dynamic_(dynamic_of(prepared.solids)), gravity_(prepared.scene.options.gravity) {
    for (const Solid& solid : dynamic_) {
      smooth_ = smooth_ && solid.material.friction == 0.0;
      elastic_ = elastic_ && solid.material.restitution == 1.0;
    }
  }

  void look(std::size_t sample, const std::vector<Motion>& motions, ErrorRun& run) {
    if (!is_finite(motions)) {
      run.error = run.energy_drift = run.momentum_drift = run.spin_drift = run.overlap = kInfinity;
      return;
    }
    const Sums now = sums_of(dynamic_, motions, gravity_);
    if (sample == 0) start_ = before_ = now;
    const auto raise = [](double& worst, double value) { worst = std::max(worst, value); };
    if (!prepared_.truth.samples.empty()) {
      const std::vector<Motion>& truth = prepared_.truth.samples[sample];
      const Sums expected = sums_of(dynamic_, truth, gravity_);
      raise(run.energy_drift, std::abs(now.energy - expected.energy) / now.mass);
      raise(run.momentum_drift, (now.momentum - expected.momentum).norm() / now.mass);
      raise(run.spin_drift, (now.spin - expected.spin).norm() / now.inertia);
      for (std::size_t i = 0; i < dynamic_.size(); ++i)
        raise(run.error, distance(dynamic_[i], motions[i], truth[i]));
    } else {
      const double energy =
          elastic_ && smooth_ ? std::abs(now.energy - start_.energy) : now.energy - before_.energy;
      raise(run.energy_drift, energy / now.mass);
      if (smooth_) {
        raise(run.momentum_drift, (now.momentum - start_.momentum).head<2>().norm() / now.mass);
        raise(run.spin_drift, (now.spin - start_.spin).norm() / now.inertia);
      }
    }
    raise(run.overlap, deepest_overlap(prepared_.solids, motions));
    if (prepared_.definition.measure == Measure::energy) {
      raise(run.error, std::abs(now.energy / start_.energy - 1.0));
    }
    if (prepared_.definition.measure == Measure::overlap) run.error = run.overlap;
    before_ = now;
  }

 private:
  const PreparedScene& prepared_;
  std::vector<Solid> dynamic_;
  Vec3 gravity_;
  bool smooth_ = true, elastic_ = true;
  Sums start_, before_;
};

/// CPU time of the whole, or none beyond the budget; `look(sample, motions)` is not in the time.
template <typename Look>
std::optional<double> simulate(const PreparedScene& prepared, const Method& method, double h, double budget,
                               Look look) {
  const std::unique_ptr<Peer> peer = method.make(prepared.scene, h);
  std::vector<Motion> motions(dynamic_of(prepared.solids).size());
  const auto read = [&] {
    for (std::size_t i = 0; i < motions.size(); ++i) motions[i] = peer->motion(i);
  };
  read();
  look(0, motions);
  const bool watched = motions.size() > 20;  // a single step may exceed the budget
  double spent = 0.0;
  const std::size_t samples =
      static_cast<std::size_t>(std::lround(prepared.definition.seconds / kSampleInterval));
  const long steps = std::lround(kSampleInterval / h);
  for (std::size_t sample = 1; sample <= samples; ++sample) {
    const double begin = cpu_time();
    for (long step = 0; step < steps; ++step) {
      peer->step();
      read();
      if (watched && spent + cpu_time() - begin > budget) return std::nullopt;
    }
    spent += cpu_time() - begin;
    if (spent > budget) return std::nullopt;
    look(sample, motions);
  }
  return spent;
}

}  // namespace

PreparedScene prepare(const ErrorScene& definition, const std::string& folder) {
  PreparedScene prepared{
      definition, scene_name(definition), read_sdf(folder + "/" + definition.file).scene, {}, {}};
  prepared.solids = solids_of(prepared.scene);
  if (definition.truth) {
    const auto samples = static_cast<std::size_t>(std::lround(definition.seconds / kSampleInterval));
    prepared.truth = definition.truth(prepared.scene, kSampleInterval, samples);
  }
  return prepared;
}

std::optional<ErrorRun> run_error(const PreparedScene& prepared, const Method& method, double h,
                                  double budget) {
  const std::size_t bodies = dynamic_of(prepared.solids).size();
  const Scope other = prepared.solids.size() > 1 ? Scope::flight : Scope::contact;
  if (bodies > method.most_bodies || method.scope == other) return std::nullopt;
  ErrorRun run;
  Meter meter(prepared);
  double total = 0.0;
  for (int repeat = 0; repeat < kRepeats; ++repeat) {
    if (repeat > 0 && total / repeat * (repeat + 1) > 0.5 * budget) break;
    const auto spent =
        simulate(prepared, method, h, budget, [&](std::size_t sample, const std::vector<Motion>& motions) {
          if (repeat == 0) meter.look(sample, motions, run);
        });
    if (!spent && repeat == 0) return std::nullopt;
    if (!spent) break;
    total += *spent;
    run.cpu.push_back(*spent / prepared.definition.seconds);
  }
  std::ranges::sort(run.cpu);
  return run;
}

}  // namespace tumble::bench
