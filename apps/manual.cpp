// SPDX-License-Identifier: BSD-3-Clause
// Manual pages in the macros of man(7).
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "help.hpp"
#include "sepcal/error.hpp"
#include "tables.hpp"

namespace sepcal::app {
namespace {

using Json = nlohmann::ordered_json;

/// Text that troff takes for no command, with hyphens that may be copied.
std::string roff(const std::string& text) {
  std::string safe;
  for (const char c : text) {
    if (c == '\\') {
      safe += "\\e";
    } else if (c == '-') {
      safe += "\\-";
    } else if (c == '\'') {
      safe += "\\(aq";
    } else if (c == '.' && (safe.empty() || safe.back() == '\n')) {
      safe += "\\&.";
    } else {
      safe += c;
    }
  }
  return safe;
}

std::string heading(const std::string& name, const std::string& sentence) {
  return fmt::format(".TH {} 1 \"\" \"sepcal {}\" \"sepcal\"\n.SH NAME\n{} \\- {}\n",
                     fmt::format("\"{}\"", name), SEPCAL_VERSION, roff(name), roff(sentence));
}

std::string ending() {
  return ".SH \"EXIT STATUS\"\n" + roff(exit_codes) +
         ".SH ENVIRONMENT\n.TP\n.B NO_COLOR\nWhere it is set, nothing has a colour.\n"
         ".TP\n.B TMPDIR\nThe folder of nameless files, of logs longer than memory.\n";
}

std::string verb_section(const Json& verb) {
  const std::string usage =
      verb.at("usage").get<std::string>().substr(std::string("Usage: ").size());
  std::string page = fmt::format(".SS {}\n{}.\n.PP\n.B {}", roff(verb.at("name")),
                                 roff(verb.at("sentence")), roff(usage));
  for (const Json& argument : verb.at("arguments")) {
    page +=
        fmt::format(".TP\n.I {}\n{}\n", roff(argument.at("name")), roff(argument.at("sentence")));
  }
  for (const Json& group : verb.at("groups")) {
    page += fmt::format(".PP\n{}:\n", roff(group.at("name")));
    for (const Json& option : group.at("options")) {
      std::string names;
      for (const std::string name : option.at("names")) {
        names += (names.empty() ? "\\fB" : ", \\fB") + roff(name) + "\\fR";
      }
      const std::string value = option.at("value");
      if (!value.empty()) names += " \\fI" + roff(value) + "\\fR";
      page += fmt::format(".TP\n{}\n{}\n", names, roff(option.at("sentence")));
    }
  }
  if (verb.at("examples").empty()) return page;
  page += ".PP\nExamples:\n.PP\n.nf\n.RS\n";
  for (const std::string example : verb.at("examples")) page += roff(example) + "\n";
  return page + ".RE\n.fi\n";
}

std::string page_of_sepcal() {
  std::string page = heading("sepcal", "calibrates aerospace sensors from flight logs");
  page += ".SH SYNOPSIS\n.B sepcal\n.I COMMAND\n.RI [ ... ]\n.SH COMMANDS\n";
  for (const Command& command : commands) {
    page += fmt::format(".TP\n\\fB{}\\fR \\fI{}\\fR\n{}{}.\n", roff(std::string(command.name)),
                        roff(std::string(command.form)), roff(std::string(command.sentence)),
                        command.kind == CommandKind::python ? "; in the Python package" : "");
  }
  page +=
      ".SH FILES\n.TP\n.B sepcal.toml\nWhat is known of a project\\(aqs instruments, in the "
      "flight\\(aqs folder or above it: options of fit by their long names, in sections [mag], "
      "[pitot], [five\\-hole], [vane\\-boom], [pitot\\-static] and [aircraft].\n";
  return page + ending() +
         ".SH \"SEE ALSO\"\n.BR sepcal\\-mag (1),\n.BR sepcal\\-pitot (1),\n.BR "
         "sepcal\\-aircraft (1)\n";
}

}  // namespace

std::string manual_page(const std::string& name, const std::vector<std::string>& tables) {
  if (name == "sepcal") return page_of_sepcal();
  for (const std::string& text : tables) {
    const Json table = Json::parse(text);
    const std::string program = "sepcal-" + table.at("name").get<std::string>();
    if (program != name) continue;
    std::string page = heading(program, table.at("sentence"));
    page += fmt::format(
        ".SH SYNOPSIS\n.B sepcal {0}\n.I VERB\n.RI [ ... ]\n.PP\n.B {1}\n.I VERB\n"
        ".RI [ ... ]\n.SH VERBS\n",
        roff(table.at("name")), roff(program));
    for (const Json& verb : table.at("verbs")) page += verb_section(verb);
    return page + ending() + ".SH \"SEE ALSO\"\n.BR sepcal (1)\n";
  }
  throw Error(fmt::format(
      "there is no manual of '{}'; there are sepcal, sepcal-mag, sepcal-pitot, sepcal-aircraft",
      name));
}

}  // namespace sepcal::app
