// SPDX-License-Identifier: BSD-3-Clause
// Effects `port[driver]` and `port[driver^k]` for composition at compile time: a coefficient s
// times phi = (d - centre)^k - mean of the column `driver`. At run time make_effect() builds the
// same by name.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <string_view>

#include "sepcal/static_composition.hpp"

namespace sepcal::effects {

/// A text as a template's argument.
template <std::size_t N>
struct Text {
  std::array<char, N> characters{};
  consteval Text(const char (&text)[N]) { std::copy_n(text, N, characters.begin()); }  // NOLINT
  constexpr std::string_view view() const { return {characters.data(), N - 1}; }
};

/// Texts one after the other.
template <Text... parts>
struct Joined {
  static constexpr auto storage = [] {
    std::array<char, (parts.view().size() + ... + 0)> all{};
    std::size_t next = 0;
    (void(std::ranges::for_each(parts.view(), [&](char c) { all[next++] = c; })), ...);
    return all;
  }();
  static constexpr std::string_view view{storage.data(), storage.size()};
};

/// "wind[altitude_m]." or "airspeed_scale[alpha^2]." and the component.
template <Text port, Text driver, int power, Text component>
constexpr std::string_view parameter_name() {
  static_assert(power >= 1 && power <= 9);
  constexpr char digit[2] = {static_cast<char>('0' + power), '\0'};
  if constexpr (power == 1) {
    return Joined<port, "[", driver, "].", component>::view;
  } else {
    return Joined<port, "[", driver, "^", Text(digit), "].", component>::view;
  }
}

/// (d - centre)^power - mean
template <int power, class T>
T power_of(const T& d, double centre, double mean = 0.0) {
  const auto from = static_cast<Real<T>>(centre);
  T value = d - from;
  for (int i = 1; i < power; ++i) value = value * (d - from);
  return value - static_cast<Real<T>>(mean);
}

/// One coefficient's name, and the model's linear parameter that it adds to.
template <Text name_, Text target_>
struct Component {
  static constexpr auto name = name_;
  static constexpr std::string_view target = target_.view();
};

/// Linear parameters that follow a driver: columns phi A_target.
template <Text port, Text driver, int power, Text unit, class... Components>
struct Follows {
  static constexpr std::array inputs{Quantity{driver.view(), ""}};
  static constexpr std::array linear{
      Quantity{parameter_name<port, driver, power, Components::name>(), unit.view()}...};
  static constexpr std::array<Quantity, 0> nonlinear{};
  static constexpr bool dual_inputs = true;
  static constexpr std::array targets{Components::target...};

  double centre = 0.0;
  double mean = 0.0;

  template <class U, class X>
  X factor(const Vec<U, 1>& u, const Vec<X, 0>& /*xi2*/) const {
    return X(power_of<power>(u[0], centre, mean));
  }
};

/// An input that follows a driver: u + s phi.
template <Text port, Text driver, int power, Text unit>
struct Shifts {
  static constexpr int corrected = 1;
  static constexpr std::array inputs{sepcal::port(port.view(), unit.view()),
                                     Quantity{driver.view(), ""}};
  static constexpr std::array nonlinear{
      Quantity{parameter_name<port, driver, power, "s">(), unit.view()}};

  double centre = 0.0;
  double mean = 0.0;

  template <class T>
  Vec<T, 1> correct(const Vec<T, 2>& u, const Vec<T, 1>& xi2) const {
    return Vec<T, 1>(u[0] + xi2[0] * power_of<power>(u[1], centre, mean));
  }
};

/// An input that is off by a constant: u + s.
template <Text port, Text unit>
struct ShiftsAlways {
  static constexpr int corrected = 1;
  static constexpr std::array inputs{sepcal::port(port.view(), unit.view())};
  static constexpr std::array nonlinear{Quantity{Joined<port, ".s">::view, unit.view()}};

  template <class T>
  Vec<T, 1> correct(const Vec<T, 1>& u, const Vec<T, 1>& xi2) const {
    return u + xi2;
  }
};

/// Several inputs that follow a driver, each with a coefficient of its own: u_i + sign s_i phi.
template <Text name, Text driver, int power, Text unit, int sign, class... Components>
struct ShiftsEach {
  static constexpr int corrected = static_cast<int>(sizeof...(Components));
  static constexpr std::array inputs{sepcal::port(Components::target, unit.view())...,
                                     Quantity{driver.view(), ""}};
  static constexpr std::array nonlinear{
      Quantity{parameter_name<name, driver, power, Components::name>(), unit.view()}...};

  double centre = 0.0;
  double mean = 0.0;

  template <class T>
  Vec<T, corrected> correct(const Vec<T, corrected + 1>& u, const Vec<T, corrected>& xi2) const {
    const T phi = power_of<power>(u[corrected], centre, mean);
    return u.template head<corrected>() + Real<T>(sign) * phi * xi2;
  }
};

}  // namespace sepcal::effects
