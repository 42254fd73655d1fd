// The server: a world, a clock, a bus, and the tick that ties them: commands in -> step -> state out. Everything it
// needs is handed in, so that tests run it on a fake clock and an in-process bus. One thread; the outbox has its own.
#pragma once

#include <csignal>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "net/bus.h"
#include "net/clock.h"
#include "net/command_inbox.h"
#include "net/outbox.h"
#include "net/world_view.h"
#include "pacer.h"
#include "protocol/channels.h"
#include "recorder.h"
#include "simulation.h"
#include "step_meter.h"
#include "tumble/heartbeat_t.hpp"
#include "tumble/query_t.hpp"

namespace tumble {

struct ServerSettings {
  std::string world_name{kDefaultWorld};
  std::string scene_name;                     ///< For people.
  double rate = 0.0;                          ///< Steps a second of wall time; 0: as fast as possible.
  double publish_rate = kDefaultPublishRate;  ///< Publications of the state a second of wall time, > 0.
  std::int64_t steps = 0;                     ///< Stop after so many steps; 0: run on.
  bool packed = false;                        ///< For people: how the outbox encodes the state.
};

class Server {
 public:
  /// `inbox`: what clients had been told before, when a run goes on. The outbox is pumped by whoever owns it.
  Server(Simulation simulation, ServerSettings settings, Clock& clock, Bus& bus, Outbox& outbox,
         CommandInbox inbox = {});

  /// One turn: commands that are due, a step unless paused, and what must be told by now.
  void tick();
  /// `observer` hears of every step.
  void set_observer(std::function<void(const StepReport&)> observer) { observer_ = std::move(observer); }
  /// Everything from now on is recorded.
  void set_recorder(Recorder recorder) { recorder_.emplace(std::move(recorder)); }
  /// Ticks, paced by the clock, until `stop` is set or the steps are done; then tells the last state.
  void run(const volatile std::sig_atomic_t& stop);

  const World& world() const { return simulation_.world(); }
  const Simulation& simulation() const { return simulation_; }
  std::int64_t steps_done() const { return steps_done_; }  ///< Over all sessions.
  const Pacer& pacer() const { return pacer_; }
  const CommandInbox& inbox() const { return inbox_; }

 private:
  void receive_commands();
  void hear(void (CommandInbox::*receive)(Bytes), Bytes bytes);
  void note(const Command& command, std::int64_t start_step);
  void apply(const Command& command);
  void send_answers();
  void note_query(Bytes bytes);
  void answer_queries();

  void step();
  void publish_when_due();
  void publish(std::int64_t now);
  void report_when_due();
  void hasten_heartbeat();
  void send_heartbeat();
  void send_stats();
  void notice_heartbeat(Bytes bytes);
  void log_damaged();
  void log_contained();
  void wait();

  template <typename Message>
  void post(const std::string& channel, const Message& message);
  /// Runs `write` on the recorder, if there is one; a file that takes no more ends the recording, not the world.
  template <typename Write>
  void record(Write write);
  bool hurrying() const { return settings_.rate <= 0.0 || simulation_.steps_wanted() > 0; }

  ServerSettings settings_;
  Clock& clock_;
  Bus& bus_;
  Outbox& outbox_;
  Simulation simulation_;
  CommandInbox inbox_;
  std::optional<Recorder> recorder_;
  std::vector<Acknowledgement> answers_;  // that are still to be sent
  std::int64_t steps_done_ = 0;
  bool changed_ = true;           // something a receiver should know at once: publish now
  bool told_paused_ = false;      // as the last heartbeat said
  bool tell_all_ = false;         // the next publication holds every body: somebody missed one
  std::vector<query_t> queries_;  // received in this tick
  std::uint64_t repeated_ = 0;    // of the inbox's counter, seen so far

  std::shared_ptr<const Catalog> catalog_;
  std::uint64_t catalog_model_ = 0;  // the world's model epoch it was made from
  std::int64_t catalog_epoch_ = 0;
  std::unique_ptr<WorldView> spare_view_;
  std::int64_t next_publication_ = 0, next_contacts_ = 0, next_pushes_ = 0, next_stats_ = 0,
               next_heartbeat_ = 0;  // now_ns
  std::int64_t last_heartbeat_ = 0;  // now_ns

  Pacer pacer_;
  StepMeter meter_;
  std::function<void(Stage)> stage_done_;
  std::function<void(const StepReport&)> observer_;
  std::uint64_t damaged_logged_ = 0;
  std::string damaged_sender_;
  std::int64_t next_damage_log_ = 0;     // now_ns
  std::int64_t next_contained_log_ = 0;  // now_ns
  std::string host_;
  std::map<std::string, std::int64_t>
      others_;  // "host pid" of other servers of this world -> when warned [now_ns]
};

/// A session's number: positive, random but for its lowest bits, which count resets and restores.
std::int64_t random_session();

}  // namespace tumble
