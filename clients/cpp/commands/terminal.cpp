// Terminal control, see terminal.h. ANSI sequences: ESC[nA goes up n lines, ESC[K clears to the end of the line,
// ESC[J to the end of the screen.
#include "commands/terminal.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>

namespace tumble::client {
namespace {

volatile std::sig_atomic_t interrupted = 0;
void note_interrupt(int) {
  interrupted = 1;
}

}  // namespace

TerminalSize get_terminal_size() {
  winsize size{};
  if (::isatty(STDOUT_FILENO) == 0) return {};
  if (::ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col == 0 || size.ws_row == 0) return {80, 24};
  return {size.ws_col, size.ws_row};
}

Interrupt::Interrupt() {
  std::signal(SIGINT, note_interrupt);
  std::signal(SIGTERM, note_interrupt);
}

Interrupt::~Interrupt() {
  std::signal(SIGINT, SIG_DFL);
  std::signal(SIGTERM, SIG_DFL);
}

bool Interrupt::pressed() {
  return interrupted != 0;
}

void Panel::draw(const std::string& text) {
  if (lines_ > 0) fmt::print("\x1b[{}A", lines_);
  for (std::size_t start = 0; start < text.size();) {
    const std::size_t end = std::min(text.find('\n', start), text.size());
    fmt::print("{}\x1b[K\n", text.substr(start, end - start));
    start = end + 1;
  }
  fmt::print("\x1b[J");
  std::fflush(stdout);
  lines_ = static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

}  // namespace tumble::client
