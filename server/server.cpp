// See server.h.
#include "server.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <random>
#include <system_error>
#include <utility>

#include "answer_query.h"
#include "host_name.h"
#include "stats.h"
#include "tumble/ack_t.hpp"
#include "version.h"

namespace tumble {
namespace {

/// Datagrams read in a tick: far above what a fleet of clients sends in 1/240 s, far below what would stall a step.
constexpr int kReceiveBudget = 2000;
/// Questions answered in a tick; who is not answered asks again.
constexpr std::size_t kMaxQueries = 256;
constexpr std::int64_t kPausedNapNs = 4'000'000;  // between ticks of a paused server, unless a message comes
constexpr std::int64_t kHeartbeatGapNs = 50'000'000;  // between heartbeats, however often the world is paused
constexpr std::int64_t kWarnAgainNs = 60'000'000'000;  // about the same second server
constexpr int kRunBits = 16;                           // of the session: counts resets

std::int64_t period_ns(double rate) {
  return static_cast<std::int64_t>(1e9 / rate);
}

/// True once `next` is reached; moves it on by `period`, without making up for what was missed.
bool is_due(std::int64_t now, std::int64_t& next, std::int64_t period) {
  if (now < next) return false;
  next += period;
  if (next <= now) next = now + period;
  return true;
}

}  // namespace

std::int64_t random_session() {
  std::random_device random;
  const std::uint64_t high = random(), low = random();
  const std::uint64_t bits = (high << 32 | low) >> 1;
  return static_cast<std::int64_t>(bits >> kRunBits << kRunBits) + 1;
}

Server::Server(Simulation simulation, ServerSettings settings, Clock& clock, Bus& bus, Outbox& outbox,
               CommandInbox inbox)
    : settings_(std::move(settings)),
      clock_(clock),
      bus_(bus),
      outbox_(outbox),
      simulation_(std::move(simulation)),
      inbox_(std::move(inbox)),
      pacer_(settings_.rate > 0.0 ? settings_.rate : 1.0),
      stage_done_([this](Stage stage) { meter_.end_stage(stage, clock_.now_ns()); }),
      host_(host_name()) {
  const std::string& name = settings_.world_name;
  bus_.subscribe(channel_name(name, kForceSuffix),
                 [this](Bytes bytes) { hear(&CommandInbox::receive_force, bytes); });
  bus_.subscribe(channel_name(name, kControlSuffix),
                 [this](Bytes bytes) { hear(&CommandInbox::receive_control, bytes); });
  bus_.subscribe(channel_name(name, kQuerySuffix), [this](Bytes bytes) { note_query(bytes); });
  bus_.subscribe(channel_name(name, kHeartbeatSuffix), [this](Bytes bytes) { notice_heartbeat(bytes); });
  inbox_.on_waiting([this](const Command& command, std::int64_t start_step) { note(command, start_step); });
}

void Server::tick() {
  meter_.begin_tick(clock_.now_ns());
  receive_commands();
  meter_.end_commands(clock_.now_ns());
  if (!simulation_.paused()) step();
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
  record([](Recorder& r) { r.finish(); });
  send_answers();
  publish(clock_.now_ns());
  send_heartbeat();
}

void Server::wait() {
  const std::int64_t now = clock_.now_ns();
  if (simulation_.paused()) {
    pacer_.restart(now);
    bus_.wait(kPausedNapNs);
  } else if (hurrying()) {
    pacer_.restart(now);
  } else {
    pacer_.advance(now);
    clock_.sleep_until(pacer_.due());
  }
}

// Commands

void Server::receive_commands() {
  inbox_.set_now(simulation_.session(), simulation_.now_step());
  bus_.receive(kReceiveBudget);
  for (const Command& command : inbox_.take_due()) {
    note(command, simulation_.now_step());
    apply(command);
  }
  // Who asks again while the world stands still may have missed the state as well as the answer.
  if (inbox_.counters().repeated != std::exchange(repeated_, inbox_.counters().repeated) &&
      simulation_.paused()) {
    tell_all_ = changed_ = true;
  }
  send_answers();
  answer_queries();
  log_damaged();
}

void Server::hear(void (CommandInbox::*receive)(Bytes), Bytes bytes) {
  const std::uint64_t damaged = inbox_.counters().damaged();
  (inbox_.*receive)(bytes);
  if (inbox_.counters().damaged() != damaged) damaged_sender_ = bus_.sender();
}

void Server::note(const Command& command, std::int64_t start_step) {
  record([&](Recorder& r) { r.note_command(command, start_step, simulation_.session(), clock_.wall_us()); });
}

void Server::apply(const Command& command) {
  const std::int64_t session = simulation_.session();
  inbox_.settle(command, simulation_.apply(command));
  if (std::holds_alternative<control_t>(command.content)) changed_ = true;
  if (simulation_.session() == session) return;
  inbox_.cancel_pending();
  inbox_.set_now(simulation_.session(), simulation_.now_step());
  catalog_ = nullptr;
  next_heartbeat_ = 0;
}

void Server::send_answers() {
  const std::vector<Acknowledgement> fresh = inbox_.take_answers();
  answers_.insert(answers_.end(), fresh.begin(), fresh.end());
  bool safe = true;
  record([&](Recorder& r) { safe = r.flush(); });
  if (!safe || answers_.empty()) return;  // nothing is answered that could still be lost
  ack_t head{};
  head.utime = clock_.wall_us();
  head.session = simulation_.session();
  head.step = simulation_.now_step();
  pack_acknowledgements(answers_, head, bus_.payload_limit(), [this](const ack_t& message) {
    post(channel_name(settings_.world_name, kAckSuffix), message);
  });
  answers_.clear();
}

void Server::note_query(Bytes bytes) {
  query_t query{};
  const Malformed reason = decode(bytes, query);
  if (reason != Malformed::none) return inbox_.count_malformed(reason);
  if (queries_.size() < kMaxQueries) queries_.push_back(query);
}

void Server::answer_queries() {
  for (const query_t& query : std::exchange(queries_, {})) {
    const bool ours = query.session == 0 || query.session == simulation_.session();
    hits_t answer = ours ? answer_query(world(), query, bus_.payload_limit())
                         : refuse_query(query, Status::wrong_session, status_text(Status::wrong_session));
    answer.utime = clock_.wall_us();
    answer.session = simulation_.session();
    post(channel_name(settings_.world_name, kHitsSuffix), answer);
  }
}

void Server::log_damaged() {
  const std::uint64_t damaged = inbox_.counters().damaged();
  if (damaged == damaged_logged_ || clock_.now_ns() < next_damage_log_) return;
  spdlog::warn("{} damaged command messages since the start{}", damaged,
               damaged_sender_.empty() ? "" : ", the last from " + damaged_sender_);
  damaged_logged_ = damaged;
  next_damage_log_ = clock_.now_ns() + period_ns(1.0);
}

// Stepping and telling

void Server::step() {
  simulation_.step(stage_done_);
  meter_.end_step(clock_.now_ns());
  ++steps_done_;
  log_contained();
  record([&](Recorder& r) {
    r.end_step(simulation_, inbox_, clock_.wall_us());
    r.flush();
  });
  if (observer_) observer_(world().report());
  if (simulation_.paused()) {  // the last step that was asked for
    changed_ = true;
    hasten_heartbeat();
  }
}

void Server::log_contained() {
  if (world().contained().empty() || clock_.now_ns() < next_contained_log_) return;
  const BodyId id = world().contained().front();
  spdlog::warn(
      "body '{}' (id {}) would have become non-finite in step {}: held at its last good state, at rest; so "
      "often "
      "has the world held one: {}",
      world().body(id.index).definition.name, id.index, world().step_count(),
      world().counters().non_finite_contained);
  next_contained_log_ = clock_.now_ns() + period_ns(1.0);
}

void Server::publish_when_due() {
  const std::int64_t now = clock_.now_ns();
  const bool due = is_due(now, next_publication_, period_ns(settings_.publish_rate));
  if (due || changed_) publish(now);
}

void Server::publish(std::int64_t now) {
  changed_ = false;
  if (!catalog_ || catalog_model_ != world().model_epoch()) {
    catalog_model_ = world().model_epoch();
    catalog_ = make_catalog(world(), ++catalog_epoch_, catalog_.get());
  }
  std::unique_ptr<WorldView> view = spare_view_ ? std::move(spare_view_) : std::make_unique<WorldView>();
  view->utime = clock_.wall_us();
  view->session = simulation_.session();
  view->catalog = catalog_;
  view->whole = std::exchange(tell_all_, false);
  view->at_once = simulation_.paused();
  const bool contacts =
      simulation_.contacts_wanted() && is_due(now, next_contacts_, period_ns(kContactsRate));
  view->has_pushes = simulation_.pushes_wanted() && is_due(now, next_pushes_, period_ns(kContactsRate));
  if (view->has_pushes) view->pushes = simulation_.view_pushes();
  copy_world(world(), {simulation_.watched(), contacts}, *view);
  spare_view_ = outbox_.offer(std::move(view));
  meter_.end_publication(clock_.now_ns());
}

void Server::report_when_due() {
  const std::int64_t now = clock_.now_ns();
  if (simulation_.paused() != told_paused_) hasten_heartbeat();
  if (is_due(now, next_heartbeat_, period_ns(kHeartbeatRate))) send_heartbeat();
  if (is_due(now, next_stats_, period_ns(kStatsRate))) send_stats();
}

void Server::hasten_heartbeat() {
  next_heartbeat_ = std::min(next_heartbeat_, last_heartbeat_ + kHeartbeatGapNs);
}

void Server::send_heartbeat() {
  told_paused_ = simulation_.paused();
  last_heartbeat_ = clock_.now_ns();
  heartbeat_t message{};
  message.utime = clock_.wall_us();
  message.session = simulation_.session();
  message.protocol_version = kProtocolVersion;
  message.pid = ::getpid();
  message.host = host_;
  message.server_version = kVersion;
  message.world = settings_.world_name;
  message.scene = settings_.scene_name;
  message.step = simulation_.now_step();
  message.time = world().time();
  message.dt = world().options().time_step;
  message.rate = settings_.rate;
  message.publish_rate = settings_.publish_rate;
  message.paused = simulation_.paused() ? 1 : 0;
  message.state_hash = std::bit_cast<std::int64_t>(world().state_hash());
  message.catalog_epoch = catalog_epoch_;
  message.num_bodies = static_cast<std::int32_t>(world().body_count());
  message.payload_limit = static_cast<std::int32_t>(bus_.payload_limit());
  post(channel_name(settings_.world_name, kHeartbeatSuffix), message);
}

void Server::send_stats() {
  stats_t message{};
  message.utime = clock_.wall_us();
  message.session = simulation_.session();
  message.paused = simulation_.paused() ? 1 : 0;
  const OutboxCounters sent = outbox_.counters();
  meter_.report(clock_.now_ns(), world().options().time_step, sent.busy_ns, message);
  message.overruns = pacer_.overruns();
  message.steps_skipped = pacer_.steps_skipped();
  fill_world_stats(world(), simulation_.start_sums(), message);
  fill_network_stats(inbox_.counters(), sent, message);
  message.commands_dropped = bus_.dropped();
  post(channel_name(settings_.world_name, kStatsSuffix), message);
}

void Server::notice_heartbeat(Bytes bytes) {
  heartbeat_t other{};
  if (decode(bytes, other) != Malformed::none ||
      other.session >> kRunBits == simulation_.session() >> kRunBits) {
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

template <typename Write>
void Server::record(Write write) {
  if (!recorder_) return;
  try {
    write(*recorder_);
  } catch (const std::system_error& error) {
    spdlog::error("the recording ends here: {}", error.what());
    recorder_.reset();
  }
}

template <typename Message>
void Server::post(const std::string& channel, const Message& message) {
  std::vector<std::uint8_t> bytes;
  encode(message, bytes);
  outbox_.post(channel, std::move(bytes));
}

}  // namespace tumble
