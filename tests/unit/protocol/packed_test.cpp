// The 25-byte record of a body: every field comes back, and no error exceeds what packed.h states.
#include "protocol/packed.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace tumble {
namespace {

packed_t make_message(double edge) {
  packed_t message{};
  message.origin[0] = -100.0;
  message.origin[1] = 3.25;
  message.origin[2] = 1e4;
  message.edge = edge;
  message.first_id = 70'000;
  return message;
}

PackedBody pass(const PackedBody& body, const packed_t& message) {
  std::array<std::uint8_t, kPackedRecord> bytes{};
  pack_body(body, message, bytes);
  return unpack_body(bytes, message);
}

double turn_between(const double* a, const double* b) {
  double dot = 0.0;
  for (int i = 0; i < 4; ++i) dot += a[i] * b[i];
  return 2.0 * std::acos(std::min(std::abs(dot), 1.0));
}

TEST(Packed, ErrorsKeepToTheirBounds) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  std::normal_distribution<double> normal;
  double worst_position = 0.0, worst_turn = 0.0, worst_speed = 0.0;
  for (int i = 0; i < 100'000; ++i) {
    const packed_t message = make_message(std::ldexp(kPackedEdge, i % 20));
    PackedBody body;
    body.id = 70'000 + static_cast<std::uint32_t>(random() % kPackedIds);
    body.generation = static_cast<std::uint32_t>(random() % 100);
    body.flags = static_cast<std::int8_t>(random() % 32);
    double length = 0.0;
    for (std::size_t k = 0; k < 3; ++k) body.values[k] = message.origin[k] + unit(random) * message.edge;
    for (std::size_t k = 3; k < 7; ++k) body.values[k] = normal(random);
    for (std::size_t k = 3; k < 7; ++k) length += body.values[k] * body.values[k];
    for (std::size_t k = 3; k < 7; ++k) body.values[k] /= std::sqrt(length);
    for (std::size_t k = 7; k < 13; ++k)
      body.values[k] = normal(random) * std::pow(10.0, 9.0 * unit(random) - 5.0);
    const PackedBody back = pass(body, message);
    ASSERT_EQ(back.id, body.id);
    ASSERT_EQ(back.generation, body.generation % kPackedGenerations);
    const int kept = state_t::FLAG_RESTING | state_t::FLAG_CONTAINED | state_t::FLAG_WATCHED;
    ASSERT_EQ(back.flags, body.flags & kept);
    for (std::size_t k = 0; k < 3; ++k) {
      worst_position = std::max(worst_position, std::abs(back.values[k] - body.values[k]) / message.edge);
    }
    worst_turn = std::max(worst_turn, turn_between(&back.values[3], &body.values[3]));
    for (std::size_t k = 7; k < 13; ++k) {
      const double x = body.values[k], error = std::abs(back.values[k] - x);
      const double bound = std::max(std::ldexp(std::abs(x), -8), std::ldexp(1.0, -22));
      worst_speed = std::max(worst_speed, error / bound);
    }
  }
  EXPECT_LE(worst_position, std::ldexp(1.0, -21) * (1.0 + 1e-5));  // 4.7684e-7
  EXPECT_LE(worst_turn, 6e-4);                                     // 4.7e-4
  EXPECT_LE(worst_speed, 1.0);                                     // 1.0
}

TEST(Packed, RestIsExactlyRest) {
  PackedBody body;
  body.id = 70'000;
  body.values = {-100.0, 3.25, 1e4, 1.0, 0.0, 0.0, 0.0};
  const PackedBody back = pass(body, make_message(kPackedEdge));
  for (std::size_t k = 7; k < 13; ++k) EXPECT_EQ(back.values[k], 0.0);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(back.values[k], body.values[k]);
}

TEST(Packed, WhatIsTooFastIsCut) {
  PackedBody body;
  body.id = 70'000;
  body.values = {-100.0, 3.25, 1e4, 1.0, 0.0, 0.0, 0.0, 1e9, -1e9, 65'000.0, 0.0, 0.0, 0.0};
  const PackedBody back = pass(body, make_message(kPackedEdge));
  EXPECT_GT(back.values[7], 130'000.0);
  EXPECT_EQ(back.values[8], -back.values[7]);
  EXPECT_NEAR(back.values[9], 65'000.0, 65'000.0 / 256.0);
}

TEST(Packed, MessagesUnpackToStates) {
  packed_t message = make_message(kPackedEdge);
  message.step = 77;
  message.n = 2;
  message.size = static_cast<std::int32_t>(2 * kPackedRecord);
  message.records.resize(2 * kPackedRecord);
  PackedBody body;
  body.values = {-99.0, 4.0, 1e4, 0.0, 1.0, 0.0, 0.0, 1.5};
  for (std::uint32_t i = 0; i < 2; ++i) {
    body.id = 70'000 + i;
    pack_body(body, message, PackedRecord(message.records.data() + i * kPackedRecord, kPackedRecord));
  }
  state_t state;
  unpack(message, state);
  EXPECT_EQ(state.step, 77);
  EXPECT_EQ(state.id, (std::vector<std::int32_t>{70'000, 70'001}));
  EXPECT_NEAR(state.px[1], -99.0, 1e-4);
  EXPECT_NEAR(std::abs(state.qx[1]), 1.0, 1e-6);
  EXPECT_EQ(state.vx[1], 1.5);
}

}  // namespace
}  // namespace tumble
