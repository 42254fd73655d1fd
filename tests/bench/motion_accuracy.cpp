// motion_accuracy SHARE CSV: prints, as Markdown, the errors of flights for 2000 SHARE cases (at least 100) of each class of
// bodies; writes to CSV the error and CPU time of 10 simulated seconds for each case, method and time step, Bullet,
// ODE and MuJoCo's Runge-Kutta integrator among the methods.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <string>
#include <vector>

#include "dynamics/flight.h"
#include "dynamics/integrator.h"
#include "peers/free_bodies.h"
#include "peers/peer.h"
#include "support/rotation_cases.h"
#include "support/rotation_classes.h"
#include "support/rotation_reference.h"

namespace {

using namespace tumble;
using namespace tumble::test;

Motion start_of(const Vec3& I, const Vec3& w, const Vec3& v = Vec3::Zero()) {
  Motion start;
  start.v = v;
  start.w = w;
  start.L = I.cwiseProduct(w);
  return start;
}

void print_classes(std::size_t cases) {
  std::printf(
      "Orientation error of a flight after up to 10 s, %zu random bodies a class [rad]; doubt: two step "
      "sizes of "
      "the reference apart.\n\n| class | median | 99 %% | max | doubt |\n|---|---|---|---|---|\n",
      cases);
  for (std::size_t k = 0; k < kRotationClassNames.size(); ++k) {
    std::vector<double> errors;
    double doubt = 0.0;
    for (std::size_t i = 0; i < cases; ++i) {
      const RandomRotation c = random_rotation(static_cast<RotationClass>(k), i);
      const Truth truth = true_rotation(c.I, c.w, c.t);
      errors.push_back(
          angle_between(Flight(principal_body(c.I), start_of(c.I, c.w), Vec3::Zero()).at(c.t).q, truth.q));
      doubt = std::max(doubt, truth.doubt);
    }
    std::sort(errors.begin(), errors.end());
    std::printf("| %s | %.1e | %.1e | %.1e | %.1e |\n", kRotationClassNames[k], errors[cases / 2],
                errors[cases * 99 / 100], errors.back(), doubt);
  }
}

struct Case {
  const char* name;
  Vec3 I, w, v, gravity;
  Quat end;
};

/// Gazebo's complex box in units of its mass; its end from the reference.
Case complex_box() {
  const Vec3 I = Vec3(0.97, 0.82, 0.17) / 12.0, w(0.1, 5.0, 0.1);
  return {"gazebo_complex", I, w, Vec3(-2, 2, 8), Vec3(0, 0, -9.8), true_rotation<__float128>(I, w, 10.0).q};
}

using Run = std::function<Motion()>;  ///< To the end; what is timed.
using Simulate = std::function<Run(const Case&, int steps, double h)>;

Simulate stepper(IntegrateFunction integrate) {
  return [integrate](const Case& c, int steps, double h) {
    return [=] {
      const MassProperties mass = principal_body(c.I);
      Motion body = start_of(c.I, c.w, c.v);
      for (int i = 0; i < steps; ++i) {
        integrate(mass, {.v0 = body.v, .v1 = body.v + h * c.gravity, .L0 = body.L, .L1 = body.L}, h, body);
      }
      return body;
    };
  };
}

Run fly(const Case& c, int steps, double h) {
  return [=] {
    const Flight flight(principal_body(c.I), start_of(c.I, c.w, c.v), c.gravity);
    Motion body;
    for (int i = 1; i <= steps; ++i) body = flight.at(i * h);
    return body;
  };
}

Simulate stepper(const bench::Method& method) {
  return [method](const Case& c, int steps, double h) {
    std::shared_ptr<bench::Peer> peer = method.make(bench::free_bodies(1, c.I, c.w, c.v, c.gravity), h);
    return [=] {
      for (int i = 0; i < steps; ++i) peer->step();
      return peer->motion(0);
    };
  };
}

void write_curves(const char* file) {
  std::FILE* csv = std::fopen(file, "w");
  if (!csv) {
    std::perror(file);
    std::exit(1);
  }
  std::fprintf(csv, "case,method,dt,angle_error_rad,position_error_m,energy_error,cpu_s\n");
  std::vector<std::pair<std::string, Simulate>> methods;
  for (int i = 0; i < static_cast<int>(Integrator::closed_form); ++i) {
    const auto integrator = static_cast<Integrator>(i);
    methods.push_back({integrator_name(integrator), stepper(integrate_function(integrator))});
  }
  methods.push_back({"closed_form", fly});
  methods.push_back({"bullet", stepper(bench::bullet_methods().front())});
  methods.push_back({"ode", stepper(bench::ode_methods().front())});
  for (const bench::Method& method : bench::mujoco_methods()) {
    if (method.name == bench::kMujocoRungeKutta) methods.push_back({method.name, stepper(method)});
  }
  std::vector<Case> cases;
  for (const RotationCase* c : {&kGeneric, &kPlate, &kDzhanibekov}) {
    cases.push_back({c->name, c->I, c->w0, Vec3::Zero(), Vec3::Zero(), c->q});
  }
  cases.push_back(complex_box());
  for (const Case& c : cases) {
    const double energy = 0.5 * (c.v.squaredNorm() + c.w.dot(c.I.cwiseProduct(c.w)));
    for (const auto& [name, simulate] : methods) {
      for (const int rate : {30, 60, 120, 240, 480, 1000, 4000}) {
        const double h = 1.0 / rate;
        double cpu = 1e9;
        Motion end;
        for (int repeat = 0; repeat < 3; ++repeat) {
          const Run run = simulate(c, 10 * rate, h);
          const auto begin = std::chrono::steady_clock::now();
          end = run();
          cpu =
              std::min(cpu, std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
        }
        const double t = 10 * rate * h;
        const Vec3 w_B = end.q.conjugate() * end.w;
        const double now =
            0.5 * (end.v.squaredNorm() + w_B.dot(c.I.cwiseProduct(w_B))) - c.gravity.dot(end.x);
        std::fprintf(csv, "%s,%s,%.17g,%.3e,%.3e,%.3e,%.3e\n", c.name, name.c_str(), h,
                     angle_between(end.q, c.end), (end.x - (t * c.v + 0.5 * t * t * c.gravity)).norm(),
                     std::abs(now / energy - 1.0), cpu);
      }
    }
  }
  std::fclose(csv);
}

}  // namespace

int main(int argc, char** argv) {
  const double share = argc > 1 ? std::atof(argv[1]) : 1.0;
  print_classes(std::max<std::size_t>(100, static_cast<std::size_t>(2000.0 * share)));
  if (argc > 2) write_curves(argv[2]);
}
