// The messages of <WORLD>_CATALOG: what changed at once, everything once a `kCatalogPeriod`. A body with many shapes
// or vertices runs on over several messages.
#pragma once

#include <cstddef>
#include <deque>
#include <memory>

#include "net/rolling.h"
#include "net/world_view.h"
#include "protocol/channels.h"
#include "tumble/catalog_t.hpp"

namespace tumble {

class CatalogStream {
 public:
  explicit CatalogStream(std::size_t payload_limit) : payload_limit_(payload_limit) {}

  /// Queues what is due: the slots in which `view`'s catalogue differs from the last one, and a part of the round.
  void begin(const WorldView& view, std::int64_t now_ns);
  /// Fills the next message, no longer than the payload limit; false: nothing is due any more.
  bool next(catalog_t& message);

 private:
  /// How far the slots [slot, end) have been told.
  struct Range {
    std::uint32_t slot, end;
    bool listed = false;       // the row of body `slot` is out
    std::size_t part = 0;      // shapes of it that are out
    bool part_listed = false;  // the row of shape `part` is out
    std::size_t vertex = 0;    // vertices of it that are out
  };
  void queue_changes(const Catalog* previous);
  void queue_round(std::int64_t now_ns);
  bool add_body(Range& range, catalog_t& message, std::size_t& room) const;

  std::size_t payload_limit_;
  std::int64_t session_ = 0, utime_ = 0;
  std::shared_ptr<const Catalog> catalog_;
  std::deque<Range> work_;
  Rolling round_{kCatalogPeriod};
  std::uint32_t round_slot_ = 0;
};

}  // namespace tumble
