// SPDX-License-Identifier: BSD-3-Clause
#include "running.hpp"

#include <fmt/format.h>

#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>
#include <csignal>
#include <new>

#include "base/escaping.hpp"
#include "base/name_list.hpp"
#include "interrupt.hpp"
#include "sepcal/detail/solver_log.hpp"
#include "sepcal/error.hpp"
#include "sepcal/flight/csv.hpp"
#include "sepcal/stop.hpp"
#include "terminal.hpp"

namespace sepcal::app {

using base::page;

namespace {

std::string list_verbs(const CLI::App& cli) {
  std::string list;
  for (const CLI::App* verb : cli.get_subcommands({})) {
    list += (list.empty() ? "" : ", ") + verb->get_name();
  }
  return list;
}

/// "--field 20.1 0.9 43.5" leaves two numbers over: said where numbers alone are.
std::string explain_extras(const CLI::App& verb, const CLI::ParseError& error) {
  if (dynamic_cast<const CLI::ExtrasError*>(&error) == nullptr) return "";
  const auto is_number = [](std::string_view word) {
    if (word.ends_with(',')) word.remove_suffix(1);
    return parse_number(word).has_value();
  };
  const bool numbers = std::ranges::all_of(verb.remaining(), is_number);
  return numbers ? "; put commas and no blanks between an option's numbers" : "";
}

/// "; did you mean --k-alpha?" of an option that is nearly one of the verb's.
std::string ask_for_option(const CLI::App& verb, const CLI::ParseError& error) {
  if (dynamic_cast<const CLI::ExtrasError*>(&error) == nullptr) return "";
  std::vector<std::string> known;
  for (const CLI::Option* option : verb.get_options()) {
    for (const std::string& name : option->get_lnames()) known.push_back("--" + name);
  }
  std::string asked;
  for (const std::string& word : verb.remaining()) {
    if (!word.starts_with("--")) continue;
    const std::string name = word.substr(0, word.find('='));
    std::string similar = base::ask_for_similar(name, known, name.size() / 4);
    std::erase(similar, '\'');
    asked += similar;
  }
  return asked;
}

/// A log in the calibration's place is taken for another flight.
std::string explain_missing(const CLI::App& verb, const CLI::ParseError& error) {
  if (dynamic_cast<const CLI::RequiredError*>(&error) == nullptr) return "";
  const CLI::Option* const more = verb.get_option_no_throw("MORE");
  if (more == nullptr || more->results().empty()) return "";
  const auto first = verb.get_option("FLIGHT")->as<std::string>();
  if (first.ends_with(".json")) {
    return fmt::format("; the flight stands before the calibration: {} {} {}", verb.get_name(),
                       base::file_in_shell(more->results().back()), base::file_in_shell(first));
  }
  return fmt::format("; {} is a log, not a calibration: give the JSON that fit wrote with -o",
                     more->results().back());
}

/// What is wrong with a command line; CLI11's words where a verb was given.
std::string describe(const CLI::App& cli, const CLI::ParseError& error) {
  if (!cli.get_subcommands().empty()) {
    std::string what = error.what();
    std::ranges::replace(what, '\n', ' ');
    const CLI::App& verb = *cli.get_subcommands().front();
    return what + ask_for_option(verb, error) + explain_extras(verb, error) +
           explain_missing(verb, error);
  }
  const std::vector<std::string> words = cli.remaining();
  if (words.empty()) return "a verb is missing; the verbs are: " + list_verbs(cli);
  std::vector<std::string> verbs;
  for (const CLI::App* verb : cli.get_subcommands({})) verbs.push_back(verb->get_name());
  const std::string similar = base::ask_for_similar(
      words.front(), verbs, std::max<std::size_t>(1, words.front().size() / 3));
  return fmt::format("'{}' is no verb{} verbs are: {}", words.front(),
                     similar.empty() ? "; the" : similar + " The", list_verbs(cli));
}

int refuse_usage(const CLI::App& cli, const CLI::ParseError& error) {
  std::string command = cli.get_name();
  for (const CLI::App* verb : cli.get_subcommands()) command += " " + verb->get_name();
  tell(page("{}: {} (see {} --help)\n", cli.get_name(), describe(cli, error), command));
  return bad_usage;
}

}  // namespace

int run(CLI::App& cli, int argc, char** argv, const std::function<int()>& perform) {
  const SignalScope full_quota(SIGXFSZ, SIG_IGN);  // an error to report, not an end
  silence_solver_log();
  cli.require_subcommand(1);
  cli.set_version_flag("--version", std::string("sepcal ") + SEPCAL_VERSION);
  cli.footer(
      "Exit codes: 0 done, 2 bad input or usage, 3 an effect is missing, 4 not identifiable,\n"
      "5 did not converge, 6 something is missing that no candidate explains,\n"
      "130 stopped by Ctrl-C.");
  try {
    cli.parse(argc, argv);
  } catch (const CLI::Success& help) {
    return cli.exit(help);
  } catch (const CLI::ParseError& error) {
    return refuse_usage(cli, error);
  }

  const auto refuse = [&](const std::string& what) {
    tell(page("{}: {}\n", cli.get_name(), what));
    return bad_usage;
  };
  try {
    const InterruptScope scope(cli.get_name());
    return perform();
  } catch (const Stopped&) {
    tell(page("{}: stopped by Ctrl-C; no file was written\n", cli.get_name()));
    return interrupted;
  } catch (const std::bad_alloc&) {
    return refuse("memory ran out; take fewer --samples or --rows, or a shorter log");
  } catch (const OptionError& error) {
    return refuse(error.spelled(as_typed));
  } catch (const std::exception& error) {
    return refuse(error.what());
  }
}

}  // namespace sepcal::app
