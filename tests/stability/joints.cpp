// Joints and ropes under stress: heavy at the end of light, long chains, closed loops, impossible anchors.
#include <cmath>

#include "stability/case.h"
#include "support/world_builder.h"

namespace tumble::stability {
namespace {

using namespace test;

constexpr double kLink = 0.2;  // [m] length of a link

/// Links along x from `begin`, each joined to the one before; the first to `held` (or the world). They go up and down by
/// `slope` [rad] in turn.
std::vector<BodyId> add_chain(World& world, int links, const Vec3& begin, std::optional<BodyId> held = {},
                              double slope = 0.0) {
  std::vector<BodyId> chain;
  Vec3 end = begin;
  for (int i = 0; i < links; ++i) {
    const double angle = i % 2 == 0 ? slope : -slope;
    const Vec3 along = kLink * Vec3(std::cos(angle), 0, -std::sin(angle));
    BodyDefinition link =
        body_of_mass("link" + std::to_string(i), Box{Vec3(0.4 * kLink, 0.02, 0.02)}, 1.0, end + 0.5 * along);
    link.X_WL.q = exp_map(Vec3(0, angle, 0));
    chain.push_back(world.create_body(link));
    end += along;
    const Anchor a = i > 0 ? Anchor{chain[chain.size() - 2], Vec3(0.5 * kLink, 0, 0)}
                           : Anchor{held, held ? Vec3(Vec3::Zero()) : begin};
    world.create_joint(
        {"joint" + std::to_string(i), JointKind::ball, a, {chain.back(), Vec3(-0.5 * kLink, 0, 0)}});
  }
  return chain;
}

/// Largest distance of the ends that joints hold together [m].
double largest_gap(const World& world, const std::vector<BodyId>& chain) {
  double largest = 0.0;
  for (std::size_t i = 1; i < chain.size(); ++i) {
    const Vec3 tail = world.link_pose(chain[i - 1].index) * Vec3(0.5 * kLink, 0, 0);
    const Vec3 head = world.link_pose(chain[i].index) * Vec3(-0.5 * kLink, 0, 0);
    largest = std::max(largest, (tail - head).norm());
  }
  return largest;
}

/// Box2D's ball and chain, with so many times the mass of a link at the end, swinging down from level.
void ball_and_chain(Trial& trial, double mass) {
  World world(trial.options());
  const std::vector<BodyId> chain = add_chain(world, 10, Vec3(0, 0, 5));
  const Vec3 end(10 * kLink, 0, 5);
  const BodyId ball = world.create_body(body_of_mass("ball", Sphere{0.3}, mass, end + Vec3(0.3, 0, 0)));
  world.create_joint(
      {"last", JointKind::ball, {chain.back(), Vec3(0.5 * kLink, 0, 0)}, {ball, Vec3(-0.3, 0, 0)}});
  trial.begin(std::move(world));
  double gap = 0.0;
  trial.run(trial.lasting(5.0, 60.0), [&](World& now) { gap = std::max(gap, largest_gap(now, chain)); });
  trial.expect("energy gain", trial.energy_gain(), 1e-2);
  trial.expect("gap of a joint [m]", gap, 1e-3);
}

/// A bridge between two points of the world, a tenth longer than their distance.
void bridge(Trial& trial) {
  World world(trial.options());
  const int planks = 20;
  const std::vector<BodyId> chain = add_chain(world, planks, Vec3(0, 0, 3), {}, std::acos(0.9));
  world.create_joint({"end",
                      JointKind::ball,
                      {chain.back(), Vec3(0.5 * kLink, 0, 0)},
                      {{}, Vec3(0.9 * planks * kLink, 0, 3)}});
  trial.begin(std::move(world));
  trial.run(trial.lasting(5.0, 60.0));
  trial.expect("gap of a joint [m]", largest_gap(trial.world(), chain), 1e-3);
  trial.expect("energy gain", trial.energy_gain(), 1e-2);
}

/// Joined to two points of the world farther apart than its length: nothing can satisfy that.
void stretched(Trial& trial) {
  World world(trial.options());
  const std::vector<BodyId> chain = add_chain(world, 5, Vec3(0, 0, 3));
  world.create_joint(
      {"end", JointKind::ball, {chain.back(), Vec3(0.5 * kLink, 0, 0)}, {{}, Vec3(7 * kLink, 0, 3)}});
  trial.begin(std::move(world));
  trial.run(trial.lasting(5.0, 60.0));
  trial.expect("speed [m/s]", trial.fastest(), 30.0);
}

/// A weight of 1e6 kg on a rope, beside one of a gram.
void ropes(Trial& trial) {
  World world(trial.options());
  for (const double mass : {1e-3, 1e6}) {
    const Vec3 hook(mass > 1.0 ? 3.0 : 0.0, 0, 10);
    const BodyId weight = world.create_body(
        body_of_mass("weight" + std::to_string(mass), Sphere{0.2}, mass, hook + Vec3(1, 0, 0)));
    world.create_rope({"rope" + std::to_string(mass),
                       {{}, hook},
                       {weight, Vec3::Zero()},
                       {.length = 1.0, .restitution = 0.0}});
  }
  trial.begin(std::move(world));
  double longest = 0.0;
  trial.run(trial.lasting(10.0, 60.0), [&](World& now) {
    longest = std::max(longest, (now.motion(0).x - Vec3(0, 0, 10)).norm());
    longest = std::max(longest, (now.motion(1).x - Vec3(3, 0, 10)).norm());
  });
  trial.expect("overlong by [m]", longest - 1.0, 1e-3);
  trial.expect("energy gain", trial.energy_gain(), 1e-3);
}

}  // namespace

std::vector<Case> joint_cases() {
  const auto swing = [](double mass) { return [mass](Trial& trial) { ball_and_chain(trial, mass); }; };
  return {
      {"chain_10", "A ball of ten links' mass swings on a chain: joints hold to 1 mm, no energy gained",
       precise(), swing(10.0)},
      {"chain_1000", "A ball of 1000 links' mass swings on a chain: joints hold to 1 mm, no energy gained",
       precise(), swing(1000.0)},
      {"bridge", "A bridge of 20 planks swings into its sag: joints hold to 1 mm", precise(), bridge},
      {"stretched", "A chain fixed farther apart than its length stays finite, below 30 m/s", precise(),
       stretched},
      {"ropes", "A gram and a thousand tonnes swing on ropes: not overlong, no energy gained",
       precise(1.0 / 240.0), ropes},
  };
}

}  // namespace tumble::stability
