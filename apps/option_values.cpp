// SPDX-License-Identifier: BSD-3-Clause
#include "option_values.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

#include "flight/probes/mounting.hpp"
#include "manners.hpp"
#include "sepcal/error.hpp"

namespace sepcal::app {
namespace {

/// Without those before and after it.
std::string without_blanks(const std::string& text) {
  const std::size_t first = text.find_first_not_of(' ');
  if (first == std::string::npos) return "";
  return text.substr(first, text.find_last_not_of(' ') - first + 1);
}

}  // namespace

std::array<double, 3> parse_triple(const std::string& option, const std::string& text,
                                   const std::string& example) {
  const std::vector<std::string> parts = split(text, ',');
  if (parts.size() != 3) {
    throw Error(fmt::format("{} {}: give three numbers, e.g. {}", option, text, example));
  }
  std::array<double, 3> values{};
  for (std::size_t i = 0; i < 3; ++i) values[i] = parse_value(option, without_blanks(parts[i]));
  return values;
}

std::array<double, 3> parse_turn(const std::string& option, const std::string& text,
                                 const std::string& example) {
  const std::vector<std::string> parts = split(text, ',');
  if (parts.size() != 4) return parse_triple(option, text, example);
  std::array<double, 4> quaternion{};
  for (std::size_t i = 0; i < 4; ++i) quaternion[i] = parse_value(option, without_blanks(parts[i]));
  return probes::angles_of_quaternion(quaternion);
}

Band parse_band(const std::string& text) {
  Band band;
  if (text.empty()) return band;
  const std::size_t colon = text.find(':');
  if (colon == std::string::npos) {
    throw Error(fmt::format("--band {}: write LOW:HIGH in Hz, as 0.1:2", text));
  }
  band.low = parse_value("--band", text.substr(0, colon));
  band.high = parse_value("--band", text.substr(colon + 1));
  check_band(band);
  return band;
}

std::uint64_t parse_whole_number(const std::string& option, const std::string& text,
                                 std::uint64_t highest) {
  const bool negative = text.starts_with('-');
  const std::string_view digits = std::string_view(text).substr(negative ? 1 : 0);
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  if (digits.empty() || !std::ranges::all_of(digits, is_digit)) {
    throw CLI::ValidationError(fmt::format("{}: '{}' is not a whole number", option, text));
  }
  if (negative) {
    throw CLI::ValidationError(fmt::format("{} must not be negative, and {} is", option, text));
  }
  std::uint64_t value = 0;
  const auto read = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (read.ec != std::errc{} || value > highest) {
    throw CLI::ValidationError(
        fmt::format("{} {} is too large; take at most {}", option, text, highest));
  }
  return value;
}

CLI::Option* add_file(CLI::App& verb, const std::string& name, std::string& file,
                      const std::string& description) {
  const auto refuse_empty = [](const std::string& text) -> std::string {
    return text.empty() ? "the name is empty; name a file" : "";
  };
  CLI::Option* const option = verb.add_option(name, file, description)->check(refuse_empty);
  const bool is_output = name.ends_with("--output");
  if (!is_output && name.starts_with('-')) return option;
  const auto name_stream = [is_output](const std::string& typed) {
    return typed != "-" ? typed : is_output ? standard_output : standard_input;
  };
  return option->transform(name_stream);
}

void add_more_flights(CLI::App& verb, std::vector<std::string>& files, const std::string& what) {
  verb.validate_positionals();
  verb.add_option("MORE", files, what)->type_name("CSV")->check([](const std::string& file) {
    const bool is_log = file.ends_with(".csv") || file.ends_with(".CSV");
    return std::string(is_log ? "" : "the name of a log ends in .csv");
  });
}

void add_deviations(CLI::App& verb, const std::string& name, std::vector<std::string>& texts,
                    const std::string& description) {
  verb.add_option(name, texts, description)
      ->type_name("NAME=SD")
      ->take_all()
      ->allow_extra_args(false);
}

std::map<std::string, double> parse_deviations(const std::string& option,
                                               const std::vector<std::string>& texts) {
  std::map<std::string, double> deviations;
  for (const std::string& text : texts) {
    const auto [name, value] = parse_assignment(option, text, "NAME=SD");
    if (!deviations.emplace(name, parse_value(option, value)).second) {
      throw Error(fmt::format("{} {} is given twice", option, name));
    }
  }
  return deviations;
}

void add_references(CLI::App& verb, std::vector<std::string>& references) {
  verb.add_option(
          "--reference", references,
          "an independent sensor's column of the log, to set what is calibrated against: "
          "airspeed_2_mps, or airspeed_kt=TAS where its name doesn't say what it is; may be "
          "repeated")
      ->type_name("COLUMN")
      ->take_all()
      ->allow_extra_args(false);
}

}  // namespace sepcal::app
