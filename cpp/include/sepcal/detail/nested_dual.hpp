// SPDX-License-Identifier: BSD-3-Clause
// A number with its first derivatives by N inner and M outer variables, which may be the same ones,
// and its second by one of each; it takes a plain double beside it, as models do. It knows between
// which of the outer variables it has derivatives and computes no others: much of a model depends
// on few of many parameters.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <compare>
#include <limits>
#include <numbers>

#include "sepcal/detail/eigen.hpp"

namespace sepcal {

template <int N, int M = N>
class NestedDual {
 public:
  NestedDual() : NestedDual(0.0) {}
  explicit NestedDual(double value) : value_(value), slopes_(Slopes::Zero()) {}
  /// The variable k at `value`.
  NestedDual(double value, int k)
    requires(N == M)
      : NestedDual(value, k, k) {}
  /// The variable `inner` and `outer` at `value`; none where that is no place among N or M.
  NestedDual(double value, int inner, int outer) : NestedDual(value) {
    if (inner >= 0 && inner < N) slopes_[inner] = 1.0;
    if (outer < 0 || outer >= M) return;
    first_ = outer;
    last_ = outer + 1;
    outer_at(outer) = 1.0;
    mixed_at(outer).setZero();
  }
  NestedDual(const NestedDual& x) : value_(x.value_), slopes_(x.slopes_) { take_outer(x); }
  NestedDual& operator=(const NestedDual& x) {
    if (this == &x) return *this;
    value_ = x.value_;
    slopes_ = x.slopes_;
    take_outer(x);
    return *this;
  }
  ~NestedDual() = default;

  double value() const { return value_; }
  /// The derivative by the inner variable k.
  double slope(int k) const { return slopes_[k]; }
  /// The derivative by the outer variable i.
  double outer_slope(int i) const { return has(i) ? outer_at(i) : 0.0; }
  /// The second derivative by the outer variable i and the inner one k.
  double second_derivative(int i, int k) const { return has(i) ? mixed_at(i)[k] : 0.0; }

  NestedDual& operator+=(const NestedDual& y) { return *this = *this + y; }
  NestedDual& operator-=(const NestedDual& y) { return *this = *this - y; }
  NestedDual& operator*=(const NestedDual& y) { return *this = *this * y; }
  NestedDual& operator/=(const NestedDual& y) { return *this = *this / y; }
  NestedDual& operator+=(double y) {
    value_ += y;
    return *this;
  }
  NestedDual& operator-=(double y) {
    value_ -= y;
    return *this;
  }
  NestedDual& operator*=(double y) { return *this = *this * y; }
  NestedDual& operator/=(double y) { return *this = *this / y; }

  friend NestedDual operator+(const NestedDual& x) { return x; }
  friend NestedDual operator-(const NestedDual& x) { return x.scaled(-x.value_, -1.0); }

  friend NestedDual operator+(const NestedDual& x, const NestedDual& y) {
    return sum(x, y, x.value_ + y.value_, 1.0);
  }
  friend NestedDual operator-(const NestedDual& x, const NestedDual& y) {
    return sum(x, y, x.value_ - y.value_, -1.0);
  }
  friend NestedDual operator*(const NestedDual& x, const NestedDual& y) {
    return combine(x, y, x.value_ * y.value_, {.x = y.value_, .y = x.value_},
                   {.to_x = y.slopes_, .to_y = x.slopes_});
  }
  friend NestedDual operator/(const NestedDual& x, const NestedDual& y) {
    const double inverse = 1.0 / y.value_;
    const double ratio = x.value_ / y.value_;
    const Slopes slopes = (x.slopes_ - ratio * y.slopes_) * inverse;
    return combine(x, y, ratio, {.x = inverse, .y = -ratio * inverse},
                   {.to_x = -inverse * inverse * y.slopes_,
                    .to_y = inverse * (ratio * inverse * y.slopes_ - slopes)});
  }

  friend NestedDual operator+(const NestedDual& x, double y) {
    NestedDual z = x;
    z.value_ += y;
    return z;
  }
  friend NestedDual operator-(const NestedDual& x, double y) {
    NestedDual z = x;
    z.value_ -= y;
    return z;
  }
  friend NestedDual operator*(const NestedDual& x, double y) { return x.scaled(x.value_ * y, y); }
  friend NestedDual operator/(const NestedDual& x, double y) { return x * (1.0 / y); }
  friend NestedDual operator+(double x, const NestedDual& y) { return y + x; }
  friend NestedDual operator-(double x, const NestedDual& y) {
    return y.scaled(x - y.value_, -1.0);
  }
  friend NestedDual operator*(double x, const NestedDual& y) { return y * x; }
  friend NestedDual operator/(double x, const NestedDual& y) {
    const double inverse = 1.0 / y.value_;
    return y.chain(x / y.value_, -x * inverse * inverse, 2.0 * x * inverse * inverse * inverse);
  }

