// Which bodies go into a publication of <WORLD>_STATE, and their messages: those that changed since they were last
// sent, and a rolling part of all, so that every receiver knows every body after `kRefreshPeriod` and a lost message
// is healed by then.
#pragma once

#include <cstddef>
#include <vector>

#include "net/rolling.h"
#include "net/world_view.h"
#include "protocol/channels.h"
#include "tumble/state_t.hpp"

namespace tumble {

class StateStream {
 public:
  explicit StateStream(std::size_t payload_limit);

  /// Chooses the bodies of the publication of `view`, which must live until the last next().
  void begin(const WorldView& view, std::int64_t now_ns);
  /// Fills the next message of the publication, no longer than the payload limit; false: there is none. At least one
  /// a publication, so that step and time are always told.
  bool next(state_t& message);

 private:
  void select(std::int64_t now_ns);

  std::size_t bodies_per_message_;
  const WorldView* view_ = nullptr;
  std::int64_t session_ = 0;
  std::vector<BodyView> sent_;           // by slot, as receivers know them
  std::vector<std::uint32_t> selected_;  // slots, ascending
  std::vector<std::uint8_t> due_;        // by slot: chosen by the refresh
  Rolling refresh_{kRefreshPeriod};
  std::uint32_t refresh_slot_ = 0;
  std::size_t chunk_ = 0, num_chunks_ = 0;
};

}  // namespace tumble
