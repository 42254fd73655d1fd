// What the subcommands share, see command.h.
#include "commands/command.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace tumble::client {

WorldOptions Globals::world_options() const {
  WorldOptions options;
  options.name = world;
  options.url = url;
  options.timing.limit =
      std::chrono::duration_cast<Outbox::Clock::duration>(std::chrono::duration<double>(timeout));
  return options;
}

CLI::Option* add_numbers(CLI::App& app, const std::string& name, double* values, int size,
                         const std::string& help) {
  const auto store = [values](const std::vector<double>& read) {
    for (const double value : read) {
      if (!std::isfinite(value)) throw CLI::ValidationError("a number must be finite");
    }
    std::copy(read.begin(), read.end(), values);
  };
  auto* option = app.add_option_function<std::vector<double>>(name, store, help);
  option->expected(size)->type_name(size == 4 ? "W X Y Z" : "X Y Z");
  return option;
}

int print_answer(const Globals& globals, const std::string& subject, const Answer& answer) {
  if (globals.json) {
    nlohmann::ordered_json object{{"accepted", answer.accepted()}, {"answered", answer.heard}};
    if (answer.heard) {
      object["status"] = status_text(answer.status);
      object["step"] = answer.step;
      object["body"] = answer.body;
      object["generation"] = answer.generation;
      object["detail"] = answer.detail;
    }
    fmt::print("{}\n", object.dump());
  } else if (!answer.heard) {
    fmt::print(
        stderr,
        "tumble: {}: no answer within {} s; it may have been applied all the same\n  try: tumble doctor\n",
        subject, globals.timeout);
  } else if (answer.accepted()) {
    fmt::print("{}: {} (step {})\n", subject, answer.text(), answer.step);
  } else {
    fmt::print(stderr, "tumble: {}: refused: {}\n", subject, answer.text());
  }
  return answer.accepted() ? kDone : kRefused;
}

}  // namespace tumble::client
