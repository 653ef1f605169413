// SPDX-License-Identifier: BSD-3-Clause
// A number that counts the operations done on it, to be put through a model's template.
#pragma once

#include <Eigen/Core>
#include <utility>

#include "sepcal/detail/lanewise.hpp"

namespace benchmark {

/// Additions, multiplications and divisions count one each, a sine with its cosine as many as
/// its vectorised evaluation has: five to reduce the argument in three parts, two polynomials in
/// its square of six coefficients each, and what puts them together.
struct Counted {
  static constexpr long sine_with_cosine = 36;
  static inline long operations = 0;

  double value = 0.0;

  Counted() = default;
  Counted(double number) : value(number) {}  // NOLINT: as numbers do

  Counted& operator+=(const Counted& x) { return count(value + x.value); }
  Counted& operator-=(const Counted& x) { return count(value - x.value); }
  Counted& operator*=(const Counted& x) { return count(value * x.value); }
  Counted& operator/=(const Counted& x) { return count(value / x.value); }
  Counted operator-() const { return {-value}; }

  friend Counted operator+(Counted x, const Counted& y) { return x += y; }
  friend Counted operator-(Counted x, const Counted& y) { return x -= y; }
  friend Counted operator*(Counted x, const Counted& y) { return x *= y; }
  friend Counted operator/(Counted x, const Counted& y) { return x /= y; }

 private:
  Counted& count(double result) {
    ++operations;
    value = result;
    return *this;
  }
};

}  // namespace benchmark

template <>
struct Eigen::NumTraits<benchmark::Counted> : Eigen::NumTraits<double> {
  using Real = benchmark::Counted;
  using NonInteger = Real;
  using Nested = Real;
};

template <class Operation>
struct Eigen::ScalarBinaryOpTraits<benchmark::Counted, double, Operation> {
  using ReturnType = benchmark::Counted;
};

template <class Operation>
struct Eigen::ScalarBinaryOpTraits<double, benchmark::Counted, Operation> {
  using ReturnType = benchmark::Counted;
};

template <>
struct sepcal::Lanewise<benchmark::Counted> {
  static std::pair<benchmark::Counted, benchmark::Counted> cos_sin(const benchmark::Counted& x) {
    benchmark::Counted::operations += benchmark::Counted::sine_with_cosine;
    return {std::cos(x.value), std::sin(x.value)};
  }
};
