// The terminal: its size, drawing in place, and Ctrl-C as a question instead of a death.
#pragma once

#include <cstddef>
#include <string>

namespace tumble::client {

struct TerminalSize {
  std::size_t width = 0, height = 0;  ///< 0: standard output is not a terminal.
};
TerminalSize get_terminal_size();

/// From its construction on Ctrl-C only sets `pressed`.
class Interrupt {
 public:
  Interrupt();
  ~Interrupt();
  Interrupt(const Interrupt&) = delete;
  Interrupt& operator=(const Interrupt&) = delete;
  static bool pressed();
};

/// Draws a text over the one it drew before.
class Panel {
 public:
  void draw(const std::string& text);

 private:
  std::size_t lines_ = 0;
};

}  // namespace tumble::client
