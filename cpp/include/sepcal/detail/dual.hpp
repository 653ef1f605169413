// SPDX-License-Identifier: BSD-3-Clause
// A dual number, a value and its N partial derivatives: what flight software differentiates a model
// with. Ceres' Jets do the same on the host, behind a header that brings iostream along.
#pragma once

#include <cmath>
#include <compare>
#include <numbers>
#include <utility>

#include "sepcal/detail/eigen.hpp"
#include "sepcal/detail/lanewise.hpp"

namespace sepcal {

/// T is double, float, or a dual number itself. Values are what T computes, to the last digit;
/// comparisons are of values.
template <class T, int N>
class Dual {
 public:
  using Slopes = Eigen::Matrix<T, N, 1>;

  Dual() = default;
  explicit Dual(T value) : value_(std::move(value)) {}
  /// The variable k at `value`; of the value alone where k is none of N.
  Dual(T value, int k) : value_(std::move(value)) {
    if (k >= 0 && k < N) slopes_[k] = T(1);
  }
  Dual(T value, Slopes slopes) : value_(std::move(value)), slopes_(std::move(slopes)) {}

  const T& value() const { return value_; }
  const T& slope(int k) const { return slopes_[k]; }  // by variable k
  const Slopes& slopes() const { return slopes_; }    // N

  Dual& operator+=(const Dual& y) { return *this = *this + y; }
  Dual& operator-=(const Dual& y) { return *this = *this - y; }
  Dual& operator*=(const Dual& y) { return *this = *this * y; }
  Dual& operator/=(const Dual& y) { return *this = *this / y; }
  Dual& operator+=(const T& y) { return *this = *this + y; }
  Dual& operator-=(const T& y) { return *this = *this - y; }
  Dual& operator*=(const T& y) { return *this = *this * y; }
  Dual& operator/=(const T& y) { return *this = *this / y; }

  friend Dual operator+(const Dual& x) { return x; }
  friend Dual operator-(const Dual& x) { return {-x.value_, -x.slopes_}; }

  friend Dual operator+(const Dual& x, const Dual& y) {
    return {x.value_ + y.value_, x.slopes_ + y.slopes_};
  }
  friend Dual operator-(const Dual& x, const Dual& y) {
    return {x.value_ - y.value_, x.slopes_ - y.slopes_};
  }
  friend Dual operator*(const Dual& x, const Dual& y) {
    return {x.value_ * y.value_, x.value_ * y.slopes_ + x.slopes_ * y.value_};
  }
  friend Dual operator/(const Dual& x, const Dual& y) {
    const T ratio = x.value_ / y.value_;
    return {ratio, (x.slopes_ - ratio * y.slopes_) * (T(1) / y.value_)};
  }

  friend Dual operator+(const Dual& x, const T& y) { return {x.value_ + y, x.slopes_}; }
  friend Dual operator-(const Dual& x, const T& y) { return {x.value_ - y, x.slopes_}; }
  friend Dual operator*(const Dual& x, const T& y) { return {x.value_ * y, x.slopes_ * y}; }
  friend Dual operator/(const Dual& x, const T& y) {
    return {x.value_ / y, x.slopes_ * (T(1) / y)};
  }
  friend Dual operator+(const T& x, const Dual& y) { return y + x; }
  friend Dual operator-(const T& x, const Dual& y) { return {x - y.value_, -y.slopes_}; }
  friend Dual operator*(const T& x, const Dual& y) { return y * x; }
  friend Dual operator/(const T& x, const Dual& y) {
    return {x / y.value_, y.slopes_ * (-x / (y.value_ * y.value_))};
  }

  friend bool operator==(const Dual& x, const Dual& y) { return x.value_ == y.value_; }
  friend bool operator==(const Dual& x, const T& y) { return x.value_ == y; }
  friend auto operator<=>(const Dual& x, const Dual& y) { return x.value_ <=> y.value_; }
  friend auto operator<=>(const Dual& x, const T& y) { return x.value_ <=> y; }

  friend Dual abs(const Dual& x) { return x.value_ < T(0) ? -x : x; }
  friend Dual fmax(const Dual& x, const Dual& y) { return x.value_ < y.value_ ? y : x; }
  friend Dual fmin(const Dual& x, const Dual& y) { return y.value_ < x.value_ ? y : x; }
  friend bool isfinite(const Dual& x) {
    using std::isfinite;
    return isfinite(x.value_);
  }
  friend bool isnan(const Dual& x) {
    using std::isnan;
    return isnan(x.value_);
  }

