// SPDX-License-Identifier: BSD-3-Clause
// A named physical quantity: the element of a model's four tables. Everything that people read or
// write (CSV headers, report labels, keys of bounds, Python names) comes from these tables.
#pragma once

#include <limits>
#include <string>
#include <string_view>
#include <vector>

namespace sepcal {

inline constexpr double infinity = std::numeric_limits<double>::infinity();
inline constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

struct Interval {
  double lower = -infinity;
  double upper = infinity;
};

/// Name and unit of an input, an output or a parameter, as a model declares it at compile time.
/// Parameters may carry the bounds that apply when the caller gives none, in the same unit.
struct Quantity {
  std::string_view name;
  std::string_view unit;
  double lower = -infinity;
  double upper = infinity;
  double absent = not_a_number;  // of an input: its value where a record has no such column
};

/// An input that is zero unless an effect drives it: a place where a model can be corrected.
constexpr Quantity port(std::string_view name, std::string_view unit) {
  return {name, unit, -infinity, infinity, 0.0};
}

/// The same at run time, when names may be composed ("wind[altitude_m].n").
struct Variable {
  std::string name;
  std::string unit;
  double lower = -infinity;
  double upper = infinity;
  double absent = not_a_number;

  Variable(std::string name_, std::string unit_, double lower_ = -infinity,
           double upper_ = infinity, double absent_ = not_a_number)
      : name(std::move(name_)),
        unit(std::move(unit_)),
        lower(lower_),
        upper(upper_),
        absent(absent_) {}
  explicit Variable(const Quantity& quantity)
      : Variable(std::string(quantity.name), std::string(quantity.unit), quantity.lower,
                 quantity.upper, quantity.absent) {}
};

/// The four tables of a model: z = A(u, xi2) xi1 + b(u, xi2) + v.
struct Tables {
  std::vector<Variable> inputs;     // u, n_u of them
  std::vector<Variable> outputs;    // z, n_z
  std::vector<Variable> linear;     // xi1, n_1
  std::vector<Variable> nonlinear;  // xi2, n_2

  int n_u() const { return static_cast<int>(inputs.size()); }
  int n_z() const { return static_cast<int>(outputs.size()); }
  int n_1() const { return static_cast<int>(linear.size()); }
  int n_2() const { return static_cast<int>(nonlinear.size()); }

  /// Linear parameters first, then nonlinear: the order of every estimate and covariance.
  std::vector<Variable> parameters() const;

  /// Throws Error where a parameter's, input's or output's name is empty or used twice.
  void check_names() const;
};

}  // namespace sepcal
