// What may come from a network: damaged, cut, lying and random bytes. Claims: nothing of it is accepted, nothing
// throws, and what encode() wrote is read back to the bit.
#include "protocol/codec.h"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>
#include <random>

namespace tumble {
namespace {

using Buffer = std::vector<std::uint8_t>;

force_command_t make_force() {
  force_command_t c{};
  c.client = 42;
  c.sequence = 7;
  c.body = 3;
  c.force[2] = 50.0;
  c.duration = 0.5;
  return c;
}

control_t make_spawn() {
  control_t c{};
  c.client = 42;
  c.sequence = 8;
  c.verb = control_t::VERB_SPAWN;
  c.name = "crate";
  c.orientation[0] = 1.0;
  return c;
}

heartbeat_t make_heartbeat() {
  heartbeat_t h{};
  h.session = 99;
  h.host = "host";
  h.server_version = "0.1.0";
  h.world = "TUMBLE";
  h.scene = "demo pile";
  h.payload_limit = 1400;
  return h;
}

template <typename Message>
Buffer bytes_of(const Message& message) {
  Buffer bytes;
  encode(message, bytes);
  return bytes;
}

void write_u32(Buffer& bytes, std::size_t at, std::uint32_t value) {
  for (std::size_t i = 0; i < 4; ++i) bytes[at + i] = static_cast<std::uint8_t>(value >> (24 - 8 * i));
}

/// Where the length of the spawn's name stands.
std::size_t name_at(const Buffer& bytes) {
  const std::uint8_t name[] = {0, 0, 0, 6, 'c', 'r', 'a', 't', 'e', 0};
  return static_cast<std::size_t>(std::search(bytes.begin(), bytes.end(), std::begin(name), std::end(name)) -
                                  bytes.begin());
}

template <typename Message>
void expect_round_trip(const Message& message) {
  const Buffer bytes = bytes_of(message);
  Message read{};
  ASSERT_EQ(decode(bytes, read), Malformed::none);
  EXPECT_EQ(bytes_of(read), bytes);
}

template <typename Message>
void expect_every_cut_refused(const Message& message) {
  Buffer bytes = bytes_of(message);
  Message read{};
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_EQ(decode(Bytes(bytes.data(), size), read), Malformed::too_short) << size;
  }
  bytes.push_back(0);
  EXPECT_EQ(decode(bytes, read), Malformed::too_long);
}

TEST(Codec, ReadsBackWhatWasWritten) {
  expect_round_trip(make_force());
  expect_round_trip(make_spawn());
  expect_round_trip(make_heartbeat());
}

TEST(Codec, RefusesEveryCutAndEverySurplus) {
  expect_every_cut_refused(make_force());
  expect_every_cut_refused(make_spawn());
  expect_every_cut_refused(make_heartbeat());
}

TEST(Codec, ForceCommandHasTheSizeTheStandardNames) {
  EXPECT_EQ(bytes_of(make_force()).size(), 145u);
}

TEST(Codec, RefusesOtherTypes) {
  control_t read{};
  EXPECT_EQ(decode(bytes_of(make_force()), read), Malformed::wrong_fingerprint);
  Buffer bytes = bytes_of(make_spawn());
  bytes[7] ^= 1;
  EXPECT_EQ(decode(bytes, read), Malformed::wrong_fingerprint);
}

TEST(Codec, RefusesLyingStringLengths) {
  control_t read{};
  for (const std::uint32_t length : {0u, 5u, 7u, 65u, 1u << 20, 0x7fffffffu, 0x80000000u, 0xffffffffu}) {
    Buffer bytes = bytes_of(make_spawn());
    write_u32(bytes, name_at(bytes), length);
    EXPECT_EQ(decode(bytes, read), Malformed::bad_text) << length;
  }
}

TEST(Codec, RefusesStringsWithAZeroInside) {
  control_t read{};
  Buffer bytes = bytes_of(make_spawn());
  bytes[name_at(bytes) + 5] = 0;
  EXPECT_EQ(decode(bytes, read), Malformed::bad_text);
}

TEST(Codec, NamesUpToTheLimitPass) {
  control_t message = make_spawn(), read{};
  message.name = std::string(kMaxBodyName, 'x');
  EXPECT_EQ(decode(bytes_of(message), read), Malformed::none);
  message.name += 'x';
  EXPECT_EQ(decode(bytes_of(message), read), Malformed::bad_text);
}

TEST(Codec, RandomBytesAreNeverAccepted) {
  std::mt19937 random(1);
  force_command_t force{};
  control_t control{};
  heartbeat_t heartbeat{};
  for (int i = 0; i < 20000; ++i) {
    Buffer bytes(random() % 300);
    for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random());
    EXPECT_NE(decode(bytes, force), Malformed::none);
    EXPECT_NE(decode(bytes, control), Malformed::none);
    EXPECT_NE(decode(bytes, heartbeat), Malformed::none);
  }
}

