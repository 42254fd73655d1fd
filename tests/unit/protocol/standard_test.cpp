// protocol/README.md is the standard others write clients from: its fingerprints and bytes are those of the code.
#include <gtest/gtest.h>

#include <fstream>
#include <regex>
#include <sstream>

#include "protocol/codec.h"
#include "tumble/ack_t.hpp"
#include "tumble/body_state_t.hpp"
#include "tumble/catalog_t.hpp"
#include "tumble/contacts_t.hpp"
#include "tumble/state_t.hpp"
#include "tumble/stats_t.hpp"

namespace tumble {
namespace {

using Buffer = std::vector<std::uint8_t>;

std::string read_standard() {
  std::ifstream file(TUMBLE_SCENES_DIR "/../../protocol/README.md");
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

/// The bytes of the fenced block number `index` that holds hexadecimal lines.
Buffer read_block(int index) {
  std::istringstream lines(read_standard());
  Buffer bytes;
  bool inside = false;
  int block = -1;
  const std::regex hex("^(?:[0-9a-f]{2} +)*[0-9a-f]{2}(?= |$)");
  for (std::string line; std::getline(lines, line);) {
    if (line == "```") {
      inside = !inside;
      block += inside;
      continue;
    }
    std::smatch match;
    if (!inside || block != index || !std::regex_search(line, match, hex)) continue;
    std::istringstream words(match.str());
    for (std::string word; words >> word;)
      bytes.push_back(static_cast<std::uint8_t>(std::stoi(word, nullptr, 16)));
  }
  return bytes;
}

template <typename Message>
void expect_fingerprint(const std::string& name) {
  char text[17];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(Message::getHash()));
  EXPECT_NE(read_standard().find("| " + name + " | " + text + " |"), std::string::npos)
      << name << " is " << text;
}

TEST(Standard, FingerprintsAreThoseOfTheTypes) {
  expect_fingerprint<ack_t>("ack_t");
  expect_fingerprint<body_state_t>("body_state_t");
  expect_fingerprint<catalog_t>("catalog_t");
  expect_fingerprint<contacts_t>("contacts_t");
  expect_fingerprint<control_t>("control_t");
  expect_fingerprint<force_command_t>("force_command_t");
  expect_fingerprint<heartbeat_t>("heartbeat_t");
  expect_fingerprint<hits_t>("hits_t");
  expect_fingerprint<packed_t>("packed_t");
  expect_fingerprint<pushes_t>("pushes_t");
  expect_fingerprint<query_t>("query_t");
  expect_fingerprint<recording_t>("recording_t");
  expect_fingerprint<snapshot_t>("snapshot_t");
  expect_fingerprint<state_t>("state_t");
  expect_fingerprint<step_record_t>("step_record_t");
  expect_fingerprint<stats_t>("stats_t");
}

TEST(Standard, TheForceCommandIsWhatTheCodeSends) {
  force_command_t command{};
  command.client = 1001;
  command.sequence = 1;
  command.body = 1;
  command.generation = 1;
  command.force[2] = 50.0;
  command.duration = 0.5;
  Buffer message;
  encode(command, message);
  const std::string header("LC02\0\0\0\0TUMBLE_FORCE\0", 21);
  Buffer datagram(header.begin(), header.end());
  datagram.insert(datagram.end(), message.begin(), message.end());
  EXPECT_EQ(read_block(0), datagram);
}

TEST(Standard, TheAnswerIsWhatTheCodeSends) {
  ack_t answer{};
  answer.session = 0x123456789a0001;
  answer.step = 480;
  answer.n = 1;
  answer.client = {1001};
  answer.sequence = {1};
  answer.status = {0};
  answer.applied_step = {480};
  answer.body = {1};
  answer.generation = {1};
  answer.detail = {""};
  Buffer message;
  encode(answer, message);
  EXPECT_EQ(read_block(1), message);
}

}  // namespace
}  // namespace tumble
