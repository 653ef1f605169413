// SPDX-License-Identifier: BSD-3-Clause
// What a model asks of its numbers besides arithmetic, so that they may be several side by side.
#pragma once

#include <cmath>
#include <concepts>
#include <utility>

namespace sepcal {

/// The plain number that a number is made of: float, or double. Constants of a model, and what it
/// holds, are brought to it: Real<U>(2.0) * u is then of one kind, whatever U.
template <class T>
struct RealOf {
  using Type = double;
};
template <>
struct RealOf<float> {
  using Type = float;
};
template <class T>
using Real = RealOf<T>::Type;

/// Of numbers of one kind; specialised where they have lanes (sepcal/lanes.hpp).
template <class T>
struct Lanewise {
  static T where(bool condition, const T& yes, const T& no) { return condition ? yes : no; }
  static std::pair<T, T> cos_sin(const T& x) {
    using std::cos;
    using std::sin;
    return {cos(x), sin(x)};
  }
  /// Of a dual number never: it may have a derivative.
  static bool vanishes(const T& x) {
    if constexpr (std::floating_point<T>) return x == T(0);
    return false;
  }
};

/// `yes` where the condition holds, else `no`: each lane by itself.
template <class Condition, class T>
T where(const Condition& condition, const T& yes, const T& no) {
  return Lanewise<T>::where(condition, yes, no);
}

/// Whether x is zero, in every lane, and has no derivative: what it adds may be left out.
template <class T>
bool vanishes(const T& x) {
  return Lanewise<T>::vanishes(x);
}

/// [cos x, sin x].
template <class T>
std::pair<T, T> cos_sin(const T& x) {
  return Lanewise<T>::cos_sin(x);
}

}  // namespace sepcal
