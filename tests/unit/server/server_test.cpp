// The whole server in one process: a real world, an in-process bus, a clock in the test's hand. Claims: commands have
// exactly the effect and the answer they should, pause, step and reset hold to the bit, and real time is kept.
#include "server.h"

#include <gtest/gtest.h>
#include <spdlog/sinks/ostream_sink.h>
#include <spdlog/spdlog.h>

#include <map>
#include <optional>
#include <sstream>

#include "protocol/channels.h"
#include "support/fake_clock.h"
#include "tumble/ack_t.hpp"
#include "tumble/catalog_t.hpp"
#include "tumble/hits_t.hpp"
#include "tumble/pushes_t.hpp"
#include "tumble/state_t.hpp"
#include "tumble/stats_t.hpp"

namespace tumble {
namespace {

constexpr double kMass = 2.0;
constexpr double kStep = 1.0 / 256.0;  // exact in binary

World make_world() {
  Options options;
  options.time_step = kStep;
  options.gravity = Vec3::Zero();
  World world(options);
  BodyDefinition ball;
  ball.name = "ball";
  ball.geometries.push_back({});
  Inertia inertia;
  inertia.mass = kMass;
  inertia.moments = 0.2 * Mat3::Identity();
  ball.inertia = inertia;
  world.create_body(ball);
  return world;
}

class TumbleServer : public testing::Test {
 protected:
  explicit TumbleServer(World world = make_world()) {
    server_.emplace(Simulation(std::move(world), random_session()), settings(), clock_, bus_, outbox_);
  }
  void SetUp() override {
    bus_.subscribe("T_ACK", [this](Bytes bytes) {
      const ack_t m = read<ack_t>(bytes);
      for (std::size_t i = 0; i < m.status.size(); ++i) {
        answers_[m.sequence[i]].push_back(
            {static_cast<Status>(m.status[i]), m.applied_step[i], m.body[i], m.generation[i], m.detail[i]});
      }
    });
    bus_.subscribe("T_STATE", [this](Bytes bytes) { states_.push_back(read<state_t>(bytes)); });
    bus_.subscribe("T_STATS", [this](Bytes bytes) { stats_ = read<stats_t>(bytes); });
    bus_.subscribe("T_HEARTBEAT", [this](Bytes bytes) { heartbeats_.push_back(read<heartbeat_t>(bytes)); });
    bus_.subscribe("T_CATALOG", [this](Bytes bytes) {
      const catalog_t m = read<catalog_t>(bytes);
      if (m.session != std::exchange(catalog_session_, m.session)) names_.clear();
      names_.erase(names_.lower_bound(m.first_id), names_.lower_bound(m.end_id));
      for (std::size_t i = 0; i < m.id.size(); ++i) names_[m.id[i]] = m.name[i];
    });
    bus_.subscribe("T_BODY_0", [this](Bytes) { ++watched_; });
  }

  static ServerSettings settings() {
    ServerSettings s;
    s.world_name = "T";
    s.rate = 1.0 / kStep;
    return s;
  }
  template <typename Message>
  static Message read(Bytes bytes) {
    Message m{};
    EXPECT_EQ(m.decode(bytes.data(), 0, static_cast<int>(bytes.size())), static_cast<int>(bytes.size()));
    return m;
  }
  /// One tick, a step's time later, and all that is sent delivered.
  void tick(int count = 1) {
    for (int i = 0; i < count; ++i) {
      clock_.pass(kStep);
      server_->tick();
      for (std::int64_t due = outbox_.pump(); due != Outbox::kIdle; due = outbox_.pump())
        clock_.sleep_until(due);
    }
  }
  void send(const force_command_t& command) { send_to("T_FORCE", command); }
  void send(const control_t& command) { send_to("T_CONTROL", command); }
  template <typename Message>
  void send_to(const std::string& channel, const Message& message) {
    std::vector<std::uint8_t> bytes;
    encode(message, bytes);
    ASSERT_TRUE(bus_.publish(channel, bytes));
  }
  force_command_t make_force(double fx, double duration) {
    force_command_t c{};
    c.client = 1;
    c.sequence = ++sequence_;
    c.generation = 1;
    c.force[0] = fx;
    c.duration = duration;
    return c;
  }
  control_t make_control(std::int8_t verb) {
    control_t c{};
    c.client = 1;
    c.sequence = ++sequence_;
    c.verb = verb;
    c.generation = 1;
    c.orientation[0] = 1.0;
    return c;
  }
  control_t make_spawn(const std::string& name) {
    control_t c = make_control(control_t::VERB_SPAWN);
    c.name = name;
    c.body_type = catalog_t::TYPE_DYNAMIC;
    c.shape_type = catalog_t::SHAPE_BOX;
    for (double& size : c.size) size = 1.0;
    c.mass = 3.0;
    c.position[2] = 3.0 * static_cast<double>(c.sequence);  // apart from all others
    return c;
  }
  /// Sends, ticks, and returns the answer.
  template <typename Message>
  Outcome ask(const Message& command) {
    send(command);
    tick(2);  // the answer is read in the tick after
    const auto& answers = answers_[command.sequence];
    EXPECT_EQ(answers.size(), 1u);
    return answers.empty() ? Outcome{} : answers.back();
  }
  double momentum() const { return server_->world().compute_conserved().momentum.x(); }

