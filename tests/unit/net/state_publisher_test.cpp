// What receivers get: no message beyond the limit, every body within the refresh period, a lost message healed by the
// next round, removals told, and only what changed sent in between.
#include "net/state_publisher.h"

#include <gtest/gtest.h>

#include <functional>
#include <map>
#include <random>
#include <set>

#include "net/outbox.h"
#include "protocol/packed.h"
#include "support/fake_clock.h"
#include "tumble/contacts_t.hpp"

namespace tumble {
namespace {

constexpr std::int64_t kFrameNs = 1'000'000'000 / 60;

std::shared_ptr<const BodyModel> make_model(std::uint32_t slot, std::size_t parts = 1) {
  auto model = std::make_shared<BodyModel>();
  model->id = {slot, 0};
  model->name = "body_" + std::to_string(slot);
  model->type = BodyType::dynamic;
  model->mass = 1.0 + slot;
  for (std::size_t i = 0; i < parts; ++i)
    model->parts.push_back({Sphere{0.5}, {}, {}, {1.0f, 0.0f, 0.0f, 1.0f}});
  return model;
}

/// A world of `count` bodies that no physics moves.
class Scenery {
 public:
  explicit Scenery(std::uint32_t count) {
    auto catalog = std::make_shared<Catalog>();
    catalog->epoch = 1;
    catalog->num_bodies = static_cast<std::int32_t>(count);
    for (std::uint32_t slot = 0; slot < count; ++slot) catalog->models.push_back(make_model(slot));
    view_.session = 77;
    view_.catalog = catalog;
    view_.bodies.resize(count);
    for (BodyView& body : view_.bodies) body.exists = true;
  }
  WorldView& view() { return view_; }
  void move(std::uint32_t slot) { view_.bodies[slot].values[0] += 1.0; }
  void change_catalog(const std::function<void(Catalog&)>& change) {
    auto catalog = std::make_shared<Catalog>(*view_.catalog);
    ++catalog->epoch;
    change(*catalog);
    view_.catalog = catalog;
  }

 private:
  WorldView view_;
};

/// A client that keeps what it hears.
struct Receiver {
  std::map<std::int32_t, double> x;           // by id: px
  std::map<std::int32_t, std::string> names;  // by id
  std::set<std::pair<std::int32_t, std::int32_t>> shapes;
  std::set<std::tuple<std::int32_t, std::int32_t, std::int32_t>> vertices;

