// SPDX-License-Identifier: BSD-3-Clause
#include "tables.hpp"

#include <nlohmann/json.hpp>

#include "help.hpp"

namespace sepcal::app {
namespace {

using Json = nlohmann::ordered_json;

/// Of "...; one of sampling, global".
std::vector<std::string> choices_in(const std::string& sentence) {
  constexpr std::string_view before = "; one of ";
  const std::size_t at = sentence.rfind(before);
  std::vector<std::string> choices;
  if (at == std::string::npos) return choices;
  std::string rest = sentence.substr(at + before.size());
  for (std::size_t comma = 0; comma != std::string::npos;) {
    comma = rest.find(", ");
    choices.push_back(rest.substr(0, comma));
    if (comma != std::string::npos) rest.erase(0, comma + 2);
  }
  return choices;
}

Json option_json(const CLI::Option& option) {
  std::vector<std::string> names;
  for (const std::string& name : option.get_snames()) names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) names.push_back("--" + name);
  std::string value;
  if (option.get_items_expected_max() > 0) {
    value = option.get_type_name().empty() ? "VALUE" : option.get_type_name();
  }
  return {{"names", names},
          {"value", value},
          {"sentence", sentence_of(option)},
          {"choices", choices_in(option.get_description())}};
}

Json verb_json(const CLI::App& verb, const std::string& called) {
  Json arguments = Json::array();
  for (const CLI::Option* argument : arguments_of(verb)) {
    arguments.push_back(
        {{"name", argument->get_name(true, false)}, {"sentence", argument->get_description()}});
  }
  Json groups = Json::array();
  for (const std::string& group : groups_of(verb)) {
    Json options = Json::array();
    for (const CLI::Option* option : options_of(verb, group))
      options.push_back(option_json(*option));
    groups.push_back({{"name", group}, {"options", std::move(options)}});
  }
  return {{"name", verb.get_name()},
          {"sentence", verb.get_description()},
          {"usage", usage_of(verb, called + " " + verb.get_name())},
          {"arguments", std::move(arguments)},
          {"groups", std::move(groups)},
          {"examples", examples_of(called, verb.get_name())}};
}

}  // namespace

std::string table_of(const CLI::App& cli) {
  Json verbs = Json::array();
  for (const CLI::App* verb : cli.get_subcommands({})) {
    verbs.push_back(verb_json(*verb, cli.get_name()));
  }
  const std::string& called = cli.get_name();
  return Json{{"name", called.substr(called.rfind(' ') + 1)},
              {"sentence", cli.get_description()},
              {"verbs", std::move(verbs)}}
      .dump();
}

}  // namespace sepcal::app
