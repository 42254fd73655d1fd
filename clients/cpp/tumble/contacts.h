// The touching points of one step, put together from the messages that carry them.
#pragma once

#include <set>
#include <vector>

#include "tumble/body.h"
#include "tumble/contacts_t.hpp"

namespace tumble::client {

struct Contact {
  std::int32_t body_a = -1, body_b = -1;
  Vec3 point{}, normal{};   ///< In W; the normal from A to B.
  double separation = 0.0;  ///< [m]; < 0: overlap.
  Vec3 impulse{};           ///< On B during the last step, in W [N s].
};

struct Contacts {
  std::int64_t step = -1;  ///< -1: none heard of.
  double time = 0.0;       ///< Simulated [s].
  bool complete = false;   ///< No message of the step is missing.
  std::vector<Contact> all;

  /// Messages of older publications and repeated ones are ignored.
  void merge(const contacts_t& message) {
    if (message.session == session && message.utime < utime) return;
    if (message.session != session || message.utime > utime) {
      *this = {message.step, message.time, false, {}, message.session, message.utime, {}};
    }
    if (!heard.insert(message.chunk).second) return;
    for (std::size_t i = 0; i < message.body_a.size(); ++i) {
      all.push_back({message.body_a[i],
                     message.body_b[i],
                     {message.px[i], message.py[i], message.pz[i]},
                     {message.nx[i], message.ny[i], message.nz[i]},
                     message.separation[i],
                     {message.jx[i], message.jy[i], message.jz[i]}});
    }
    complete = static_cast<std::int32_t>(all.size()) == message.num_contacts;
  }

  std::int64_t session = 0, utime = 0;
  std::set<std::int16_t> heard;  ///< Numbers of the messages in `all`.
};

}  // namespace tumble::client
