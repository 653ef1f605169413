// SPDX-License-Identifier: BSD-3-Clause
#include "tables.hpp"

#include <nlohmann/json.hpp>

#include "base/name_list.hpp"
#include "help.hpp"
#include "sepcal/detail/flight/effect_catalogue.hpp"

namespace sepcal::app {
namespace {

using Json = nlohmann::ordered_json;

std::vector<std::string> cut_at(std::string text, std::string_view mark) {
  std::vector<std::string> parts;
  for (std::size_t at = 0; at != std::string::npos;) {
    at = text.find(mark);
    parts.push_back(text.substr(0, at));
    if (at != std::string::npos) text.erase(0, at + mark.size());
  }
  return parts;
}

/// Of "...; one of sampling, global", or of a value "smooth|linear|held"; of an EFFECT those.
std::vector<std::string> choices_of(const CLI::Option& option,
                                    const std::vector<std::string>& effects) {
  constexpr std::string_view before = "; one of ";
  const std::string& sentence = option.get_description();
  const std::string value = option.get_type_name();
  const std::size_t at = sentence.rfind(before);
  if (at != std::string::npos) return cut_at(sentence.substr(at + before.size()), ", ");
  if (value.find('|') != std::string::npos) return cut_at(value, "|");
  return value == "EFFECT" ? effects : std::vector<std::string>();
}

Json option_json(const CLI::Option& option, const std::vector<std::string>& effects) {
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
          {"choices", choices_of(option, effects)}};
}

/// Effects that have a name of their own, each once: those of a port need a driver.
std::vector<std::string> names_in_catalogues(const std::vector<std::string>& models) {
  std::vector<std::string> names;
  for (const std::string& model : models) {
    for (const CataloguedEffect& effect : effect_catalogue(model)) {
      if (effect.name.find('[') == std::string::npos && !base::is_among(names, effect.name)) {
        names.push_back(effect.name);
      }
    }
  }
  return names;
}

Json verb_json(const CLI::App& verb, const std::string& called,
               const std::vector<std::string>& effects) {
  Json arguments = Json::array();
  for (const CLI::Option* argument : arguments_of(verb)) {
    arguments.push_back(
        {{"name", argument->get_name(true, false)}, {"sentence", argument->get_description()}});
  }
  Json groups = Json::array();
  for (const std::string& group : groups_of(verb)) {
    Json options = Json::array();
    for (const CLI::Option* option : options_of(verb, group)) {
      options.push_back(option_json(*option, effects));
    }
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

std::string table_of(const CLI::App& cli, const std::vector<std::string>& models) {
  const std::vector<std::string> effects = names_in_catalogues(models);
  Json verbs = Json::array();
  for (const CLI::App* verb : cli.get_subcommands({})) {
    verbs.push_back(verb_json(*verb, cli.get_name(), effects));
  }
  const std::string& called = cli.get_name();
  return Json{{"name", called.substr(called.rfind(' ') + 1)},
              {"sentence", cli.get_description()},
              {"verbs", std::move(verbs)}}
      .dump();
}

}  // namespace sepcal::app
