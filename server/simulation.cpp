// See simulation.h.
#include "simulation.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "apply_command.h"
#include "from_message.h"

namespace tumble {

Simulation::Simulation(World world, std::int64_t session)
    : start_(std::make_shared<const State>(State{std::move(world), {}})),
      now_(*start_),
      session_(session),
      start_sums_(now_.world.compute_conserved()) {}

void Simulation::start_session(const State& state) {
  now_ = state;
  ++session_;
  start_sums_ = now_.world.compute_conserved();
  watched_.clear();
}

void Simulation::step(const std::function<void(Stage)>& stage_done) {
  if (stage_done) {
    now_.world.step(stage_done);
  } else {
    now_.world.step();
  }
  std::erase_if(now_.pushes, [&](const ActivePush& push) { return push.end <= world().time(); });
  if (steps_wanted_ > 0 && --steps_wanted_ == 0) paused_ = true;
}

Outcome Simulation::apply(const Command& command) {
  if (command.session != 0 && command.session != session_) {  // a reset came before it in the same tick
    return {.status = Status::wrong_session, .detail = status_text(Status::wrong_session)};
  }
  if (const auto* force = std::get_if<force_command_t>(&command.content)) return push(*force);
  return apply_control(std::get<control_t>(command.content));
}

Outcome Simulation::apply_control(const control_t& command) {
  switch (command.verb) {
    case control_t::VERB_SPAWN:
      return apply_spawn(now_.world, command);
    case control_t::VERB_REMOVE:
      return apply_remove(now_.world, command);
    case control_t::VERB_SET_STATE:
      return apply_set_state(now_.world, command);
    case control_t::VERB_RESET:
      start_session(*start_);
      return done();
    case control_t::VERB_SNAPSHOT:
      return keep_snapshot(command.name);
    case control_t::VERB_RESTORE:
      return restore_snapshot(command.name);
    case control_t::VERB_PAUSE:
    case control_t::VERB_RESUME:
      paused_ = command.verb == control_t::VERB_PAUSE;
      steps_wanted_ = 0;
      return done();
    case control_t::VERB_STEP:
      paused_ = false;
      steps_wanted_ = command.count;
      return done();
    case control_t::VERB_WATCH:
      return watch(command);
    case control_t::VERB_UNWATCH:
      return unwatch(command);
    case control_t::VERB_PUSHES_ON:
    case control_t::VERB_PUSHES_OFF:
      pushes_wanted_ = command.verb == control_t::VERB_PUSHES_ON;
      return done();
    case control_t::VERB_CONTACTS_ON:
    case control_t::VERB_CONTACTS_OFF:
      contacts_wanted_ = command.verb == control_t::VERB_CONTACTS_ON;
      return done();
    default:
      return {.status = Status::unknown_verb, .detail = status_text(Status::unknown_verb)};
  }
}

Outcome Simulation::push(const force_command_t& command) {
  Outcome outcome = apply_force(now_.world, command);
  if (outcome.status != Status::applied) return outcome;
  const double least = world().options().time_step;  // a duration of 0 is one step
  now_.pushes.push_back({command, world().time() + std::max(command.duration, least)});
  return outcome;
}

std::vector<PushView> Simulation::view_pushes() const {
  std::vector<PushView> views;
  for (auto push = now_.pushes.rbegin(); push != now_.pushes.rend(); ++push) {
    const force_command_t& command = push->command;
    const auto slot = static_cast<std::uint32_t>(command.body);
    if (!world().is_valid({slot, static_cast<std::uint32_t>(command.generation)})) continue;
    const Motion& motion = world().motion(slot);
    const bool turns = command.frame == force_command_t::FRAME_BODY;
    const Quat q_WF = turns ? motion.q : Quat::Identity();
    views.push_back({slot, motion.x + motion.q * to_vector(command.point), q_WF * to_vector(command.force),
                     q_WF * to_vector(command.torque), push->end - world().time()});
  }
  return views;
}

Outcome Simulation::watch(const control_t& command) {
  Outcome found = find_body(now_.world, command.body, command.generation);
  if (found.status != Status::applied) return found;
  std::erase_if(watched_, [this](BodyId id) { return !now_.world.is_valid(id); });
  const BodyId id{static_cast<std::uint32_t>(found.body), static_cast<std::uint32_t>(found.generation)};
  if (std::find(watched_.begin(), watched_.end(), id) != watched_.end()) return found;
  if (watched_.size() == kMaxWatched) {
    return {.status = Status::out_of_range,
            .detail = fmt::format("{} bodies are watched already", kMaxWatched)};
  }
  watched_.push_back(id);
  return found;
}

Outcome Simulation::unwatch(const control_t& command) {
  Outcome found = find_body(now_.world, command.body, command.generation);
  std::erase_if(watched_, [&](BodyId id) { return id.index == static_cast<std::uint32_t>(command.body); });
  return found;
}

Outcome Simulation::keep_snapshot(const std::string& name) {
  if (!kept_.contains(name) && kept_.size() == kMaxSnapshots) {
    return {.status = Status::out_of_range,
            .detail = fmt::format("{} snapshots are kept already", kMaxSnapshots)};
  }
  kept_.insert_or_assign(name, std::make_shared<const State>(now_));
  return done();
}

Outcome Simulation::restore_snapshot(const std::string& name) {
  const auto kept = kept_.find(name);
  if (kept == kept_.end()) {
    std::string names;
    for (const auto& [known, state] : kept_) names.append(names.empty() ? "" : ", ").append(known);
    return {.status = Status::invalid,
            .detail = fmt::format("no snapshot is called \"{}\"; there is {}", name,
                                  names.empty() ? "none" : names)};
  }
  start_session(*kept->second);
  return done();
}

}  // namespace tumble
