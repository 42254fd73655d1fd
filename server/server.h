// The server: a world, a clock, a bus, and the tick that ties them: commands in -> step -> state out. Everything it
// needs is handed in, so that tests run it on a fake clock and an in-process bus. One thread; the outbox has its own.
#pragma once

#include <csignal>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "net/bus.h"
#include "net/clock.h"
#include "net/command_inbox.h"
#include "net/outbox.h"
#include "net/world_view.h"
#include "pacer.h"
#include "protocol/channels.h"
#include "step_meter.h"
#include "tumble/heartbeat_t.hpp"

namespace tumble {

struct ServerSettings {
  std::string world_name{kDefaultWorld};
  std::string scene_name;                     ///< For people.
  double rate = 0.0;                          ///< Steps a second of wall time; 0: as fast as possible.
  double publish_rate = kDefaultPublishRate;  ///< Publications of the state a second of wall time, > 0.
  std::int64_t steps = 0;                     ///< Stop after so many steps; 0: run on.
};

class Server {
 public:
  /// `world` as it is now is what a reset goes back to. The outbox is pumped by whoever owns it.
  Server(World world, ServerSettings settings, Clock& clock, Bus& bus, Outbox& outbox);

  /// One turn: commands that are due, a step unless paused, and what must be told by now.
  void tick();
  /// `observer` hears of every step.
  void set_observer(std::function<void(const StepReport&)> observer) { observer_ = std::move(observer); }
  /// Ticks, paced by the clock, until `stop` is set or the steps are done; then tells the last state.
  void run(const volatile std::sig_atomic_t& stop);

  const World& world() const { return world_; }
  std::int64_t session() const { return session_; }
  bool paused() const { return paused_; }
  std::int64_t steps_done() const { return steps_done_; }  ///< Over all sessions.
  const Pacer& pacer() const { return pacer_; }
  const CommandInbox& inbox() const { return inbox_; }

 private:
  void receive_commands();
  Outcome apply(const Command& command);
  Outcome apply_control(const control_t& command);
  Outcome watch(const control_t& command);
  Outcome unwatch(const control_t& command);
  void reset();
  void send_answers();

  void step();
  void publish_when_due();
  void publish(std::int64_t now);
  void report_when_due();
  void send_heartbeat();
  void send_stats();
  void notice_heartbeat(Bytes bytes);
  void log_damaged();
  void wait();

  template <typename Message>
  void post(const std::string& channel, const Message& message);
  void start_session(std::int64_t session);
  bool hurrying() const { return settings_.rate <= 0.0 || steps_wanted_ > 0; }
  std::int64_t now_step() const { return static_cast<std::int64_t>(world_.step_count()); }

  ServerSettings settings_;
  Clock& clock_;
  Bus& bus_;
  Outbox& outbox_;
  World start_;  // what a reset goes back to
  World world_;
  Conserved start_sums_;

  CommandInbox inbox_;
  std::int64_t session_ = 0;
  bool paused_ = false;
  std::int64_t steps_wanted_ = 0;  // > 0: of a STEP command, then pause
  std::int64_t steps_done_ = 0;
  std::vector<BodyId> watched_;
  bool contacts_wanted_ = false;
  bool changed_ = true;  // something a receiver should know at once: publish now

  std::shared_ptr<const Catalog> catalog_;
  std::uint64_t catalog_model_ = 0;  // the world's model epoch it was made from
  std::int64_t catalog_epoch_ = 0;
  std::unique_ptr<WorldView> spare_view_;
  std::int64_t next_publication_ = 0, next_contacts_ = 0, next_stats_ = 0, next_heartbeat_ = 0;  // now_ns

  Pacer pacer_;
  StepMeter meter_;
  std::function<void(Stage)> stage_done_;
  std::function<void(const StepReport&)> observer_;
  std::uint64_t damaged_logged_ = 0;
  std::int64_t next_damage_log_ = 0;  // now_ns
  std::string host_;
  std::map<std::string, std::int64_t>
      others_;  // "host pid" of other servers of this world -> when warned [now_ns]
};

}  // namespace tumble
