// The commands of a client, see world.h: filled in, numbered, and handed to the outbox.
#include <algorithm>
#include <chrono>

#include "tumble/world.h"

namespace tumble::client {
namespace {

constexpr double kAskAgain = 0.05;  // [s] after which a lost answer is asked for again

std::int64_t wall_clock() {
  using namespace std::chrono;
  return duration_cast<microseconds>(system_clock::now().time_since_epoch()).count();
}

}  // namespace

template <typename Message>
std::int64_t World::post(Message& command, std::string_view suffix) {
  if (!heartbeat_) wait_for_server(time_limit());
  command.utime = wall_clock();
  // Both tell the session; after a reset the state stream has it first, twice a second the heartbeat.
  command.session = picture_.session() != 0 ? picture_.session() : heartbeat_->session;
  command.client = outbox_.client();
  command.sequence = outbox_.next_sequence();
  std::vector<std::uint8_t> bytes;
  encode(command, bytes);
  outbox_.add(command.sequence, channel_name(name(), suffix), std::move(bytes), Outbox::Clock::now());
  send_due();
  return command.sequence;
}

std::int64_t World::send(force_command_t command) {
  return post(command, kForceSuffix);
}
std::int64_t World::send(control_t command) {
  return post(command, kControlSuffix);
}

control_t World::make_control(std::int8_t verb) const {
  control_t command{};
  command.verb = verb;
  command.orientation[0] = 1.0;
  return command;
}

control_t World::make_control(std::int8_t verb, const std::string& name) {
  const Body& body = wait_for_body(name, time_limit());
  control_t command = make_control(verb);
  command.body = body.id;
  command.generation = body.generation;
  return command;
}

Answer World::push(const Push& push) {
  const Body& body = wait_for_body(push.body, time_limit());
  force_command_t command{};
  command.start_step = push.start_step;
  command.body = body.id;
  command.generation = body.generation;
  command.frame = static_cast<std::int8_t>(push.frame);
  std::copy(push.force.begin(), push.force.end(), command.force);
  std::copy(push.torque.begin(), push.torque.end(), command.torque);
  std::copy(push.point.begin(), push.point.end(), command.point);
  command.duration = push.seconds;
  return wait(send(command));
}

Answer World::spawn(const Spawn& spawn) {
  control_t command = make_control(control_t::VERB_SPAWN);
  command.name = spawn.name;
  command.body_type = spawn.body_type;
  command.shape_type = spawn.shape_type;
  std::copy(spawn.size.begin(), spawn.size.end(), command.size);
  command.mass = spawn.mass;
  std::copy(spawn.position.begin(), spawn.position.end(), command.position);
  std::copy(spawn.orientation.begin(), spawn.orientation.end(), command.orientation);
  std::copy(spawn.velocity.begin(), spawn.velocity.end(), command.velocity);
  std::copy(spawn.angular_velocity.begin(), spawn.angular_velocity.end(), command.angular_velocity);
  command.friction = spawn.friction;
  command.restitution = spawn.restitution;
  std::copy(spawn.color.begin(), spawn.color.end(), command.color);
  return send_and_wait(command);
}

Answer World::remove(const std::string& body) {
  return send_and_wait(make_control(control_t::VERB_REMOVE, body));
}

Answer World::set_motion(const std::string& body, const Motion& motion) {
  control_t command = make_control(control_t::VERB_SET_STATE, body);
  std::copy(motion.position.begin(), motion.position.end(), command.position);
  std::copy(motion.orientation.begin(), motion.orientation.end(), command.orientation);
  std::copy(motion.velocity.begin(), motion.velocity.end(), command.velocity);
  std::copy(motion.angular_velocity.begin(), motion.angular_velocity.end(), command.angular_velocity);
  return send_and_wait(command);
}

Answer World::watch(const std::string& body, bool on) {
  return send_and_wait(make_control(on ? control_t::VERB_WATCH : control_t::VERB_UNWATCH, body));
}

Answer World::stream_contacts(bool on) {
  return send_and_wait(make_control(on ? control_t::VERB_CONTACTS_ON : control_t::VERB_CONTACTS_OFF));
}

Answer World::pause() {
  return send_and_wait(make_control(control_t::VERB_PAUSE));
}
Answer World::resume() {
  return send_and_wait(make_control(control_t::VERB_RESUME));
}

Answer World::step(std::int64_t count) {
  control_t command = make_control(control_t::VERB_STEP);
  command.count = count;
  return send_and_wait(command);
}

Answer World::reset() {
  return send_and_wait(make_control(control_t::VERB_RESET));
}

Answer World::snapshot(const std::string& name) {
  control_t command = make_control(control_t::VERB_SNAPSHOT);
  command.name = name;
  return send_and_wait(command);
}

Answer World::restore(const std::string& name) {
  control_t command = make_control(control_t::VERB_RESTORE);
  command.name = name;
  return send_and_wait(command);
}

Answer World::advance(std::int64_t count, const std::function<void(std::int64_t)>& progress) {
  control_t command = make_control(control_t::VERB_STEP);
  command.count = count;
  const std::int64_t sequence = post(command, kControlSuffix);
  Answer answer = wait(sequence);
  if (!answer.accepted()) return answer;
  const std::int64_t end = answer.step + count;
  const auto whole = [&] { return picture_.whole_step() >= end; };
  std::int64_t last = -1;
  auto moved = Outbox::Clock::now();
  while (!spin_until(whole, kAskAgain)) {
    if (picture_.step() != last) moved = Outbox::Clock::now();
    last = picture_.step();
    if (progress) progress(last - answer.step);
    if (std::chrono::duration<double>(Outbox::Clock::now() - moved).count() > time_limit()) {
      throw NoServer("the step was accepted, but the world stays at step " + std::to_string(last));
    }
    publish(command, kControlSuffix);  // answered again, and the whole state with it
  }
  return answer;
}

hits_t World::ask(query_t query) {
  if (!heartbeat_) wait_for_server(time_limit());
  query.utime = wall_clock();
  query.client = outbox_.client();
  query.sequence = ++questions_;
  hits_.reset();
  const auto answered = [&] { return hits_ && hits_->sequence == query.sequence; };
  const auto end = Outbox::Clock::now() + options_.timing.limit;
  do {
    if (Outbox::Clock::now() >= end)
      throw NoServer("no answer to a query on " + channel_name(name(), kHitsSuffix));
    publish(query, kQuerySuffix);
  } while (!spin_until(answered, kAskAgain));
  return *hits_;
}

template <typename Message>
void World::publish(const Message& message, std::string_view suffix) {
  std::vector<std::uint8_t> bytes;
  encode(message, bytes);
  bus_->publish(channel_name(name(), suffix), bytes.data(), static_cast<unsigned>(bytes.size()));
}

}  // namespace tumble::client