  void hear(const std::string& channel, const std::vector<std::uint8_t>& bytes) {
    const int size = static_cast<int>(bytes.size());
    if (channel == "T_STATE") {
      state_t m{};
      ASSERT_EQ(m.decode(bytes.data(), 0, size), size);
      for (std::size_t i = 0; i < m.id.size(); ++i) x[m.id[i]] = m.px[i];
    } else if (channel == "T_CATALOG") {
      catalog_t m{};
      ASSERT_EQ(m.decode(bytes.data(), 0, size), size);
      names.erase(names.lower_bound(m.first_id), names.lower_bound(m.end_id));
      for (std::size_t i = 0; i < m.id.size(); ++i) {
        EXPECT_TRUE(m.id[i] >= m.first_id && m.id[i] < m.end_id);
        names[m.id[i]] = m.name[i];
      }
      for (std::size_t i = 0; i < m.shape_body.size(); ++i)
        shapes.insert({m.shape_body[i], m.shape_number[i]});
      for (std::size_t i = 0; i < m.vertex_body.size(); ++i) {
        vertices.insert({m.vertex_body[i], m.vertex_shape[i], m.vertex_number[i]});
      }
    }
  }
};

class Publisher : public testing::Test {
 protected:
  /// Publishes the view; hands what `lost` doesn't take to the receiver. Returns messages sent by channel.
  std::map<std::string, int> publish(
      Scenery& scenery, Receiver& receiver, const std::function<bool()>& lost = [] { return false; }) {
    std::map<std::string, int> sent;
    now_ += kFrameNs;
    publisher_.begin(scenery.view(), now_);
    std::string channel;
    std::vector<std::uint8_t> bytes;
    while (publisher_.next(channel, bytes)) {
      EXPECT_LE(bytes.size(), kNetworkPayload) << channel;
      ++sent[channel];
      if (!lost()) receiver.hear(channel, bytes);
    }
    return sent;
  }
  StatePublisher publisher_{"T", kNetworkPayload};
  std::int64_t now_ = 5'000'000'000;
};

TEST_F(Publisher, FirstPublicationTellsEverything) {
  Scenery scenery(1000);
  Receiver receiver;
  const auto sent = publish(scenery, receiver);
  EXPECT_EQ(receiver.x.size(), 1000u);
  EXPECT_EQ(receiver.names.size(), 1000u);
  EXPECT_EQ(receiver.shapes.size(), 1000u);
  EXPECT_EQ(sent.at("T_STATE"), 91);  // 11 bodies of 113 bytes a message
}

TEST_F(Publisher, LateJoinerIsCompleteWithinASecondWhileAllRest) {
  Scenery scenery(1000);
  Receiver early, late;
  for (int i = 0; i < 100; ++i) publish(scenery, early);
  int most = 0;
  for (int i = 0; i < 61; ++i) {  // 1 s and the frame that ends it
    const auto sent = publish(scenery, late);
    most = std::max(most, sent.at("T_STATE") + (sent.contains("T_CATALOG") ? sent.at("T_CATALOG") : 0));
    if (i == 30) {
      EXPECT_EQ(late.x.size(), 1000u) << "the refresh comes round in 0.5 s";
    }
  }
  EXPECT_EQ(late.x.size(), 1000u);
  EXPECT_EQ(late.names.size(), 1000u);
  EXPECT_LE(most, 10);  // spread: no bursts in a resting world (4 of state, 4 of catalogue)
}

TEST_F(Publisher, LostMessagesAreHealedByTheNextRounds) {
  Scenery scenery(1000);
  Receiver receiver;
  std::mt19937 random(3);
  const auto lossy = [&random] { return random() % 100 < 20; };
  publish(scenery, receiver);
  for (std::uint32_t slot = 0; slot < 1000; ++slot) scenery.move(slot);
  publish(scenery, receiver, lossy);  // they moved once and rest from now on
  const auto count_stale = [&] {
    int stale = 0;
    for (const auto& [id, x] : receiver.x) stale += x != 1.0;
    return stale;
  };
  const int lost = count_stale();
  EXPECT_GT(lost, 100);  // 20 % of 1000
  for (int i = 0; i < 31; ++i) publish(scenery, receiver);
  EXPECT_EQ(count_stale(), 0);
}

TEST_F(Publisher, OnlyWhatMovedIsSentBetweenRefreshes) {
  Scenery scenery(11 * 60);
  Receiver receiver;
  for (int i = 0; i < 3; ++i) publish(scenery, receiver);  // the first, and twice more
  scenery.move(3);
  Receiver next;
  publish(scenery, next);
  EXPECT_TRUE(next.x.contains(3));
  EXPECT_LE(next.x.size(), 1u + 11 * 60 / 30);  // and a 30th of all: one frame of the 0.5 s round
}

TEST_F(Publisher, AnEmptyWorldStillTellsTheStep) {
  Scenery scenery(0);
  Receiver receiver;
  const auto sent = publish(scenery, receiver);
  EXPECT_EQ(sent.at("T_STATE"), 1);
  EXPECT_EQ(sent.at("T_CATALOG"), 1);
}

TEST_F(Publisher, ALastChangeIsToldThreeTimes) {
  Scenery scenery(2);
  Receiver receiver;
  publish(scenery, receiver);
  for (int i = 0; i < 100; ++i) publish(scenery, receiver);
  scenery.move(1);
  std::vector<int> sent;
  for (int i = 0; i < 4; ++i) {
    receiver.x.clear();
    publish(scenery, receiver);
    sent.push_back(receiver.x.contains(1));
  }
  EXPECT_EQ(sent[0] + sent[1] + sent[2], 3);
}

TEST_F(Publisher, AWholeViewTellsEveryBody) {
  Scenery scenery(100);
  Receiver receiver;
  for (int i = 0; i < 10; ++i) publish(scenery, receiver);
  receiver.x.clear();
  scenery.view().whole = true;
  publish(scenery, receiver);
  EXPECT_EQ(receiver.x.size(), 100u);
}

TEST(PackedPublisher, TellsEveryBodyIn25Bytes) {
  constexpr std::uint32_t kBodies = 20'000;
  Scenery scenery(kBodies);
  for (std::uint32_t slot = 0; slot < kBodies; ++slot) {
    scenery.view().bodies[slot].values = {0.01 * slot, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 2.0};
  }
  StatePublisher publisher("T", kNetworkPayload, Encoding::packed);
  publisher.begin(scenery.view(), 0);
  std::string channel;
  std::vector<std::uint8_t> bytes;
  std::map<std::int32_t, double> x;
  std::size_t messages = 0, total = 0;
  while (publisher.next(channel, bytes)) {
    ASSERT_LE(bytes.size(), kNetworkPayload);
    if (channel != "T_PACKED") continue;
    packed_t message{};
    ASSERT_EQ(decode(bytes, message), Malformed::none);
    EXPECT_EQ(message.chunk, static_cast<int>(messages));
    ++messages;
    total += bytes.size();
    state_t state;
    unpack(message, state);
    for (std::size_t i = 0; i < state.id.size(); ++i) x[state.id[i]] = state.px[i];
  }
  ASSERT_EQ(x.size(), kBodies);
  for (const auto& [id, value] : x) EXPECT_NEAR(value, 0.01 * id, kPackedEdge / (1 << 21) * 1.01);
  EXPECT_LT(static_cast<double>(total) / kBodies, 28.0);  // 27.7: 25 and a share of the messages' heads
}

TEST_F(Publisher, SpawnsAndRemovalsAreToldAtOnce) {
  Scenery scenery(1000);
  Receiver receiver;
  publish(scenery, receiver);
  scenery.change_catalog([](Catalog& catalog) {
    catalog.models[500] = nullptr;
    catalog.models.push_back(make_model(1000));
  });
  scenery.view().bodies[500].exists = false;
  scenery.view().bodies.push_back({.exists = true});
  publish(scenery, receiver);
  EXPECT_FALSE(receiver.names.contains(500));
  EXPECT_EQ(receiver.names.at(1000), "body_1000");
  EXPECT_TRUE(receiver.x.contains(1000));
}

TEST_F(Publisher, ANewSessionStartsFromNothing) {
  Scenery scenery(200);
  Receiver before, after;
  publish(scenery, before);
  scenery.view().session = 78;
  publish(scenery, after);
  EXPECT_EQ(after.x.size(), 200u);
  EXPECT_EQ(after.names.size(), 200u);
}

TEST_F(Publisher, BodiesLargerThanAMessageRunOn) {
  Scenery scenery(3);
  std::vector<Vec3> points;
  for (int i = 0; i < 200; ++i) {  // on a paraboloid: all of them corners
    const double x = 0.1 * (i % 20) - 1.0, y = 0.1 * (i / 20) - 0.5;
    points.push_back({x, y, x * x + y * y});
  }
  scenery.change_catalog([&](Catalog& catalog) {
    auto big = std::make_shared<BodyModel>(*make_model(1, 40));
    big->parts[20].shape = std::make_shared<const ConvexHull>(ConvexHull::Parts{.vertices = points});
    catalog.models[1] = big;
  });
  Receiver receiver;
  publish(scenery, receiver);
  EXPECT_EQ(receiver.names.size(), 3u);
  EXPECT_EQ(receiver.shapes.size(), 42u);
  EXPECT_EQ(receiver.vertices.size(), points.size());
}

TEST_F(Publisher, WatchedBodiesAndContactsHaveChannels) {
  Scenery scenery(5);
  scenery.view().watched.push_back({.slot = 2, .L = Vec3::Zero(), .kinetic_energy = 1.0});
  scenery.view().has_contacts = true;
  scenery.view().contacts.resize(100);
  Receiver receiver;
  const auto sent = publish(scenery, receiver);
  EXPECT_EQ(sent.at("T_BODY_2"), 1);
  EXPECT_EQ(sent.at("T_CONTACTS"), 7);  // 15 of 88 bytes a message
}

/// Of 91 messages over 80 ms; what is urgent goes in between at once; who waits gets everything in bursts.
TEST(OutboxPacing, PublicationsAreSpread) {
  FakeClock clock;
  std::vector<std::pair<std::string, std::int64_t>> sent;
  Outbox outbox(
      "T", kNetworkPayload, clock,
      [&](const std::string& channel, Bytes) {
        sent.emplace_back(channel, clock.now_ns());
        return true;
      },
      Encoding::exact, 80'000'000);
  Scenery scenery(1000);
  const auto pump_all = [&] {
    for (std::int64_t due = outbox.pump(); due != Outbox::kIdle; due = outbox.pump()) clock.sleep_until(due);
  };
  outbox.offer(std::make_unique<WorldView>(scenery.view()));
  pump_all();  // with the whole catalogue behind
  scenery.view().whole = true;
  sent.clear();
  std::int64_t start = clock.now_ns();
  outbox.offer(std::make_unique<WorldView>(scenery.view()));
  outbox.pump();
  outbox.post("T_ACK", {1, 2, 3});
  outbox.pump();
  EXPECT_EQ(sent.back().first, "T_ACK");
  EXPECT_EQ(sent.back().second, start);
  pump_all();
  std::vector<std::int64_t> states;
  for (const auto& [channel, time] : sent) {
    if (channel == "T_STATE") states.push_back(time - start);
  }
  ASSERT_EQ(states.size(), 91u);
  for (std::size_t i = 0; i < states.size(); ++i) {
    EXPECT_NEAR(static_cast<double>(states[i]), static_cast<double>(i) * 80e6 / 91.0, 1e6);
  }
  scenery.view().at_once = true;
  start = clock.now_ns();
  sent.clear();
  outbox.offer(std::make_unique<WorldView>(scenery.view()));
  pump_all();
  EXPECT_LE(sent.back().second - start,
            91 / Outbox::kBurstMessages * Outbox::kBurstNs + 10 * Outbox::kBurstNs);
}

/// Bursts: what a receiver with LCM's default queue of 30 messages can take.
TEST(OutboxPacing, BurstsAreShortAndSpaced) {
  FakeClock clock;
  std::vector<std::int64_t> times;
  Outbox outbox("T", kNetworkPayload, clock, [&](const std::string&, Bytes) {
    times.push_back(clock.now_ns());
    return true;
  });
  Scenery scenery(1000);
  outbox.offer(std::make_unique<WorldView>(scenery.view()));
  for (std::int64_t due = outbox.pump(); due != Outbox::kIdle; due = outbox.pump()) clock.sleep_until(due);
  ASSERT_GT(times.size(), 150u);  // 91 of state, the catalogue behind them
  for (std::size_t i = Outbox::kBurstMessages; i < times.size(); ++i) {
    EXPECT_GE(times[i] - times[i - Outbox::kBurstMessages], Outbox::kBurstNs);
  }
  EXPECT_EQ(outbox.counters().datagrams, times.size());
  EXPECT_EQ(outbox.counters().frames, 1u);
}

TEST(OutboxPacing, AnswersOvertakeAndTheNewestViewWins) {
  FakeClock clock;
  std::vector<std::string> channels;
  std::int64_t last_step = -1;
  Outbox outbox("T", kNetworkPayload, clock, [&](const std::string& channel, Bytes bytes) {
    channels.push_back(channel);
    state_t m{};
    if (channel == "T_STATE" && m.decode(bytes.data(), 0, static_cast<int>(bytes.size())) > 0)
      last_step = m.step;
    return true;
  });
  Scenery scenery(1000);
  for (int step = 0; step < 3; ++step) {
    scenery.view().step = step;
    outbox.offer(std::make_unique<WorldView>(scenery.view()));
  }
  std::int64_t due = outbox.pump();
  outbox.post("T_ACK", {1, 2, 3});
  const std::size_t before = channels.size();
  while (due != Outbox::kIdle) {
    clock.sleep_until(due);
    due = outbox.pump();
  }
  EXPECT_EQ(last_step, 2);
  EXPECT_EQ(outbox.counters().frames_dropped, 2u);
  const auto ack = std::find(channels.begin(), channels.end(), "T_ACK");
  ASSERT_NE(ack, channels.end());
  EXPECT_LE(ack - channels.begin(),
            static_cast<std::ptrdiff_t>(before) + 1);  // behind what was encoded already
}

TEST(OutboxPacing, TheThreadSendsWhatWaitsBeforeItEnds) {
  SystemClock clock;
  std::size_t sent = 0;
  {
    Outbox outbox("T", kNetworkPayload, clock, [&](const std::string&, Bytes) { return ++sent > 0; });
    outbox.start();
    Scenery scenery(100);
    outbox.offer(std::make_unique<WorldView>(scenery.view()));
    outbox.post("T_ACK", {1});
    outbox.stop();
  }
  EXPECT_GE(sent, 1u + 10u);  // the answer and at least ten messages of state
}

}  // namespace
}  // namespace tumble
