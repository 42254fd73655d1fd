// Structures that friction holds: arch, house of cards, rows of dominoes.
#include <cmath>

#include "stability/case.h"
#include "support/world_builder.h"

namespace tumble::stability {
namespace {

using namespace test;

/// Voussoirs between two semicircles, on the ground. Stable: thickness is a quarter of the mean radius (0.107 would do).
World arch(const Options& options, int stones) {
  const Material stone{.friction = 0.6, .density = 200.0};
  World world(options);
  world.create_body(ground(stone));
  const double inner = 3.5, outer = 4.5, half_depth = 0.5, pi = 4.0 * std::atan(1.0);
  for (int i = 0; i < stones; ++i) {
    const double middle = pi * (i + 0.5) / stones, half_angle = 0.5 * pi / stones;
    const Vec3 centre = 4.0 * Vec3(std::cos(middle), 0, std::sin(middle));
    std::vector<Vec3> corners;
    for (const double angle : {middle - half_angle, middle + half_angle}) {
      for (const double radius : {inner, outer}) {
        for (const double y : {-half_depth, half_depth}) {
          corners.push_back(Vec3(radius * std::cos(angle), y, radius * std::sin(angle)) - centre);
        }
      }
    }
    const HullPointer hull = std::make_shared<const ConvexHull>(build_convex_hull(corners));
    world.create_body(body("stone" + std::to_string(i), hull, centre, stone));
  }
  return world;
}

void arch_stands(Trial& trial) {
  trial.begin(arch(trial.options(), 15));
  trial.run(trial.lasting(10.0, 60.0));
  trial.expect("drift [m]", trial.drift(), 1e-3);
}

/// A house of cards of so many storeys (Box2D's): leaning pairs at 25 degrees with flat cards between, from tip to tip.
World card_house(const Options& options, int storeys) {
  const Material paper{.friction = 0.7, .density = 700.0};
  const Box card{Vec3(0.001, 0.1, 0.2)};  // 2 mm x 20 cm x 40 cm
  const double lean = 25.0 * std::atan(1.0) / 45.0;
  // A leaning card stands on an edge of its lower face and touches its partner with an edge of its upper one.
  const double rise = 0.2 * std::cos(lean) + 0.001 * std::sin(lean);
  const double half_foot = 0.2 * std::sin(lean) + 0.001 * std::cos(lean);
  const Box flat_card{Vec3(2.0 * half_foot - 0.0005, 0.1, 0.001)};  // 1 mm short of the next one
  World world(options);
  world.create_body(ground(paper));
  double floor = 0.0;
  for (int storey = storeys; storey > 0; --storey) {
    const double width = 4.0 * half_foot;
    for (int pair = 0; pair < storey; ++pair) {
      const double x = width * (pair - 0.5 * (storey - 1));
      for (const double side : {-1.0, 1.0}) {
        BodyDefinition leaning =
            body("lean" + std::to_string(storey) + "_" + std::to_string(pair) + (side < 0 ? "a" : "b"), card,
                 Vec3(x + side * half_foot, 0, floor + rise), paper);
        leaning.X_WL.q = exp_map(Vec3(0, -side * lean, 0));
        world.create_body(leaning);
      }
    }
    floor += 2.0 * rise;
    for (int flat = 0; flat + 1 < storey; ++flat) {
      const Vec3 place(width * (flat - 0.5 * (storey - 2)), 0, floor + 0.001);
      world.create_body(
          body("flat" + std::to_string(storey) + "_" + std::to_string(flat), flat_card, place, paper));
    }
    floor += 0.002;
  }
  return world;
}

void cards_stand(Trial& trial, int storeys) {
  trial.begin(card_house(trial.options(), storeys));
  trial.run(trial.lasting(5.0, 60.0));
  trial.expect("drift [m]", trial.drift(), 1e-3);
}

/// The first of a row is pushed over; the wave runs through to the last.
void dominoes_fall(Trial& trial) {
  const int count = trial.extent(30, 1000);
  World world(trial.options());
  world.create_body(ground());
  const double pitch = 0.4;
  for (int i = 0; i < count; ++i) {
    world.create_body(body("domino" + std::to_string(i), Box{Vec3(0.05, 0.2, 0.5)}, Vec3(pitch * i, 0, 0.5)));
  }
  world.set_motion(world.id(1), {Quat::Identity(), Vec3(0, 0, 0.5)}, Vec3(0.5, 0, 0), Vec3(0, 1.0, 0));
  trial.begin(std::move(world));
  trial.run(0.25 * count + 3.0);
  int fallen = 0;
  for (std::uint32_t slot = 1; slot <= static_cast<std::uint32_t>(count); ++slot) {
    const Vec3 up = trial.world().motion(slot).q * Vec3::UnitZ();
    fallen += up.x() > 0.5 ? 1 : 0;
  }
  trial.expect("dominoes left standing", count - fallen, 0.0);
  trial.expect("energy gain", trial.energy_gain(), 1e-3);
}

void dominoes_stand(Trial& trial) {
  World world(trial.options());
  world.create_body(ground());
  for (int i = 0; i < 30; ++i) {
    world.create_body(body("domino" + std::to_string(i), Box{Vec3(0.05, 0.2, 0.5)}, Vec3(0.4 * i, 0, 0.5)));
  }
  trial.begin(std::move(world));
  trial.run(trial.lasting(5.0, 60.0));
  trial.expect("drift [m]", trial.drift(), 1e-9);
}

}  // namespace

std::vector<Case> structure_cases() {
  const auto cards = [](int storeys) { return [storeys](Trial& trial) { cards_stand(trial, storeys); }; };
  return {
      {"arch", "An arch of 15 voussoirs stands: drift <= 1 mm", precise(), arch_stands},
      {"cards_2", "A house of 7 cards of 2 mm stands: drift <= 1 mm", precise(), cards(2)},
      {"cards_5", "A house of 40 cards of 2 mm stands: drift <= 1 mm", precise(), cards(5)},
      {"dominoes", "A row of dominoes falls to the last", precise(), dominoes_fall},
      {"dominoes_stand", "A row that nobody touches stands", precise(), dominoes_stand},
  };
}

}  // namespace tumble::stability
