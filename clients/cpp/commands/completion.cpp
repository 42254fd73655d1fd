// tumble completion: a script that completes subcommands and options in bash, made from what the program itself reads.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "commands/command.h"

namespace tumble::client {
namespace {

std::vector<std::string> option_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  return names;
}

/// The words that may follow each subcommand, and those that may stand first.
std::string completion_script(const CLI::App& app) {
  const std::vector<std::string> common = option_names(app);
  std::vector<std::string> commands;
  std::string cases;
  for (const CLI::App* command : app.get_subcommands({})) {
    commands.push_back(command->get_name());
    cases +=
        fmt::format("    {}) words=\"{}\" ;;\n", command->get_name(), fmt::join(option_names(*command), " "));
  }
  return fmt::format(
      R"(# Completion of tumble in bash:  source <(tumble completion)
_tumble() {{
  local word=${{COMP_WORDS[COMP_CWORD]}} command='' words i
  for ((i = 1; i < COMP_CWORD; ++i)); do
    [[ " {0} " == *" ${{COMP_WORDS[i]}} "* ]] && command=${{COMP_WORDS[i]}}
  done
  case $command in
{1}    *) words="{0}" ;;
  esac
  mapfile -t COMPREPLY < <(compgen -W "$words {2}" -- "$word")
}}
complete -F _tumble tumble
)",
      fmt::join(commands, " "), cases, fmt::join(common, " "));
}

}  // namespace

void add_completion(CLI::App& app, const Globals&, Action& action) {
  auto* command = app.add_subcommand("completion", "Print a script that completes tumble's words in bash");
  command->callback([&app, &action] {
    action = [&app] {
      fmt::print("{}", completion_script(app));
      return kDone;
    };
  });
}

}  // namespace tumble::client
