// tumble record FILE: everything that the world's channels carry, commands of all clients included, as an LCM event log.
#include <fmt/format.h>

#include <filesystem>
#include <lcm/lcm-cpp.hpp>
#include <limits>
#include <nlohmann/json.hpp>

#include "commands/command.h"
#include "commands/terminal.h"

namespace tumble::client {
namespace {

/// Messages that wait while the disk does something else: 2 s of a world of 10 000 bodies.
constexpr int kWaiting = 20'000;
constexpr int kLook = 100;  // [ms] between two looks at the clock and at Ctrl-C

/// A regular expression for the channels of this world and of no other whose name starts alike.
std::string channels_of(const std::string& world) {
  const std::initializer_list<std::string_view> suffixes = {
      kStateSuffix, kStatsSuffix,  kContactsSuffix, kCatalogSuffix, kHeartbeatSuffix, kAckSuffix,
      kHitsSuffix,  kPackedSuffix, kPushesSuffix,   kForceSuffix,   kControlSuffix,   kQuerySuffix};
  return fmt::format("{}({}|{}[0-9]+)", world, fmt::join(suffixes, "|"), kBodySuffix);
}

class Recording {
 public:
  explicit Recording(const std::string& path) : path_(path) {
    if (std::filesystem::exists(path))
      throw std::runtime_error(fmt::format("{}: there is such a file", path));
    log_ = std::make_unique<lcm::LogFile>(path, "w");
    if (!log_->good()) throw std::runtime_error(fmt::format("{}: cannot be written", path));
  }

  void write(const lcm::ReceiveBuffer* buffer, const std::string& channel) {
    const auto size = static_cast<std::int32_t>(buffer->data_size);
    lcm::LogEvent event{messages_, buffer->recv_utime, channel, size, buffer->data};
    // Thrown at once it would pass through liblcm.
    failed_ = failed_ || log_->writeEvent(&event) != 0;
    bytes_ += size;
    ++messages_;
  }
  void check() const {
    if (failed_) throw std::runtime_error(fmt::format("{}: cannot be written any further", path_));
  }
  void print(bool json) const {
    if (json) {
      fmt::print("{}\n",
                 nlohmann::ordered_json{{"file", path_}, {"messages", messages_}, {"bytes", bytes_}}.dump());
    } else {
      fmt::print("{}: {} messages, {:.1f} kB\n  again on the bus: lcm-logplayer {}\n", path_, messages_,
                 1e-3 * static_cast<double>(bytes_), path_);
    }
  }

 private:
  std::string path_;
  std::unique_ptr<lcm::LogFile> log_;
  std::int64_t messages_ = 0, bytes_ = 0;
  bool failed_ = false;
};

/// Until Ctrl-C, or for so many seconds.
int record(const Globals& globals, const std::string& path, double seconds) {
  std::string url;
  {
    World world(globals.world_options());  // which tries the network first, and says what is wrong with it
    world.wait_for_server(globals.timeout);
    url = world.url();
  }
  lcm::LCM bus(url);
  Recording recording(path);
  bus.subscribeFunction(
         channels_of(globals.world),
         +[](const lcm::ReceiveBuffer* buffer, const std::string& channel, Recording* to) {
           to->write(buffer, channel);
         },
         &recording)
      ->setQueueCapacity(kWaiting);
  const Interrupt interrupt;
  using Clock = std::chrono::steady_clock;
  for (const auto start = Clock::now();
       !Interrupt::pressed() && std::chrono::duration<double>(Clock::now() - start).count() < seconds;) {
    bus.handleTimeout(kLook);
    recording.check();
  }
  recording.print(globals.json);
  return kDone;
}

}  // namespace

void add_record(CLI::App& app, const Globals& globals, Action& action) {
  auto* command = app.add_subcommand("record", "Write all that the world's channels carry into an LCM log");
  auto path = std::make_shared<std::string>();
  auto seconds = std::make_shared<double>(std::numeric_limits<double>::infinity());
  command->add_option("FILE", *path, "A new file")->required();
  command->add_option("--seconds", *seconds, "End after this wall time instead of with Ctrl-C")
      ->check(CLI::PositiveNumber);
  command->callback([&globals, &action, path, seconds] {
    action = [&globals, path, seconds] { return record(globals, *path, *seconds); };
  });
}

}  // namespace tumble::client
