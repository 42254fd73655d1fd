// Free motion through the whole engine, row by row of what it promises. The truth is a closed form, a tabled solution of 113
// bits, or a Taylor series of order 24 in 80 bits that checks itself. Measured values stand beside the bounds.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "support/rotation_cases.h"
#include "support/rotation_classes.h"
#include "support/rotation_reference.h"
#include "support/world_builder.h"
#include "world/world.h"

namespace tumble {
namespace {

using namespace test;

BodyDefinition body_with_moments(const Vec3& I, const Vec3& w) {
  BodyDefinition definition;
  definition.name = "body";
  definition.inertia = Inertia{1.0, Vec3::Zero(), I.asDiagonal()};
  definition.w_WB = w;
  return definition;
}

struct RotationErrors {
  double angle = 0.0, energy = 0.0, momentum = 0.0;  // [rad], relative
};

__extension__ using Quad = __float128;

/// Largest errors of a free body read 60 times a second, against a truth in Real that ends within `doubt` of the table's.
template <typename Real>
RotationErrors errors_at_60_hz(const RotationCase& c, double doubt) {
  const double h = 1.0 / 60.0;
  World world(weightless(h));
  world.create_body(body_with_moments(c.I, c.w0));
  const Conserved start = world.compute_conserved();
  RotationReference<Real> truth(c.I, c.w0);
  RotationErrors errors;
  const int steps = static_cast<int>(std::lround(60.0 * c.time));
  for (int i = 0; i < steps; ++i) {
    world.step();
    truth.advance(h, static_cast<Real>(0.3));
    const Conserved now = world.compute_conserved();
    errors.angle = std::max(errors.angle, angle_between(world.motion(0).q, truth.orientation()));
    errors.energy = std::max(errors.energy, std::abs(now.kinetic_energy / start.kinetic_energy - 1.0));
    errors.momentum = std::max(errors.momentum, (now.angular_momentum - start.angular_momentum).norm() /
                                                    start.angular_momentum.norm());
  }
  EXPECT_LT(angle_between(truth.orientation(), c.q), doubt) << c.name;
  return errors;
}

TEST(FreeMotion, AGenericBodyReadAt60Hz) {
  for (const RotationCase* c : {&kGeneric, &kPlate}) {
    const RotationErrors errors = errors_at_60_hz<Quad>(*c, 2e-15);
    EXPECT_LE(errors.angle, 1e-13) << c->name;   // 1.0e-14, 2.7e-14
    EXPECT_LE(errors.energy, 1e-14) << c->name;  // 4.4e-16, 6.7e-16
    EXPECT_EQ(errors.momentum, 0.0) << c->name;
  }
  const RotationErrors errors = errors_at_60_hz<long double>(kGenericLong, 1e-13);
  EXPECT_LE(errors.angle, 1e-11);   // 9.4e-13
  EXPECT_LE(errors.energy, 1e-14);  // 6.7e-16
  EXPECT_EQ(errors.momentum, 0.0);
}

TEST(FreeMotion, DzhanibekovsNutReadAt60Hz) {
  const RotationErrors brief = errors_at_60_hz<Quad>(kDzhanibekov, 1e-15);
  EXPECT_LE(brief.angle, 1e-12);   // 1.7e-14
  EXPECT_LE(brief.energy, 1e-14);  // 1.8e-15
  World world(weightless(1.0 / 60.0));
  world.create_body(body_with_moments(kDzhanibekovLong.I, kDzhanibekovLong.w0));
  run(world, 60000);
  EXPECT_LE(angle_between(world.motion(0).q, kDzhanibekovLong.q), 1e-10);  // 9.9e-13
}

/// Change of the closed form's answer when each datum moves by its last bit.
double conditioning(const RandomRotation& c, const Quat& answer) {
  double sum = 0.0;
  for (int i = 0; i < 6; ++i) {
    RandomRotation moved = c;
    double& datum = i < 3 ? moved.I[i] : moved.w[i - 3];
    datum = std::nextafter(datum, 10.0);
    Motion start;
    start.w = moved.w;
    start.L = moved.I.cwiseProduct(moved.w);
    sum += angle_between(Flight(principal_body(moved.I), start, Vec3::Zero()).at(c.t).q, answer);
  }
  return sum + 2e-16 * (1.0 + c.w.norm() * c.t);
}

TEST(FreeMotion, EveryClassOfBodies) {
  constexpr std::uint64_t kCases = 100;  // ./run bench motion takes 2000
  for (int k = 0; k < static_cast<int>(kRotationClassNames.size()); ++k) {
    const auto kind = static_cast<RotationClass>(k);
    std::vector<double> errors;
    for (std::uint64_t i = 0; i < kCases; ++i) {
      const RandomRotation c = random_rotation(kind, i);
      Motion start;
      start.w = c.w;
      start.L = c.I.cwiseProduct(c.w);
      const Quat answer = Flight(principal_body(c.I), start, Vec3::Zero()).at(c.t).q;
      ASSERT_TRUE(answer.coeffs().allFinite());
      const Truth truth = true_rotation(c.I, c.w, c.t);
      const double error = angle_between(answer, truth.q);
      errors.push_back(error);
      if (kind == RotationClass::separatrix) {
        EXPECT_LE(error, conditioning(c, answer) + truth.doubt) << i;
      }
    }
    if (kind == RotationClass::separatrix) continue;
    std::sort(errors.begin(), errors.end());
    // Largest over the classes: 1.6e-13, 4.4e-13.
    EXPECT_LE(errors[kCases * 99 / 100 - 1], 1e-12) << kRotationClassNames[static_cast<std::size_t>(k)];
    EXPECT_LE(errors.back(), 1e-9) << kRotationClassNames[static_cast<std::size_t>(k)];
  }
}

/// The case under its torque as one push, at 1/h steps a second.
double torque_error(const RotationCase& c, double h) {
  World world(weightless(h));
  const BodyId id = world.create_body(body_with_moments(c.I, c.w0));
  world.push({.body = id, .torque = c.torque, .duration = c.time});
  run(world, static_cast<int>(std::lround(c.time / h)));
  return angle_between(world.motion(0).q, c.q);
}

TEST(FreeMotion, AConstantTorqueInTheWorld) {
  EXPECT_LE(torque_error(kTorque, 1.0 / 60.0), 1e-11);      // 9.4e-15
  EXPECT_LE(torque_error(kTorque, 1.0 / 240.0), 1e-11);     // 9.5e-15
  EXPECT_LE(torque_error(kTorque, 1e-3), 1e-11);            // 4.1e-14
  EXPECT_LE(torque_error(kTorqueLong, 1.0 / 60.0), 1e-10);  // 2.2e-12
}

TEST(FreeMotion, FreeFallAndThrow) {
  for (const double h : {1.0 / 60.0, 1e-3}) {
    for (const Vec3& v0 : {Vec3(0, 0, 0), Vec3(3, -1, 12)}) {
      Options options;
      options.time_step = h;
      World world(options);
      BodyDefinition definition = body("box", Box{Vec3(0.1, 0.2, 0.3)}, Vec3::Zero());
      definition.v_WB = v0;
      world.create_body(definition);
      const int steps = static_cast<int>(std::lround(10.0 / h));
      run(world, steps);
      const double t = steps * h;
      const Vec3 exact = t * v0 + 0.5 * t * t * options.gravity;
      EXPECT_LE((world.motion(0).x - exact).norm(), 1e-13 * exact.norm());  // 1.6e-16
      EXPECT_LE((world.motion(0).v - (v0 + t * options.gravity)).norm(), 1e-13 * 98.1);
    }
  }
}

TEST(FreeMotion, ADampedThrow) {
  for (const double h : {1.0 / 60.0, 1e-3}) {
    Options options;
    options.time_step = h;
    World world(options);
    BodyDefinition definition = body("box", Box{Vec3(0.1, 0.2, 0.3)}, Vec3::Zero());
    const Vec3 v0(3, -1, 12);
    const long double c = 0.4;
    definition.v_WB = v0;
    definition.linear_damping = static_cast<double>(c);
    world.create_body(definition);
    const int steps = static_cast<int>(std::lround(10.0 / h));
    run(world, steps);
    const long double t = static_cast<long double>(steps) * h,
                      loss = -std::expm1(-static_cast<long double>(definition.linear_damping) * t);
    const long double damping = definition.linear_damping;
    for (int i = 0; i < 3; ++i) {
      const long double a = options.gravity[i];
      const long double x = v0[i] * loss / damping + a * (damping * t - loss) / (damping * damping);
      // Measured: 2.8e-14 m, 1e-17 m/s.
      EXPECT_NEAR(world.motion(0).x[i], static_cast<double>(x), 1e-13 * 200.0);
      EXPECT_NEAR(world.motion(0).v[i], static_cast<double>(v0[i] * (1 - loss) + a * loss / damping),
                  1e-13 * 25.0);
    }
  }
}

/// Error of a mass of 2 kg on 200 N/m (10 rad/s), stretched by 0.1 m, after 10 s.
double spring_error(double h) {
  World world(weightless(h));
  const BodyId ball = world.create_body(body_of_mass("ball", Sphere{0.1}, 2.0, Vec3(1.1, 0, 0)));
  world.create_spring({"spring", Anchor{}, Anchor{ball, Vec3::Zero()}, Spring{1.0, 200.0, 0.0}});
  const int steps = static_cast<int>(std::lround(10.0 / h));
  run(world, steps);
  EXPECT_EQ(world.counters().islands_smooth, static_cast<std::uint64_t>(steps));
  return std::abs(world.motion(0).x.x() - (1.0 + 0.1 * std::cos(10.0 * steps * h))) / 0.1;
}

TEST(FreeMotion, ASpringOscillator) {
  EXPECT_LE(spring_error(1e-3), 1e-9);        // 1.3e-14
  EXPECT_LE(spring_error(1.0 / 60.0), 1e-8);  // 1.7e-10
  // Both without sub-steps.
  EXPECT_NEAR(std::log2(spring_error(1.0 / 120.0) / spring_error(1.0 / 240.0)), 6.0, 0.3);
}

TEST(FreeMotion, AThrustThatTurnsWithItsBody) {
  // Spin w about z, thrust F along the body's x: v = F/(m w) (sin wt, 1 - cos wt), x its integral.
  const double w = 3.0, force = 5.0, t = 4.0;
  for (const double h : {1.0 / 60.0, 1e-3}) {
    World world(weightless(h));
    const BodyId id = world.create_body(body_with_moments(Vec3(1, 2, 3), Vec3(0, 0, w)));
    world.push({.body = id, .frame = Push::Frame::body, .force = Vec3(force, 0, 0), .duration = t});
    run(world, static_cast<int>(std::lround(t / h)));
    const Motion motion = world.motion(0);
    const double s = std::sin(w * t), c = std::cos(w * t);
    // Measured: 1.0e-13 m/s, 3.6e-13 m, 3.2e-14 rad.
    EXPECT_LE((motion.v - force / w * Vec3(s, 1 - c, 0)).norm(), 1e-11);
    EXPECT_LE((motion.x - force / (w * w) * Vec3(1 - c, w * t - s, 0)).norm(), 1e-11);
    EXPECT_LE(angle_between(motion.q, exp_map(Vec3(0, 0, w * t))), 1e-12);
  }
}

TEST(FreeMotion, ATorqueAboutAPrincipalAxisOfTheBody) {
  // theta = tau t^2 / (2 I)
  for (const Push::Frame frame : {Push::Frame::world, Push::Frame::body}) {
    World world(weightless(1.0 / 60.0));
    const BodyId id = world.create_body(body_with_moments(Vec3(1, 2, 3), Vec3::Zero()));
    world.push({.body = id, .frame = frame, .torque = Vec3(0, 0, 1.5), .duration = 4.0});
    run(world, 240);
    // Measured: 1.9e-14 rad, 1.7e-14 rad/s.
    EXPECT_LE(angle_between(world.motion(0).q, exp_map(Vec3(0, 0, 1.5 * 16.0 / 6.0))), 1e-12);
    EXPECT_NEAR(world.motion(0).w.z(), 1.5 * 4.0 / 3.0, 1e-13);
  }
}

struct BoxesErrors {
  double position = 0.0, velocity = 0.0, momentum = 0.0, energy = 0.0;
};

/// Gazebo's benchmark "boxes" (scpeters/benchmark): largest errors over 10 s; position and velocity absolute.
BoxesErrors boxes_errors(const Vec3& v0, const Vec3& w0, const Vec3& gravity, double h) {
  Options options;
  options.time_step = h;
  options.gravity = gravity;
  World world(options);
  BodyDefinition box = body_of_mass("box", Box{Vec3(0.05, 0.2, 0.45)}, 10.0, Vec3::Zero());
  box.v_WB = v0;
  box.w_WB = w0;
  world.create_body(box);
  const Vec3 L0 = world.motion(0).L;
  const auto energy_of = [](const Conserved& c) { return c.kinetic_energy + c.potential_energy; };
  const double E0 = energy_of(world.compute_conserved());
  BoxesErrors errors;
  const int steps = static_cast<int>(std::lround(10.0 / h));
  for (int i = 1; i <= steps; ++i) {
    world.step();
    const double t = i * h;
    const Motion motion = world.motion(0);
    errors.position = std::max(errors.position, (motion.x - (t * v0 + 0.5 * t * t * gravity)).norm());
    errors.velocity = std::max(errors.velocity, (motion.v - (v0 + t * gravity)).norm());
    errors.momentum = std::max(errors.momentum, (motion.L - L0).norm() / L0.norm());
    errors.energy = std::max(errors.energy, std::abs(energy_of(world.compute_conserved()) / E0 - 1.0));
  }
  return errors;
}

TEST(FreeMotion, GazebosBoxes) {
  for (const double h : {1e-4, 1e-3, 1e-2}) {
    for (const bool complex : {false, true}) {
      const BoxesErrors errors = complex
                                     ? boxes_errors(Vec3(-2, 2, 8), Vec3(0.1, 5, 0.1), Vec3(0, 0, -9.8), h)
                                     : boxes_errors(Vec3(-0.9, 0.4, 0.1), Vec3(0.5, 0, 0), Vec3::Zero(), h);
      // Measured, at worst: 1.1e-13 m, 0, 0, 4.6e-14 (of 368 J, where 40 kJ of height and speed cancel).
      EXPECT_LE(errors.position, 1e-11) << h << " " << complex;
      EXPECT_LE(errors.velocity, 1e-12) << h << " " << complex;
      EXPECT_LE(errors.momentum, 1e-13) << h << " " << complex;
      EXPECT_LE(errors.energy, 1e-13) << h << " " << complex;
    }
  }
}

}  // namespace
}  // namespace tumble
