// impacts_accuracy [SHARE]: a Markdown table of every row of the impacts' acceptance, bound and measured value side by
// side, at three steps; SHARE (1) scales the simulated times and the number of random blows.
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <string>

#include "support/impact_scenes.h"
#include "support/random_blows.h"

namespace {

using namespace tumble;
using namespace tumble::test;

const char* step_name(double h) {
  return h > 0.01 ? "1/60" : h > 0.002 ? "1/240" : "1/1000";
}

void print(const std::string& scene, const char* step, const char* what, double bound, double measured,
           double microseconds, const Counters& counters) {
  std::printf("| %s | %s | %s | %.0e | %.1e | %.1f | %llu | %llu |\n", scene.c_str(), step, what, bound,
              measured, microseconds, static_cast<unsigned long long>(counters.impacts),
              static_cast<unsigned long long>(counters.impacts_capped));
}

/// Of the world, stepped through `seconds`; what follows each step is not in the time.
double time_steps(World& world, double seconds, const std::function<void()>& after_step) {
  using Clock = std::chrono::steady_clock;
  const int steps = static_cast<int>(std::lround(seconds / world.options().time_step));
  double spent = 0.0;
  for (int i = 0; i < steps; ++i) {
    const Clock::time_point start = Clock::now();
    world.step();
    spent += std::chrono::duration<double, std::micro>(Clock::now() - start).count();
    after_step();
  }
  return spent / steps;
}

void run_energy(const char* scene, World world, double seconds, const char* what, double bound) {
  const double start = total_energy(world);
  const double steps = std::round(seconds / world.options().time_step);
  double square = 0.0, drift = 0.0;
  const double microseconds = time_steps(world, seconds, [&] {
    const double error = total_energy(world) - start;
    square += error * error / steps;
    drift = std::max(drift, std::abs(error / start));
  });
  const bool relative = std::string(what) == "energy drift";
  print(scene, step_name(world.options().time_step), what, bound, relative ? drift : square, microseconds,
        world.counters());
}

void run_ball(double restitution, double h, double seconds) {
  const Material material{.friction = 0.0, .restitution = restitution};
  World world(with_step(h));
  world.create_body(ground(material));
  const BodyId ball = world.create_body(body("ball", Sphere{0.1}, Vec3(0, 0, 1.1), material));
  double height = 0.0;
  const double microseconds = time_steps(world, seconds, [&] {
    const double exact = bouncing_height(restitution, world.time());
    height = std::max(height, std::abs(world.motion(ball.index).x.z() - 0.1 - exact));
  });
  print(restitution == 1.0 ? "ball, e = 1" : "ball, e = 0.8", step_name(h), "height [m]", 1e-12, height,
        microseconds, world.counters());
}

void run_cradle(double gap, double h) {
  double worst = 0.0, microseconds = 0.0;
  Counters counters;
  for (int arriving = 1; arriving <= 4; ++arriving) {
    World world = cradle(arriving, gap, 1.0, with_step(h));
    microseconds = time_steps(world, 1.0, [] {});
    for (std::uint32_t i = 0; i < 5; ++i) {
      const double exact = i < 5u - static_cast<unsigned>(arriving) ? 0.0 : 1.0;
      worst = std::max(worst, std::abs(world.motion(i).v.x() - exact));
    }
    counters.impacts += world.counters().impacts;
  }
  print(gap == 0.0 ? "cradle, touching" : "cradle, gaps of 1e-9 m", step_name(h), "velocity [m/s]", 1e-13,
        worst, microseconds, counters);
}

void run_blows(int points, int count) {
  const BlowTally tally = strike_random_boxes(points, count);
  const std::string name = std::to_string(count) + " blows of " + std::to_string(points) + " points";
  std::printf("| %s | | energy gain | 1e-13 | %.1e | | | %d |\n", name.c_str(), std::max(0.0, tally.gain),
              tally.capped);
  std::printf("| %s | | beyond the cone | 1e-13 | %.1e | | | |\n", name.c_str(),
              std::max(0.0, tally.beyond_cone));
  std::printf("| %s | | approach left | 1e-08 | %.1e | | | |\n", name.c_str(), std::max(0.0, tally.approach));
}

}  // namespace

int main(int argc, char** argv) {
  const double share = argc > 1 ? std::atof(argv[1]) : 1.0;
  std::puts("| scene | step [s] | error | bound | measured | us a step | impacts | capped |");
  std::puts("|---|---|---|---|---|---|---|---|");
  for (const double h : kStepLengths) {
    run_ball(1.0, h, std::max(1.0, 10.0 * share));
    run_ball(0.8, h, 5.0);
    run_energy("bouncing, 49 balls", bouncing(7, h), std::max(1.5, 20.0 * share), "energy^2 [J^2]", 1e-12);
    run_energy("elastic 666, 216 balls", elastic_666(6, h), std::max(0.6, 10.0 * share), "energy^2 [J^2]",
               1e-6);
    run_energy("gas, 512 balls", gas(8, with_step(h)), std::max(0.2, 10.0 * share), "energy drift", 1e-13);
    run_energy("tumbling box", tumbling_box(h), std::max(1.0, 10.0 * share), "energy drift", 1e-12);
    run_cradle(0.0, h);
    run_cradle(1e-9, h);
  }
  for (const int points : {1, 3, 4}) run_blows(points, std::max(500, static_cast<int>(1e5 * share)));
  return 0;
}
