// SPDX-License-Identifier: BSD-3-Clause
// A number with its first and second derivatives: a dual number whose parts are dual numbers, by N
// variables within and M without, which may be the same ones. Ceres' Jet nests, but not with a
// plain double beside it, which models are full of.
#pragma once

#include <ceres/jet.h>

#include <cmath>
#include <compare>
#include <limits>
#include <utility>

#include "sepcal/eigen.hpp"

namespace sepcal {

template <int N, int M = N>
class NestedDual {
 public:
  using Dual = ceres::Jet<double, N>;
  using Jet = ceres::Jet<Dual, M>;

  NestedDual() = default;
  explicit NestedDual(double value) : jet_(Dual(value)) {}
  explicit NestedDual(Jet jet) : jet_(std::move(jet)) {}
  /// The variable k at `value`.
  NestedDual(double value, int k)
    requires(N == M)
      : jet_(Dual(value, k), k) {}
  /// The variable `inner` and `outer` at `value`; none where that is no place among N or M.
  NestedDual(double value, int inner, int outer) : jet_(Dual(value)) {
    if (inner >= 0 && inner < N) jet_.a.v[inner] = 1.0;
    if (outer >= 0 && outer < M) jet_.v[outer] = Dual(1.0);
  }

  double value() const { return jet_.a.a; }
  /// The derivative by the inner variable k.
  double slope(int k) const { return jet_.a.v[k]; }
  /// The derivative by the outer variable i.
  double outer_slope(int i) const { return jet_.v[i].a; }
  /// The second derivative by the outer variable i and the inner one k.
  double second_derivative(int i, int k) const { return jet_.v[i].v[k]; }

  NestedDual& operator+=(const NestedDual& y) { return *this = *this + y; }
  NestedDual& operator-=(const NestedDual& y) { return *this = *this - y; }
  NestedDual& operator*=(const NestedDual& y) { return *this = *this * y; }
  NestedDual& operator/=(const NestedDual& y) { return *this = *this / y; }
  NestedDual& operator+=(double y) { return *this = *this + y; }
  NestedDual& operator-=(double y) { return *this = *this - y; }
  NestedDual& operator*=(double y) { return *this = *this * y; }
  NestedDual& operator/=(double y) { return *this = *this / y; }

  friend NestedDual operator+(const NestedDual& x) { return x; }
  friend NestedDual operator-(const NestedDual& x) { return NestedDual(-x.jet_); }

  friend NestedDual operator+(const NestedDual& x, const NestedDual& y) {
    return NestedDual(x.jet_ + y.jet_);
  }
  friend NestedDual operator-(const NestedDual& x, const NestedDual& y) {
    return NestedDual(x.jet_ - y.jet_);
  }
  friend NestedDual operator*(const NestedDual& x, const NestedDual& y) {
    return NestedDual(x.jet_ * y.jet_);
  }
  friend NestedDual operator/(const NestedDual& x, const NestedDual& y) {
    return NestedDual(x.jet_ / y.jet_);
  }

  friend NestedDual operator+(const NestedDual& x, double y) {
    return NestedDual(x.jet_ + Dual(y));
  }
  friend NestedDual operator-(const NestedDual& x, double y) {
    return NestedDual(x.jet_ - Dual(y));
  }
  friend NestedDual operator*(const NestedDual& x, double y) {
    return NestedDual(x.jet_ * Dual(y));
  }
  friend NestedDual operator/(const NestedDual& x, double y) { return x * (1.0 / y); }
  friend NestedDual operator+(double x, const NestedDual& y) { return y + x; }
  friend NestedDual operator-(double x, const NestedDual& y) { return -y + x; }
  friend NestedDual operator*(double x, const NestedDual& y) { return y * x; }
  friend NestedDual operator/(double x, const NestedDual& y) {
    return NestedDual(Dual(x) / y.jet_);
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
  friend NestedDual sqrt(const NestedDual& x) { return NestedDual(ceres::sqrt(x.jet_)); }
  friend NestedDual cbrt(const NestedDual& x) { return NestedDual(ceres::cbrt(x.jet_)); }
  friend NestedDual exp(const NestedDual& x) { return NestedDual(ceres::exp(x.jet_)); }
  friend NestedDual exp2(const NestedDual& x) { return NestedDual(ceres::exp2(x.jet_)); }
  friend NestedDual expm1(const NestedDual& x) { return NestedDual(ceres::expm1(x.jet_)); }
  friend NestedDual log(const NestedDual& x) { return NestedDual(ceres::log(x.jet_)); }
  friend NestedDual log2(const NestedDual& x) { return NestedDual(ceres::log2(x.jet_)); }
  friend NestedDual log10(const NestedDual& x) { return NestedDual(ceres::log10(x.jet_)); }
  friend NestedDual log1p(const NestedDual& x) { return NestedDual(ceres::log1p(x.jet_)); }
  friend NestedDual cos(const NestedDual& x) { return NestedDual(ceres::cos(x.jet_)); }
  friend NestedDual sin(const NestedDual& x) { return NestedDual(ceres::sin(x.jet_)); }
  friend NestedDual tan(const NestedDual& x) { return NestedDual(ceres::tan(x.jet_)); }
  friend NestedDual acos(const NestedDual& x) { return NestedDual(ceres::acos(x.jet_)); }
  friend NestedDual asin(const NestedDual& x) { return NestedDual(ceres::asin(x.jet_)); }
  friend NestedDual atan(const NestedDual& x) { return NestedDual(ceres::atan(x.jet_)); }
  friend NestedDual cosh(const NestedDual& x) { return NestedDual(ceres::cosh(x.jet_)); }
  friend NestedDual sinh(const NestedDual& x) { return NestedDual(ceres::sinh(x.jet_)); }
  friend NestedDual tanh(const NestedDual& x) { return NestedDual(ceres::tanh(x.jet_)); }
  friend NestedDual erf(const NestedDual& x) { return NestedDual(ceres::erf(x.jet_)); }
  friend NestedDual fmax(const NestedDual& x, const NestedDual& y) { return x < y ? y : x; }
  friend NestedDual fmin(const NestedDual& x, const NestedDual& y) { return y < x ? y : x; }
  friend NestedDual atan2(const NestedDual& y, const NestedDual& x) {
    return NestedDual(ceres::atan2(y.jet_, x.jet_));
  }
  friend NestedDual hypot(const NestedDual& x, const NestedDual& y) {
    return NestedDual(ceres::hypot(x.jet_, y.jet_));
  }
  friend NestedDual pow(const NestedDual& x, double y) { return NestedDual(power(x.jet_, y)); }
  friend bool isfinite(const NestedDual& x) { return std::isfinite(x.value()); }
  friend bool isnan(const NestedDual& x) { return std::isnan(x.value()); }

 private:
  /// x^y by the chain rule: Ceres' own takes no exponent in double where Jets nest.
  static Jet power(const Jet& x, double y) {
    const Dual slope = Dual(y) * ceres::pow(x.a, y - 1.0);
    return Jet(ceres::pow(x.a, y), slope * x.v);
  }

  Jet jet_;
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
