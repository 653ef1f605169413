// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/effect_name.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <utility>

#include "sepcal/error.hpp"

namespace sepcal {
namespace {

using Shape = EffectName::Shape;

constexpr int most_knots = 1000;

constexpr std::array<std::pair<std::string_view, Shape>, 6> functions{{{"spline", Shape::spline},
                                                                       {"levels", Shape::levels},
                                                                       {"step", Shape::step},
                                                                       {"ramp", Shape::ramp},
                                                                       {"decay", Shape::decay},
                                                                       {"delay", Shape::delay}}};

std::string without_spaces(std::string_view text) {
  std::string kept(text);
  std::erase_if(kept, [](char c) { return c == ' ' || c == '\t'; });
  return kept;
}

[[noreturn]] void refuse(std::string_view text, const std::string& why) {
  throw Error("effect '" + std::string(text) + "': " + why);
}

std::optional<int> parse_count(std::string_view digits) {
  int value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc{} || end != digits.data() + digits.size()) return std::nullopt;
  return value;
}

/// The channel; the thresholds after it go to the name.
std::string_view read_thresholds(EffectName& name, std::string_view arguments) {
  const std::size_t comma = arguments.find(',');
  std::string_view rest = comma == std::string_view::npos ? "" : arguments.substr(comma);
  while (!rest.empty()) {
    rest.remove_prefix(1);
    const std::size_t end = std::min(rest.find(','), rest.size());
    double value = 0.0;
    const std::string text(rest.substr(0, end));
    const char* const behind = text.data() + text.size();  // NOLINT(*-pointer-arithmetic)
    const auto [read, error] = std::from_chars(text.data(), behind, value);
    const bool is_number = error == std::errc{} && read == behind && std::isfinite(value);
    if (!is_number || (!name.thresholds.empty() && !(value > name.thresholds.back()))) {
      name.thresholds.clear();
      break;
    }
    name.thresholds.push_back(value);
    rest.remove_prefix(end);
  }
  if (name.thresholds.empty()) {
    refuse(name.text, "write levels as levels(x,a,b) with thresholds that rise");
  }
  return arguments.substr(0, comma);
}

/// "name(arguments)".
void read_function(EffectName& name, std::string_view driver, std::size_t open) {
  const auto* const function =
      std::ranges::find(functions, driver.substr(0, open), [](const auto& at) { return at.first; });
  if (function == functions.end() || driver.back() != ')') {
    refuse(name.text, "'" + std::string(driver) +
                          "' is no driver; known: x, x^2, x^n, x*y, abs(x), spline(x,k), "
                          "levels(x,a,b), step(time), ramp(time), decay(time), delay(x)");
  }
  name.shape = function->second;
  std::string_view arguments = driver.substr(open + 1, driver.size() - open - 2);
  if (name.shape == Shape::spline) {
    const std::size_t comma = arguments.rfind(',');
    const auto knots =
        comma == std::string_view::npos ? std::nullopt : parse_count(arguments.substr(comma + 1));
    if (!knots || *knots < 3 || *knots > most_knots) {
      refuse(name.text, "write a spline as spline(x,k) with k knots, 3 to 1000");
    }
    name.number = *knots;
    arguments = arguments.substr(0, comma);
  }
  if (name.shape == Shape::levels) arguments = read_thresholds(name, arguments);
  name.base = arguments;
  const bool of_time =
      name.shape == Shape::step || name.shape == Shape::ramp || name.shape == Shape::decay;
  if (of_time && name.base != "time") {
    refuse(name.text, std::string(function->first) + " takes time: write " +
                          std::string(function->first) + "(time)");
  }
}

/// Whether it is more than one channel's power.
bool read_as_product(EffectName& name, std::string_view driver) {
  if (driver.find('*') == std::string_view::npos && !driver.starts_with("abs(")) return false;
  auto factors = read_product(driver);
  if (!factors) return false;
  name.shape = Shape::product;
  name.base = driver;
  name.factors = *std::move(factors);
  if (std::ranges::find(name.factors, "maneuver", &ChannelFactor::channel) != name.factors.end()) {
    refuse(name.text, "maneuver is a label, not a number; write port[maneuver]");
  }
  return true;
}

void read_power(EffectName& name, std::string_view driver) {
  const std::size_t caret = driver.rfind('^');
  name.shape = Shape::power;
  name.base = driver.substr(0, caret);
  if (caret == std::string_view::npos) return;
  const std::string_view power = driver.substr(caret + 1);
  if (power == "n") {
    name.shape = Shape::exponent;
    return;
  }
  const auto value = parse_count(power);
  if (!value || *value < 1 || *value > 9) {
    refuse(name.text, "the power '" + std::string(power) +
                          "' must be a whole number from 1 to 9, or n for a fitted exponent");
  }
  name.number = *value;
}

}  // namespace

EffectName parse_effect_name(std::string_view text) {
  EffectName name;
  name.text = without_spaces(text);
  const std::string_view whole = name.text;
  const std::size_t open = whole.find('[');
  name.port = whole.substr(0, open);
  if (name.port.empty()) refuse(text, "a name is missing; write port[driver], e.g. wind[time]");
  if (open == std::string_view::npos) {
    if (whole.find_first_of("]()") != std::string_view::npos) {
      refuse(text, "write port[driver], e.g. wind[spline(time,6)]");
    }
    return name;
  }
  if (whole.back() != ']' || open + 2 >= whole.size()) {
    refuse(text, "write port[driver], e.g. wind[altitude_m], airspeed_scale[alpha^2]");
  }
  const std::string_view driver = whole.substr(open + 1, whole.size() - open - 2);
  const std::size_t bracket = driver.find('(');
  if (read_as_product(name, driver)) return name;
  if (bracket != std::string_view::npos && bracket > 0 && driver.back() == ')') {
    read_function(name, driver, bracket);
  } else {
    read_power(name, driver);
  }
  if (name.base.empty()) refuse(text, "the driver names no channel");
  if (name.base == "maneuver" && (name.shape != Shape::power || name.number != 1)) {
    refuse(text, "maneuver is a label, not a number; write port[maneuver]");
  }
  return name;
}

std::vector<std::string> driver_channels(const EffectName& name) {
  std::vector<std::string> channels;
  for (const ChannelFactor& factor : name.factors) {
    if (std::ranges::find(channels, factor.channel) == channels.end()) {
      channels.push_back(factor.channel);
    }
  }
  if (channels.empty() && !name.base.empty()) channels.push_back(name.base);
  return channels;
}

bool can_name(std::string_view channel) {
  return !channel.empty() && channel.find_first_of(" \t[]()^*") == std::string_view::npos;
}

std::vector<std::string> split_effects(std::string_view text) {
  std::vector<std::string> names(1);
  int depth = 0;
  for (const char c : text) {
    if (c == '[' || c == '(') ++depth;
    if (c == ']' || c == ')') --depth;
    if (c == '+' && depth == 0) {
      names.emplace_back();
    } else {
      names.back() += c;
    }
  }
  for (std::string& name : names) {
    name = without_spaces(name);
    if (name.empty()) refuse(text, "a name is missing beside '+'");
  }
  return names;
}

}  // namespace sepcal
