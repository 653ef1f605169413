// SPDX-License-Identifier: BSD-3-Clause
// What --help prints: a line on what the verb does, its arguments, its options in groups and two
// examples, in lines of at most 80 columns.
#pragma once

#include <CLI/App.hpp>
#include <CLI/Formatter.hpp>
#include <string>
#include <vector>

namespace sepcal::app {

class HelpPage : public CLI::FormatterBase {
 public:
  std::string make_help(const CLI::App* app, std::string called,
                        CLI::AppFormatMode mode) const override;
};

/// An option as people type it: "-o, --output".
std::string names_of(const CLI::Option& option);

/// What it says, with its default.
std::string sentence_of(const CLI::Option& option);

/// The groups of an app's options, that of results last.
std::vector<std::string> groups_of(const CLI::App& app);

/// The options of a group, in the order of their definition.
std::vector<const CLI::Option*> options_of(const CLI::App& app, const std::string& group);

/// The arguments without a name, in their order.
std::vector<const CLI::Option*> arguments_of(const CLI::App& app);

/// "Usage: sepcal mag fit FLIGHT [OPTIONS]", a line.
std::string usage_of(const CLI::App& app, const std::string& called);

/// Two commands that do something sensible: "sepcal mag fit flight.csv ..."; none of a verb that
/// has none.
std::vector<std::string> examples_of(const std::string& called, const std::string& verb);

/// What the exit codes are, for the end of a page.
inline constexpr const char* exit_codes =
    "Exit codes: 0 done, 2 bad input or usage, 3 an effect is missing,\n"
    "4 not identifiable, 5 did not converge, 6 something is missing that no\n"
    "candidate explains, 130 stopped by Ctrl-C.\n";

}  // namespace sepcal::app
