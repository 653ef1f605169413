// SPDX-License-Identifier: BSD-3-Clause
// What a sensor reads over what it should read. It is bound below: in a short turn a model turned
// over, or one that reads next to nothing, fits as well as the true one.
#pragma once

#include <string_view>

#include "sepcal/detail/quantity.hpp"

namespace sepcal {

inline constexpr double least_scale = 0.05;

/// A linear scale error, the scale less one, open above: a wrong unit may make it large.
constexpr Quantity scale_error(std::string_view name) {
  return {name, "1", least_scale - 1.0, infinity};
}

}  // namespace sepcal