  FakeClock clock_;
  Bus bus_{parse_bus_url("memq://"), "T"};
  Outbox outbox_{"T", bus_.payload_limit(), clock_,
                 [this](const std::string& channel, Bytes bytes) { return bus_.publish(channel, bytes); }};
  std::optional<Server> server_;
  std::int64_t sequence_ = 0;
  std::map<std::int64_t, std::vector<Outcome>> answers_;
  std::vector<state_t> states_;
  std::vector<heartbeat_t> heartbeats_;
  std::map<std::int32_t, std::string> names_;
  std::int64_t catalog_session_ = 0;
  stats_t stats_{};
  int watched_ = 0;
};

TEST_F(TumbleServer, APushGivesForceTimesDuration) {
  const force_command_t push = make_force(6.0, 0.5);
  for (int i = 0; i < 3; ++i) send(push);
  tick(200);
  EXPECT_NEAR(momentum(), 3.0, 3e-12);
  ASSERT_EQ(answers_[1].size(), 3u);
  for (const Outcome& answer : answers_[1]) {
    EXPECT_EQ(answer.status, Status::applied);
    EXPECT_EQ(answer.step, 0);
  }
  EXPECT_EQ(stats_.commands_applied, 1);
  EXPECT_EQ(stats_.commands_repeated, 2);
}

TEST_F(TumbleServer, AStartStepIsKeptToTheStep) {
  force_command_t push = make_force(512.0, 0.0);
  push.start_step = 40;
  send(push);
  tick(40);
  EXPECT_EQ(momentum(), 0.0);
  tick(2);
  EXPECT_NEAR(momentum(), 512.0 * kStep, 1e-12);
  ASSERT_EQ(answers_[1].size(), 2u);
  EXPECT_EQ(answers_[1][0].status, Status::queued);
  EXPECT_EQ(answers_[1][1].step, 40);
}

TEST_F(TumbleServer, RefusesWhatTheWorldDoesNotHave) {
  force_command_t push = make_force(1.0, 0.0);
  push.body = 99;
  EXPECT_EQ(ask(push).status, Status::unknown_body);
  push = make_force(1.0, 0.0);
  push.body = -1;
  EXPECT_EQ(ask(push).status, Status::unknown_body);
  push = make_force(1.0, 0.0);
  push.generation = 2;
  const Outcome stale = ask(push);
  EXPECT_EQ(stale.status, Status::stale_generation);
  EXPECT_FALSE(stale.detail.empty());
  EXPECT_EQ(momentum(), 0.0);
}

TEST_F(TumbleServer, SpawnsListsAndRemoves) {
  const Outcome spawned = ask(make_spawn("crate"));
  ASSERT_EQ(spawned.status, Status::applied) << spawned.detail;
  EXPECT_EQ(names_.at(spawned.body), "crate");
  EXPECT_EQ(server_->world().mass_properties(static_cast<std::uint32_t>(spawned.body)).mass, 3.0);
  const Outcome taken = ask(make_spawn("crate"));
  EXPECT_EQ(taken.status, Status::invalid);
  EXPECT_NE(taken.detail.find("crate"), std::string::npos) << taken.detail;
  control_t remove = make_control(control_t::VERB_REMOVE);
  remove.body = spawned.body;
  remove.generation = spawned.generation;
  EXPECT_EQ(ask(remove).status, Status::applied);
  EXPECT_FALSE(names_.contains(spawned.body));
  force_command_t push = make_force(1.0, 0.0);
  push.body = spawned.body;
  push.generation = spawned.generation;
  EXPECT_EQ(ask(push).status, Status::stale_generation);
}

TEST_F(TumbleServer, SetStatePlacesTheCentreOfMass) {
  control_t c = make_control(control_t::VERB_SET_STATE);
  c.position[1] = 7.0;
  c.angular_velocity[2] = 2.0;
  EXPECT_EQ(ask(c).status, Status::applied);
  EXPECT_EQ(states_.back().py[0], 7.0);
  EXPECT_NEAR(states_.back().wz[0], 2.0, 1e-15);
}

TEST_F(TumbleServer, PauseStandsStillAndStepDoesExactlySoMany) {
  tick(10);
  EXPECT_EQ(ask(make_control(control_t::VERB_PAUSE)).status, Status::applied);
  const std::uint64_t step = server_->world().step_count(), hash = server_->world().state_hash();
  tick(100);
  EXPECT_EQ(server_->world().step_count(), step);
  EXPECT_EQ(server_->world().state_hash(), hash);
  control_t c = make_control(control_t::VERB_STEP);
  c.count = 7;
  send(c);
  tick(100);
  EXPECT_EQ(server_->world().step_count(), step + 7);
  EXPECT_TRUE(server_->simulation().paused());
  EXPECT_EQ(states_.back().step, static_cast<std::int64_t>(step) + 7);
  EXPECT_TRUE(heartbeats_.back().paused);
  ask(make_control(control_t::VERB_RESUME));
  EXPECT_GT(server_->world().step_count(), step + 7);
}

TEST_F(TumbleServer, ResetIsExactAndANewSession) {
  const std::uint64_t start = server_->world().state_hash();
  const std::int64_t session = server_->simulation().session();
  ask(make_control(control_t::VERB_PAUSE));
  ask(make_spawn("crate"));
  force_command_t late = make_force(1.0, 0.0);
  late.start_step = 100000;
  send(late);
  send(make_force(5.0, 10.0));
  control_t steps = make_control(control_t::VERB_STEP);
  steps.count = 20;
  send(steps);
  tick(30);
  EXPECT_NE(momentum(), 0.0);
  EXPECT_EQ(ask(make_control(control_t::VERB_RESET)).status, Status::applied);
  EXPECT_NE(server_->simulation().session(), session);
  tick(2);
  EXPECT_EQ(answers_[late.sequence].back().status, Status::cancelled);
  EXPECT_EQ(states_.back().session, server_->simulation().session());
  ask(make_control(control_t::VERB_RESET));
  EXPECT_TRUE(server_->simulation().paused());
  force_command_t old = make_force(1.0, 0.0);
  old.session = session;
  EXPECT_EQ(ask(old).status, Status::wrong_session);
  EXPECT_EQ(names_.size(), 1u);
  EXPECT_EQ(server_->world().state_hash(), start);
}

TEST_F(TumbleServer, GoesBackToASnapshotInANewSession) {
  force_command_t push = make_force(5.0, 1.0);
  send(push);
  tick(20);
  control_t snapshot = make_control(control_t::VERB_SNAPSHOT);
  snapshot.name = "a";
  const Outcome kept = ask(snapshot);
  EXPECT_EQ(kept.status, Status::applied);
  tick(50);
  const std::int64_t session = server_->simulation().session();
  control_t restore = make_control(control_t::VERB_RESTORE);
  restore.name = "b";
  const Outcome unknown = ask(restore);
  EXPECT_EQ(unknown.status, Status::invalid);
  EXPECT_NE(unknown.detail.find("a"), std::string::npos);
  restore = make_control(control_t::VERB_RESTORE);
  restore.name = "a";
  const Outcome restored = ask(restore);
  EXPECT_EQ(restored.step, kept.step);
  EXPECT_EQ(server_->simulation().session(), session + 1);
  tick(300);  // the push goes on where it was
  EXPECT_NEAR(momentum(), 5.0, 1e-11);
  for (std::size_t i = 0; i <= kMaxSnapshots; ++i) {
    snapshot = make_control(control_t::VERB_SNAPSHOT);
    snapshot.name = std::to_string(i);
    EXPECT_EQ(ask(snapshot).status, i + 1 < kMaxSnapshots ? Status::applied : Status::out_of_range) << i;
  }
  snapshot = make_control(control_t::VERB_SNAPSHOT);
  EXPECT_EQ(ask(snapshot).status, Status::out_of_range) << "no name";
}

TEST_F(TumbleServer, ShowsThePushesThatAct) {
  std::vector<pushes_t> heard;
  bus_.subscribe("T_PUSHES", [&](Bytes bytes) { heard.push_back(read<pushes_t>(bytes)); });
  tick(100);
  EXPECT_TRUE(heard.empty()) << "nobody asked";
  EXPECT_EQ(ask(make_control(control_t::VERB_PUSHES_ON)).status, Status::applied);
  force_command_t push = make_force(7.0, 0.5);
  push.point[1] = 0.25;
  send(push);
  tick(60);
  ASSERT_FALSE(heard.empty());
  ASSERT_EQ(heard.back().n, 1);
  EXPECT_EQ(heard.back().fx[0], 7.0);
  EXPECT_GT(heard.back().seconds_left[0], 0.2);
  tick(120);
  EXPECT_EQ(heard.back().n, 0) << "it is over";
}

TEST_F(TumbleServer, AnswersQuestions) {
  std::vector<hits_t> heard;
  bus_.subscribe("T_HITS", [&](Bytes bytes) { heard.push_back(read<hits_t>(bytes)); });
  ask(make_spawn("crate"));  // a cube of 1 m, apart from the ball at the origin
  query_t query{};
  query.client = 3;
  query.sequence = 9;
  query.kind = query_t::KIND_RAY;
  query.origin[2] = -10.0;
  query.direction[2] = 2.0;
  query.ignored = -1;
  const auto put = [&] {
    heard.clear();
    send_to("T_QUERY", query);
    tick(2);
    return heard.empty() ? hits_t{} : heard.back();
  };
  hits_t answer = put();
  EXPECT_EQ(answer.client, 3);
  EXPECT_EQ(answer.sequence, 9);
  ASSERT_EQ(answer.n, 1);
  EXPECT_EQ(answer.body[0], 0);
  EXPECT_EQ(answer.nz[0], -1.0);
  EXPECT_NEAR(answer.distance[0] - 10.0, answer.pz[0], 1e-12);
  query.ignored = 0;
  answer = put();
  ASSERT_EQ(answer.n, 1);
  EXPECT_EQ(answer.body[0], 1) << "the crate above";
  query.kind = query_t::KIND_RAY_ALL;
  query.ignored = -1;
  EXPECT_EQ(put().n, 2);
  query.kind = query_t::KIND_OVERLAP;
  query.shape_type = catalog_t::SHAPE_SPHERE;
  query.size[0] = 0.1;
  query.orientation[0] = 1.0;
  query.origin[2] = 0.0;
  answer = put();
  ASSERT_EQ(answer.n, 1);
  EXPECT_EQ(answer.body[0], 0);
  query.kind = query_t::KIND_CLOSEST;
  query.body_b = 1;
  answer = put();
  ASSERT_EQ(answer.n, 1);
  EXPECT_GT(answer.distance[0], 0.5);
  query.body_b = 77;
  answer = put();
  EXPECT_EQ(answer.status, static_cast<int>(Status::invalid));
  EXPECT_NE(answer.detail.find("body_b"), std::string::npos);
  query.kind = 99;
  EXPECT_EQ(put().status, static_cast<int>(Status::invalid));
  query.session = 5;
  EXPECT_EQ(put().status, static_cast<int>(Status::wrong_session));
}

TEST_F(TumbleServer, TellsEverythingToWhoAsksAgainWhilePaused) {
  ask(make_spawn("crate"));
  ask(make_control(control_t::VERB_PAUSE));
  control_t step = make_control(control_t::VERB_STEP);
  step.count = 3;
  ask(step);
  tick(20);
  states_.clear();
  send(step);
  tick(2);
  ASSERT_FALSE(states_.empty());
  EXPECT_EQ(states_.front().n, 2);
  EXPECT_EQ(server_->simulation().now_step(), states_.front().step) << "and did no further step";
}

TEST_F(TumbleServer, WatchesBodiesUpToTheLimit) {
  control_t watch = make_control(control_t::VERB_WATCH);
  EXPECT_EQ(ask(watch).status, Status::applied);
  tick(100);
  EXPECT_GT(watched_, 10);
  EXPECT_TRUE(states_.back().flags.empty() || (states_.back().flags[0] & state_t::FLAG_WATCHED));
  control_t unwatch = make_control(control_t::VERB_UNWATCH);
  EXPECT_EQ(ask(unwatch).status, Status::applied);
  const int seen = watched_;
  tick(100);
  EXPECT_EQ(watched_, seen);
  for (std::size_t i = 0; i <= kMaxWatched; ++i) {
    const Outcome body = ask(make_spawn("crate" + std::to_string(i)));
    watch = make_control(control_t::VERB_WATCH);
    watch.body = body.body;
    EXPECT_EQ(ask(watch).status, i < kMaxWatched ? Status::applied : Status::out_of_range);
  }
}

TEST_F(TumbleServer, KeepsItsRates) {
  tick(256);  // warm up
  states_.clear();
  heartbeats_.clear();
  const std::int64_t start = clock_.now_ns();
  tick(10 * 256);
  const double seconds = static_cast<double>(clock_.now_ns() - start) * 1e-9;
  EXPECT_NEAR(static_cast<double>(heartbeats_.size()), kHeartbeatRate * seconds, 1.0);
  EXPECT_NEAR(static_cast<double>(states_.size()), kDefaultPublishRate * seconds, 2.0);
}

TEST_F(TumbleServer, RunsInRealTimeAndStopsAfterItsSteps) {
  ServerSettings s = settings();
  s.steps = 512;
  Server server(Simulation(make_world(), random_session()), s, clock_, bus_, outbox_);
  const std::int64_t start = clock_.now_ns();
  const volatile std::sig_atomic_t stop = 0;
  server.run(stop);
  EXPECT_EQ(server.world().step_count(), 512u);
  EXPECT_NEAR(static_cast<double>(clock_.now_ns() - start) * 1e-9, 512 * kStep, 1e-6);
  EXPECT_EQ(server.pacer().overruns(), 0);
}

/// What the server logs while this lives.
class CapturedLog {
 public:
  CapturedLog() : kept_(spdlog::default_logger()) {
    spdlog::set_default_logger(
        std::make_shared<spdlog::logger>("test", std::make_shared<spdlog::sinks::ostream_sink_mt>(log_)));
  }
  ~CapturedLog() { spdlog::set_default_logger(kept_); }
  CapturedLog(const CapturedLog&) = delete;
  CapturedLog& operator=(const CapturedLog&) = delete;
  std::string text() const { return log_.str(); }

