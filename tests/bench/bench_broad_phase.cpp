// What a step of the broad phase costs, beside Bullet's tree of boxes (btDbvtBroadphase, double precision) on the same
// motion: spheres of radius 0.5 m fly through a cage, filling a tenth of it, and bounce off its walls; or all of them rest.
// Both sides keep the list of pairs whose boxes meet. Times are of all that a step asks: new boxes, lost and found pairs.
#include <BulletCollision/BroadphaseCollision/btDbvtBroadphase.h>
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iterator>
#include <random>
#include <vector>

#include "collision/broad_phase.h"

namespace {

using namespace tumble;

constexpr double kRadius = 0.5;        // [m]
constexpr double kStep = 1.0 / 240.0;  // [s]
constexpr double kMargin = 0.05;       // [m] slack of the boxes, the same for both
constexpr std::size_t kSpheres = 10'000;

/// Straight flight in a cage, the same for every rival.
class Flight {
 public:
  Flight(std::size_t count, double speed) {
    cage_ = std::cbrt(static_cast<double>(count) * 10.0 * 4.18879 * kRadius * kRadius * kRadius);
    std::mt19937 engine(1);
    const auto uniform = [&](double low, double high) {
      return low + (high - low) * (static_cast<double>(engine()) / 4294967296.0);
    };
    for (std::size_t i = 0; i < count; ++i) {
      Vec3 p, v;
      for (int k = 0; k < 3; ++k) p[k] = uniform(0.0, cage_);
      for (int k = 0; k < 3; ++k) v[k] = uniform(-speed, speed);
      positions.push_back(p);
      velocities.push_back(v);
    }
  }
  void advance() {
    for (std::size_t i = 0; i < positions.size(); ++i) {
      positions[i] += kStep * velocities[i];
      for (int k = 0; k < 3; ++k) {
        if (positions[i][k] < 0.0 || positions[i][k] > cage_) {
          velocities[i][k] = std::copysign(velocities[i][k], 0.5 * cage_ - positions[i][k]);
        }
      }
    }
  }
  Aabb bounds(std::size_t i) const {
    return {positions[i] - Vec3::Constant(kRadius), positions[i] + Vec3::Constant(kRadius)};
  }
  std::vector<Vec3> positions, velocities;

 private:
  double cage_;  // [m]
};

class Tumble {
 public:
  explicit Tumble(const Flight& flight) {
    for (std::size_t i = 0; i < flight.positions.size(); ++i) {
      broad_phase_.add(static_cast<std::uint32_t>(i), flight.bounds(i), kMargin, true);
    }
    find();
  }
  void move(const Flight& flight) {
    for (std::size_t i = 0; i < flight.positions.size(); ++i) {
      broad_phase_.move(static_cast<std::uint32_t>(i), flight.bounds(i), kMargin,
                        kStep * flight.velocities[i]);
    }
  }
  void find() {
    // As the world does: what came apart leaves, what is new is merged in, in order.
    std::erase_if(pairs_, [&](GeometryPair pair) { return !broad_phase_.overlaps(pair); });
    found_.clear();
    broad_phase_.update_pairs(found_);
    merged_.clear();
    std::set_union(pairs_.begin(), pairs_.end(), found_.begin(), found_.end(), std::back_inserter(merged_));
    pairs_.swap(merged_);
  }
  /// Resting bodies are not looked at: neither do their pairs come apart.
  void find_new() {
    found_.clear();
    broad_phase_.update_pairs(found_);
  }
  std::size_t pairs() const { return pairs_.size(); }
  bool has(std::uint32_t a, std::uint32_t b) const {
    return std::binary_search(pairs_.begin(), pairs_.end(), GeometryPair{a, b});
  }

 private:
  BroadPhase broad_phase_;
  std::vector<GeometryPair> pairs_, found_, merged_;
};

btVector3 to_bullet(const Vec3& v) {
  return {v.x(), v.y(), v.z()};
}

class Bullet {
 public:
  explicit Bullet(const Flight& flight) {
    gDbvtMargin = kMargin;
    for (std::size_t i = 0; i < flight.positions.size(); ++i) {
      const Aabb box = flight.bounds(i);
      proxies_.push_back(
          tree_.createProxy(to_bullet(box.lower), to_bullet(box.upper), 0, nullptr, 1, 1, nullptr));
    }
    find();
  }
  void move(const Flight& flight) {
    for (std::size_t i = 0; i < flight.positions.size(); ++i) {
      const Aabb box = flight.bounds(i);
      tree_.setAabb(proxies_[i], to_bullet(box.lower), to_bullet(box.upper), nullptr);
    }
  }
  void find() { tree_.calculateOverlappingPairs(nullptr); }
  void find_new() { find(); }
  std::size_t pairs() {
    return static_cast<std::size_t>(tree_.getOverlappingPairCache()->getNumOverlappingPairs());
  }
  bool has(std::uint32_t a, std::uint32_t b) {
    return tree_.getOverlappingPairCache()->findPair(proxies_[a], proxies_[b]) != nullptr;
  }

 private:
  btDbvtBroadphase tree_;
  std::vector<btBroadphaseProxy*> proxies_;
};

/// Every pair that really touches must be in the list: a quick broad phase that misses some is none.
template <typename Rival>
void check_complete(const Flight& flight, Rival& rival) {
  for (std::size_t i = 0; i < flight.positions.size(); ++i) {
    for (std::size_t j = i + 1; j < flight.positions.size(); ++j) {
      if (!flight.bounds(i).overlaps(flight.bounds(j))) continue;
      if (!rival.has(static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(j))) std::abort();
    }
  }
}

template <typename Rival>
void moving(benchmark::State& state) {
  Flight flight(kSpheres, static_cast<double>(state.range(0)));
  Rival rival(flight);
  const auto step = [&] {
    flight.advance();
    rival.move(flight);
    rival.find();
  };
  for (int i = 0; i < 60; ++i) step();
  check_complete(flight, rival);
  double pairs = 0.0;
  for (auto _ : state) {
    step();
    pairs += static_cast<double>(rival.pairs());
  }
  pairs /= static_cast<double>(state.iterations());
  state.counters["pairs"] = pairs;
  state.counters["seconds_per_pair"] =
      benchmark::Counter(pairs * static_cast<double>(state.iterations()),
                         benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

template <typename Rival>
void resting(benchmark::State& state) {
  const Flight flight(kSpheres, 1.0);
  Rival rival(flight);
  for (auto _ : state) rival.find_new();
  state.counters["pairs"] = static_cast<double>(rival.pairs());
}

/// The flight itself, which the times of `moving` include.
void flight_alone(benchmark::State& state) {
  Flight flight(kSpheres, static_cast<double>(state.range(0)));
  for (auto _ : state) flight.advance();
}

BENCHMARK(flight_alone)->Arg(5)->ArgName("speed_mps")->Unit(benchmark::kMicrosecond);
BENCHMARK(moving<Tumble>)->Arg(1)->Arg(5)->Arg(50)->ArgName("speed_mps")->Unit(benchmark::kMicrosecond);
BENCHMARK(moving<Bullet>)->Arg(1)->Arg(5)->Arg(50)->ArgName("speed_mps")->Unit(benchmark::kMicrosecond);
BENCHMARK(resting<Tumble>)->Unit(benchmark::kMicrosecond);
BENCHMARK(resting<Bullet>)->Unit(benchmark::kMicrosecond);

}  // namespace

BENCHMARK_MAIN();
