// SPDX-License-Identifier: BSD-3-Clause
#include "flight/logs/chosen_columns.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "flight/files/headers.hpp"
#include "sepcal/error.hpp"

namespace sepcal::logs {
namespace {

[[noreturn]] void fail(const Flight& flight, const char* option, const std::string& what) {
  throw OptionError({flight.name() + ": ", Option{option}, what});
}

bool is_ignored(const LogChoice& choice, const std::string& header) {
  return std::ranges::find(choice.ignore, header) != choice.ignore.end();
}

void rename_columns(Flight& flight, const LogChoice& choice) {
  for (const auto& [header, logged] : choice.map) {
    if (header == "maneuver") {
      fail(flight, "map", " can't name labels: call that column maneuver in the file");
    }
    if (flight.find(logged) == nullptr) {
      fail(flight, "map",
           fmt::format(" {}={} names a column that is not there; {}", header, logged,
                       flight.list_columns()));
    }
    if (header == logged) continue;
    if (flight.find(header) != nullptr) {
      throw OptionError(
          {flight.name() + ": ", Option{"map"},
           fmt::format(" {}={}: there is a column '{}' already; ", header, logged, header),
           Option{"ignore"}, " " + header});
    }
    flight.rename(logged, header);
  }
}

}  // namespace

void choose_columns(Flight& flight, const LogChoice& choice) {
  if (flight.find(files::flight_number) != nullptr) return;  // joined, each under these names
  const auto ignored_as_logged = [&](const std::string& header) {
    return is_ignored(choice, header) && flight.find(header) != nullptr;
  };
  std::vector<std::string> dropped;
  std::ranges::copy_if(choice.ignore, std::back_inserter(dropped), ignored_as_logged);
  for (const std::string& header : dropped) flight.drop(header);
  rename_columns(flight, choice);
  for (const std::string& header : choice.ignore) {
    if (std::ranges::find(dropped, header) != dropped.end()) continue;
    if (flight.find(header) == nullptr) {
      fail(flight, "ignore",
           fmt::format(" names {}, which is no column; {}", header, flight.list_columns()));
    }
    flight.drop(header);
  }
}

}  // namespace sepcal::logs