  friend bool operator==(const NestedDual& x, const NestedDual& y) { return x.value_ == y.value_; }
  friend bool operator==(const NestedDual& x, double y) { return x.value_ == y; }
  friend auto operator<=>(const NestedDual& x, const NestedDual& y) {
    return x.value_ <=> y.value_;
  }
  friend auto operator<=>(const NestedDual& x, double y) { return x.value_ <=> y; }

  friend NestedDual abs(const NestedDual& x) { return x < 0.0 ? -x : x; }
  friend NestedDual sqrt(const NestedDual& x) {
    const double root = std::sqrt(x.value_);
    const double slope = 0.5 / root;
    return x.chain(root, slope, -0.5 * slope / x.value_);
  }
  friend NestedDual cbrt(const NestedDual& x) {
    const double root = std::cbrt(x.value_);
    const double slope = 1.0 / (3.0 * root * root);
    return x.chain(root, slope, -2.0 / 3.0 * slope / x.value_);
  }
  friend NestedDual exp(const NestedDual& x) {
    const double power = std::exp(x.value_);
    return x.chain(power, power, power);
  }
  friend NestedDual exp2(const NestedDual& x) {
    constexpr double ln2 = std::numbers::ln2;
    const double power = std::exp2(x.value_);
    return x.chain(power, power * ln2, power * ln2 * ln2);
  }
  friend NestedDual expm1(const NestedDual& x) {
    const double power = std::expm1(x.value_);
    return x.chain(power, power + 1.0, power + 1.0);
  }
  friend NestedDual log(const NestedDual& x) { return x.logarithm(std::log(x.value_), 1.0); }
  friend NestedDual log2(const NestedDual& x) {
    return x.logarithm(std::log2(x.value_), std::numbers::log2e);
  }
  friend NestedDual log10(const NestedDual& x) {
    return x.logarithm(std::log10(x.value_), std::numbers::log10e);
  }
  friend NestedDual log1p(const NestedDual& x) {
    const double inverse = 1.0 / (1.0 + x.value_);
    return x.chain(std::log1p(x.value_), inverse, -inverse * inverse);
  }
  friend NestedDual cos(const NestedDual& x) {
    const double cosine = std::cos(x.value_);
    return x.chain(cosine, -std::sin(x.value_), -cosine);
  }
  friend NestedDual sin(const NestedDual& x) {
    const double sine = std::sin(x.value_);
    return x.chain(sine, std::cos(x.value_), -sine);
  }
  friend NestedDual tan(const NestedDual& x) {
    const double tangent = std::tan(x.value_);
    const double slope = 1.0 + tangent * tangent;
    return x.chain(tangent, slope, 2.0 * tangent * slope);
  }
  friend NestedDual acos(const NestedDual& x) {
    const double rest = 1.0 - x.value_ * x.value_;
    const double slope = -1.0 / std::sqrt(rest);
    return x.chain(std::acos(x.value_), slope, slope * x.value_ / rest);
  }
  friend NestedDual asin(const NestedDual& x) {
    const double rest = 1.0 - x.value_ * x.value_;
    const double slope = 1.0 / std::sqrt(rest);
    return x.chain(std::asin(x.value_), slope, slope * x.value_ / rest);
  }
  friend NestedDual atan(const NestedDual& x) {
    const double slope = 1.0 / (1.0 + x.value_ * x.value_);
    return x.chain(std::atan(x.value_), slope, -2.0 * x.value_ * slope * slope);
  }
  friend NestedDual cosh(const NestedDual& x) {
    const double value = std::cosh(x.value_);
    return x.chain(value, std::sinh(x.value_), value);
  }
  friend NestedDual sinh(const NestedDual& x) {
    const double value = std::sinh(x.value_);
    return x.chain(value, std::cosh(x.value_), value);
  }
  friend NestedDual tanh(const NestedDual& x) {
    const double tangent = std::tanh(x.value_);
    const double slope = 1.0 - tangent * tangent;
    return x.chain(tangent, slope, -2.0 * tangent * slope);
  }
  friend NestedDual erf(const NestedDual& x) {
    constexpr double two_by_root_pi = 2.0 * std::numbers::inv_sqrtpi;
    const double slope = two_by_root_pi * std::exp(-x.value_ * x.value_);
    return x.chain(std::erf(x.value_), slope, -2.0 * x.value_ * slope);
  }
  friend NestedDual fmax(const NestedDual& x, const NestedDual& y) { return x < y ? y : x; }
  friend NestedDual fmin(const NestedDual& x, const NestedDual& y) { return y < x ? y : x; }
  friend NestedDual atan2(const NestedDual& y, const NestedDual& x) {
    const double inverse = 1.0 / (x.value_ * x.value_ + y.value_ * y.value_);
    const double by_y = x.value_ * inverse;
    const double by_x = -y.value_ * inverse;
    const double twice = 2.0 * by_y * by_x;  // by y twice; by x twice it is the negative
    const double mixed = by_x * by_x - by_y * by_y;
    return combine(y, x, std::atan2(y.value_, x.value_), {.x = by_y, .y = by_x},
                   {.to_x = twice * y.slopes_ + mixed * x.slopes_,
                    .to_y = mixed * y.slopes_ - twice * x.slopes_});
  }
  friend NestedDual hypot(const NestedDual& x, const NestedDual& y) {
    const double length = std::hypot(x.value_, y.value_);
    const double by_x = x.value_ / length;
    const double by_y = y.value_ / length;
    const Slopes across = (by_y * x.slopes_ - by_x * y.slopes_) / length;
    return combine(x, y, length, {.x = by_x, .y = by_y},
                   {.to_x = by_y * across, .to_y = -by_x * across});
  }
  /// x to a power that is no variable.
  friend NestedDual pow(const NestedDual& x, double power) {
    const double slope = power == 0.0 ? 0.0 : power * std::pow(x.value_, power - 1.0);
    const double curvature = power == 0.0 || power == 1.0
                                 ? 0.0
                                 : power * (power - 1.0) * std::pow(x.value_, power - 2.0);
    return x.chain(std::pow(x.value_, power), slope, curvature);
  }
  friend bool isfinite(const NestedDual& x) { return std::isfinite(x.value_); }
  friend bool isnan(const NestedDual& x) { return std::isnan(x.value_); }

