// SPDX-License-Identifier: BSD-3-Clause
// Of a check's notes, those that a fit shows.
#include <fmt/format.h>

#include "flight/checks/log.hpp"
#include "sepcal/flight/check.hpp"
#include "sepcal/flight/probe.hpp"

namespace sepcal {

std::vector<std::string> brief_notes(const FlightCheck& check) {
  constexpr std::size_t most = 6;
  std::vector<std::string> lines;
  std::size_t hidden = 0;
  for (const LogNote& note : check.notes) {
    if (note.concern == Concern::slight || note.kind == "implausible") continue;
    if (lines.size() == most) {
      ++hidden;
    } else {
      lines.push_back(checks::in_one_line(note, check.file));
    }
  }
  if (hidden > 0) {
    const std::string command =
        check.sha256.empty() ? "sepcal.check()"
                             : fmt::format("{} {}", command_of(check.app, "check"), check.file);
    lines.push_back(fmt::format("{} more: {}", hidden, command));
  }
  return lines;
}

}  // namespace sepcal
