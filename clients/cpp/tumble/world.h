// A world served somewhere on the bus, seen from a client: its picture, and commands with the server's answers.
// Everything happens in the caller's thread, inside `spin` and the calls that wait.
#pragma once

#include <functional>
#include <lcm/lcm-cpp.hpp>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>

#include "protocol/bus_address.h"
#include "protocol/codec.h"
#include "tumble/contacts.h"
#include "tumble/outbox.h"
#include "tumble/picture.h"

namespace tumble::client {

/// The bus can't be used: what() says why, repair() is the command that repairs it.
class BusError : public std::runtime_error {
 public:
  BusError(const std::string& what, std::string repair)
      : std::runtime_error(what), repair_(std::move(repair)) {}
  const std::string& repair() const { return repair_; }

 private:
  std::string repair_;
};

/// Nobody answers for this world.
class NoServer : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Axes in which force and torque are given.
enum class Frame : std::int8_t { world = force_command_t::FRAME_WORLD, body = force_command_t::FRAME_BODY };

struct Push {
  std::string body;
  Vec3 force{}, torque{};  ///< [N], [N m], in the axes of `frame`.
  Vec3 point{};            ///< Where the force acts: from the centre of mass, link axes [m].
  Frame frame = Frame::world;
  double seconds = 0.0;         ///< Simulated; 0: exactly one step.
  std::int64_t start_step = 0;  ///< 0: the next step.
};

struct Spawn {
  std::string name;
  std::int8_t body_type = catalog_t::TYPE_DYNAMIC;
  std::int8_t shape_type = catalog_t::SHAPE_SPHERE;
  Vec3 size{};        ///< As catalog_t.size_* [m].
  double mass = 0.0;  ///< [kg]; 0: from a density of 1000 kg/m^3.
  Vec3 position{};    ///< Centre of mass in W [m].
  Quat orientation{1, 0, 0, 0};
  Vec3 velocity{}, angular_velocity{};  ///< In W [m/s], [rad/s].
  double friction = 0.5, restitution = 0.0;
  std::array<float, 4> color{0.55f, 0.65f, 0.75f, 1.0f};
};

/// Pose and velocities to put a body into.
struct Motion {
  Vec3 position{};
  Quat orientation{1, 0, 0, 0};
  Vec3 velocity{}, angular_velocity{};
};

struct WorldOptions {
  std::string name{kDefaultWorld};  ///< Prefix of the channels.
  std::string url;                  ///< LCM URL; empty: LCM_DEFAULT_URL, else LCM's default.
  Outbox::Timing timing;
};

class World {
 public:
  /// Probes the bus, then connects. Throws std::invalid_argument for a wrong name or URL, BusError if multicast
  /// doesn't work here. Says nothing about a server: see wait_for_server.
  explicit World(const WorldOptions& options = {});
  /// On a bus that is open already.
  World(std::shared_ptr<lcm::LCM> bus, const WorldOptions& options);
  ~World();
  World(const World&) = delete;
  World& operator=(const World&) = delete;

  const std::string& name() const { return options_.name; }
  const std::string& url() const { return url_; }

  // Listening.
  /// Receives and resends for `seconds`.
  void spin(double seconds);
  /// The same, until `done()`; false if the time ran out first.
  bool spin_until(const std::function<bool()>& done, double seconds);
  /// Until a heartbeat came; throws NoServer after `seconds`, std::runtime_error for another protocol version.
  void wait_for_server(double seconds);
  /// Until every body is described and placed; throws NoServer after `seconds`.
  void wait_for_picture(double seconds);
  /// Until the body is described and placed; throws std::invalid_argument with similar names if there is none.
  const Body& wait_for_body(const std::string& body, double seconds);

  const Picture& picture() const { return picture_; }
  const std::optional<heartbeat_t>& heartbeat() const { return heartbeat_; }
  const std::optional<stats_t>& stats() const { return stats_; }
  std::int64_t messages_malformed() const { return messages_malformed_; }

  // Commands: send and wait for the answer. They need a heartbeat (the session) and, by name, the body's description,
  // and wait for both as long as for an answer: std::invalid_argument for an unknown body, NoServer.
  Answer push(const Push& push);
  Answer spawn(const Spawn& spawn);
  Answer remove(const std::string& body);
  Answer set_motion(const std::string& body, const Motion& motion);
  /// Streams the body on a channel of its own, or stops that.
  Answer watch(const std::string& body, bool on);
  Answer stream_contacts(bool on);
  Answer pause();
  Answer resume();
  /// Runs `count` steps at full speed, then pauses; returns when the command was accepted.
  Answer step(std::int64_t count);
  Answer reset();
  /// Keeps the world as it is under a name, or goes back to what was kept, in a new session.
  Answer snapshot(const std::string& name);
  Answer restore(const std::string& name);
  /// Lock-step: runs `count` steps and returns when the whole state after them is here, asking again for what the
  /// network lost. `progress` hears now and then how many steps are done. Throws NoServer if the world stands still
  /// for the time limit.
  Answer advance(std::int64_t count = 1, const std::function<void(std::int64_t)>& progress = {});

  /// A question to the world, see query_t; asked until it is answered. Throws NoServer.
  hits_t ask(query_t query);
  /// Every touching point of the newest step heard of; empty unless they are streamed (stream_contacts).
  const Contacts& contacts() const { return contacts_; }

  // The same in two halves, for many commands at once: fill in what you want, `send`, go on, `spin`, look at `answer`.
  std::int64_t send(force_command_t command);
  std::int64_t send(control_t command);
  const Answer* answer(std::int64_t sequence) const { return outbox_.answer(sequence); }
  Answer wait(std::int64_t sequence);

 private:
  void subscribe();
  template <typename Message, typename Use>
  void receive(const lcm::ReceiveBuffer* buffer, Use use);
  void on_state(const lcm::ReceiveBuffer* buffer, const std::string&);
  void on_catalog(const lcm::ReceiveBuffer* buffer, const std::string&);
  void on_heartbeat(const lcm::ReceiveBuffer* buffer, const std::string&);
  void on_stats(const lcm::ReceiveBuffer* buffer, const std::string&);
  void on_ack(const lcm::ReceiveBuffer* buffer, const std::string&);
  void on_packed(const lcm::ReceiveBuffer* buffer, const std::string&);
  void on_contacts(const lcm::ReceiveBuffer* buffer, const std::string&);
  void on_hits(const lcm::ReceiveBuffer* buffer, const std::string&);

  template <typename Message>
  std::int64_t post(Message& command, std::string_view suffix);
  template <typename Message>
  void publish(const Message& message, std::string_view suffix);
  void send_due();
  double time_limit() const;
  control_t make_control(std::int8_t verb) const;
  control_t make_control(std::int8_t verb, const std::string& body);
  Answer send_and_wait(const control_t& command) { return wait(send(command)); }

  WorldOptions options_;
  std::string url_;
  std::shared_ptr<lcm::LCM> bus_;
  std::vector<lcm::Subscription*> subscriptions_;
  Picture picture_;
  Outbox outbox_;
  std::optional<heartbeat_t> heartbeat_;
  std::optional<stats_t> stats_;
  std::optional<hits_t> hits_;  ///< The newest answer to this client.
  std::int64_t questions_ = 0;
  Contacts contacts_;
  std::int64_t messages_malformed_ = 0;
};

/// Names among `known` that look like `name`, at most three, for error messages.
std::vector<std::string> similar_names(const std::string& name, const std::vector<std::string>& known);

}  // namespace tumble::client
