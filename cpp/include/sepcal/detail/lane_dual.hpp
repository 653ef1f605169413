// SPDX-License-Identifier: BSD-3-Clause
// Dual numbers side by side: a value and its derivatives by N parameters in each lane. ceres::Jet
// of a batch does not mix with plain numbers, as 1.0 + x.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <utility>
#include <xsimd/xsimd.hpp>

#include "sepcal/detail/lane_angles.hpp"
#include "sepcal/detail/lanewise.hpp"

namespace sepcal {

/// What Eigen asks of numbers with lanes besides their types; a product costs so many sums.
template <int product_cost>
struct LaneTraits : Eigen::GenericNumTraits<double> {
  // NOLINTBEGIN(readability-identifier-naming): as Eigen calls them
  enum {
    IsComplex = 0,
    IsInteger = 0,
    IsSigned = 1,
    RequireInitialization = 1,
    ReadCost = 1,
    AddCost = 1,
    MulCost = product_cost
  };
  // NOLINTEND(readability-identifier-naming)
};

template <class Arch, int N>
struct LaneDual {
  using B = xsimd::batch<double, Arch>;

  B a;
  std::array<B, static_cast<std::size_t>(N)> v;

  LaneDual() = default;
  LaneDual(double value) : LaneDual(B(value)) {}           // NOLINT: numbers mix
  LaneDual(int value) : LaneDual(B(double(value))) {}      // NOLINT
  LaneDual(const B& value) : a(value) { v.fill(B(0.0)); }  // NOLINT
  /// The k-th parameter.
  LaneDual(const B& value, int k) : LaneDual(value) { v[static_cast<std::size_t>(k)] = B(1.0); }

  LaneDual& operator+=(const LaneDual& y) { return *this = *this + y; }
  LaneDual& operator-=(const LaneDual& y) { return *this = *this - y; }
  LaneDual& operator*=(const LaneDual& y) { return *this = *this * y; }
  LaneDual& operator/=(const LaneDual& y) { return *this = *this / y; }

  /// f(x) with f' at x.
  static LaneDual chain(const B& f, const B& slope, const LaneDual& x) {
    return each(f, [&](std::size_t i) { return slope * x.v[i]; });
  }

  friend LaneDual operator-(const LaneDual& x) {
    return each(-x.a, [&](std::size_t i) { return -x.v[i]; });
  }
  friend LaneDual operator+(const LaneDual& x, const LaneDual& y) {
    return each(x.a + y.a, [&](std::size_t i) { return x.v[i] + y.v[i]; });
  }
  friend LaneDual operator-(const LaneDual& x, const LaneDual& y) {
    return each(x.a - y.a, [&](std::size_t i) { return x.v[i] - y.v[i]; });
  }
  friend LaneDual operator*(const LaneDual& x, const LaneDual& y) {
    return each(x.a * y.a, [&](std::size_t i) { return xsimd::fma(x.a, y.v[i], x.v[i] * y.a); });
  }
  friend LaneDual operator/(const LaneDual& x, const LaneDual& y) {
    const B inverse = B(1.0) / y.a;
    const B ratio = x.a * inverse;
    return each(ratio, [&](std::size_t i) { return xsimd::fnma(ratio, y.v[i], x.v[i]) * inverse; });
  }

  friend LaneDual operator+(const LaneDual& x, const B& s) { return {x.a + s, x.v}; }
  friend LaneDual operator+(const B& s, const LaneDual& x) { return x + s; }
  friend LaneDual operator-(const LaneDual& x, const B& s) { return {x.a - s, x.v}; }
  friend LaneDual operator-(const B& s, const LaneDual& x) { return -x + s; }
  friend LaneDual operator*(const LaneDual& x, const B& s) { return chain(x.a * s, s, x); }
  friend LaneDual operator*(const B& s, const LaneDual& x) { return x * s; }
  friend LaneDual operator/(const LaneDual& x, const B& s) { return x * (B(1.0) / s); }
  friend LaneDual operator/(const B& s, const LaneDual& x) { return LaneDual(s) / x; }
  friend LaneDual operator+(const LaneDual& x, double s) { return x + B(s); }
  friend LaneDual operator+(double s, const LaneDual& x) { return x + B(s); }
  friend LaneDual operator-(const LaneDual& x, double s) { return x - B(s); }
  friend LaneDual operator-(double s, const LaneDual& x) { return B(s) - x; }
  friend LaneDual operator*(const LaneDual& x, double s) { return x * B(s); }
  friend LaneDual operator*(double s, const LaneDual& x) { return x * B(s); }
  friend LaneDual operator/(const LaneDual& x, double s) { return x * B(1.0 / s); }
  friend LaneDual operator/(double s, const LaneDual& x) { return LaneDual(s) / x; }

