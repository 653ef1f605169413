// SPDX-License-Identifier: BSD-3-Clause
// A number with its first and second derivatives: a dual number whose parts are dual numbers, by N
// variables within and M without, which may be the same ones, and which takes a plain double beside
// it, as models do.
#pragma once

#include <cmath>
#include <compare>
#include <limits>
#include <utility>

#include "sepcal/detail/dual.hpp"
#include "sepcal/detail/eigen.hpp"

namespace sepcal {

template <int N, int M = N>
class NestedDual {
 public:
  using Inner = Dual<double, N>;
  using Outer = Dual<Inner, M>;

  NestedDual() = default;
  explicit NestedDual(double value) : number_(Inner(value)) {}
  explicit NestedDual(Outer number) : number_(std::move(number)) {}
  /// The variable k at `value`.
  NestedDual(double value, int k)
    requires(N == M)
      : number_(Inner(value, k), k) {}
  /// The variable `inner` and `outer` at `value`; none where that is no place among N or M.
  NestedDual(double value, int inner, int outer) : number_(Inner(value, inner), outer) {}

  double value() const { return number_.value().value(); }
  /// The derivative by the inner variable k.
  double slope(int k) const { return number_.value().slope(k); }
  /// The derivative by the outer variable i.
  double outer_slope(int i) const { return number_.slope(i).value(); }
  /// The second derivative by the outer variable i and the inner one k.
  double second_derivative(int i, int k) const { return number_.slope(i).slope(k); }

  NestedDual& operator+=(const NestedDual& y) { return *this = *this + y; }
  NestedDual& operator-=(const NestedDual& y) { return *this = *this - y; }
  NestedDual& operator*=(const NestedDual& y) { return *this = *this * y; }
  NestedDual& operator/=(const NestedDual& y) { return *this = *this / y; }
  NestedDual& operator+=(double y) { return *this = *this + y; }
  NestedDual& operator-=(double y) { return *this = *this - y; }
  NestedDual& operator*=(double y) { return *this = *this * y; }
  NestedDual& operator/=(double y) { return *this = *this / y; }

  friend NestedDual operator+(const NestedDual& x) { return x; }
  friend NestedDual operator-(const NestedDual& x) { return NestedDual(-x.number_); }

  friend NestedDual operator+(const NestedDual& x, const NestedDual& y) {
    return NestedDual(x.number_ + y.number_);
  }
  friend NestedDual operator-(const NestedDual& x, const NestedDual& y) {
    return NestedDual(x.number_ - y.number_);
  }
  friend NestedDual operator*(const NestedDual& x, const NestedDual& y) {
    return NestedDual(x.number_ * y.number_);
  }
  friend NestedDual operator/(const NestedDual& x, const NestedDual& y) {
    return NestedDual(x.number_ / y.number_);
  }

  friend NestedDual operator+(const NestedDual& x, double y) {
    return NestedDual(x.number_ + Inner(y));
  }
  friend NestedDual operator-(const NestedDual& x, double y) {
    return NestedDual(x.number_ - Inner(y));
  }
  friend NestedDual operator*(const NestedDual& x, double y) {
    return NestedDual(x.number_ * Inner(y));
  }
  friend NestedDual operator/(const NestedDual& x, double y) { return x * (1.0 / y); }
  friend NestedDual operator+(double x, const NestedDual& y) { return y + x; }
  friend NestedDual operator-(double x, const NestedDual& y) { return -y + x; }
  friend NestedDual operator*(double x, const NestedDual& y) { return y * x; }
  friend NestedDual operator/(double x, const NestedDual& y) {
    return NestedDual(Inner(x) / y.number_);
  }

  friend bool operator==(const NestedDual& x, const NestedDual& y) {
    return x.value() == y.value();
  }
  friend bool operator==(const NestedDual& x, double y) { return x.value() == y; }
  friend auto operator<=>(const NestedDual& x, const NestedDual& y) {
    return x.value() <=> y.value();
  }
  friend auto operator<=>(const NestedDual& x, double y) { return x.value() <=> y; }

  friend NestedDual abs(const NestedDual& x) { return x < 0.0 ? -x : x; }
  friend NestedDual sqrt(const NestedDual& x) { return NestedDual(sqrt(x.number_)); }
  friend NestedDual cbrt(const NestedDual& x) { return NestedDual(cbrt(x.number_)); }
  friend NestedDual exp(const NestedDual& x) { return NestedDual(exp(x.number_)); }
  friend NestedDual exp2(const NestedDual& x) { return NestedDual(exp2(x.number_)); }
  friend NestedDual expm1(const NestedDual& x) { return NestedDual(expm1(x.number_)); }
  friend NestedDual log(const NestedDual& x) { return NestedDual(log(x.number_)); }
  friend NestedDual log2(const NestedDual& x) { return NestedDual(log2(x.number_)); }
  friend NestedDual log10(const NestedDual& x) { return NestedDual(log10(x.number_)); }
  friend NestedDual log1p(const NestedDual& x) { return NestedDual(log1p(x.number_)); }
  friend NestedDual cos(const NestedDual& x) { return NestedDual(cos(x.number_)); }
  friend NestedDual sin(const NestedDual& x) { return NestedDual(sin(x.number_)); }
  friend NestedDual tan(const NestedDual& x) { return NestedDual(tan(x.number_)); }
  friend NestedDual acos(const NestedDual& x) { return NestedDual(acos(x.number_)); }
  friend NestedDual asin(const NestedDual& x) { return NestedDual(asin(x.number_)); }
  friend NestedDual atan(const NestedDual& x) { return NestedDual(atan(x.number_)); }
  friend NestedDual cosh(const NestedDual& x) { return NestedDual(cosh(x.number_)); }
  friend NestedDual sinh(const NestedDual& x) { return NestedDual(sinh(x.number_)); }
  friend NestedDual tanh(const NestedDual& x) { return NestedDual(tanh(x.number_)); }
  friend NestedDual erf(const NestedDual& x) { return NestedDual(erf(x.number_)); }
  friend NestedDual fmax(const NestedDual& x, const NestedDual& y) { return x < y ? y : x; }
  friend NestedDual fmin(const NestedDual& x, const NestedDual& y) { return y < x ? y : x; }
  friend NestedDual atan2(const NestedDual& y, const NestedDual& x) {
    return NestedDual(atan2(y.number_, x.number_));
  }
  friend NestedDual hypot(const NestedDual& x, const NestedDual& y) {
    return NestedDual(hypot(x.number_, y.number_));
  }
  friend NestedDual pow(const NestedDual& x, double y) { return NestedDual(pow(x.number_, y)); }
  friend bool isfinite(const NestedDual& x) { return std::isfinite(x.value()); }
  friend bool isnan(const NestedDual& x) { return std::isnan(x.value()); }

 private:
  Outer number_;
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
