// SPDX-License-Identifier: BSD-3-Clause
// Interval arithmetic that holds: a number is known to lie within [lower, upper], and what is
// computed of it lies within what comes out, whatever was rounded on the way. Every operation of
// IEEE 754 is correct to half an ulp and is widened by two; libm's functions are correct to an ulp
// and are widened by four. Where nothing can be said, the whole line is the answer.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "sepcal/detail/eigen.hpp"
#include "sepcal/detail/quantity.hpp"

namespace sepcal {

class Enclosure {
 public:
  Enclosure() = default;
  /// A number that is known exactly; the whole line where it isn't finite.
  explicit Enclosure(double value) : Enclosure(value, value) {}
  /// The whole line where an end is not a number.
  Enclosure(double lower, double upper)
      : lower_(std::isnan(lower) || std::isnan(upper) ? -infinity : lower),
        upper_(std::isnan(lower) || std::isnan(upper) ? infinity : upper) {}

  double lower() const { return lower_; }
  double upper() const { return upper_; }
  /// Of what is within, the most; at least the true one.
  double magnitude() const { return std::max(std::abs(lower_), std::abs(upper_)); }
  /// About the middle: of no meaning but as a guess.
  double middle() const { return lower_ + 0.5 * (upper_ - lower_); }
  bool is_finite() const { return std::isfinite(lower_) && std::isfinite(upper_); }
  bool contains(double value) const { return lower_ <= value && value <= upper_; }

  /// Ends of a sum, which is exact where it is subnormal; of another operation that is correct to
  /// half an ulp; and of a function that is correct to an ulp.
  static Enclosure summed(double lower, double upper) {
    return widened(lower, upper, 0x1p-51, 0.0);
  }
  static Enclosure rounded(double lower, double upper) {
    return widened(lower, upper, 0x1p-51, least);
  }
  static Enclosure by_libm(double lower, double upper) {
    return widened(lower, upper, 0x1p-50, least);
  }

 private:
  static constexpr double least = 4.0 * std::numeric_limits<double>::denorm_min();

  static Enclosure widened(double lower, double upper, double share, double floor) {
    const double below = lower - (std::abs(lower) * share + floor);
    const double above = upper + (std::abs(upper) * share + floor);
    return {std::isnan(below) ? -infinity : below, std::isnan(above) ? infinity : above};
  }

