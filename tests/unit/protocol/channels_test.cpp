// Names on the wire: every channel fits what LCM takes, and world names that would not are refused.
#include "protocol/channels.h"

#include <gtest/gtest.h>

#include <limits>
#include <set>

namespace tumble {
namespace {

constexpr std::size_t kMaxLcmChannel = 63;

TEST(Channels, TheLongestWorldNameStillFits) {
  const std::string world(kMaxWorldName, 'W');
  ASSERT_TRUE(is_world_name(world));
  for (const std::string_view suffix : {kStateSuffix, kStatsSuffix, kContactsSuffix, kCatalogSuffix,
                                        kHeartbeatSuffix, kAckSuffix, kForceSuffix, kControlSuffix}) {
    EXPECT_LE(channel_name(world, suffix).size(), kMaxLcmChannel);
  }
  EXPECT_LE(body_channel_name(world, std::numeric_limits<std::int32_t>::max()).size(), kMaxLcmChannel);
}

TEST(Channels, WorldNamesOfOtherCharactersAreRefused) {
  for (const char* name : {"", "a b", "a.b", "TUMBLE-2", "w\xc3\xa4", ".*"})
    EXPECT_FALSE(is_world_name(name)) << name;
  EXPECT_FALSE(is_world_name(std::string(kMaxWorldName + 1, 'W')));
}

TEST(Channels, EveryStatusHasATextOfItsOwn) {
  std::set<std::string> texts;
  for (std::int8_t i = 0; i < kNumStatuses; ++i) texts.insert(status_text(static_cast<Status>(i)));
  EXPECT_EQ(texts.size(), static_cast<std::size_t>(kNumStatuses));
  EXPECT_EQ(texts.count("unknown status"), 0u);
}

}  // namespace
}  // namespace tumble