  friend auto operator<(const LaneDual& x, double s) { return x.a < B(s); }
  friend auto operator>(const LaneDual& x, double s) { return x.a > B(s); }

  friend LaneDual sin(const LaneDual& x) {
    const auto [cosine, sine] = lanes::cos_sin(x.a);
    return chain(sine, cosine, x);
  }
  friend LaneDual cos(const LaneDual& x) {
    const auto [cosine, sine] = lanes::cos_sin(x.a);
    return chain(cosine, -sine, x);
  }
  friend LaneDual exp(const LaneDual& x) {
    const B value = xsimd::exp(x.a);
    return chain(value, value, x);
  }
  friend LaneDual sqrt(const LaneDual& x) {
    const B root = xsimd::sqrt(x.a);
    return chain(root, B(0.5) / root, x);
  }

 private:
  LaneDual(const B& value, const std::array<B, static_cast<std::size_t>(N)>& slopes)
      : a(value), v(slopes) {}

  template <class Slope>
  static LaneDual each(const B& value, const Slope& slope) {
    LaneDual result;
    result.a = value;
    for (std::size_t i = 0; i < static_cast<std::size_t>(N); ++i) result.v[i] = slope(i);
    return result;
  }
};

template <class Arch, int N>
struct Lanewise<LaneDual<Arch, N>> {
  using T = LaneDual<Arch, N>;
  static T where(const xsimd::batch_bool<double, Arch>& condition, const T& yes, const T& no) {
    T chosen;
    chosen.a = xsimd::select(condition, yes.a, no.a);
    for (std::size_t i = 0; i < static_cast<std::size_t>(N); ++i) {
      chosen.v[i] = xsimd::select(condition, yes.v[i], no.v[i]);
    }
    return chosen;
  }
  static std::pair<T, T> cos_sin(const T& x) {
    const auto [cosine, sine] = lanes::cos_sin(x.a);
    return {T::chain(cosine, -sine, x), T::chain(sine, cosine, x)};
  }
  static bool vanishes(const T& /*x*/) { return false; }
};

}  // namespace sepcal

namespace Eigen {

template <class Arch, int N>
struct NumTraits<sepcal::LaneDual<Arch, N>> : sepcal::LaneTraits<3> {
  using Real = sepcal::LaneDual<Arch, N>;
  using NonInteger = Real;
  using Nested = Real;
  using Literal = Real;
};

template <class Arch, int N, class Operation>
struct ScalarBinaryOpTraits<sepcal::LaneDual<Arch, N>, xsimd::batch<double, Arch>, Operation> {
  using ReturnType = sepcal::LaneDual<Arch, N>;
};

template <class Arch, int N, class Operation>
struct ScalarBinaryOpTraits<xsimd::batch<double, Arch>, sepcal::LaneDual<Arch, N>, Operation> {
  using ReturnType = sepcal::LaneDual<Arch, N>;
};

template <class Arch, int N, class Operation>
struct ScalarBinaryOpTraits<sepcal::LaneDual<Arch, N>, double, Operation> {
  using ReturnType = sepcal::LaneDual<Arch, N>;
};

template <class Arch, int N, class Operation>
struct ScalarBinaryOpTraits<double, sepcal::LaneDual<Arch, N>, Operation> {
  using ReturnType = sepcal::LaneDual<Arch, N>;
};

}  // namespace Eigen
