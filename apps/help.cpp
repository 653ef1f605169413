// SPDX-License-Identifier: BSD-3-Clause
#include "help.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "layout.hpp"
#include "manners.hpp"

namespace sepcal::app {
namespace {

constexpr std::size_t page_width = 80;
constexpr std::size_t second_column = 28;

std::string row(const std::string& name, const std::string& sentence) {
  const std::string first = "  " + name;
  const std::string text = wrapped(sentence, page_width, second_column);
  if (first.size() + 2 > second_column) {
    return fmt::format("{}\n{:{}}{}\n", first, "", second_column, text);
  }
  return fmt::format("{:<{}}{}\n", first, second_column, text);
}

std::string row_of(const CLI::Option& option) {
  std::string name = option.get_positional() ? option.get_name(true, false) : names_of(option);
  if (!option.get_positional() && option.get_items_expected_max() > 0) {
    const std::string value = option.get_type_name();
    name += value.empty() ? " VALUE" : " " + value;
  }
  return row(name, sentence_of(option));
}

/// What examples are told of, an instrument each.
struct Story {
  std::string_view instrument;
  std::string_view known;    // options of a first fit
  std::string_view another;  // of a second
  std::string_view effect;
  std::string_view parameter;
  std::string_view target;  // of an export
};
constexpr std::array stories{
    Story{"mag", "--field 19.7,-1.4,49.4", "--field-strength 53.2", "time_offset", "n_x", "px4"},
    Story{"pitot", "--k-alpha 4.5 --k-beta 4.5", "--probe pitot-static --free w_d", "time_offset",
          "b_va", "c"},
    Story{"aircraft", "--model path", "--model longitudinal --geometry aircraft.json", "imu_late",
          "b_ax", ""},
};

struct Example {
  std::string_view verb;
  std::string_view one;
  std::string_view other;
};
/// {0} known, {1} another, {2} effect, {3} parameter, {4} target.
constexpr std::array examples{
    Example{"check", "flight.csv {0}", "flight.csv {0} --json"},
    Example{"fit", "flight.csv {0} -o base.json", "flight.csv {1} --from 10 --to 300"},
    Example{"compare", "flight.csv base.json", "another.csv base.json --json"},
    Example{"residuals", "flight.csv base.json -o residuals.csv",
            "flight.csv base.json -o - | head"},
    Example{"intervals", "flight.csv base.json", "flight.csv base.json --parameter {3}"},
    Example{"diagnose", "flight.csv base.json", "flight.csv base.json --auto -o better.json"},
    Example{"add", "flight.csv base.json {2} -o better.json", "flight.csv base.json {2} --json"},
    Example{"apply", "flight.csv base.json -o corrected.csv", "another.csv base.json -o - | head"},
    Example{"export", "base.json --to {4} -o exported",
            "base.json flight.csv --to cpp --float -o correction.hpp"},
    Example{"join", "sensor.csv receiver.csv -o flight.csv",
            "sensor.csv receiver.csv --how linear --offset -0.2 -o flight.csv"},
    Example{"simulate", "-o flight.csv --truth truth.json", "-o flight.csv --rows 2000 --seed 7"},
    Example{"effects", "", "--json"},
    Example{"two-step", "flight.csv --geometry aircraft.json -o two.json",
            "flight.csv --geometry aircraft.json --json"},
    Example{"track", "flight.csv base.json --start-rows 300 -o track.csv",
            "another.csv base.json --method iekf -o -"},
    Example{"response", "flight.csv --of q_radps --input elevator_rad -o response.csv",
            "flight.csv --of p_radps --input aileron_rad --input rudder_rad -o -"},
    Example{"design", "--input elevator_rad=0.05 --input aileron_rad=0.1 -o inputs.csv",
            "--signal 3-2-1-1 --input elevator_rad=0.05 --band 0.3:0.9 -o steps.csv"},
};

}  // namespace

std::string usage_of(const CLI::App& app, const std::string& called) {
  std::string usage = "Usage: " + called;
  if (!app.get_subcommands({}).empty()) return usage + " VERB ...\n";
  for (const CLI::Option* argument : arguments_of(app)) {
    const bool several = argument->get_expected_max() >= CLI::detail::expected_max_vector_size;
    const std::string name = argument->get_name(true, false) + (several ? "..." : "");
    usage += argument->get_required() ? " " + name : " [" + name + "]";
  }
  return usage + " [OPTIONS]\n";
}

std::string names_of(const CLI::Option& option) {
  std::string names;
  for (const std::string& name : option.get_snames()) names += (names.empty() ? "-" : ", -") + name;
  for (const std::string& name : option.get_lnames()) {
    names += (names.empty() ? "--" : ", --") + name;
  }
  return names;
}

std::string sentence_of(const CLI::Option& option) {
  std::string sentence = option.get_description();
  if (!option.get_default_str().empty()) {
    sentence += fmt::format(" (default: {})", option.get_default_str());
  }
  if (option.get_required() && !option.get_positional()) sentence += "; needed";
  return sentence;
}

std::vector<const CLI::Option*> options_of(const CLI::App& app, const std::string& group) {
  return app.get_options([&](const CLI::Option* option) {
    return option->get_group() == group && option->nonpositional();
  });
}

std::vector<const CLI::Option*> arguments_of(const CLI::App& app) {
  return app.get_options([](const CLI::Option* option) { return option->get_positional(); });
}

std::vector<std::string> groups_of(const CLI::App& app) {
  std::vector<std::string> groups;
  for (const std::string& group : app.get_groups()) {
    if (group != result_group && !options_of(app, group).empty()) groups.push_back(group);
  }
  if (!options_of(app, result_group).empty()) groups.emplace_back(result_group);
  return groups;
}

std::vector<std::string> examples_of(const std::string& called, const std::string& verb) {
  const auto* const story = std::ranges::find_if(
      stories, [&](const Story& each) { return called.ends_with(each.instrument); });
  const auto* const example = std::ranges::find(examples, verb, &Example::verb);
  if (story == stories.end() || example == examples.end()) return {};
  std::vector<std::string> lines;
  for (const std::string_view words : {example->one, example->other}) {
    const std::string typed = fmt::format(fmt::runtime(words), story->known, story->another,
                                          story->effect, story->parameter, story->target);
    lines.push_back(called + " " + verb + (typed.empty() ? "" : " ") + typed);
  }
  return lines;
}

std::string HelpPage::make_help(const CLI::App* app, std::string called,
                                CLI::AppFormatMode /*mode*/) const {
  std::string page = wrapped(app->get_description(), page_width, 0) + "\n" + usage_of(*app, called);
  const auto arguments = arguments_of(*app);
  if (!arguments.empty()) page += '\n';
  for (const CLI::Option* argument : arguments) page += row_of(*argument);
  const auto verbs = app->get_subcommands({});
  if (!verbs.empty()) page += "\nVerbs (each with --help):\n";
  for (const CLI::App* verb : verbs) page += row(verb->get_name(), verb->get_description());
  for (const std::string& group : groups_of(*app)) {
    page += "\n" + group + ":\n";
    for (const CLI::Option* option : options_of(*app, group)) page += row_of(*option);
  }
  const std::size_t last = called.rfind(' ');
  if (last != std::string::npos && app->get_parent() != nullptr) {
    const auto lines = examples_of(called.substr(0, last), app->get_name());
    if (!lines.empty()) page += "\nExamples:\n";
    for (const std::string& example : lines) page += "  " + example + "\n";
  }
  return page + "\n" + app->get_footer();
}

}  // namespace sepcal::app
