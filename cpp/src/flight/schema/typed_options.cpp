// SPDX-License-Identifier: BSD-3-Clause
#include "flight/schema/typed_options.hpp"

#include <fmt/format.h>

#include "sepcal/effect_name.hpp"
#include "sepcal/error.hpp"
#include "sepcal/flight/csv.hpp"

namespace sepcal::schema {
namespace {

/// Two halves, or an Error with the form.
std::pair<std::string, std::string> two_of(const Typed& typed, const std::string& name,
                                           const std::string& text, char separator) {
  std::vector<std::string> parts = split(text, separator);
  if (parts.size() != 2) {
    throw Error(fmt::format("{} {}={}: write it as {}", typed.flag, name, text, typed.form));
  }
  return {std::move(parts[0]), std::move(parts[1])};
}

/// {NAME: read(NAME, TEXT)} of each NAME=TEXT, none of them twice.
template <class Value, class Read>
void read_assignments(const Typed& typed, std::map<std::string, Value>& values, const Read& read) {
  for (const std::string& text : typed.texts) {
    const auto [name, value] = parse_assignment(typed.flag, text, typed.form);
    if (values.contains(name)) {
      throw Error(fmt::format("{} {} is given twice; keep one", typed.flag, name));
    }
    values[name] = read(name, value);
  }
}

}  // namespace

std::vector<std::string> split(std::string_view text, char separator) {
  std::vector<std::string> parts(1);
  for (const char c : text) {
    if (c == separator) {
      parts.emplace_back();
    } else {
      parts.back() += c;
    }
  }
  return parts;
}

double parse_value(const std::string& option, const std::string& text) {
  if (const auto value = parse_number(text)) return *value;
  throw Error(fmt::format("{}: '{}' is not a number", option, text));
}

std::pair<std::string, std::string> parse_assignment(const std::string& option,
                                                     const std::string& text,
                                                     const std::string& form) {
  const std::size_t at = text.find('=');
  if (at == std::string::npos || at == 0) {
    throw Error(fmt::format("{} {}: write it as {}", option, text, form));
  }
  return {text.substr(0, at), text.substr(at + 1)};
}

void read_typed(const Typed& typed, std::map<std::string, Interval>& values) {
  read_assignments(typed, values, [&](const std::string& name, const std::string& text) {
    const auto [lower, upper] = two_of(typed, name, text, ',');
    const std::string option = typed.flag + " " + name;
    return Interval{lower.empty() ? -infinity : parse_value(option, lower),
                    upper.empty() ? infinity : parse_value(option, upper)};
  });
}

void read_typed(const Typed& typed, std::map<std::string, double>& values) {
  read_assignments(typed, values, [&](const std::string& name, const std::string& text) {
    return parse_value(typed.flag + " " + name, text);
  });
}

void read_typed(const Typed& typed, std::map<std::string, Normal>& values) {
  read_assignments(typed, values, [&](const std::string& name, const std::string& text) {
    const auto [mean, deviation] = two_of(typed, name, text, ':');
    const std::string option = typed.flag + " " + name;
    return Normal{parse_value(option, mean), parse_value(option, deviation)};
  });
}

void read_typed(const Typed& typed, std::map<std::string, std::string>& values) {
  std::vector<std::string> pairs;
  for (const std::string& text : typed.texts) {  // a column's name may hold the comma of a list
    if (pairs.empty() || text.find('=') != std::string::npos) {
      pairs.push_back(text);
    } else {
      pairs.back() += ',' + text;
    }
  }
  for (const std::string& text : pairs) {
    const auto [name, value] = parse_assignment(typed.flag, text, "HEADER=COLUMN");
    if (value.empty()) {
      throw Error(fmt::format("{} {}: write it as HEADER=COLUMN", typed.flag, text));
    }
    values[name] = value;
  }
}

void read_typed(const Typed& typed, std::vector<std::string>& values) { values = typed.texts; }

void read_typed(const Typed& typed, std::vector<EffectSetting>& values) {
  for (const std::string& text : typed.texts) {
    for (const std::string& name : split_effects(text)) values.push_back({.name = name});
  }
}

void read_typed(const Typed& typed, std::string& value) { value = typed.texts.back(); }

}  // namespace sepcal::schema
