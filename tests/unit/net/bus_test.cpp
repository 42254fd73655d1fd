// The bus in one process (memq), and that a bus that can't work is said to be so at once instead of after liblcm's ten
// seconds. Multicast itself is tested end to end, in a network namespace.
#include "net/bus.h"

#include <gtest/gtest.h>

namespace tumble {
namespace {

TEST(Bus, CarriesBytesBetweenPublisherAndSubscriber) {
  Bus bus(parse_bus_url("memq://"), "T");
  std::vector<std::uint8_t> heard;
  bus.subscribe("T_FORCE", [&](Bytes bytes) { heard.assign(bytes.begin(), bytes.end()); });
  const std::vector<std::uint8_t> sent = {1, 2, 3};
  EXPECT_TRUE(bus.publish("T_FORCE", sent));
  EXPECT_TRUE(bus.publish("T_OTHER", sent));
  EXPECT_EQ(bus.receive(10), 1);
  EXPECT_EQ(heard, sent);
  EXPECT_EQ(bus.receive(10), 0);
}

TEST(Bus, ReceivesNoMoreThanItsBudget) {
  Bus bus(parse_bus_url("memq://"), "T");
  int heard = 0;
  bus.subscribe("T_FORCE", [&](Bytes) { ++heard; });
  const std::vector<std::uint8_t> sent = {1};
  for (int i = 0; i < 100; ++i) bus.publish("T_FORCE", sent);
  EXPECT_EQ(bus.receive(60), 60);
  EXPECT_EQ(bus.receive(60), 40);
  EXPECT_EQ(heard, 100);
}

TEST(Bus, PayloadLimitFollowsTheReach) {
  EXPECT_EQ(Bus(parse_bus_url("memq://"), "T").payload_limit(), kLoopbackPayload);
}

}  // namespace
}  // namespace tumble
