// SPDX-License-Identifier: BSD-3-Clause
// A number with its first and second derivatives by N variables, each enclosed wherever the
// variables are within a box: what a model's at() is asked with to prove something of its cost.
#pragma once

#include <array>
#include <cstddef>

#include "sepcal/detail/eigen.hpp"
#include "sepcal/detail/enclosure.hpp"

namespace sepcal {

/// Whether something holds of an enclosed number: always, never, or for some of what is within.
struct EnclosedCondition {
  bool ever = false;
  bool always = false;
};

template <int N>
class EnclosedDual {
 public:
  static constexpr int curvatures = N * (N + 1) / 2;

  EnclosedDual() = default;
  EnclosedDual(double value) : value_(value) {}  // NOLINT(*-explicit-*): beside plain numbers
  EnclosedDual(const Enclosure& value)
      : value_(value) {}  // NOLINT(*-explicit-*): and beside inputs
  /// The variable k within a range.
  EnclosedDual(const Enclosure& range, int k) : value_(range) {
    slopes_[static_cast<std::size_t>(k)] = Enclosure(1.0);
  }

  const Enclosure& value() const { return value_; }
  const Enclosure& slope(int j) const { return slopes_[static_cast<std::size_t>(j)]; }
  /// By the variables j >= k.
  const Enclosure& curvature(int j, int k) const { return curvatures_[place(j, k)]; }

  /// Value, slopes, curvatures, as EnclosedRows has them.
  void copy_to(Enclosure* parts) const {
    *parts++ = value_;
    for (const Enclosure& slope : slopes_) *parts++ = slope;
    for (const Enclosure& curvature : curvatures_) *parts++ = curvature;
  }

  /// f(x) where f, f' and f'' are known over x's range.
  static EnclosedDual chain(const EnclosedDual& x, const Enclosure& f, const Enclosure& slope,
                            const Enclosure& curvature) {
    EnclosedDual y;
    y.value_ = f;
    for (int j = 0; j < N; ++j) {
      y.slopes_[static_cast<std::size_t>(j)] = slope * x.slope(j);
      for (int k = 0; k <= j; ++k) {
        const Enclosure product = j == k ? square(x.slope(j)) : x.slope(j) * x.slope(k);
        y.curvatures_[place(j, k)] = curvature * product + slope * x.curvature(j, k);
      }
    }
    return y;
  }

  friend EnclosedDual operator+(const EnclosedDual& x) { return x; }
  friend EnclosedDual operator-(const EnclosedDual& x) {
    return combine(x, [](const Enclosure& part) { return -part; });
  }
  friend EnclosedDual operator+(const EnclosedDual& x, const EnclosedDual& y) {
    EnclosedDual sum = x;
    sum.value_ += y.value_;
    for (std::size_t j = 0; j < N; ++j) sum.slopes_[j] += y.slopes_[j];
    for (std::size_t i = 0; i < curvatures; ++i) sum.curvatures_[i] += y.curvatures_[i];
    return sum;
  }
  friend EnclosedDual operator-(const EnclosedDual& x, const EnclosedDual& y) { return x + (-y); }
  friend EnclosedDual operator*(const EnclosedDual& x, const EnclosedDual& y) {
    EnclosedDual product;
    product.value_ = &x == &y ? square(x.value_) : x.value_ * y.value_;
    for (int j = 0; j < N; ++j) {
      product.slopes_[static_cast<std::size_t>(j)] = x.slope(j) * y.value_ + x.value_ * y.slope(j);
      for (int k = 0; k <= j; ++k) {
        product.curvatures_[place(j, k)] = x.curvature(j, k) * y.value_ + x.slope(j) * y.slope(k) +
                                           x.slope(k) * y.slope(j) + x.value_ * y.curvature(j, k);
      }
    }
    return product;
  }
  friend EnclosedDual operator/(const EnclosedDual& x, const EnclosedDual& y) {
    const Enclosure inverse = Enclosure(1.0) / y.value_;
    const Enclosure slope = -square(inverse);
    return x * chain(y, inverse, slope, slope * inverse * -2.0);
  }
  friend EnclosedDual operator+(const EnclosedDual& x, double y) {
    EnclosedDual sum = x;
    sum.value_ += Enclosure(y);
    return sum;
  }
  friend EnclosedDual operator+(double x, const EnclosedDual& y) { return y + x; }
  friend EnclosedDual operator-(const EnclosedDual& x, double y) { return x + (-y); }
  friend EnclosedDual operator-(double x, const EnclosedDual& y) { return (-y) + x; }
  friend EnclosedDual operator*(const EnclosedDual& x, double y) {
    return combine(x, [y](const Enclosure& part) { return part * y; });
  }
  friend EnclosedDual operator*(double x, const EnclosedDual& y) { return y * x; }
  friend EnclosedDual operator/(const EnclosedDual& x, double y) { return x / EnclosedDual(y); }
  friend EnclosedDual operator/(double x, const EnclosedDual& y) { return EnclosedDual(x) / y; }
  EnclosedDual& operator+=(const EnclosedDual& y) { return *this = *this + y; }
  EnclosedDual& operator-=(const EnclosedDual& y) { return *this = *this - y; }
  EnclosedDual& operator*=(const EnclosedDual& y) { return *this = *this * y; }
  EnclosedDual& operator/=(const EnclosedDual& y) { return *this = *this / y; }

