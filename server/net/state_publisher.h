// One publication: a view of the world turned into messages, one at a time, in the order of their urgency: watched
// bodies, state, catalogue, contacts, pushes. Knows no thread, bus or clock; outbox.h drives it.
#pragma once

#include <string>
#include <vector>

#include "net/catalog_stream.h"
#include "net/state_stream.h"
#include "net/world_view.h"

namespace tumble {

class StatePublisher {
 public:
  StatePublisher(std::string world_name, std::size_t payload_limit, Encoding encoding = Encoding::exact);

  /// Starts the publication of `view`, which must live until next() returned false.
  void begin(const WorldView& view, std::int64_t now_ns);
  /// Messages of the publication that began, the catalogue's not counted.
  std::size_t count() const { return view_->watched.size() + state_.count() + num_contact_chunks_; }
  /// Encodes the next message and names its channel; false: the publication is complete.
  bool next(std::string& channel, std::vector<std::uint8_t>& bytes);

 private:
  void encode_watched(const WatchedView& watched, std::string& channel,
                      std::vector<std::uint8_t>& bytes) const;
  bool encode_state(std::string& channel, std::vector<std::uint8_t>& bytes);
  void encode_contacts(std::vector<std::uint8_t>& bytes);
  void encode_pushes(std::vector<std::uint8_t>& bytes) const;

  std::string world_name_, state_channel_, packed_channel_, catalog_channel_, contacts_channel_,
      pushes_channel_;
  Encoding encoding_;
  std::size_t contacts_per_message_, pushes_per_message_;
  StateStream state_;
  CatalogStream catalog_;
  const WorldView* view_ = nullptr;
  std::size_t watched_ = 0, contact_chunk_ = 0, num_contact_chunks_ = 0;
  bool pushes_told_ = false;
  state_t state_message_{};
  packed_t packed_message_{};
  catalog_t catalog_message_{};
};

}  // namespace tumble