 private:
  using Slopes = Eigen::Array<double, N, 1, Eigen::DontAlign>;

  /// A function's derivatives by its two arguments, and how these change with the inner variables.
  struct Partials {
    double x;
    double y;
  };
  struct Changes {
    Slopes to_x;
    Slopes to_y;
  };

  struct Unset {};
  explicit NestedDual(Unset /*unset*/) {}

  bool has(int i) const { return i >= first_ && i < last_; }
  double& outer_at(int i) { return outer_[static_cast<std::size_t>(i)]; }
  double outer_at(int i) const { return outer_[static_cast<std::size_t>(i)]; }
  Slopes& mixed_at(int i) { return mixed_[static_cast<std::size_t>(i)]; }
  const Slopes& mixed_at(int i) const { return mixed_[static_cast<std::size_t>(i)]; }

  [[gnu::noinline]] void take_outer(const NestedDual& x) {
    first_ = x.first_;
    last_ = x.last_;
    for (int i = first_; i < last_; ++i) {
      outer_at(i) = x.outer_at(i);
      mixed_at(i) = x.mixed_at(i);
    }
  }

  /// `value` with all derivatives times a factor.
  [[gnu::noinline]] NestedDual scaled(double value, double factor) const {
    NestedDual z{Unset()};
    z.value_ = value;
    z.slopes_ = factor * slopes_;
    z.first_ = first_;
    z.last_ = last_;
    for (int i = first_; i < last_; ++i) {
      z.outer_at(i) = factor * outer_at(i);
      z.mixed_at(i) = factor * mixed_at(i);
    }
    return z;
  }

  /// A function's value here and its derivatives: the chain rule.
  [[gnu::noinline]] NestedDual chain(double value, double slope, double curvature) const {
    NestedDual z{Unset()};
    z.value_ = value;
    z.slopes_ = slope * slopes_;
    z.first_ = first_;
    z.last_ = last_;
    const Slopes bend = curvature * slopes_;
    for (int i = first_; i < last_; ++i) {
      z.outer_at(i) = slope * outer_at(i);
      z.mixed_at(i) = slope * mixed_at(i) + outer_at(i) * bend;
    }
    return z;
  }