/// Behind a right fingerprint anything may stand: what is accepted must be exactly what its bytes say.
TEST(Codec, DamagedMessagesAreRefusedOrReadExactly) {
  std::mt19937 random(2);
  const Buffer good = bytes_of(make_spawn());
  for (int i = 0; i < 20000; ++i) {
    Buffer bytes = good;
    for (int changes = 0; changes < 3; ++changes) {
      const std::size_t at = 8 + random() % (bytes.size() - 8);
      bytes[at] = static_cast<std::uint8_t>(random());
    }
    bytes.resize(bytes.size() - random() % 3);
    control_t read{};
    if (decode(bytes, read) == Malformed::none) {
      EXPECT_EQ(bytes_of(read), bytes);
    }
  }
}

TEST(Codec, TheSenderOfADamagedCommandIsKnown) {
  Buffer bytes = bytes_of(make_force());
  bytes.pop_back();
  EXPECT_EQ(read_sender(bytes).client, 42);
  EXPECT_EQ(read_sender(bytes).sequence, 7);
  bytes[0] ^= 1;  // of another type: nothing in it can be trusted
  EXPECT_EQ(read_sender(bytes).client, 0);
  EXPECT_EQ(read_sender(Bytes(bytes.data(), 39)).client, 0);
}

TEST(Codec, NonFiniteNumbersAreNamedWhereverTheyStand) {
  EXPECT_EQ(find_not_finite(make_force()), nullptr);
  EXPECT_EQ(find_not_finite(make_spawn()), nullptr);
  force_command_t force = make_force();
  const std::pair<double*, const char*> in_force[] = {{&force.force[1], "force"},
                                                      {&force.torque[0], "torque"},
                                                      {&force.point[2], "point"},
                                                      {&force.duration, "duration"}};
  for (const auto& [field, name] : in_force) {
    const double kept = std::exchange(*field, std::numeric_limits<double>::quiet_NaN());
    EXPECT_STREQ(find_not_finite(force), name);
    *field = kept;
  }
  control_t spawn = make_spawn();
  const std::pair<double*, const char*> in_spawn[] = {
      {&spawn.size[0], "size"},         {&spawn.mass, "mass"},
      {&spawn.position[1], "position"}, {&spawn.orientation[3], "orientation"},
      {&spawn.velocity[2], "velocity"}, {&spawn.angular_velocity[0], "angular_velocity"},
      {&spawn.friction, "friction"},    {&spawn.restitution, "restitution"}};
  for (const auto& [field, name] : in_spawn) {
    const double kept = std::exchange(*field, -std::numeric_limits<double>::infinity());
    EXPECT_STREQ(find_not_finite(spawn), name);
    *field = kept;
  }
  spawn.color[3] = std::numeric_limits<float>::infinity();
  EXPECT_STREQ(find_not_finite(spawn), "color");
}

}  // namespace
}  // namespace tumble
