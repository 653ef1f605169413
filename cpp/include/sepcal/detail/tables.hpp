// SPDX-License-Identifier: BSD-3-Clause
// A model's four tables at run time, z = A(u, xi2) xi1 + b(u, xi2) + v, when names may be composed
// ("wind[altitude_m].n").
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "sepcal/detail/quantity.hpp"

namespace sepcal {

/// A Quantity whose name is made at run time.
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

  /// Of all outputs; empty where they have several.
  std::string output_unit() const;

  /// Throws Error where a parameter's, input's or output's name is empty or used twice.
  void check_names() const;
};

}  // namespace sepcal
