// Whatever bytes and numbers clients send: nothing crashes, memory stays bounded, and the world stays finite. Messages
// are good ones with random fields, some of their bytes then changed; ./run test --sanitize watches.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <random>

#include "answer_query.h"
#include "net/command_inbox.h"
#include "scene/demo.h"
#include "scene/sdf.h"
#include "simulation.h"

namespace tumble {
namespace {

class Attacker {
 public:
  explicit Attacker(std::uint64_t seed) : random_(seed) {}

  std::vector<std::uint8_t> force() {
    force_command_t m{};
    fill_head(m);
    m.body = static_cast<std::int32_t>(below(12)) - 1;
    m.generation = static_cast<std::int32_t>(below(3));
    m.frame = static_cast<std::int8_t>(below(3));
    for (double& x : m.force) x = number();
    for (double& x : m.torque) x = number();
    for (double& x : m.point) x = number();
    m.duration = std::abs(number());
    return damaged(m);
  }
  std::vector<std::uint8_t> control() {
    control_t m{};
    fill_head(m);
    m.verb = static_cast<std::int8_t>(below(18));
    m.count = below(3) == 0 ? static_cast<std::int64_t>(random_()) : static_cast<std::int64_t>(below(5));
    m.body = static_cast<std::int32_t>(below(12)) - 1;
    m.generation = static_cast<std::int32_t>(below(3));
    const char letter = static_cast<char>('!' + below(90));
    m.name = std::string(below(80), letter);
    m.body_type = static_cast<std::int8_t>(below(4));
    m.shape_type = static_cast<std::int8_t>(below(12));
    for (double& x : m.size) x = number();
    m.mass = std::abs(number());
    for (double& x : m.position) x = number();
    fill_turn(m.orientation);
    for (double& x : m.velocity) x = number();
    for (double& x : m.angular_velocity) x = number();
    m.friction = std::abs(number());
    m.restitution = below(2) == 0 ? 0.5 : number();
    return damaged(m);
  }
  query_t query() {
    query_t m{};
    m.kind = static_cast<std::int8_t>(below(8));
    for (double& x : m.origin) x = number();
    for (double& x : m.direction) x = number();
    m.length = number();
    m.shape_type = static_cast<std::int8_t>(below(12));
    for (double& x : m.size) x = number();
    fill_turn(m.orientation);
    m.ignored = static_cast<std::int32_t>(below(6)) - 1;
    m.body_a = static_cast<std::int32_t>(below(12)) - 1;
    m.body_b = static_cast<std::int32_t>(below(12)) - 1;
    return m;
  }

 private:
  std::uint64_t below(std::uint64_t n) { return random_() % n; }
  double number() {
    switch (below(8)) {
      case 0:
        return std::bit_cast<double>(random_());
      case 1:
        return 0.0;
      case 2:
        return std::pow(10.0, static_cast<double>(below(30)) - 15.0);
      default:
        return static_cast<double>(below(2001)) * 1e-3 - 1.0;
    }
  }
  void fill_turn(double (&q)[4]) {
    q[below(4)] = 1.0;
    if (below(4) == 0) q[below(4)] = number();
  }
  template <typename Message>
  void fill_head(Message& m) {
    m.client = static_cast<std::int64_t>(below(20));
    m.sequence = ++sequence_;
    if (below(10) == 0) m.start_step = static_cast<std::int64_t>(below(500));
    if (below(10) == 0) m.session = static_cast<std::int64_t>(below(3));
  }
  template <typename Message>
  std::vector<std::uint8_t> damaged(const Message& message) {
    std::vector<std::uint8_t> bytes;
    encode(message, bytes);
    if (below(4) == 0) bytes[below(bytes.size())] = static_cast<std::uint8_t>(below(256));
    if (below(16) == 0) bytes.resize(below(bytes.size() + 40));
    return bytes;
  }

  std::mt19937_64 random_;
  std::int64_t sequence_ = 0;
};

void expect_finite(const World& world) {
  for (std::uint32_t slot = 0; slot < world.body_capacity(); ++slot) {
    if (!world.body(slot).exists) continue;
    const Motion& motion = world.motion(slot);
    ASSERT_TRUE(motion.x.allFinite() && motion.q.coeffs().allFinite() && motion.v.allFinite() &&
                motion.w.allFinite())
        << world.body(slot).definition.name;
  }
}

TEST(Hostile, NothingThatIsSentHarmsTheServer) {
  Attacker attacker(5);
  Simulation simulation(build_world(read_sdf_text(std::string(demo_text("cradle")), "cradle", ".").scene), 1);
  CommandInbox inbox;
  int applied = 0;
  for (int round = 0; round < 300; ++round) {
    inbox.set_now(simulation.session(), simulation.now_step());
    for (int i = 0; i < 30; ++i) {
      inbox.receive_force(attacker.force());
      inbox.receive_control(attacker.control());
    }
    for (const Command& command : inbox.take_due()) {
      const std::int64_t session = simulation.session();
      const Outcome outcome = simulation.apply(command);
      applied += outcome.status == Status::applied;
      inbox.settle(command, outcome);
      if (simulation.session() != session) inbox.cancel_pending();
    }
    for (const Acknowledgement& answer : inbox.take_answers()) ASSERT_LT(answer.outcome.detail.size(), 1000u);
    for (int i = 0; i < 10; ++i) {
      const hits_t answer = answer_query(simulation.world(), attacker.query(), kNetworkPayload);
      ASSERT_LE(static_cast<std::size_t>(answer.getEncodedSize()), kNetworkPayload);
    }
    if (!simulation.paused()) simulation.step();
    expect_finite(simulation.world());
  }
  EXPECT_GT(applied, 500);
  EXPECT_GT(inbox.counters().damaged(), 500u);
  EXPECT_LE(inbox.pending(), CommandInbox::kMaxPending);
}

}  // namespace
}  // namespace tumble
