// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/hidden_driver.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>

#include "sepcal/error.hpp"
#include "simulation/hidden_spline.hpp"
#include "simulation/simulated_flight.hpp"

namespace sepcal::simulation {
namespace {

using Form = Driver::Form;

constexpr std::string_view forms =
    "x, x^2 to x^9, x^n, spline(x,k), step(time), ramp(time), decay(time), delay(x), maneuver";

[[noreturn]] void fail_form(const std::string& effect) {
  throw Error(
      fmt::format("{}: the driver in the brackets is not understood; write {}", effect, forms));
}

std::size_t find_base(const std::string& effect, std::string_view name, const Sources& sources) {
  const auto found = std::ranges::find(sources.names, name);
  if (found == sources.names.end()) {
    throw Error(
        fmt::format("{}: nothing in the simulated log is named '{}'; a driver x can be: "
                    "{}, maneuver",
                    effect, name, fmt::join(sources.names, ", ")));
  }
  return static_cast<std::size_t>(found - sources.names.begin());
}

std::optional<int> parse_count(std::string_view text) {
  int value = 0;
  const auto read = std::from_chars(text.data(), text.data() + text.size(), value);
  if (read.ec != std::errc{} || read.ptr != text.data() + text.size()) return std::nullopt;
  return value;
}

/// "spline(time,12)" to "spline" and "time,12"; nothing where the text is no call.
std::optional<std::pair<std::string_view, std::string_view>> split_call(std::string_view text) {
  const std::size_t open = text.find('(');
  if (open == std::string_view::npos || !text.ends_with(')')) return std::nullopt;
  return std::pair{text.substr(0, open), text.substr(open + 1, text.size() - open - 2)};
}

Driver parse_call(const std::string& effect, std::string_view name, std::string_view argument,
                  const Sources& sources) {
  if (name == "spline") {
    const std::size_t comma = argument.rfind(',');
    if (comma == std::string_view::npos) fail_form(effect);
    const auto knots = parse_count(argument.substr(comma + 1));
    constexpr int most_knots = 1000;
    if (!knots || *knots < 3 || *knots > most_knots) {
      throw Error(
          fmt::format("{}: a spline needs 3 to {} knots, e.g. spline(time,8)", effect, most_knots));
    }
    return {Form::spline, find_base(effect, argument.substr(0, comma), sources), *knots};
  }
  if (name == "delay") {
    const std::size_t base = find_base(effect, argument, sources);
    if (argument == "time" || argument == "alpha" || argument == "beta") {
      throw Error(fmt::format("{}: only a column or a body rate can be delayed", effect));
    }
    return {Form::delay, base};
  }
  if (argument != "time") fail_form(effect);
  const std::size_t base = find_base(effect, argument, sources);
  if (name == "step") return {Form::step, base};
  if (name == "ramp") return {Form::ramp, base};
  if (name == "decay") return {Form::decay, base};
  fail_form(effect);
}

/// The mean over the rows for time, altitudes and temperatures, else 0.
double find_centre(const Driver& driver, const Sources& sources) {
  const std::string& name = sources.names[driver.base];
  if (name != "time" && !name.starts_with("altitude") && !name.starts_with("temp")) return 0.0;
  double sum = 0.0;
  for (const Moment& row : sources.rows) sum += row.values[driver.base];
  return sum / static_cast<double>(sources.rows.size());
}

HiddenSpline make_spline(const std::string& effect, const Driver& driver, const Sources& sources,
                         std::span<const double> coefficients) {
  const auto value = [&](const Moment& row) { return row.values[driver.base]; };
  const auto [lowest, highest] = std::ranges::minmax_element(sources.rows, {}, value);
  if (!(value(*lowest) < value(*highest))) {
    throw Error(fmt::format("{}: {} is constant in this flight; nothing can be smooth in it",
                            effect, sources.names[driver.base]));
  }
  std::vector<double> values{0.0};
  values.insert(values.end(), coefficients.begin(), coefficients.end());
  return {value(*lowest), value(*highest), std::move(values)};
}

double check_positive(const std::string& effect, std::string_view shape, double value) {
  if (value > 0.0) return value;
  throw Error(fmt::format("{}: {} = {} must be above 0", effect, shape, format_number(value)));
}

}  // namespace

Sources list_sources(std::vector<std::string> names, std::function<Moment(double)> at,
                     std::function<std::string_view(double)> label,
                     const std::vector<double>& times) {
  Sources sources{std::move(names), std::move(at), std::move(label), {}, {}};
  for (const double time : times) {
    sources.rows.push_back(sources.at(time));
    const std::string here(sources.label(time));
    if (std::ranges::find(sources.labels, here) == sources.labels.end()) {
      sources.labels.push_back(here);
    }
  }
  return sources;
}

Driver parse_driver(const std::string& effect, std::string_view text, const Sources& sources) {
  if (text.empty()) return {};
  if (text == "maneuver") return {Form::maneuver};
  if (const auto call = split_call(text)) {
    return parse_call(effect, call->first, call->second, sources);
  }
  const std::size_t caret = std::min(text.find('^'), text.size());
  const std::string_view power = text.substr(caret);
  if (power == "^n") return {Form::exponent, find_base(effect, text.substr(0, caret), sources)};
  const auto number = power.empty() ? 1 : parse_count(power.substr(1));
  if (!number || *number < 1 || *number > 9) fail_form(effect);
  return {Form::power, find_base(effect, text.substr(0, caret), sources), *number};
}

double check_shift(const std::string& effect, double shift) {
  if (std::abs(shift) <= longest_shift) return shift;
  throw Error(fmt::format("{}: tau = {} s is out of range; choose it within +-{} s", effect,
                          format_number(shift), format_number(longest_shift)));
}

std::string_view shape_parameter(Driver::Form form) {
  switch (form) {
    case Form::step:
    case Form::ramp:
      return "t0";
    case Form::decay:
    case Form::delay:
      return "tau";
    case Form::exponent:
      return "exponent";
    default:
      return "";
  }
}

double default_shape(Driver::Form form, const Sources& sources) {
  const double begin = sources.rows.front().time;
  const double length = sources.rows.back().time - begin;
  switch (form) {
    case Form::step:
    case Form::ramp:
      return begin + length / 3.0;
    case Form::decay:
      return length / 5.0;
    case Form::delay:
      return 0.05;
    default:
      return 0.7;
  }
}

std::vector<std::string> coefficient_suffixes(const std::string& effect, const Driver& driver,
                                              const Sources& sources) {
  std::vector<std::string> suffixes;
  if (driver.form == Form::spline) {
    for (int knot = 2; knot <= driver.number; ++knot) suffixes.push_back(fmt::format("_{}", knot));
  } else if (driver.form == Form::maneuver) {
    if (sources.labels.size() < 2) {
      throw Error(fmt::format("{}: every row of this flight is labelled {}; it takes two maneuvers",
                              effect, sources.labels.front()));
    }
    for (std::size_t i = 1; i < sources.labels.size(); ++i) {
      suffixes.push_back("_" + sources.labels[i]);
    }
  } else {
    suffixes.emplace_back();
  }
  return suffixes;
}

std::function<double(const Moment&)> drive(const std::string& effect, const Driver& driver,
                                           const Sources& sources,
                                           std::span<const double> coefficients, double shape) {
  const double s = coefficients.front();
  const std::size_t base = driver.base;
  switch (driver.form) {
    case Form::constant:
      return [s](const Moment&) { return s; };
    case Form::power:
      return [s, base, centre = find_centre(driver, sources), power = driver.number](
                 const Moment& now) { return s * std::pow(now.values[base] - centre, power); };
    case Form::exponent:
      return [s, base, n = check_positive(effect, "exponent", shape)](const Moment& now) {
        return s * std::pow(std::max(now.values[base], 0.0), n);
      };
    case Form::spline:
      return [base, spline = make_spline(effect, driver, sources, coefficients)](
                 const Moment& now) { return spline(now.values[base]); };
    case Form::maneuver:
      return [label = sources.label, labels = sources.labels,
              values = std::vector(coefficients.begin(), coefficients.end())](const Moment& now) {
        const auto found = std::ranges::find(labels, label(now.time));
        if (found == labels.begin() || found == labels.end()) return 0.0;
        return values[static_cast<std::size_t>(found - labels.begin()) - 1];
      };
    case Form::step:
      return [s, shape](const Moment& now) { return now.time >= shape ? s : 0.0; };
    case Form::ramp:
      return [s, shape](const Moment& now) { return s * std::max(now.time - shape, 0.0); };
    case Form::decay:
      return [s, begin = sources.rows.front().time, tau = check_positive(effect, "tau", shape)](
                 const Moment& now) { return s * std::exp((begin - now.time) / tau); };
    default:
      return [s, base, at = sources.at, tau = check_shift(effect, shape)](const Moment& now) {
        return s * at(now.time - tau).values[base];
      };
  }
}

}  // namespace sepcal::simulation
