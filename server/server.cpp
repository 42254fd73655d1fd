// See server.h.
#include "server.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <bit>
#include <random>
#include <utility>

#include "apply_command.h"
#include "stats.h"
#include "tumble/ack_t.hpp"
#include "version.h"

namespace tumble {
namespace {

/// Datagrams read in a tick: far above what a fleet of clients sends in 1/240 s, far below what would stall a step.
constexpr int kReceiveBudget = 2000;
constexpr std::int64_t kPausedNapNs = 1'000'000;       // between ticks of a paused server without a rate
constexpr std::int64_t kWarnAgainNs = 60'000'000'000;  // about the same second server
constexpr int kRunBits = 16;                           // of the session: counts resets

std::int64_t period_ns(double rate) {
  return static_cast<std::int64_t>(1e9 / rate);
}

/// Positive, random but for its lowest bits, which count the resets.
std::int64_t random_session() {
  std::random_device random;
  const std::uint64_t high = random(), low = random();
  const std::uint64_t bits = (high << 32 | low) >> 1;
  return static_cast<std::int64_t>(bits >> kRunBits << kRunBits) + 1;
}

std::string host_name() {
  std::array<char, 256> name{};
  ::gethostname(name.data(), name.size() - 1);
  return name.data();
}

/// True once `next` is reached; moves it on by `period`, without making up for what was missed.
bool is_due(std::int64_t now, std::int64_t& next, std::int64_t period) {
  if (now < next) return false;
  next += period;
  if (next <= now) next = now + period;
  return true;
}

}  // namespace

Server::Server(World world, ServerSettings settings, Clock& clock, Bus& bus, Outbox& outbox)
    : settings_(std::move(settings)),
      clock_(clock),
      bus_(bus),
      outbox_(outbox),
      start_(world),
      world_(std::move(world)),
      pacer_(settings_.rate > 0.0 ? settings_.rate : 1.0),
      stage_done_([this](Stage stage) { meter_.end_stage(stage, clock_.now_ns()); }),
      host_(host_name()) {
  const std::string& name = settings_.world_name;
  bus_.subscribe(channel_name(name, kForceSuffix), [this](Bytes bytes) { inbox_.receive_force(bytes); });
  bus_.subscribe(channel_name(name, kControlSuffix), [this](Bytes bytes) { inbox_.receive_control(bytes); });
  bus_.subscribe(channel_name(name, kHeartbeatSuffix), [this](Bytes bytes) { notice_heartbeat(bytes); });
  start_session(random_session());
}

void Server::start_session(std::int64_t session) {
  session_ = session;
  start_sums_ = world_.compute_conserved();
  watched_.clear();
  catalog_ = nullptr;
  changed_ = true;
}

void Server::tick() {
  meter_.begin_tick(clock_.now_ns());
  receive_commands();
  meter_.end_commands(clock_.now_ns());
  if (!paused_) step();
  publish_when_due();
  meter_.end_tick(clock_.now_ns());
  report_when_due();
}

void Server::run(const volatile std::sig_atomic_t& stop) {
  pacer_.restart(clock_.now_ns());
  while (stop == 0 && (settings_.steps == 0 || steps_done_ < settings_.steps)) {
    tick();
    wait();
  }
  publish(clock_.now_ns());
  send_heartbeat();
}

void Server::wait() {
  const std::int64_t now = clock_.now_ns();
  if (hurrying()) {
    pacer_.restart(now);
    if (paused_) clock_.sleep_until(now + kPausedNapNs);
    return;
  }
  pacer_.advance(now);
  clock_.sleep_until(pacer_.due());
}

// Commands

void Server::receive_commands() {
  inbox_.set_now(session_, now_step());
  bus_.receive(kReceiveBudget);
  for (const Command& command : inbox_.take_due()) {
    inbox_.settle(command, apply(command));
  }
  send_answers();
  log_damaged();
}

Outcome Server::apply(const Command& command) {
  if (command.session != 0 && command.session != session_) {  // a reset came before it in the same tick
    return {.status = Status::wrong_session, .detail = status_text(Status::wrong_session)};
  }
  if (const auto* force = std::get_if<force_command_t>(&command.content)) return apply_force(world_, *force);
  return apply_control(std::get<control_t>(command.content));
}

Outcome Server::apply_control(const control_t& command) {
  changed_ = true;
  const Outcome done{.step = now_step()};
  switch (command.verb) {
    case control_t::VERB_SPAWN:
      return apply_spawn(world_, command);
    case control_t::VERB_REMOVE:
      return apply_remove(world_, command);
    case control_t::VERB_SET_STATE:
      return apply_set_state(world_, command);
    case control_t::VERB_RESET:
      reset();
      return {.step = now_step()};
    case control_t::VERB_PAUSE:
      paused_ = true;
      steps_wanted_ = 0;
      next_heartbeat_ = 0;
      return done;
    case control_t::VERB_RESUME:
      paused_ = false;
      steps_wanted_ = 0;
      next_heartbeat_ = 0;
      return done;
    case control_t::VERB_STEP:
      paused_ = false;
      steps_wanted_ = command.count;
      return done;
    case control_t::VERB_WATCH:
      return watch(command);
    case control_t::VERB_UNWATCH:
      return unwatch(command);
    case control_t::VERB_CONTACTS_ON:
      contacts_wanted_ = true;
      return done;
    case control_t::VERB_CONTACTS_OFF:
      contacts_wanted_ = false;
      return done;
    default:
      return {.status = Status::unknown_verb, .detail = status_text(Status::unknown_verb)};
  }
}

Outcome Server::watch(const control_t& command) {
  const Outcome found = find_body(world_, command.body, command.generation);
  if (found.status != Status::applied) return found;
  std::erase_if(watched_, [this](BodyId id) { return !world_.is_valid(id); });
  const BodyId id{static_cast<std::uint32_t>(found.body), static_cast<std::uint32_t>(found.generation)};
  if (std::find(watched_.begin(), watched_.end(), id) != watched_.end()) return found;
  if (watched_.size() == kMaxWatched) {
    return {.status = Status::out_of_range,
            .detail = fmt::format("{} bodies are watched already", kMaxWatched)};
  }
  watched_.push_back(id);
  return found;
}

Outcome Server::unwatch(const control_t& command) {
  const Outcome found = find_body(world_, command.body, command.generation);
  std::erase_if(watched_, [&](BodyId id) { return id.index == static_cast<std::uint32_t>(command.body); });
  return found;
}

void Server::reset() {
  world_ = start_;
  inbox_.cancel_pending();
  start_session(session_ + 1);
  inbox_.set_now(session_, now_step());
  next_heartbeat_ = 0;
}

void Server::send_answers() {
  const std::vector<Acknowledgement> answers = inbox_.take_answers();
  if (answers.empty()) return;
  ack_t head{};
  head.utime = clock_.wall_us();
  head.session = session_;
  head.step = now_step();
  pack_acknowledgements(answers, head, bus_.payload_limit(), [this](const ack_t& message) {
    post(channel_name(settings_.world_name, kAckSuffix), message);
  });
}

void Server::log_damaged() {
  const std::uint64_t damaged = inbox_.counters().damaged();
  if (damaged == damaged_logged_ || clock_.now_ns() < next_damage_log_) return;
  spdlog::warn("{} damaged command messages since the start", damaged);
  damaged_logged_ = damaged;
  next_damage_log_ = clock_.now_ns() + period_ns(1.0);
}

// Stepping and telling

void Server::step() {
  world_.step(stage_done_);
  meter_.end_step(clock_.now_ns());
  ++steps_done_;
  if (observer_) observer_(world_.report());
  if (steps_wanted_ > 0 && --steps_wanted_ == 0) {
    paused_ = true;
    changed_ = true;
    next_heartbeat_ = 0;
  }
}

void Server::publish_when_due() {
  const std::int64_t now = clock_.now_ns();
  const bool due = is_due(now, next_publication_, period_ns(settings_.publish_rate));
  if (due || changed_) publish(now);
}

void Server::publish(std::int64_t now) {
  changed_ = false;
  if (!catalog_ || catalog_model_ != world_.model_epoch()) {
    catalog_model_ = world_.model_epoch();
    catalog_ = make_catalog(world_, ++catalog_epoch_, catalog_.get());
  }
  std::unique_ptr<WorldView> view = spare_view_ ? std::move(spare_view_) : std::make_unique<WorldView>();
  view->utime = clock_.wall_us();
  view->session = session_;
  view->catalog = catalog_;
  const bool contacts = contacts_wanted_ && is_due(now, next_contacts_, period_ns(kContactsRate));
  copy_world(world_, {watched_, contacts}, *view);
  spare_view_ = outbox_.offer(std::move(view));
  meter_.end_publication(clock_.now_ns());
}

void Server::report_when_due() {
  const std::int64_t now = clock_.now_ns();
  if (is_due(now, next_heartbeat_, period_ns(kHeartbeatRate))) send_heartbeat();
  if (is_due(now, next_stats_, period_ns(kStatsRate))) send_stats();
}

void Server::send_heartbeat() {
  heartbeat_t message{};
  message.utime = clock_.wall_us();
  message.session = session_;
  message.protocol_version = kProtocolVersion;
  message.pid = ::getpid();
  message.host = host_;
  message.server_version = kVersion;
  message.world = settings_.world_name;
  message.scene = settings_.scene_name;
  message.step = now_step();
  message.time = world_.time();
  message.dt = world_.options().time_step;
  message.rate = settings_.rate;
  message.publish_rate = settings_.publish_rate;
  message.paused = paused_ ? 1 : 0;
  message.state_hash = std::bit_cast<std::int64_t>(world_.state_hash());
  message.catalog_epoch = catalog_epoch_;
  message.num_bodies = static_cast<std::int32_t>(world_.body_count());
  message.payload_limit = static_cast<std::int32_t>(bus_.payload_limit());
  post(channel_name(settings_.world_name, kHeartbeatSuffix), message);
}

void Server::send_stats() {
  stats_t message{};
  message.utime = clock_.wall_us();
  message.session = session_;
  message.paused = paused_ ? 1 : 0;
  const OutboxCounters sent = outbox_.counters();
  meter_.report(clock_.now_ns(), world_.options().time_step, sent.busy_ns, message);
  message.overruns = pacer_.overruns();
  message.steps_skipped = pacer_.steps_skipped();
  fill_world_stats(world_, start_sums_, message);
  fill_network_stats(inbox_.counters(), sent, message);
  post(channel_name(settings_.world_name, kStatsSuffix), message);
}

void Server::notice_heartbeat(Bytes bytes) {
  heartbeat_t other{};
  if (decode(bytes, other) != Malformed::none || other.session >> kRunBits == session_ >> kRunBits) {
    return;
  }
  const std::string name = fmt::format("{} pid {}", other.host, other.pid);
  const std::int64_t now = clock_.now_ns();
  if (others_.size() > 64) others_.clear();
  const auto [known, is_new] = others_.try_emplace(name, now);
  if (!is_new && now < known->second + kWarnAgainNs) return;
  known->second = now;
  spdlog::warn(
      "another server serves the world {} on this bus: host {}, pid {}, scene {}. Clients hear both; stop "
      "one, "
      "or give one another --world or --lcm-url",
      settings_.world_name, other.host, other.pid, other.scene);
}

template <typename Message>
void Server::post(const std::string& channel, const Message& message) {
  std::vector<std::uint8_t> bytes;
  encode(message, bytes);
  outbox_.post(channel, std::move(bytes));
}

}  // namespace tumble
