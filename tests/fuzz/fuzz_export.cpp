// SPDX-License-Identifier: BSD-3-Clause
// Exports of calibrations with hostile names, messages and numbers, beside the same with plain
// names. A header is the same tokens but for the names of its arguments; a file of parameters has
// the same lines, each a comment or a parameter with its value.
#include "sepcal/flight/export.hpp"

#include <algorithm>
#include <cstring>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <tuple>

#include "c_tokens.hpp"
#include "flight/probes/quantities.hpp"
#include "hostile_words.hpp"
#include "sepcal/effect_name.hpp"
#include "simulated_calibrations.hpp"

namespace sepcal::fuzz {
namespace {

using Effects = std::vector<std::string>;

const std::vector<std::function<Fitted()>>& makers() {
  const auto magnetometer = [](const Effects& effects) {
    return fit_with(magnetometer_probe(std::array{19.7, -1.4, 49.4}), magnetic_record(), effects);
  };
  static const std::vector<std::function<Fitted()>> all{
      [] { return fit_with(attitude_independent_probe(53.2), magnetic_record(), {}); },
      [] { return fit_with(pitot_static_probe(), tube_record(), {"airspeed_scale[c1]"}); },
      [=] { return magnetometer({"bias[c1]", "axis_scale[c2^2]"}); },
      [=] { return magnetometer({"bias[abs(c1)*c2]", "scale[c2]"}); },
      [=] { return magnetometer({"bias[spline(c1,4)]", "bias[levels(c2,0)]"}); },
      [] {
        return fit_with(five_hole_probe(4.5, 4.5, {0.35, 0.0, -0.02}), five_hole_record(),
                        {"airspeed_scale[c1]", "wind[c2]"});
      },
  };
  return all;
}

const Fitted& fitted(std::size_t at) {
  static std::map<std::size_t, Fitted> made;
  const auto found = made.find(at);
  return found != made.end() ? found->second : made.emplace(at, makers()[at]()).first->second;
}

/// What the bytes say, read once so that the plain export gets the same numbers.
struct Case {
  std::size_t fitted = 0;
  ExportOptions options;
  std::string first, second;  // the channels c1 and c2
  std::string flight, label, file, message, output;
  std::vector<double> values;  // of the parameters
  bool with_flight = true;
};

/// A channel of an effect's name has no blanks.
std::string without_blanks(std::string_view text) {
  std::string kept(text);
  std::erase_if(kept, [](char c) { return c == ' ' || c == '\t'; });
  return kept;
}

Case read_case(Hostile& hostile) {
  Case read;
  read.fitted = static_cast<std::size_t>(hostile.choice(static_cast<int>(makers().size()) - 1));
  constexpr std::array targets{ExportTarget::c, ExportTarget::cpp, ExportTarget::px4,
                               ExportTarget::ardupilot};
  read.options.target = targets.at(static_cast<std::size_t>(hostile.choice(3)));
  read.options.force = true;
  if (hostile.choice(3) == 0) read.options.sensor = hostile.choice(9) - 1;
  if (hostile.choice(7) == 0) read.options.device_id = 197388;
  if (hostile.choice(7) == 0) read.options.in_use = hostile.number(1.6);
  const bool is_header =
      read.options.target == ExportTarget::c || read.options.target == ExportTarget::cpp;
  read.with_flight = !is_header || hostile.choice(3) == 0;
  for (const Parameter& one : fitted(read.fitted).calibration.fit.parameters) {
    read.values.push_back(hostile.number(one.value));
  }
  for (std::string* const word : {&read.first, &read.second, &read.flight, &read.label, &read.file,
                                  &read.message, &read.output}) {
    const bool is_channel = word == &read.first || word == &read.second;
    *word = is_channel ? without_blanks(hostile.word()) : hostile.word();
    if (word->empty()) *word = std::string(1, static_cast<char>('0' + hostile.choice(9)));
  }
  return read;
}

struct Outcome {
  std::optional<Exported> exported;
  std::string error;
};

Outcome export_case(const Case& read, bool is_hostile) {
  const Fitted& base = fitted(read.fitted);
  const auto name = [&](const std::string& word, const char* plain) {
    return is_hostile ? word : std::string(plain);
  };
  Outcome outcome;
  const auto act = [&] {
    Flight flight(name(read.flight, "flight"));
    const Flight columns = renamed(base.flight, name(read.first, "c1"), name(read.second, "c2"));
    for (const Flight::Column& column : columns.columns()) {
      flight.view(column.header, column.values);
    }
    std::vector<std::string> labels(columns.rows(), name(read.label, "leg"));
    std::fill(labels.begin() + static_cast<std::ptrdiff_t>(labels.size() / 2), labels.end(), "~");
    flight.label(std::move(labels));
    Calibration calibration =
        renamed(base.calibration, name(read.first, "c1"), name(read.second, "c2"));
    for (std::size_t i = 0; i < read.values.size(); ++i) {
      calibration.fit.parameters[i].value = read.values[i];
    }
    calibration.flight.file = name(read.file, "flight.csv");
    calibration.file = name(read.file, "base.json");
    calibration.fit.message = name(read.message, "message");
    outcome.exported =
        export_calibration(calibration, read.with_flight ? &flight : nullptr, read.options);
  };
  accepts([&] {
    try {
      act();
    } catch (const Error& error) {
      outcome.error = error.what();
      throw;
    }
  });
  return outcome;
}

/// Columns of the flights, and what begins as a quantity with a unit does: sepcal reads a meaning.
bool is_known(const std::string& name) {
  static const std::set<std::string> known = [] {
    std::set<std::string> names{"maneuver", "temperature", "alpha", "beta"};
    for (std::size_t at = 0; at < makers().size(); ++at) {
      for (const Flight::Column& column : fitted(at).flight.columns()) names.insert(column.header);
      for (const auto& quantity : fitted(at).calibration.probe->quantities()) {
        names.emplace(quantity.name);
      }
    }
    return names;
  }();
  if (known.contains(name)) return true;
  for (std::size_t at = name.find('_'); at != std::string::npos; at = name.find('_', at + 1)) {
    if (known.contains(name.substr(0, at))) return true;
  }
  return false;
}

/// Whether the effects are what they were, but for the channels' names.
bool is_the_same_but_for_names(const Case& read) {
  const auto& [first, second] = std::tie(read.first, read.second);
  if (first == second || is_known(first) || is_known(second)) return false;
  for (const EffectSetting& setting : fitted(read.fitted).calibration.options.effects) {
    const EffectName plain = parse_effect_name(setting.name);
    EffectName name;
    const std::string text = renamed(std::string_view(setting.name), first, second);
    if (!accepts([&] { name = parse_effect_name(text); })) return false;
    const auto same = [&](const ChannelFactor& a, const ChannelFactor& b) {
      return a.channel == renamed(std::string_view(b.channel), first, second) &&
             a.power == b.power && a.absolute == b.absolute;
    };
    if (name.port != plain.port || name.shape != plain.shape || name.number != plain.number ||
        name.thresholds != plain.thresholds ||
        name.base != renamed(std::string_view(plain.base), first, second) ||
        !std::ranges::equal(name.factors, plain.factors, same)) {
      return false;
    }
  }
  return true;
}

std::string in_letters_of_c(std::string_view header) {
  std::string name;
  for (const char c : header) name += is_letter(c) || is_digit(c) ? c : '_';
  return name;
}

void check_argument(const std::string& argument, const std::string& channel,
                    const std::set<std::string>& others) {
  require(is_letter(argument.front()) && argument.front() != '_', "an argument is an identifier");
  require(!is_keyword(argument), "an argument is no keyword");
  require(
      argument.find("system") == std::string::npos || channel.find("system") != std::string::npos,
      "an argument is of its channel");
  require(argument.find(in_letters_of_c(channel)) != std::string::npos,
          "an argument is its channel in letters of C");
  require(!others.contains(argument), "an argument has a name of its own");
}

/// A calibration's id is of its bytes, names among them.
bool is_id(const std::string& token) {
  return token.size() == 66 && token.front() == '"' &&
         token.find_first_not_of("0123456789abcdef", 1) == 65;
}

/// The same tokens but for the calibration's id and the arguments of c1 and c2.
void check_header(const std::string& text, const std::string& plain, const Case& read) {
  check_printed(text);
  const CTokens tokens(text);
  const CTokens expected(plain);
  require(tokens.list().size() == expected.list().size(), "a header has the same tokens");
  std::set<std::string> others(expected.list().begin(), expected.list().end());
  std::map<std::string, std::string> arguments;
  for (std::size_t at = 0; at < tokens.list().size(); ++at) {
    const std::string& token = tokens.list()[at];
    const std::string& known = expected.list()[at];
    if (known != "c1" && known != "c2") {
      require(token == known || (is_id(token) && is_id(known)), "a header's tokens are the same");
      continue;
    }
    const auto [there, is_new] = arguments.emplace(known, token);
    require(there->second == token, "an argument has one name");
    if (is_new) {
      check_argument(token, known == "c1" ? read.first : read.second, others);
      others.insert(token);
    }
  }
}

std::vector<std::string> lines_of(std::string_view text) {
  require(text.ends_with('\n'), "a file ends with its last line");
  std::vector<std::string> lines;
  while (!text.empty()) {
    const std::size_t end = text.find('\n');
    lines.emplace_back(text.substr(0, end));
    text.remove_prefix(end + 1);
  }
  return lines;
}

void check_parameters(const std::string& text, const std::string& plain) {
  const std::vector<std::string> lines = lines_of(text);
  const std::vector<std::string> expected = lines_of(plain);
  require(lines.size() == expected.size(), "a file of parameters has the same lines");
  for (std::size_t at = 0; at < lines.size(); ++at) {
    if (!expected[at].starts_with('#')) {
      require(lines[at] == expected[at], "a parameter and its value are the same");
    } else {
      require(lines[at].starts_with('#'), "a comment stays one");
      check_printed(lines[at]);
    }
  }
}

/// Every parameter has a line, and no line is another's: NAME,VALUE or QGroundControl's five.
void check_names(const Exported& exported) {
  std::size_t at = 0;
  for (const std::string& line : lines_of(exported.text)) {
    if (line.starts_with('#')) continue;
    require(at < exported.parameters.size(), "a file has no more than the parameters");
    const VehicleParameter& parameter = exported.parameters[at++];
    const bool is_px4 = exported.target == ExportTarget::px4;
    const std::string head = is_px4 ? "1\t1\t" + parameter.name + "\t" : parameter.name + ",";
    require(line.starts_with(head), "a line has its parameter's name");
    const std::string rest = line.substr(head.size());
    char* end = nullptr;
    const auto value = std::strtof(rest.c_str(), &end);
    require(value == static_cast<float>(parameter.value), "a line has its parameter's value");
    const std::string tail = is_px4 ? (parameter.whole ? "\t6" : "\t9") : "";
    require(end == rest.c_str() + rest.size() - tail.size() && rest.ends_with(tail),
            "a line ends with its value");
    require(std::ranges::all_of(
                parameter.name,
                [](char c) { return is_digit(c) || (is_letter(c) && (c < 'a' || c > 'z')); }),
            "a parameter's name is in capitals");
  }
  require(at == exported.parameters.size(), "every parameter has a line");
}

void check_pages(const Exported& exported, const Exported& plain, const std::string& output) {
  const std::string page = to_text(exported, output);
  check_printed(page);
  require(lines_of(page).size() == lines_of(to_text(plain, "out")).size(),
          "no name makes a line of a page");
  for (const std::string& note : exported.notes) require(!note.empty(), "a note says something");
  const auto json = nlohmann::json::parse(to_json(exported, output));
  if (is_utf8(output)) require(json.at("output") == output, "JSON gives the very name back");
}

bool is_header(const Exported& exported) { return exported.parameters.empty(); }

}  // namespace
}  // namespace sepcal::fuzz

/// The fits that all inputs begin with: they take longer than an input may.
extern "C" int LLVMFuzzerInitialize(int* /*count*/, char*** /*arguments*/) {
  using namespace sepcal::fuzz;
  for (std::size_t at = 0; at < makers().size(); ++at) static_cast<void>(fitted(at));
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace sepcal::fuzz;
  Hostile hostile(data, size);
  const Case read = read_case(hostile);
  const Outcome outcome = export_case(read, true);
  if (outcome.exported && !is_header(*outcome.exported)) check_names(*outcome.exported);
  if (!is_the_same_but_for_names(read)) return 0;
  const Outcome plain = export_case(read, false);
  if (outcome.error.empty() != plain.error.empty()) {
    std::fprintf(stderr, "%s\n%s\n", outcome.error.c_str(), plain.error.c_str());
  }
  require(outcome.exported.has_value() == plain.exported.has_value(),
          "a name decides on no export");
  if (!plain.exported) return 0;
  if (is_header(*plain.exported)) {
    check_header(outcome.exported->text, plain.exported->text, read);
  } else {
    check_parameters(outcome.exported->text, plain.exported->text);
  }
  check_pages(*outcome.exported, *plain.exported, read.output);
  return 0;
}
