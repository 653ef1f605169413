// SPDX-License-Identifier: BSD-3-Clause
// Products of powers of channels: what a regressor is, and what may drive an effect.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sepcal/record.hpp"

namespace sepcal {

struct ChannelFactor {
  std::string channel;
  int power = 1;  // 1 to 9
  bool absolute = false;

  friend bool operator==(const ChannelFactor&, const ChannelFactor&) = default;
};

/// The factors of "alpha", "alpha^2*elevator", "beta*abs(beta)"; nothing for a text that is no such
/// product. Channels are letters, digits and underscores.
std::optional<std::vector<ChannelFactor>> read_product(std::string_view text);

/// The product in every row of the record. Throws Error for a channel that it doesn't have.
std::vector<double> multiply(const std::vector<ChannelFactor>& factors, const Record& record);

}  // namespace sepcal
