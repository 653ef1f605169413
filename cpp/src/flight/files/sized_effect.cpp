// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/detail/flight/sized_effect.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "sepcal/error.hpp"
#include "sepcal/flight/csv.hpp"

namespace sepcal {

SizedEffect parse_sized_effect(const std::string& text, std::string_view option) {
  const std::size_t equals = text.rfind('=');
  if (equals == std::string::npos || equals == 0) {
    throw Error(
        fmt::format("{} {}: write it as E=SIZE or E=SIZE1:SIZE2:..., e.g. "
                    "wind[time]=0.02:-0.01",
                    option, text));
  }
  SizedEffect effect{text.substr(0, equals)};
  std::string_view rest = std::string_view(text).substr(equals + 1);
  for (bool last = false; !last;) {
    const std::size_t colon = std::min(rest.find(':'), rest.size());
    const auto size = parse_number(rest.substr(0, colon));
    if (!size) {
      throw Error(fmt::format("{} {}: '{}' is not a number", option, text, rest.substr(0, colon)));
    }
    effect.sizes.push_back(*size);
    last = colon == rest.size();
    rest.remove_prefix(last ? colon : colon + 1);
  }
  return effect;
}

}  // namespace sepcal