  double lower_ = 0.0;
  double upper_ = 0.0;
};

inline Enclosure operator-(const Enclosure& x) { return {-x.upper(), -x.lower()}; }
inline Enclosure operator+(const Enclosure& x, const Enclosure& y) {
  return Enclosure::summed(x.lower() + y.lower(), x.upper() + y.upper());
}
inline Enclosure operator-(const Enclosure& x, const Enclosure& y) { return x + (-y); }
inline Enclosure operator*(const Enclosure& x, const Enclosure& y) {
  if (!x.is_finite() || !y.is_finite()) return {-infinity, infinity};
  const auto [least, most] = std::minmax(
      {x.lower() * y.lower(), x.lower() * y.upper(), x.upper() * y.lower(), x.upper() * y.upper()});
  return Enclosure::rounded(least, most);
}
inline Enclosure operator/(const Enclosure& x, const Enclosure& y) {
  if (!x.is_finite() || !y.is_finite() || y.contains(0.0)) return {-infinity, infinity};
  const auto [least, most] = std::minmax(
      {x.lower() / y.lower(), x.lower() / y.upper(), x.upper() / y.lower(), x.upper() / y.upper()});
  return Enclosure::rounded(least, most);
}
inline Enclosure operator+(const Enclosure& x, double y) { return x + Enclosure(y); }
inline Enclosure operator+(double x, const Enclosure& y) { return Enclosure(x) + y; }
inline Enclosure operator*(const Enclosure& x, double y) { return x * Enclosure(y); }
inline Enclosure operator*(double x, const Enclosure& y) { return Enclosure(x) * y; }
inline Enclosure& operator+=(Enclosure& x, const Enclosure& y) { return x = x + y; }

/// What holds both.
inline Enclosure hull(const Enclosure& x, const Enclosure& y) {
  return {std::min(x.lower(), y.lower()), std::max(x.upper(), y.upper())};
}

/// x^2, which is never below zero.
inline Enclosure square(const Enclosure& x) {
  const double most = x.magnitude();
  const double least = x.contains(0.0) ? 0.0 : std::min(std::abs(x.lower()), std::abs(x.upper()));
  const Enclosure wide = Enclosure::rounded(least * least, most * most);
  return {std::max(0.0, wide.lower()), wide.upper()};
}

/// Of what is not below zero; the whole line where all of it is.
inline Enclosure sqrt(const Enclosure& x) {
  if (!(x.upper() >= 0.0)) return {-infinity, infinity};
  const Enclosure wide =
      Enclosure::rounded(std::sqrt(std::max(0.0, x.lower())), std::sqrt(x.upper()));
  return {std::max(0.0, wide.lower()), wide.upper()};
}

inline Enclosure exp(const Enclosure& x) {
  const Enclosure wide = Enclosure::by_libm(std::exp(x.lower()), std::exp(x.upper()));
  return {std::max(0.0, wide.lower()), wide.upper()};
}

/// Of what is above zero; the whole line where not all of it is.
inline Enclosure log(const Enclosure& x) {
  if (!(x.lower() > 0.0)) return {-infinity, infinity};
  return Enclosure::by_libm(std::log(x.lower()), std::log(x.upper()));
}

inline Enclosure cos(const Enclosure& x) {
  constexpr double pi = std::numbers::pi;
  constexpr double near = 1e-9;  // of a turn's place, far more than pi is off: what is so near
                                 // may be an extremum
  constexpr double most = 1e6;   // rad, beyond which that is not enough
  if (!x.is_finite() || x.magnitude() > most || x.upper() - x.lower() >= 2.0 * pi)
    return {-1.0, 1.0};
  const double at_lower = std::cos(x.lower());
  const double at_upper = std::cos(x.upper());
  const auto [least, greatest] = std::minmax(at_lower, at_upper);
  const Enclosure wide = Enclosure::by_libm(least, greatest);
  double lower = std::max(-1.0, wide.lower());
  double upper = std::min(1.0, wide.upper());
  const auto first = static_cast<int>(std::ceil(x.lower() / pi - near));  // half turns within
  const auto last = static_cast<int>(std::floor(x.upper() / pi + near));
  for (int half = first; half <= last; ++half) {
    if (half % 2 == 0) {
      upper = 1.0;
    } else {
      lower = -1.0;
    }
  }
  return {lower, upper};
}

inline Enclosure sin(const Enclosure& x) {
  constexpr double quarter = 0.5 * std::numbers::pi;
  return cos(x - Enclosure(std::nextafter(quarter, 0.0), std::nextafter(quarter, 2.0)));
}

/// Ranges of [A | b] of rows, as EnclosedDual has them: of the values, of the slopes by xi2, and of
/// the second derivatives.
struct EnclosedRows {
  int columns = 0;  // n_1 + 1
  int n_2 = 0;
  std::vector<Enclosure> parts =
      {};  // row after row, column after column: value, slopes, curvatures

  static int parts_of(int n_2) { return 1 + n_2 + n_2 * (n_2 + 1) / 2; }
  void resize(Eigen::Index rows) {
    parts.resize(static_cast<std::size_t>(rows * columns * parts_of(n_2)));
  }
  Enclosure* at(Eigen::Index row, Eigen::Index column) {
    return parts.data() + (row * columns + column) * parts_of(n_2);
  }
  const Enclosure* at(Eigen::Index row, Eigen::Index column) const {
    return parts.data() + (row * columns + column) * parts_of(n_2);
  }
};

}  // namespace sepcal
