// SPDX-License-Identifier: BSD-3-Clause
// Between which distances a function that begins at zero crosses a height, narrowed by the Illinois
// rule: a secant that halves the excess of an end that stays twice.
#pragma once

#include <algorithm>

namespace sepcal::numerics {

class CrossingBracket {
 public:
  /// The function is zero at 0; by `first` (positive) it is expected to have reached `height`.
  CrossingBracket(double height, double first)
      : height_(height), low_excess_(-height), low_true_(-height), slope_(height / first) {}

  bool closed() const { return high_ > 0; }
  double low() const { return low_; }
  double high() const { return high_; }
  double width() const { return high_ - low_; }

  /// Takes a value between the ends, or beyond the lower one while the bracket is not closed.
  void add(double distance, double value) {
    const bool above = value > height_;
    if (!above) {
      slope_ = (value - height_ - low_true_) / (distance - low_);
      low_ = distance;
      low_excess_ = low_true_ = value - height_;
    } else {
      high_ = distance;
      high_excess_ = high_true_ = value - height_;
    }
    const int side = above ? 1 : -1;
    if (closed() && last_side_ == side) (above ? low_excess_ : high_excess_) *= 0.5;
    last_side_ = side;
  }

  /// Forgets the upper end, which turned out to lie below the height with `value`.
  void reopen(double value) {
    const double distance = high_;
    high_ = 0.0;
    add(distance, value);
  }

  /// Whether that value is so much higher than what lies below promises that it may be another
  /// branch's.
  bool leaps_to(double distance, double value) const {
    constexpr double steepening = 3.0;
    const double rise = value - height_ - low_true_;
    return value > height_ && rise > steepening * std::max(0.0, slope_) * (distance - low_);
  }
  bool leaps() const { return closed() && leaps_to(high_, high_true_ + height_); }

  /// Where to look next.
  double next() const {
    constexpr double most_growth = 4.0;
    if (closed()) return low_ - low_excess_ * (high_ - low_) / (high_excess_ - low_excess_);
    const double longest = most_growth * low_;
    return slope_ > 0 ? std::min(low_ - low_true_ / slope_, longest) : longest;
  }

 private:
  double height_;
  double low_ = 0.0;
  double low_excess_;  // value - height, halved by the rule
  double low_true_;    // the same, not halved
  double slope_;       // of the last two points below
  double high_ = 0.0;  // zero: none yet
  double high_excess_ = 0.0;
  double high_true_ = 0.0;
  int last_side_ = 0;  // of the point added last: 1 above the height, -1 below
};

}  // namespace sepcal::numerics
