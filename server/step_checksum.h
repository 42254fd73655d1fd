// Over what a recorded log says of one step: the commands' bytes and the step record's own fields. A log has no
// checksums of its own.
#pragma once

#include "math/hash.h"
#include "protocol/codec.h"
#include "tumble/step_record_t.hpp"

namespace tumble {

class StepChecksum {
 public:
  void add_command(Bytes bytes) {
    for (const std::uint8_t byte : bytes) hash_.add(std::uint64_t{byte});
    ++commands_;
  }
  std::int32_t commands() const { return commands_; }
  /// Of a record whose fields, but for the checksum, are filled.
  std::int64_t finish(const step_record_t& record) const {
    Hash hash = hash_;
    for (const std::int64_t field : {record.utime, record.session, record.step, record.state_hash,
                                     static_cast<std::int64_t>(record.commands)}) {
      hash.add(static_cast<std::uint64_t>(field));
    }
    return static_cast<std::int64_t>(hash.value());
  }

 private:
  Hash hash_;
  std::int32_t commands_ = 0;
};

}  // namespace tumble
