// Which bodies go into a publication of <WORLD>_STATE or <WORLD>_PACKED, and their messages: those that changed, twice
// more after their last change, and a rolling part of all, so that every receiver knows every body after
// `kRefreshPeriod` and a lost message is healed by then, most often with the next publication.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "net/rolling.h"
#include "net/world_view.h"
#include "protocol/channels.h"
#include "tumble/packed_t.hpp"
#include "tumble/state_t.hpp"

namespace tumble {

/// How bodies are told: state_t's doubles, or packed_t's 25 bytes.
enum class Encoding { exact, packed };

class StateStream {
 public:
  StateStream(std::size_t payload_limit, Encoding encoding);

  /// Chooses the bodies of the publication of `view`, which must live until the last next().
  void begin(const WorldView& view, std::int64_t now_ns);
  std::size_t count() const { return chunk_ends_.size(); }  ///< Messages of the publication.
  /// Fills the next message of the publication, no longer than the payload limit; false: there is none. At least one
  /// a publication, so that step and time are always told.
  bool next(state_t& message);
  bool next(packed_t& message);  ///< Likewise; for Encoding::packed.

 private:
  void select(std::int64_t now_ns);
  void cut_chunks();
  /// The slots of the next message, whose head is filled; false: there is none.
  template <typename Message>
  bool take_chunk(Message& message, std::span<const std::uint32_t>& slots);

  std::size_t bodies_per_message_;
  std::uint32_t ids_per_message_;  // a message's highest id is less than this above its lowest
  const WorldView* view_ = nullptr;
  std::int64_t session_ = 0;
  std::vector<BodyView> sent_;           // by slot, as receivers know them
  std::vector<std::uint32_t> selected_;  // slots, ascending
  std::vector<std::uint8_t> due_;        // by slot: chosen by the refresh
  std::vector<std::uint8_t> repeats_;    // by slot: times to send it although it didn't change
  Rolling refresh_{kRefreshPeriod};
  std::uint32_t refresh_slot_ = 0;
  std::vector<std::size_t> chunk_ends_;  // in selected_
  std::size_t chunk_ = 0;
};

}  // namespace tumble