 private:
  std::ostringstream log_;
  std::shared_ptr<spdlog::logger> kept_;
};

TEST_F(TumbleServer, WarnsOfASecondServerByName) {
  const CapturedLog log;
  tick(256);  // hears itself: says nothing
  EXPECT_EQ(log.text(), "");
  heartbeat_t other{};
  other.session = 12345;
  other.host = "elsewhere";
  other.pid = 4711;
  for (int i = 0; i < 5; ++i) send_to("T_HEARTBEAT", other);
  tick();
  const std::string text = log.text();
  EXPECT_NE(text.find("elsewhere"), std::string::npos);
  EXPECT_NE(text.find("4711"), std::string::npos);
  EXPECT_EQ(text.find("4711"), text.rfind("4711")) << "once, not at every heartbeat";
}

/// Has a second body, so light that the largest push carries it beyond all numbers.
class ServerOfASpeck : public TumbleServer {
 protected:
  ServerOfASpeck() : TumbleServer(add_speck(make_world())) {}
  static World add_speck(World world) {
    BodyDefinition speck;
    speck.name = "speck";
    speck.X_WL.p = Vec3(0, 5, 0);
    speck.geometries.push_back({});
    speck.inertia = Inertia{1e-100, Vec3::Zero(), 1e-101 * Mat3::Identity()};
    world.create_body(speck);
    return world;
  }
};

TEST_F(ServerOfASpeck, HoldsReportsAndNamesABodyThatWouldBecomeNonFinite) {
  const CapturedLog log;
  force_command_t push = make_force(0.0, 0.5);
  push.body = 1;
  push.force[1] = kMaxForce;
  ASSERT_EQ(ask(push).status, Status::applied);
  EXPECT_EQ(server_->world().contained().size(), 1u);
  ASSERT_EQ(ask(make_force(kMass, 1.0)).status, Status::applied);
  tick(512);
  EXPECT_EQ(stats_.non_finite_contained, 128) << "every step of half a second";
  EXPECT_EQ(server_->world().motion(1).x, Vec3(0, 5, 0));
  EXPECT_NEAR(momentum(), kMass, 1e-9) << "the rest of the world goes on";
  const std::string text = log.text();
  EXPECT_NE(text.find("'speck'"), std::string::npos);
  EXPECT_EQ(text.find("'speck'"), text.rfind("'speck'")) << "once a second, not at every step";
}

}  // namespace
}  // namespace tumble
