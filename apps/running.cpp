// SPDX-License-Identifier: BSD-3-Clause
#include "running.hpp"

#include <fmt/format.h>

#include <CLI/Config.hpp>
#include <algorithm>
#include <chrono>
#include <csignal>
#include <exception>
#include <new>
#include <utility>

#include "base/escaping.hpp"
#include "base/name_list.hpp"
#include "help.hpp"
#include "interrupt.hpp"
#include "manners.hpp"
#include "project_file.hpp"
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
  tell_refusal(cli.get_name(), fmt::format("{} (see {} --help)", describe(cli, error), command));
  return bad_usage;
}

/// What was typed for an option or an argument; empty where it is not there.
std::vector<std::string> typed_for(const CLI::App& verb, const char* name) {
  const CLI::Option* const option = verb.get_option_no_throw(name);
  return option == nullptr ? std::vector<std::string>{} : option->results();
}

/// Takes what goes to standard output and comes from standard input as it was typed.
void use_streams(const CLI::App& verb) {
  for (const char* const argument : {"FLIGHT", "CALIBRATION", "FIT", "MEASURED", "OTHER"}) {
    const auto names = typed_for(verb, argument);
    if (!names.empty() && names.front() == standard_input) spool_standard_input();
  }
  const auto outputs = typed_for(verb, "--output");
  if (outputs.empty() || outputs.front() != standard_output) return;
  manners().shows_page = false;
  const CLI::Option* const json = verb.get_option_no_throw("--json");
  if (json != nullptr && json->count() > 0) {
    throw Error("-o - and --json would both print a result; leave one out");
  }
}

/// CLI11 takes them from the last to the first.
void parse(CLI::App& cli, std::vector<std::string> words) {
  std::ranges::reverse(words);
  cli.parse(std::move(words));
}

/// Reads the command line; where a project says more, once more with that.
void parse_with_project(CLI::App& cli, std::vector<std::string> words) {
  std::exception_ptr lacking;
  try {
    parse(cli, words);
  } catch (const CLI::RequiredError&) {
    lacking = std::current_exception();  // the project may have it
  }
  const auto verbs = cli.get_subcommands();
  std::vector<std::string> known;
  std::string file = manners().project;
  if (!verbs.empty() && takes_project(*verbs.front())) {
    const auto flights = typed_for(*verbs.front(), "FLIGHT");
    if (file.empty() && !flights.empty()) file = find_project_file(flights.front());
    if (!file.empty()) known = read_project(file, cli, *verbs.front());
  }
  if (known.empty()) {
    if (lacking) std::rethrow_exception(lacking);
    return;
  }
  words.insert(words.end(), known.begin(), known.end());
  try {
    parse(cli, words);
  } catch (const CLI::RequiredError&) {
    throw;
  } catch (const CLI::ParseError& error) {
    throw Error(fmt::format("{}: {}", file, error.what()));
  }
  std::string options;
  for (const std::string& word : known) options += " " + base::in_shell(word);
  tell_notes({fmt::format("{} says{}", file, options)});
}

}  // namespace

void complete(CLI::App& cli) {
  const std::string version = std::string("sepcal ") + SEPCAL_VERSION;
  cli.set_version_flag("--version", version, "prints the version")->group(result_group);
  cli.set_help_flag("-h,--help", "prints this")->group(result_group);
  cli.footer(exit_codes);
  cli.formatter(std::make_shared<HelpPage>());
  for (CLI::App* verb : cli.get_subcommands({})) {
    verb->formatter(cli.get_formatter());
    verb->set_help_flag("-h,--help", "prints this");
    add_manners(*verb);
    verb->set_version_flag("--version", version, "prints the version")->group(result_group);
  }
}

int run(CLI::App& cli, int argc, char** argv, const std::function<int()>& perform) {
  const SignalScope full_quota(SIGXFSZ, SIG_IGN);  // an error to report, not an end
  silence_solver_log();
  cli.require_subcommand(1);
  manners() = {};
  complete(cli);
  const auto refuse = [&](const std::string& what) {
    tell_refusal(cli.get_name(), what);
    return bad_usage;
  };
  try {
    parse_with_project(cli, {argv + std::min(argc, 1), argv + argc});
  } catch (const CLI::Success& help) {
    return cli.exit(help);
  } catch (const CLI::ParseError& error) {
    return refuse_usage(cli, error);
  } catch (const Error& error) {
    return refuse(error.what());
  }

  try {
    const InterruptScope scope(cli.get_name());
    const auto begun = std::chrono::steady_clock::now();
    use_streams(*cli.get_subcommands().front());
    const int code = perform();
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - begun;
    tell_more(page("done in {:.2f} s\n", elapsed.count()));
    return manners().exit_zero ? 0 : code;
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