  NestedDual logarithm(double value, double unit) const {
    const double inverse = 1.0 / value_;
    return chain(value, unit * inverse, -unit * inverse * inverse);
  }

  /// visit(i, whether x has it, whether y does) for all of z, which has what either has.
  template <class Visit>
  static void join(const NestedDual& x, const NestedDual& y, NestedDual& z, const Visit& visit) {
    const bool no_x = x.first_ == x.last_;
    const bool no_y = y.first_ == y.last_;
    z.first_ = no_x ? y.first_ : no_y ? x.first_ : std::min(x.first_, y.first_);
    z.last_ = no_x ? y.last_ : no_y ? x.last_ : std::max(x.last_, y.last_);
    for (int i = z.first_; i < z.last_; ++i) visit(i, x.has(i), y.has(i));
  }

  /// x + sign y.
  [[gnu::noinline]] static NestedDual sum(const NestedDual& x, const NestedDual& y, double value,
                                          double sign) {
    NestedDual z{Unset()};
    z.value_ = value;
    z.slopes_ = x.slopes_ + sign * y.slopes_;
    join(x, y, z, [&](int i, bool in_x, bool in_y) {
      z.outer_at(i) = (in_x ? x.outer_at(i) : 0.0) + (in_y ? sign * y.outer_at(i) : 0.0);
      if (in_x && in_y) {
        z.mixed_at(i) = x.mixed_at(i) + sign * y.mixed_at(i);
      } else if (in_x) {
        z.mixed_at(i) = x.mixed_at(i);
      } else if (in_y) {
        z.mixed_at(i) = sign * y.mixed_at(i);
      } else {
        z.mixed_at(i).setZero();
      }
    });
    return z;
  }

  [[gnu::noinline]] static NestedDual combine(const NestedDual& x, const NestedDual& y,
                                              double value, const Partials& by,
                                              const Changes& change) {
    NestedDual z{Unset()};
    z.value_ = value;
    z.slopes_ = by.x * x.slopes_ + by.y * y.slopes_;
    join(x, y, z, [&](int i, bool in_x, bool in_y) {
      if (in_x && in_y) {
        z.outer_at(i) = by.x * x.outer_at(i) + by.y * y.outer_at(i);
        z.mixed_at(i) = by.x * x.mixed_at(i) + by.y * y.mixed_at(i) + x.outer_at(i) * change.to_x +
                        y.outer_at(i) * change.to_y;
      } else if (in_x) {
        z.outer_at(i) = by.x * x.outer_at(i);
        z.mixed_at(i) = by.x * x.mixed_at(i) + x.outer_at(i) * change.to_x;
      } else if (in_y) {
        z.outer_at(i) = by.y * y.outer_at(i);
        z.mixed_at(i) = by.y * y.mixed_at(i) + y.outer_at(i) * change.to_y;
      } else {
        z.outer_at(i) = 0.0;
        z.mixed_at(i).setZero();
      }
    });
    return z;
  }

  double value_;
  Slopes slopes_;  // by the inner variables
  int first_ = 0;  // of the outer ones it has [first, last)
  int last_ = 0;
  std::array<double, M> outer_;
  std::array<Slopes, M> mixed_;
};

}  // namespace sepcal

namespace Eigen {

/// So that matrices of them can be multiplied and inverted, as those of Ceres' Jets.
template <int N, int M>
struct NumTraits<sepcal::NestedDual<N, M>> : GenericNumTraits<sepcal::NestedDual<N, M>> {
  using Number = sepcal::NestedDual<N, M>;
  using Real = Number;
  using NonInteger = Number;
  using Nested = Number;
  using Literal = Number;
  // NOLINTBEGIN(readability-identifier-naming): Eigen's names
  enum { IsComplex = 0, IsInteger = 0, IsSigned = 1, RequireInitialization = 1 };
  // NOLINTEND(readability-identifier-naming)
  static Number epsilon() { return Number(std::numeric_limits<double>::epsilon()); }
  static Number dummy_precision() { return Number(1e-12); }
  static int digits10() { return std::numeric_limits<double>::digits10; }
};

template <typename BinaryOp, int N, int M>
struct ScalarBinaryOpTraits<sepcal::NestedDual<N, M>, double, BinaryOp> {
  using ReturnType = sepcal::NestedDual<N, M>;
};
template <typename BinaryOp, int N, int M>
struct ScalarBinaryOpTraits<double, sepcal::NestedDual<N, M>, BinaryOp> {
  using ReturnType = sepcal::NestedDual<N, M>;
};

}  // namespace Eigen
