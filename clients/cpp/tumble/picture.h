// The client's picture of the world, merged from the server's messages in whatever order the network delivers them.
// The rules: only what changed is sent, so what is not mentioned stays; newer steps win over older ones; a body is gone
// when a catalogue of a newer epoch no longer lists it; a new session starts from nothing.
#pragma once

#include <map>
#include <set>
#include <string_view>

#include "tumble/body.h"
#include "tumble/catalog_t.hpp"
#include "tumble/packed_t.hpp"
#include "tumble/state_t.hpp"

namespace tumble::client {

class Picture {
 public:
  /// All return false if the message was too old to say anything.
  bool merge(const state_t& message);
  bool merge(const packed_t& message);
  bool merge(const catalog_t& message);

  /// By id, ascending. A body may be known from one of the two channels only: see Body::described and ::placed.
  const std::map<std::int32_t, Body>& bodies() const { return bodies_; }
  const Body* find(std::int32_t id) const;
  const Body* find(std::string_view name) const;

  /// True if every body of the newest epoch is described with all its shapes, and placed.
  bool is_complete() const;

  std::int64_t session() const { return session_; }  ///< 0: nothing heard yet.
  std::int64_t step() const { return step_; }        ///< Newest heard of in this session; -1: none.
  /// Newest step of which a whole publication was heard, no message of it lost; -1: none.
  std::int64_t whole_step() const { return whole_step_; }
  double time() const { return time_; }                    ///< Simulated [s], of step().
  std::int64_t state_hash() const { return state_hash_; }  ///< Of the whole world, at step().
  std::int64_t epoch() const { return epoch_; }
  std::int32_t num_bodies() const { return num_bodies_; }  ///< In the server's world.

 private:
  bool adopt_session(std::int64_t session, std::int64_t utime);
  bool merge_state(const state_t& message, bool may_create);
  void note_chunk(const state_t& message);
  void note_epoch(std::int64_t epoch, std::int32_t num_bodies);
  /// The entry for (id, generation), made if `may_create`; null if the message is about an earlier user of the id.
  Body* body_for(std::int32_t id, std::int32_t generation, bool may_create);
  void remove_unlisted(const catalog_t& message);
  void forget_name(const Body& body);
  void merge_bodies(const catalog_t& message);
  void merge_shapes(const catalog_t& message);
  void merge_vertices(const catalog_t& message);

  std::map<std::int32_t, Body> bodies_;
  std::map<std::string, std::int32_t, std::less<>> ids_by_name_;  ///< Of the described.
  std::int64_t session_ = 0;
  std::int64_t utime_ = 0;  ///< Newest server clock heard in this session [us].
  std::int64_t step_ = -1;
  double time_ = 0.0;
  std::int64_t state_hash_ = 0;
  struct Publication {
    std::int64_t utime = 0;
    std::set<std::int16_t> heard;  ///< Numbers of its messages.
  };
  Publication publication_;  ///< The newest.
  std::int64_t whole_step_ = -1;
  std::int64_t epoch_ = -1;
  std::int32_t num_bodies_ = -1;
};

}  // namespace tumble::client
