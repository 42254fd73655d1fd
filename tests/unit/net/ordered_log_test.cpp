// A log with a record that is made beside it: order and numbers are as if it had been made at once, and nothing counts
// as safe before it is.
#include "net/ordered_log.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <system_error>

namespace tumble {
namespace {

class OrderedLogTest : public testing::Test {
 protected:
  ~OrderedLogTest() override { std::filesystem::remove(path_); }

  static void write_number(auto& log, std::uint8_t number) {
    log.write(1000 * number, "C", Bytes(&number, 1));
  }
  std::vector<int> read() const {
    std::vector<int> numbers;
    EventLogReader reader(path_);
    for (auto event = reader.next(); event; event = reader.next()) {
      EXPECT_EQ(event->utime, 1000 * event->data.at(0));
      numbers.push_back(event->data[0]);
    }
    EXPECT_FALSE(reader.damage());  // it checks the events' numbers
    return numbers;
  }

  static std::string make_place() {
    std::string path = testing::TempDir() + "ordered_log_" + std::to_string(::getpid()) + ".lcm";
    std::filesystem::remove(path);
    return path;
  }

  std::string path_ = make_place();
  OrderedLog log_{EventLogWriter(path_)};
};

TEST_F(OrderedLogTest, KeepsTheOrderOfWhatIsWrittenWhileARecordIsMade) {
  std::promise<void> may_write;
  write_number(log_, 1);
  log_.write_beside([go = may_write.get_future().share()](EventLogWriter& writer) {
    write_number(writer, 2);
    go.wait();
    write_number(writer, 3);
  });
  write_number(log_, 4);
  write_number(log_, 5);
  EXPECT_FALSE(log_.flush()) << "neither is in the file";
  may_write.set_value();
  log_.finish();
  EXPECT_EQ(read(), (std::vector{1, 2, 3, 4, 5}));
  EXPECT_TRUE(log_.flush());
  write_number(log_, 6);
  log_.write_beside([](EventLogWriter& writer) { write_number(writer, 7); });
  log_.write_beside([](EventLogWriter& writer) { write_number(writer, 8); });  // after the one before
  OrderedLog moved = std::move(log_);
  write_number(moved, 9);
  moved.finish();
  EXPECT_EQ(read(), (std::vector{1, 2, 3, 4, 5, 6, 7, 8, 9}));
}

TEST_F(OrderedLogTest, WritesWhatWaitsBeforeItEnds) {
  {
    OrderedLog log = std::move(log_);
    log.write_beside([](EventLogWriter& writer) { write_number(writer, 1); });
    write_number(log, 2);
  }
  EXPECT_EQ(read(), (std::vector{1, 2}));
}

TEST_F(OrderedLogTest, PassesOnThatTheFileTakesNoMore) {
  log_.write_beside(
      [](EventLogWriter&) { throw std::system_error(std::make_error_code(std::errc::no_space_on_device)); });
  EXPECT_THROW(log_.finish(), std::system_error);
}

}  // namespace
}  // namespace tumble
