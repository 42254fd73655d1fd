// LCM URLs are read before LCM sees them, and what is wrong with one is named.
#include "protocol/bus_address.h"

#include <gtest/gtest.h>

#include <stdexcept>

#include "protocol/bus_probe.h"

namespace tumble {
namespace {

TEST(BusAddress, ReadsGroupPortAndOptions) {
  const BusAddress bus = parse_bus_url("udpm://239.1.2.3:7700?ttl=1&recv_buf_size=100000");
  EXPECT_EQ(bus.group, "239.1.2.3");
  EXPECT_EQ(bus.port, 7700);
  EXPECT_EQ(bus.ttl, 1);
  EXPECT_EQ(bus.receive_buffer, 100000);
}

TEST(BusAddress, FillsInLcmsDefaults) {
  const BusAddress bus = parse_bus_url("udpm://");
  EXPECT_EQ(bus.group, "239.255.76.67");
  EXPECT_EQ(bus.port, 7667);
  EXPECT_EQ(bus.ttl, 0);
  EXPECT_FALSE(parse_bus_url("memq://").is_multicast());
}

TEST(BusAddress, NamesTheWrongPart) {
  const std::pair<const char*, const char*> wrong[] = {
      {"nonsense", "provider://"},
      {"foo://", "unknown provider"},
      {"udpm://10.0.0.1:7667", "10.0.0.1"},
      {"udpm://239.1.1.1:0", "port"},
      {"udpm://239.1.1.1:99999", "port"},
      {"udpm://?ttl=256", "ttl"},
      {"udpm://?ttl=", "ttl"},
      {"udpm://?speed=3", "speed"},
  };
  for (const auto& [url, part] : wrong) {
    try {
      parse_bus_url(url);
      ADD_FAILURE() << url << " was accepted";
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
      EXPECT_NE(std::string(error.what()).find(url), std::string::npos) << error.what();
    }
  }
}

TEST(ShortMessage, IsReadOnlyIfWhole) {
  const std::string datagram("LC02\0\0\0\7TUMBLE_ACK\0abc", 22);
  const auto message = parse_short_message(datagram);
  ASSERT_TRUE(message);
  EXPECT_EQ(message->channel, "TUMBLE_ACK");
  EXPECT_EQ(message->payload, "abc");
  EXPECT_FALSE(parse_short_message("LC02"));
  EXPECT_FALSE(parse_short_message(datagram.substr(0, 15)));       // the channel has no end
  EXPECT_FALSE(parse_short_message("LC03" + datagram.substr(4)));  // a fragment
}

}  // namespace
}  // namespace tumble
