// SPDX-License-Identifier: BSD-3-Clause
// A flight log for a test to spoil, and what it looks at in the record that comes of it.
#pragma once

#include <algorithm>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "sepcal/detail/flight/probe_columns.hpp"
#include "sepcal/detail/quantity.hpp"

namespace sepcal::test {

/// A flight's columns by header, to be changed by a test before it is built.
struct Log {
  std::vector<std::pair<std::string, std::vector<double>>> columns;

  std::vector<double>& operator[](const std::string& header) {
    for (auto& [name, values] : columns) {
      if (name == header) return values;
    }
    return columns.emplace_back(header, std::vector<double>(columns[0].second.size())).second;
  }
  Log& erase(const std::string& header) {
    std::erase_if(columns, [&](const auto& column) { return column.first == header; });
    return *this;
  }
  Log& rename(const std::string& from, const std::string& to) {
    for (auto& [name, values] : columns) {
      if (name == from) name = to;
    }
    return *this;
  }
  Flight build() const {
    Flight flight("log");
    for (const auto& [name, values] : columns) flight.add(name, values);
    return flight;
  }
};

inline std::vector<double> column(const ProbeRecord& prepared, std::string_view name) {
  const auto values = prepared.record.column(name);
  return {values.begin(), values.end()};
}

inline bool mentions(const std::vector<std::string>& notes, std::string_view text) {
  return std::ranges::any_of(
      notes, [&](const auto& note) { return note.find(text) != std::string::npos; });
}

}  // namespace sepcal::test
