// What the subcommands of `tumble` share: the options before them, how they are attached, how they end.
// Exit status: 0 done, 1 refused or no answer, 2 wrong usage.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <map>
#include <memory>
#include <string>

#include "tumble/world.h"

namespace tumble::client {

inline constexpr int kDone = 0, kRefused = 1, kUsage = 2;

struct Globals {
  std::string world{kDefaultWorld};
  std::string url;
  double timeout = 2.0;  ///< [s] to wait for the server, and for an answer.
  bool json = false;

  WorldOptions world_options() const;
};

/// The chosen subcommand: set while the arguments are read, run afterwards.
using Action = std::function<int()>;

void add_list(CLI::App& app, const Globals& globals, Action& action);
void add_watch(CLI::App& app, const Globals& globals, Action& action);
void add_push(CLI::App& app, const Globals& globals, Action& action);   // push, torque
void add_spawn(CLI::App& app, const Globals& globals, Action& action);  // spawn, set, remove
void add_control(CLI::App& app, const Globals& globals,
                 Action& action);  // pause, resume, step, reset, snapshot, restore, contacts, plot
void add_record(CLI::App& app, const Globals& globals, Action& action);
void add_doctor(CLI::App& app, const Globals& globals, Action& action);
void add_completion(CLI::App& app, const Globals& globals, Action& action);

/// An option of `size` finite numbers.
CLI::Option* add_numbers(CLI::App& app, const std::string& name, double* values, int size,
                         const std::string& help);

/// An option that takes one of some words.
template <typename Value>
CLI::Option* add_choice(CLI::App& app, const std::string& name, Value& value,
                        const std::map<std::string, Value>& words, const std::string& help) {
  const auto store = [&value, words](const std::string& word) { value = words.at(word); };
  return app.add_option_function<std::string>(name, store, help)->check(CLI::IsMember(words))->type_name("");
}

/// Prints the server's answer to a command about `subject`; returns the exit status.
int print_answer(const Globals& globals, const std::string& subject, const Answer& answer);

}  // namespace tumble::client