  friend Dual sqrt(const Dual& x) {
    using std::sqrt;
    const T root = sqrt(x.value_);
    return x.to(root, T(1) / (T(2) * root));
  }
  friend Dual cbrt(const Dual& x) {
    using std::cbrt;
    const T root = cbrt(x.value_);
    return x.to(root, T(1) / (T(3) * root * root));
  }
  friend Dual exp(const Dual& x) {
    using std::exp;
    const T power = exp(x.value_);
    return x.to(power, power);
  }
  friend Dual exp2(const Dual& x) {
    using std::exp2;
    const T power = exp2(x.value_);
    return x.to(power, power * T(Real<T>(std::numbers::ln2)));
  }
  friend Dual expm1(const Dual& x) {
    using std::expm1;
    const T power = expm1(x.value_);
    return x.to(power, power + T(1));
  }
  friend Dual log(const Dual& x) {
    using std::log;
    return x.to(log(x.value_), T(1) / x.value_);
  }
  friend Dual log2(const Dual& x) {
    using std::log2;
    return x.to(log2(x.value_), T(1) / (x.value_ * T(Real<T>(std::numbers::ln2))));
  }
  friend Dual log10(const Dual& x) {
    using std::log10;
    return x.to(log10(x.value_), T(1) / (x.value_ * T(Real<T>(std::numbers::ln10))));
  }
  friend Dual log1p(const Dual& x) {
    using std::log1p;
    return x.to(log1p(x.value_), T(1) / (T(1) + x.value_));
  }
  friend Dual cos(const Dual& x) {
    using std::cos;
    using std::sin;
    return x.to(cos(x.value_), -sin(x.value_));
  }
  friend Dual sin(const Dual& x) {
    using std::cos;
    using std::sin;
    return x.to(sin(x.value_), cos(x.value_));
  }
  friend Dual tan(const Dual& x) {
    using std::tan;
    const T tangent = tan(x.value_);
    return x.to(tangent, T(1) + tangent * tangent);
  }
  friend Dual acos(const Dual& x) {
    using std::acos;
    using std::sqrt;
    return x.to(acos(x.value_), T(-1) / sqrt(T(1) - x.value_ * x.value_));
  }
  friend Dual asin(const Dual& x) {
    using std::asin;
    using std::sqrt;
    return x.to(asin(x.value_), T(1) / sqrt(T(1) - x.value_ * x.value_));
  }
  friend Dual atan(const Dual& x) {
    using std::atan;
    return x.to(atan(x.value_), T(1) / (T(1) + x.value_ * x.value_));
  }
  friend Dual cosh(const Dual& x) {
    using std::cosh;
    using std::sinh;
    return x.to(cosh(x.value_), sinh(x.value_));
  }
  friend Dual sinh(const Dual& x) {
    using std::cosh;
    using std::sinh;
    return x.to(sinh(x.value_), cosh(x.value_));
  }
  friend Dual tanh(const Dual& x) {
    using std::tanh;
    const T tangent = tanh(x.value_);
    return x.to(tangent, T(1) - tangent * tangent);
  }
  friend Dual erf(const Dual& x) {
    using std::erf;
    using std::exp;
    constexpr double two_by_root_pi = 2.0 * std::numbers::inv_sqrtpi;
    return x.to(erf(x.value_), T(Real<T>(two_by_root_pi)) * exp(-x.value_ * x.value_));
  }
  friend Dual atan2(const Dual& y, const Dual& x) {
    using std::atan2;
    const T inverse = T(1) / (x.value_ * x.value_ + y.value_ * y.value_);
    return {atan2(y.value_, x.value_), (x.value_ * y.slopes_ - y.value_ * x.slopes_) * inverse};
  }
  friend Dual hypot(const Dual& x, const Dual& y) {
    using std::hypot;
    const T length = hypot(x.value_, y.value_);
    return {length, x.value_ / length * x.slopes_ + y.value_ / length * y.slopes_};
  }
  /// x to a power that is no variable.
  friend Dual pow(const Dual& x, const Real<T>& power) {
    using std::pow;
    if (power == Real<T>(0)) return Dual(T(Real<T>(1)));
    return x.to(pow(x.value_, power), T(power) * pow(x.value_, power - Real<T>(1)));
  }

 private:
  /// A function's value here and its derivative: the chain rule.
  Dual to(const T& value, const T& derivative) const { return {value, derivative * slopes_}; }

  T value_ = T(0);
  Slopes slopes_ = Slopes::Constant(T(0));
};

template <class T, int N>
struct RealOf<Dual<T, N>> : RealOf<T> {};

}  // namespace sepcal

namespace Eigen {

/// So that matrices of them can be multiplied and inverted.
template <class T, int N>
struct NumTraits<sepcal::Dual<T, N>> : GenericNumTraits<sepcal::Dual<T, N>> {
  using Number = sepcal::Dual<T, N>;
  using Real = Number;
  using NonInteger = Number;
  using Nested = Number;
  using Literal = Number;
  // NOLINTBEGIN(readability-identifier-naming): Eigen's names
  enum { IsComplex = 0, IsInteger = 0, IsSigned = 1, RequireInitialization = 1 };
  // NOLINTEND(readability-identifier-naming)
  static Number epsilon() { return Number(NumTraits<T>::epsilon()); }
  static Number dummy_precision() { return Number(NumTraits<T>::dummy_precision()); }
  static int digits10() { return NumTraits<T>::digits10(); }
};

template <typename BinaryOp, class T, int N>
struct ScalarBinaryOpTraits<sepcal::Dual<T, N>, T, BinaryOp> {
  using ReturnType = sepcal::Dual<T, N>;
};
template <typename BinaryOp, class T, int N>
struct ScalarBinaryOpTraits<T, sepcal::Dual<T, N>, BinaryOp> {
  using ReturnType = sepcal::Dual<T, N>;
};

}  // namespace Eigen
