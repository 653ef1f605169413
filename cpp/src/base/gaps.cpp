// SPDX-License-Identifier: BSD-3-Clause
#include "base/gaps.hpp"

#include <cmath>

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <utility>

#include "sepcal/detail/quantity.hpp"

namespace sepcal::base {
namespace {

class SortedIntervals {
 public:
  explicit SortedIntervals(std::vector<double> intervals) : intervals_(std::move(intervals)) {
    std::ranges::sort(intervals_);
  }

  std::size_t count() const { return intervals_.size(); }
  double at(std::size_t rank) const { return intervals_[rank]; }
  double largest_up_to(double most) const {
    return *std::prev(std::ranges::upper_bound(intervals_, most));
  }

 private:
  std::vector<double> intervals_;
};

/// Bits that are ordered as the numbers are.
std::uint64_t key_of(double value) {
  const auto bits = std::bit_cast<std::uint64_t>(value);
  constexpr std::uint64_t sign = std::uint64_t{1} << 63U;
  return (bits & sign) != 0 ? ~bits : bits | sign;
}

double value_of(std::uint64_t key) {
  constexpr std::uint64_t sign = std::uint64_t{1} << 63U;
  return std::bit_cast<double>((key & sign) != 0 ? key & ~sign : ~key);
}

class PassedIntervals {
 public:
  PassedIntervals(std::size_t count, const PassOverIntervals& pass) : count_(count), pass_(pass) {}

  std::size_t count() const { return count_; }

  /// Digit by digit, the highest first: how many of those that begin alike go on with each.
  double at(std::size_t rank) const {
    constexpr unsigned digit = 16;
    std::uint64_t key = 0;
    for (unsigned below = 64; below > 0;) {
      below -= digit;
      const std::uint64_t known = below + digit == 64 ? 0 : ~std::uint64_t{0} << (below + digit);
      std::vector<std::size_t> counts(std::size_t{1} << digit, 0);
      pass_([&](double value) {
        const std::uint64_t own = key_of(value);
        if ((own & known) == key) ++counts[(own >> below) & (counts.size() - 1)];
      });
      std::size_t next = 0;
      while (next + 1 < counts.size() && rank >= counts[next]) rank -= counts[next++];
      key |= static_cast<std::uint64_t>(next) << below;
    }
    return value_of(key);
  }

  double largest_up_to(double most) const {
    double largest = -infinity;
    pass_([&](double value) {
      if (value <= most) largest = std::max(largest, value);
    });
    return largest;
  }

 private:
  std::size_t count_;
  const PassOverIntervals& pass_;
};

template <class Intervals>
double find_gap_of(const Intervals& intervals) {
  constexpr double jump = 5 * (1 + 1e-6);
  const std::size_t n = intervals.count();
  if (n == 0) return infinity;
  const double longest = intervals.at(static_cast<std::size_t>(0.95 * static_cast<double>(n - 1)));
  double usual = (intervals.at((n - 1) / 2) + intervals.at(n / 2)) / 2;
  constexpr std::size_t fewest = 20;  // of which one in twenty can be told
  while (n >= fewest) {
    const double reached = std::min(jump * usual, longest);
    const double next = intervals.largest_up_to(std::max(usual, reached));
    if (!(next > usual)) break;
    usual = next;
  }
  return jump * usual;
}

}  // namespace

double usual_interval(std::vector<double> intervals) {
  const auto middle = intervals.begin() + static_cast<std::ptrdiff_t>(intervals.size() / 2);
  std::ranges::nth_element(intervals, middle);
  return *middle;
}

double find_gap(std::vector<double> intervals) {
  return find_gap_of(SortedIntervals(std::move(intervals)));
}

double find_gap(std::size_t count, const PassOverIntervals& pass) {
  return find_gap_of(PassedIntervals(count, pass));
}

void bridge_gaps(std::span<double> values) {
  const std::size_t none = values.size();
  std::size_t last = none;  // that is there
  for (std::size_t row = 0; row < values.size(); ++row) {
    if (std::isnan(values[row])) continue;
    const std::size_t first = last == none ? 0 : last + 1;
    for (std::size_t at = first; at < row; ++at) {
      const double share =
          last == none ? 1.0 : static_cast<double>(at - last) / static_cast<double>(row - last);
      values[at] = last == none ? values[row] : values[last] + share * (values[row] - values[last]);
    }
    last = row;
  }
  if (last == none) return;
  for (std::size_t at = last + 1; at < values.size(); ++at) values[at] = values[last];
}

}  // namespace sepcal::base
