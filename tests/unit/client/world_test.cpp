// The client against a server without physics, both on one bus inside the process (memq://).
#include "tumble/world.h"

#include <gtest/gtest.h>

#include "unit/client/messages.h"

namespace tumble::client {
namespace {

/// Notes commands and answers them as it is told.
class FakeServer {
 public:
  explicit FakeServer(std::shared_ptr<lcm::LCM> bus) : bus_(std::move(bus)) {
    bus_->subscribe("FAKE_FORCE", &FakeServer::on_command<force_command_t>, this);
    bus_->subscribe("FAKE_CONTROL", &FakeServer::on_command<control_t>, this);
  }

  template <typename Message>
  void send(const char* suffix, const Message& message) {
    bus_->publish(std::string("FAKE") + suffix, &message);
  }
  void introduce() {
    heartbeat_t heartbeat{};
    heartbeat.session = 1;
    heartbeat.protocol_version = protocol_version;
    send("_HEARTBEAT", heartbeat);
    send("_CATALOG", make_catalog({{0, "floor"}, {1, "ball"}}));
    send("_STATE", make_state(0, {{0, 0.0}, {1, 1.0}}));
  }

  std::int32_t protocol_version = kProtocolVersion;
  Status status = Status::applied;
  std::string detail;
  std::size_t silent = 0;  ///< So many commands are not answered.
  std::vector<std::int64_t> sequences;
  force_command_t force{};
  control_t control{};

 private:
  template <typename Message>
  void on_command(const lcm::ReceiveBuffer*, const std::string&, const Message* command) {
    note(*command);
    sequences.push_back(command->sequence);
    if (sequences.size() <= silent) return;
    ack_t answer{};
    answer.n = 1;
    answer.client = {command->client};
    answer.sequence = {command->sequence};
    answer.status = {static_cast<std::int8_t>(status)};
    answer.applied_step = {7};
    answer.body = {command->body};
    answer.generation = {0};
    answer.detail = {detail};
    send("_ACK", answer);
  }
  void note(const force_command_t& command) { force = command; }
  void note(const control_t& command) { control = command; }

  std::shared_ptr<lcm::LCM> bus_;
};

class WorldTest : public testing::Test {
 protected:
  static WorldOptions options() {
    WorldOptions options;
    options.name = "FAKE";
    options.timing = {std::chrono::milliseconds(2), std::chrono::seconds(1)};
    return options;
  }

  std::shared_ptr<lcm::LCM> bus = std::make_shared<lcm::LCM>("memq://");
  FakeServer server{bus};
  World world{bus, options()};
};

TEST_F(WorldTest, APushSaysWhatItMeans) {
  server.introduce();
  Push push;
  push.body = "ball";
  push.force = {0, 0, 50};
  push.point = {0.1, 0, 0};
  push.frame = Frame::body;
  push.seconds = 0.5;
  const Answer answer = world.push(push);
  EXPECT_TRUE(answer.accepted());
  EXPECT_EQ(answer.step, 7);
  EXPECT_EQ(server.force.body, 1);
  EXPECT_EQ(server.force.session, 1);
  EXPECT_EQ(server.force.sequence, 1);
  EXPECT_NE(server.force.client, 0);
  EXPECT_EQ(server.force.force[2], 50.0);
  EXPECT_EQ(server.force.point[0], 0.1);
  EXPECT_EQ(server.force.frame, force_command_t::FRAME_BODY);
  EXPECT_EQ(server.force.duration, 0.5);
}

TEST_F(WorldTest, RepeatsUnderTheSameNumberUntilAnswered) {
  server.introduce();
  server.silent = 3;
  EXPECT_TRUE(world.pause().accepted());
  EXPECT_EQ(server.sequences, (std::vector<std::int64_t>{1, 1, 1, 1}));
  EXPECT_EQ(server.control.verb, control_t::VERB_PAUSE);
}

TEST_F(WorldTest, GivesUpOnASilentServer) {
  server.introduce();
  server.silent = 1000;
  const Answer answer = world.reset();
  EXPECT_FALSE(answer.heard);
  EXPECT_FALSE(answer.accepted());
}

TEST_F(WorldTest, HandsOverTheReasonOfARefusal) {
  server.introduce();
  server.status = Status::invalid;
  server.detail = "name: \"ball\" is taken";
  Spawn spawn;
  spawn.name = "ball";
  const Answer answer = world.spawn(spawn);
  EXPECT_FALSE(answer.accepted());
  EXPECT_EQ(answer.text(), "name: \"ball\" is taken");
}

TEST_F(WorldTest, AnUnknownBodyIsNamedWithSimilarOnes) {
  server.introduce();
  try {
    world.remove("bell");
    FAIL() << "no exception";
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(), "no body is called \"bell\"; similar: ball");
  }
  EXPECT_TRUE(server.sequences.empty());
}

TEST_F(WorldTest, SaysWhereItListenedInVain) {
  try {
    world.wait_for_server(0.05);
    FAIL() << "no exception";
  } catch (const NoServer& error) {
    EXPECT_NE(std::string(error.what()).find("FAKE_HEARTBEAT"), std::string::npos) << error.what();
  }
}

TEST_F(WorldTest, RefusesAServerOfAnotherProtocol) {
  server.protocol_version = kProtocolVersion + 1;
  server.introduce();
  EXPECT_THROW(world.wait_for_server(0.5), std::runtime_error);
}

TEST_F(WorldTest, DamagedMessagesAreCountedAndChangeNothing) {
  server.introduce();
  world.wait_for_picture(0.5);
  std::vector<std::uint8_t> bytes;
  encode(make_state(3, {{1, 4.0}}), bytes);
  const auto publish = [&](std::size_t size) {
    bus->publish("FAKE_STATE", bytes.data(), static_cast<unsigned>(size));
  };
  publish(0);
  publish(7);
  publish(bytes.size() - 8);
  std::swap(bytes[0], bytes[1]);
  publish(bytes.size());
  world.spin(0.02);
  EXPECT_EQ(world.messages_malformed(), 4);
  EXPECT_EQ(world.picture().step(), 0);
}

TEST(World, RefusesNamesThatAreNoChannelPrefix) {
  const auto bus = std::make_shared<lcm::LCM>("memq://");
  WorldOptions options;
  options.name = "MY WORLD";
  EXPECT_THROW(World(bus, options), std::invalid_argument);
}

TEST(SimilarNames, AreRankedByEditDistance) {
  EXPECT_EQ(similar_names("bal1", {"ball", "bowl", "wall", "floor"}),
            (std::vector<std::string>{"ball", "wall"}));
  EXPECT_EQ(similar_names("box", {"box_1", "box_2", "sphere"}), (std::vector<std::string>{"box_1", "box_2"}));
  EXPECT_TRUE(similar_names("xyz", {"floor"}).empty());
}

}  // namespace
}  // namespace tumble::client
