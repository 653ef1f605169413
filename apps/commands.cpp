// SPDX-License-Identifier: BSD-3-Clause
#include "commands.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace sepcal::app {

using base::Page;
using base::page;

namespace {

constexpr std::array verbs{"fit",       "compare",   "diagnose", "add",      "apply",
                           "intervals", "residuals", "export",   "simulate", "effects",
                           "track",     "two-step",  "response", "design"};

Page list_of(CommandKind kind) {
  Page list;
  for (const Command& command : commands) {
    if (command.kind != kind) continue;
    list +=
        page("  {:<28}{}\n", fmt::format("{} {}", command.name, command.form), command.sentence);
  }
  return list;
}

}  // namespace

Page command_help() {
  return page(
      "Calibrates aerospace sensors from flight logs.\n"
      "Usage: sepcal COMMAND ...\n\n"
      "Instruments, each with verbs (sepcal mag --help, sepcal mag fit --help):\n{}\n"
      "Files:\n{}\n"
      "In the Python package (pip install sepcal; also as python -m sepcal COMMAND):\n{}\n"
      "Examples:\n"
      "  sepcal check flight.csv\n"
      "  sepcal mag fit flight.csv --field 19.7,-1.4,49.4 -o mag.json\n\n"
      "Options:\n"
      "  -h, --help                  prints this; of a command or verb, its own help\n"
      "  --version                   prints the version\n",
      list_of(CommandKind::instrument), list_of(CommandKind::file), list_of(CommandKind::python));
}

std::string list_commands() {
  std::string list;
  for (const Command& command : commands) {
    if (!list.empty()) list += ", ";
    list += command.name;
  }
  return list;
}

const Command* find_command(std::string_view name) {
  const auto* const found = std::ranges::find(commands, name, &Command::name);
  return found == commands.end() ? nullptr : &*found;
}

std::string explain_unknown_command(const std::string& word) {
  if (std::ranges::find(verbs, word) != verbs.end()) {
    const bool of_aircraft =
        word == "track" || word == "two-step" || word == "response" || word == "design";
    return fmt::format("'{0}' is a verb; name the instrument first: {1}", word,
                       of_aircraft
                           ? fmt::format("sepcal aircraft {}", word)
                           : fmt::format("sepcal mag {0}, sepcal pitot {0}, or with a model of "
                                         "your own sepcal model {0} --model FILE.py:CLASS",
                                         word));
  }
  return fmt::format("'{}' is no command; the commands are: {}", word, list_commands());
}

}  // namespace sepcal::app