  friend EnclosedDual sin(const EnclosedDual& x) {
    const Enclosure s = sin(x.value_);
    return chain(x, s, cos(x.value_), -s);
  }
  friend EnclosedDual cos(const EnclosedDual& x) {
    const Enclosure c = cos(x.value_);
    return chain(x, c, -sin(x.value_), -c);
  }
  friend EnclosedDual tan(const EnclosedDual& x) { return sin(x) / cos(x); }
  friend EnclosedDual exp(const EnclosedDual& x) {
    const Enclosure e = exp(x.value_);
    return chain(x, e, e, e);
  }
  friend EnclosedDual log(const EnclosedDual& x) {
    const Enclosure inverse = Enclosure(1.0) / x.value_;
    return chain(x, log(x.value_), inverse, -square(inverse));
  }
  friend EnclosedDual sqrt(const EnclosedDual& x) {
    const Enclosure root = sqrt(x.value_);
    const Enclosure slope = Enclosure(0.5) / root;
    return chain(x, root, slope, slope / x.value_ * -0.5);
  }

  friend EnclosedCondition operator<(const EnclosedDual& x, double y) {
    return {x.value_.lower() < y, x.value_.upper() < y};
  }
  /// One or the other; where either may be, both, and nothing of the derivatives.
  friend EnclosedDual where(EnclosedCondition condition, const EnclosedDual& x,
                            const EnclosedDual& y) {
    if (condition.always) return x;
    if (!condition.ever) return y;
    const Enclosure anything(-infinity, infinity);
    EnclosedDual either = combine(x, [&](const Enclosure&) { return anything; });
    either.value_ = hull(x.value_, y.value_);
    return either;
  }

 private:
  static constexpr std::size_t place(int j, int k) {
    const auto row = static_cast<std::size_t>(j);
    return row * (row + 1) / 2 + static_cast<std::size_t>(k);
  }

  template <class Map>
  static EnclosedDual combine(const EnclosedDual& x, const Map& map) {
    EnclosedDual y;
    y.value_ = map(x.value_);
    for (std::size_t j = 0; j < N; ++j) y.slopes_[j] = map(x.slopes_[j]);
    for (std::size_t i = 0; i < curvatures; ++i) y.curvatures_[i] = map(x.curvatures_[i]);
    return y;
  }

  Enclosure value_ = Enclosure(0.0);
  std::array<Enclosure, N> slopes_ = {};
  std::array<Enclosure, curvatures> curvatures_ = {};
};

}  // namespace sepcal

namespace Eigen {

template <>
struct NumTraits<sepcal::Enclosure> : GenericNumTraits<sepcal::Enclosure> {
  using Number = sepcal::Enclosure;
  using Real = Number;
  using NonInteger = Number;
  using Nested = Number;
  using Literal = Number;
  // NOLINTBEGIN(readability-identifier-naming): Eigen's names
  enum { IsComplex = 0, IsInteger = 0, IsSigned = 1, RequireInitialization = 1 };
  // NOLINTEND(readability-identifier-naming)
};

/// So that matrices of them can be multiplied, as those of dual numbers.
template <int N>
struct NumTraits<sepcal::EnclosedDual<N>> : GenericNumTraits<sepcal::EnclosedDual<N>> {
  using Number = sepcal::EnclosedDual<N>;
  using Real = Number;
  using NonInteger = Number;
  using Nested = Number;
  using Literal = Number;
  // NOLINTBEGIN(readability-identifier-naming): Eigen's names
  enum { IsComplex = 0, IsInteger = 0, IsSigned = 1, RequireInitialization = 1 };
  // NOLINTEND(readability-identifier-naming)
};

template <typename BinaryOp, int N>
struct ScalarBinaryOpTraits<sepcal::EnclosedDual<N>, double, BinaryOp> {
  using ReturnType = sepcal::EnclosedDual<N>;
};
template <typename BinaryOp, int N>
struct ScalarBinaryOpTraits<double, sepcal::EnclosedDual<N>, BinaryOp> {
  using ReturnType = sepcal::EnclosedDual<N>;
};
template <typename BinaryOp, int N>
struct ScalarBinaryOpTraits<sepcal::EnclosedDual<N>, sepcal::Enclosure, BinaryOp> {
  using ReturnType = sepcal::EnclosedDual<N>;
};
template <typename BinaryOp, int N>
struct ScalarBinaryOpTraits<sepcal::Enclosure, sepcal::EnclosedDual<N>, BinaryOp> {
  using ReturnType = sepcal::EnclosedDual<N>;
};

}  // namespace Eigen
