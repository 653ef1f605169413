// SPDX-License-Identifier: BSD-3-Clause
#include "project_file.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <toml++/toml.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <optional>
#include <string_view>
#include <system_error>

#include "base/name_list.hpp"
#include "flight/files/text_file.hpp"
#include "manners.hpp"
#include "sepcal/error.hpp"

namespace sepcal::app {
namespace {

constexpr std::array kinds_of_probe{"five-hole", "vane-boom", "pitot-static"};
constexpr std::array sections{"mag", "pitot", "five-hole", "vane-boom", "pitot-static", "aircraft"};

/// The instrument of a program: "mag" of "sepcal-mag" and of "sepcal mag".
std::string instrument_of(const CLI::App& cli) {
  const std::string& name = cli.get_name();
  return name.substr(name.find_last_of("- ") + 1);
}

std::string with_hyphens(std::string_view key) {
  std::string name(key);
  std::ranges::replace(name, '_', '-');
  return name;
}

/// How a value is typed; nothing for a table or an array in it.
std::optional<std::string> typed(const toml::node& node) {
  if (const auto* text = node.as_string()) return text->get();
  if (const auto* whole = node.as_integer()) return fmt::format("{}", whole->get());
  if (const auto* number = node.as_floating_point()) return fmt::format("{}", number->get());
  return std::nullopt;
}

/// [19.7, -1.4, 49.4] as "19.7,-1.4,49.4".
std::optional<std::string> typed_list(const toml::node& node) {
  const auto* const array = node.as_array();
  if (array == nullptr) return typed(node);
  std::vector<std::string> parts;
  for (const toml::node& each : *array) {
    const auto part = typed(each);
    if (!part) return std::nullopt;
    parts.push_back(*part);
  }
  return fmt::format("{}", fmt::join(parts, ","));
}

/// The values that an option has: {w_d = [-1, 1]} gives "w_d=-1,1", ["a=b", "c=d"] gives two.
/// Empty for what no option takes.
std::vector<std::string> values_of(const toml::node& node) {
  std::vector<std::string> values;
  if (const auto* const table = node.as_table()) {
    for (const auto& [name, value] : *table) {
      const auto text = typed_list(value);
      if (!text) return {};
      values.push_back(fmt::format("{}={}", name.str(), *text));
    }
    return values;
  }
  const auto* const array = node.as_array();
  if (array != nullptr && !array->empty() && array->is_homogeneous(toml::node_type::string)) {
    for (const toml::node& each : *array) values.push_back(typed(each).value_or(""));
    return values;
  }
  const auto text = typed_list(node);
  return text ? std::vector{*text} : std::vector<std::string>{};
}

class Project {
 public:
  Project(const std::string& file, const CLI::App& cli, const CLI::App& verb)
      : file_(file), cli_(cli), verb_(verb), table_(parse(file)) {
    for (const auto& [key, node] : table_) {
      const std::string name(key.str());
      const std::vector<std::string> known(sections.begin(), sections.end());
      if (!base::is_among(known, name) || !node.is_table()) {
        fail(fmt::format("'{}' is no section{}; the sections are: {}", name,
                         base::ask_for_similar(name, known, 2), base::list_names(known)));
      }
    }
  }

  std::vector<std::string> words() {
    const std::string instrument = instrument_of(cli_);
    take(instrument);
    if (instrument == "pitot") take_kind_of_probe();
    return words_;
  }

 private:
  static toml::table parse(const std::string& file) {
    try {
      return toml::parse(files::read_text_file(file, "as a project file"), file);
    } catch (const toml::parse_error& error) {
      throw Error(fmt::format("{}: line {} is no TOML: {}", file, error.source().begin.line,
                              error.description()));
    }
  }

  [[noreturn]] void fail(const std::string& what) const { throw Error(file_ + ": " + what); }

