// SPDX-License-Identifier: BSD-3-Clause
// What a driver's channel is called in a header: a reading that is there already, a quantity in the
// unit used inside, or the column's own name as far as C and C++ take it.
#pragma once

#include <array>
#include <map>
#include <string>
#include <string_view>

#include "flight/export/exporter.hpp"

namespace sepcal::exporting {

/// Quantities that a record has under their own name: the argument, its unit, and what it may be.
struct KnownChannel {
  std::string_view channel;
  std::string_view argument;
  std::string_view unit;
  std::array<double, 3> trial;
};

/// By its name in a record or as a column in that unit; nullptr for any other column of the log.
const KnownChannel* find_known(std::string_view channel);

/// Expressions of a correction by channel, as the header has them.
std::map<std::string, std::string, std::less<>> names_of_readings(const Exporter& exporter,
                                                                  bool single);

/// A column's header as an argument of a function.
std::string identifier(const std::string& header);

}  // namespace sepcal::exporting
