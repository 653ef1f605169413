// SPDX-License-Identifier: BSD-3-Clause
#include "flight/files/icartt.hpp"

#include <algorithm>
#include <array>

#include "flight/files/text_lines.hpp"
#include "sepcal/flight/csv.hpp"

namespace sepcal::files {
namespace {

constexpr std::size_t line_of_time = 8;        // counted from 0: the independent variable
constexpr std::size_t line_of_count = 9;       // how many dependent ones there are
constexpr std::size_t line_of_scales = 10;     // one each
constexpr std::size_t line_of_missing = 11;    // one each
constexpr std::size_t line_of_variables = 12;  // the first of them

std::string_view stripped(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t')) text.remove_suffix(1);
  return text;
}

std::vector<std::string_view> parts_of(std::string_view line) {
  std::vector<std::string_view> parts;
  for (;;) {
    const std::size_t comma = line.find(',');
    parts.push_back(stripped(line.substr(0, comma)));
    if (comma == std::string_view::npos) return parts;
    line.remove_prefix(comma + 1);
  }
}

/// A number of lines or variables; nothing where it is none, or more than any file has.
std::optional<std::size_t> parse_count(std::string_view text) {
  constexpr double most = 10'000;
  const auto number = parse_number(stripped(text));
  if (!number || *number < 1 || *number > most) return std::nullopt;
  return static_cast<std::size_t>(*number);
}

std::vector<double> parse_numbers(std::string_view line) {
  std::vector<double> numbers;
  for (const std::string_view part : parts_of(line)) {
    const auto number = parse_number(part);
    if (!number) return {};
    numbers.push_back(*number);
  }
  return numbers;
}

/// "TrueAirspeed, m/s, ...": a variable's unit.
std::string unit_in(std::string_view line) {
  const auto parts = parts_of(line);
  return parts.size() > 1 ? to_utf8(parts[1]) : "";
}

/// What "LLOD_FLAG: -8888" and "ULOD_FLAG: -7777" of the comments say: readings below and above
/// what the sensor resolves.
std::vector<double> find_limits(std::span<const std::string_view> lines) {
  std::vector<double> limits;
  for (const std::string_view line : lines) {
    for (const std::string_view flag : {"ULOD_FLAG:", "LLOD_FLAG:"}) {
      const std::string_view text = stripped(line);
      if (!text.starts_with(flag)) continue;
      if (const auto number = parse_number(stripped(text.substr(flag.size())))) {
        limits.push_back(*number);
      }
    }
  }
  return limits;
}

}  // namespace

std::optional<IcarttHead> read_icartt(std::span<const std::string_view> lines) {
  if (lines.empty()) return std::nullopt;
  const auto first = parts_of(lines.front());
  if (first.size() < 2 || first[1] != "1001") return std::nullopt;
  const auto count = parse_count(first.front());
  if (!count || *count > lines.size() || *count <= line_of_variables) return std::nullopt;
  const auto variables = parse_count(lines[line_of_count]);
  if (!variables || line_of_variables + *variables >= *count) return std::nullopt;
  const std::vector<double> scales = parse_numbers(lines[line_of_scales]);
  const std::vector<double> missing = parse_numbers(lines[line_of_missing]);
  const auto names = parts_of(lines[*count - 1]);
  if (scales.size() != *variables || missing.size() != *variables ||
      names.size() != *variables + 1) {
    return std::nullopt;
  }
  const std::vector<double> limits =
      find_limits(lines.subspan(line_of_variables, *count - line_of_variables));
  IcarttHead head{.lines = *count, .columns = {}};
  head.columns.push_back({to_utf8(names.front()), unit_in(lines[line_of_time])});
  for (std::size_t i = 0; i < *variables; ++i) {
    IcarttColumn column{.name = to_utf8(names[i + 1]),
                        .unit = unit_in(lines[line_of_variables + i]),
                        .scale = scales[i],
                        .missing = {missing[i]}};
    column.missing.insert(column.missing.end(), limits.begin(), limits.end());
    head.columns.push_back(std::move(column));
  }
  return head;
}

}  // namespace sepcal::files
