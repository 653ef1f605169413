// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>

#include "commands.hpp"
#include "delivery.hpp"
#include "running.hpp"
#include "sepcal/detail/flight/read_as.hpp"
#include "sepcal/error.hpp"
#include "tables.hpp"
#include "terminal.hpp"

namespace sepcal::app {

using base::page;

namespace {

int refuse(const std::string& what) {
  tell_refusal("sepcal", what + " (see sepcal --help)");
  return bad_usage;
}

/// Columns that make a flight an instrument's: all of one line, whatever their units and case.
struct Signature {
  std::string_view command;
  std::string_view sensor;
  std::vector<std::string_view> quantities;
};

const std::vector<Signature>& signatures() {
  static const std::vector<Signature> all{
      {"pitot", "a five-hole probe", {"dpa", "dpb"}},
      {"aircraft", "an aircraft with accelerometers and gyros", {"ax", "ay", "az", "p", "q", "r"}},
      {"pitot", "a boom with vanes", {"alpha", "beta", "airspeed"}},
      {"mag", "a magnetometer", {"mx", "my", "mz"}},
      {"pitot", "a Pitot-static tube", {"airspeed"}},
      {"pitot", "a Pitot-static tube", {"dp"}},
      {"pitot", "a Pitot-static tube", {"pt", "ps"}},
  };
  return all;
}

std::string lower(std::string_view text) {
  std::string lowered(text);
  std::ranges::transform(lowered, lowered.begin(), [](unsigned char c) { return std::tolower(c); });
  return lowered;
}

bool has(const Flight& flight, std::string_view quantity) {
  return std::ranges::any_of(flight.columns(), [&](const Flight::Column& column) {
    const std::string header = lower(column.header);
    return header == quantity || header.starts_with(std::string(quantity) + "_");
  });
}

/// The first word that names a file to be read; where none is there, the first that could.
std::string first_file(const std::vector<std::string>& words) {
  std::string could;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const bool is_output = i > 0 && (words[i - 1] == "-o" || words[i - 1] == "--output");
    if (is_output || words[i].starts_with('-')) continue;
    if (is_there(words[i])) return words[i];
    if (could.empty()) could = words[i];
  }
  return could;
}

/// `sepcal check FILE` and `sepcal join FILE OTHER`: by the program whose columns the file has.
int run_guessed(const std::vector<NamedProgram>& programs, int argc, char** argv) {
  const std::string verb = argv[0];
  const std::string called = "sepcal " + verb;
  const auto asks_for_help = [](std::string_view word) { return word == "-h" || word == "--help"; };
  if (std::any_of(argv + 1, argv + argc, asks_for_help)) {  // every instrument's is the same
    const auto pitot = std::ranges::find(programs, std::string("pitot"), &NamedProgram::name);
    std::vector<char*> asked{argv[0]};
    asked.insert(asked.end(), argv, argv + argc);
    return pitot->run("sepcal pitot", static_cast<int>(asked.size()), asked.data());
  }
  const std::string file = first_file({argv + 1, argv + argc});
  if (file.empty()) {
    return refuse(
        fmt::format("{0}: name a file; an instrument's own has more: sepcal mag {0} --help", verb));
  }
  Guess guess;
  try {
    guess = guess_instrument(read_as(read_csv(file), {}).flight);
  } catch (const std::exception& error) {
    tell_refusal(called, error.what());
    return bad_usage;
  }
  // Any sensor's join is the same; an aircraft has none.
  if (verb == "join" && (guess.command.empty() || guess.command == "aircraft")) {
    guess.command = "pitot";
  }
  const auto program = std::ranges::find(programs, guess.command, &NamedProgram::name);
  if (program == programs.end()) {
    tell_refusal(called, guess.reason);
    return bad_usage;
  }
  if (verb == "check") tell_notes({guess.reason});
  std::vector<char*> words{argv[0]};
  words.insert(words.end(), argv, argv + argc);
  static char model[] = "--model=path";  // what an aircraft's log is checked for
  const bool names_model =
      std::ranges::any_of(words, [](std::string_view word) { return word.starts_with("--model"); });
  if (guess.command == "aircraft" && verb == "check" && !names_model) words.push_back(model);
  return program->run("sepcal " + guess.command, static_cast<int>(words.size()), words.data());
}

}  // namespace

Guess guess_instrument(const Flight& flight) {
  std::vector<const Signature*> found;
  for (const Signature& signature : signatures()) {
    const auto is_there = [&](std::string_view quantity) { return has(flight, quantity); };
    if (!std::ranges::all_of(signature.quantities, is_there)) continue;
    const bool known = std::ranges::any_of(
        found, [&](const Signature* other) { return other->command == signature.command; });
    if (!known) found.push_back(&signature);
  }
  if (found.empty()) {
    return {"",
            fmt::format("{}: no sensor's columns are known here: a magnetometer has mx_ut, my_ut, "
                        "mz_ut, a tube airspeed_mps or dp_pa; give them with an instrument's "
                        "--map: sepcal mag check FILE --map mx_ut=COLUMN ({})",
                        flight.name(), flight.list_columns())};
  }
  const Signature& first = *found.front();
  std::string reason = fmt::format("{} is taken for the log of {}: sepcal {} check", flight.name(),
                                   first.sensor, first.command);
  for (std::size_t i = 1; i < found.size(); ++i) {
    reason += fmt::format("{}of {}: sepcal {} check", i == 1 ? "; it may also be that " : ", ",
                          found[i]->sensor, found[i]->command);
  }
  return {std::string(first.command), std::move(reason)};
}

int run_sepcal(const std::vector<NamedProgram>& programs, const std::vector<std::string>& others,
               int argc, char** argv) try {
  if (argc < 2) return refuse("a command is missing; the commands are: " + list_commands());
  const std::string word = argv[1];
  if (word == "--help" || word == "-h" || word == "help") {
    print(command_help());
    return 0;
  }
  if (word == "--version") {
    print(page("sepcal {}\n", SEPCAL_VERSION));
    return 0;
  }
  const auto program = std::ranges::find(programs, word, &NamedProgram::name);
  if (program != programs.end()) return program->run("sepcal " + word, argc - 1, argv + 1);
  if (word == "check" || word == "join") return run_guessed(programs, argc - 1, argv + 1);
  if (word == "completion" || word == "manual") {
    if (argc != 3)
      return refuse(word == "manual" ? "manual: name a page, e.g. sepcal manual sepcal"
                                     : "completion: name a shell: bash, zsh, fish");
    std::vector<std::string> tables = others;
    for (const NamedProgram& each : programs) tables.push_back(each.table());
    print(word == "manual" ? manual_page(argv[2], tables) : completions(argv[2], tables));
    return 0;
  }
  const Command* const command = find_command(word);
  if (command != nullptr && command->kind == CommandKind::python) {
    tell_refusal(
        "sepcal " + word,
        fmt::format("is in the Python package: pip install sepcal, then python -m sepcal {}",
                    word));
    return bad_usage;
  }
  return refuse(explain_unknown_command(word));
} catch (const Error& error) {  // as of a full disc behind standard output
  tell_refusal("sepcal", error.what());
  return bad_usage;
}

}  // namespace sepcal::app
