// A world and what commands may do to it as a whole: pause, steps on request, reset, snapshots, the lists of what is
// told. The live server and a replay hand it the same commands in the same order and get the same bits. It has no
// clock, no bus and no log.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "net/command_inbox.h"
#include "net/world_view.h"
#include "world/world.h"

namespace tumble {

class Simulation {
 public:
  /// A force command that was applied, until its last step is done.
  struct ActivePush {
    force_command_t command;
    double end;  ///< Simulated [s].
  };
  struct State {
    World world;
    std::vector<ActivePush> pushes;
  };
  /// By name; what is kept never changes.
  using KeptStates = std::map<std::string, std::shared_ptr<const State>>;

  /// `world` as it is now is what a reset goes back to. `session` > 0.
  Simulation(World world, std::int64_t session);

  /// Does what an admitted command says; a refused one has changed nothing.
  Outcome apply(const Command& command);
  /// One step. The last of those that a STEP command asked for pauses.
  void step(const std::function<void(Stage)>& stage_done = {});

  const World& world() const { return now_.world; }
  const Conserved& start_sums() const { return start_sums_; }  ///< At the start of the session.
  std::int64_t session() const { return session_; }            ///< Rises with every reset and restore.
  std::int64_t now_step() const { return static_cast<std::int64_t>(now_.world.step_count()); }
  bool paused() const { return paused_; }
  std::int64_t steps_wanted() const { return steps_wanted_; }  ///< Left of a STEP command, then it pauses.
  const std::vector<BodyId>& watched() const { return watched_; }
  bool contacts_wanted() const { return contacts_wanted_; }
  bool pushes_wanted() const { return pushes_wanted_; }
  /// The force commands that act in the next step, the newest first.
  std::vector<PushView> view_pushes() const;
  /// What a reset goes back to, and what a restore can.
  const std::shared_ptr<const State>& start() const { return start_; }
  const KeptStates& kept() const { return kept_; }

 private:
  template <typename>
  friend struct Archived;  // its list of members, snapshot.cpp
  Outcome apply_control(const control_t& command);
  Outcome watch(const control_t& command);
  Outcome unwatch(const control_t& command);
  Outcome keep_snapshot(const std::string& name);
  Outcome restore_snapshot(const std::string& name);
  Outcome push(const force_command_t& command);
  Outcome done() const { return {.step = now_step()}; }
  void start_session(const State& state);

  std::shared_ptr<const State> start_;
  State now_;
  KeptStates kept_;
  std::int64_t session_;
  Conserved start_sums_;
  bool paused_ = false;
  std::int64_t steps_wanted_ = 0;
  std::vector<BodyId> watched_;
  bool contacts_wanted_ = false, pushes_wanted_ = false;
};

}  // namespace tumble
