// See event_log.h.
#include "net/event_log.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <system_error>

namespace tumble {
namespace {

constexpr std::uint32_t kSync = 0xEDA1DA01;
constexpr std::size_t kHeader = 28;
constexpr std::int64_t kLongestChannel = 63;  // LCM's limit

using Header = std::array<std::uint8_t, kHeader>;

[[noreturn]] void fail_with(const std::string& what) {
  throw std::system_error(errno, std::generic_category(), what);
}

template <typename Word>
void put(Header& header, std::size_t at, Word word) {
  for (std::size_t i = sizeof word; i-- > 0; word = static_cast<Word>(word >> 8)) {
    header[at + i] = static_cast<std::uint8_t>(word & 0xff);
  }
}

template <typename Word>
Word get(const Header& header, std::size_t at) {
  Word word = 0;
  for (std::size_t i = 0; i < sizeof word; ++i) word = static_cast<Word>(word << 8 | header[at + i]);
  return word;
}

File open_file(const std::string& path, int flags, const char* mode) {
  const int descriptor = ::open(path.c_str(), flags | O_CLOEXEC, 0666);
  if (descriptor < 0) fail_with(path);
  return File(::fdopen(descriptor, mode));
}

}  // namespace

EventLogWriter::EventLogWriter(const std::string& path)
    : file_(open_file(path, O_WRONLY | O_CREAT | O_EXCL, "wb")) {}

EventLogWriter::EventLogWriter(const std::string& path, std::int64_t size, std::int64_t number)
    : file_(open_file(path, O_WRONLY, "wb")), number_(number) {
  if (::ftruncate(::fileno(file_.get()), size) != 0 || ::fseeko(file_.get(), size, SEEK_SET) != 0)
    fail_with(path);
}

void EventLogWriter::write(std::int64_t utime, std::string_view channel, Bytes data) {
  Header header;
  put<std::uint32_t>(header, 0, kSync);
  put<std::uint64_t>(header, 4, static_cast<std::uint64_t>(number_));
  put<std::uint64_t>(header, 12, static_cast<std::uint64_t>(utime));
  put<std::uint32_t>(header, 20, static_cast<std::uint32_t>(channel.size()));
  put<std::uint32_t>(header, 24, static_cast<std::uint32_t>(data.size()));
  const bool written = std::fwrite(header.data(), kHeader, 1, file_.get()) == 1 &&
                       std::fwrite(channel.data(), channel.size(), 1, file_.get()) == 1 &&
                       (data.empty() || std::fwrite(data.data(), data.size(), 1, file_.get()) == 1);
  if (!written) fail_with("the log can't be written");
  ++number_;
}

void EventLogWriter::flush() {
  if (std::fflush(file_.get()) != 0) fail_with("the log can't be written");
}

EventLogReader::EventLogReader(const std::string& path) : file_(open_file(path, O_RDONLY, "rb")) {
  struct stat status {};
  if (::fstat(::fileno(file_.get()), &status) != 0) fail_with(path);
  size_ = status.st_size;
}

std::optional<LogEvent> EventLogReader::next() {
  if (damage_ || offset_ == size_) return std::nullopt;
  Header header;
  if (std::fread(header.data(), kHeader, 1, file_.get()) != 1)
    return stop("it ends within an event's header");
  if (get<std::uint32_t>(header, 0) != kSync) return stop("no event starts here");
  LogEvent event;
  event.number = static_cast<std::int64_t>(get<std::uint64_t>(header, 4));
  event.utime = static_cast<std::int64_t>(get<std::uint64_t>(header, 12));
  const std::int64_t name = get<std::uint32_t>(header, 20), length = get<std::uint32_t>(header, 24);
  if (name < 1 || name > kLongestChannel) return stop(fmt::format("a channel's name of {} bytes", name));
  if (offset_ + static_cast<std::int64_t>(kHeader) + name + length > size_)
    return stop("it ends within an event");
  event.channel.resize(static_cast<std::size_t>(name));
  event.data.resize(static_cast<std::size_t>(length));
  const bool read = std::fread(event.channel.data(), event.channel.size(), 1, file_.get()) == 1 &&
                    (length == 0 || std::fread(event.data.data(), event.data.size(), 1, file_.get()) == 1);
  if (!read) return stop("it can't be read");
  if (event.number != count_)
    return stop(fmt::format("event {} stands in the place of {}", event.number, count_));
  offset_ += static_cast<std::int64_t>(kHeader) + name + length;
  ++count_;
  return event;
}

void EventLogReader::skip_to(std::int64_t offset, std::int64_t count) {
  if (::fseeko(file_.get(), offset, SEEK_SET) != 0) fail_with("the log can't be read");
  offset_ = offset;
  count_ = count;
}

std::optional<LogEvent> EventLogReader::stop(std::string what) {
  damage_ = {.offset = offset_, .cut = false, .what = std::move(what)};
  damage_->cut = !sync_follows() && damage_->what.starts_with("it ends");
  return std::nullopt;
}

/// Does a further event start anywhere behind the one at offset_? Then the file was not merely cut.
bool EventLogReader::sync_follows() {
  if (::fseeko(file_.get(), offset_ + 1, SEEK_SET) != 0) return false;
  std::uint32_t word = 0;
  for (int byte = std::fgetc(file_.get()); byte != EOF; byte = std::fgetc(file_.get())) {
    word = word << 8 | static_cast<std::uint32_t>(byte);
    if (word == kSync) return true;
  }
  return false;
}

}  // namespace tumble