  /// Of five-hole, vane-boom and pitot-static the one that --probe names, or that alone is there.
  void take_kind_of_probe() {
    std::vector<std::string> there;
    for (const char* const kind : kinds_of_probe) {
      if (table_.contains(kind)) there.emplace_back(kind);
    }
    const auto typed = verb_.get_option("--probe")->results();
    const auto told = std::ranges::find_if(
        words_, [](const std::string& word) { return word.starts_with("--probe="); });
    std::string kind = !typed.empty()         ? typed.front()
                       : told != words_.end() ? told->substr(std::string("--probe=").size())
                       : there.size() == 1    ? there.front()
                                              : "";
    if (kind.empty() && there.size() > 1) {
      fail(fmt::format("has {}; say which with --probe", fmt::join(there, ", ")));
    }
    if (kind.empty() || !base::is_among(there, kind)) return;
    if (typed.empty() && told == words_.end()) words_.push_back("--probe=" + kind);
    take(kind);
  }

  void take(const std::string& section) {
    const toml::table* const options = table_[section].as_table();
    if (options == nullptr) return;
    for (const auto& [key, node] : *options) take(section, with_hyphens(key.str()), node);
  }

  void take(const std::string& section, const std::string& name, const toml::node& node) {
    if (!is_known(name)) {
      fail(fmt::format("[{}] {}: there is no such option{}", section, name,
                       base::ask_for_similar(name, known(), 2)));
    }
    const CLI::Option* const option = verb_.get_option_no_throw("--" + name);
    if (option == nullptr || is_excluded(name)) return;
    if (node.is_boolean()) {
      if (option->get_items_expected_max() > 0) fail_value(section, name);
      if (option->count() == 0 && node.value_or(false)) words_.push_back("--" + name);
      return;
    }
    const std::vector<std::string> values = values_of(node);
    if (values.empty() || option->get_items_expected_max() == 0) fail_value(section, name);
    for (const std::string& value : values) {
      if (!is_typed(*option, value)) words_.push_back(fmt::format("--{}={}", name, value));
    }
  }

  [[noreturn]] void fail_value(const std::string& section, const std::string& name) const {
    fail(fmt::format("[{0}] {1}: no option takes such a value; write it as --{1} has it, in quotes",
                     section, name));
  }

  /// Whether what was typed says this already: the option itself, or the same NAME of NAME=VALUE.
  static bool is_typed(const CLI::Option& option, const std::string& value) {
    const std::size_t equals = value.find('=');
    if (equals == std::string::npos) return option.count() > 0;
    const std::string name = value.substr(0, equals + 1);
    return std::ranges::any_of(option.results(),
                               [&](const std::string& result) { return result.starts_with(name); });
  }

  /// A strength has no place beside a field that was typed, nor the other way round.
  bool is_excluded(const std::string& name) const {
    const auto is_typed = [&](const char* option) {
      const CLI::Option* const known = verb_.get_option_no_throw(option);
      return known != nullptr && known->count() > 0;
    };
    return (name == "field" && is_typed("--field-strength")) ||
           (name == "field-strength" && (is_typed("--field") || is_typed("--mounting"))) ||
           (name == "mounting" && is_typed("--field-strength"));
  }

  /// Options that a project may have: those of fit and check that say what is known.
  std::vector<std::string> known() const {
    std::vector<std::string> names;
    for (const CLI::App* verb : cli_.get_subcommands([](const CLI::App* each) {
           return each->get_name() == "fit" || each->get_name() == "check";
         })) {
      for (const CLI::Option* option : verb->get_options()) {
        if (option->get_group() == result_group || option->get_positional()) continue;
        for (const std::string& name : option->get_lnames()) names.push_back(name);
      }
    }
    return names;
  }

  bool is_known(const std::string& name) const { return base::is_among(known(), name); }

  const std::string& file_;
  const CLI::App& cli_;
  const CLI::App& verb_;
  toml::table table_;
  std::vector<std::string> words_;
};

}  // namespace

std::string find_project_file(const std::string& flight) {
  std::error_code failed;
  const auto whole = std::filesystem::absolute(flight, failed);
  if (failed) return "";
  for (auto folder = whole.parent_path();; folder = folder.parent_path()) {
    const auto file = folder / "sepcal.toml";
    if (std::filesystem::is_regular_file(file, failed)) {
      const auto near = std::filesystem::proximate(file, failed);
      return failed ? file.string() : near.string();
    }
    if (folder == folder.parent_path()) return "";
  }
}

std::vector<std::string> read_project(const std::string& file, const CLI::App& cli,
                                      const CLI::App& verb) {
  return Project(file, cli, verb).words();
}

}  // namespace sepcal::app
