// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/detail/channel_product.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <span>

namespace sepcal {
namespace {

constexpr int highest_power = 9;

bool is_plain_name(std::string_view text) {
  const auto is_part = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_';
  };
  return !text.empty() && std::ranges::all_of(text, is_part) &&
         std::isdigit(static_cast<unsigned char>(text.front())) == 0;
}

std::optional<ChannelFactor> read_factor(std::string_view text) {
  ChannelFactor factor;
  const std::size_t caret = text.find('^');
  if (caret != std::string_view::npos) {
    const std::string_view power = text.substr(caret + 1);
    const auto [end, error] =
        std::from_chars(power.data(), power.data() + power.size(), factor.power);
    const bool whole_number = error == std::errc{} && end == power.data() + power.size();
    if (!whole_number || factor.power < 1 || factor.power > highest_power) return std::nullopt;
    text = text.substr(0, caret);
  }
  if (text.starts_with("abs(") && text.ends_with(')')) {
    factor.absolute = true;
    text = text.substr(4, text.size() - 5);
  }
  if (!is_plain_name(text)) return std::nullopt;
  factor.channel = std::string(text);
  return factor;
}

}  // namespace

std::optional<std::vector<ChannelFactor>> read_product(std::string_view text) {
  std::vector<ChannelFactor> factors;
  for (std::size_t first = 0; first <= text.size();) {
    const std::size_t star = std::min(text.find('*', first), text.size());
    std::optional<ChannelFactor> factor = read_factor(text.substr(first, star - first));
    if (!factor) return std::nullopt;
    factors.push_back(*std::move(factor));
    first = star + 1;
  }
  return factors;
}

std::vector<double> multiply(const std::vector<ChannelFactor>& factors, const Record& record) {
  std::vector<double> product(record.length(), 1.0);
  for (const ChannelFactor& factor : factors) {
    const std::span<const double> values = record.column(factor.channel);
    for (std::size_t row = 0; row < product.size(); ++row) {
      const double value = factor.absolute ? std::abs(values[row]) : values[row];
      for (int i = 0; i < factor.power; ++i) product[row] *= value;
    }
  }
  return product;
}

}  // namespace sepcal
