// SPDX-License-Identifier: BSD-3-Clause
// A calibration's correction as statements and constants: what its effects add to each port, by
// drivers that a vehicle has on board. C and C++ read the same.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "flight/export/dialect.hpp"
#include "sepcal/detail/quantity.hpp"
#include "sepcal/flight/calibration.hpp"

namespace sepcal::exporting {

/// An argument of the correction beside the readings.
struct Driver {
  std::string channel;             // by its name in a record: "current_a", "q"
  std::string argument;            // "q_radps"
  std::string comment;             // "rad/s"; "as it was logged" of a column
  bool is_state = false;           // a quantity in the unit used inside, not a column
  std::vector<double> trial = {};  // three values for the self-test
  double origin = 0.0;             // that the caller takes away before it becomes a float
  std::string known = {};          // KnownChannel::argument, where it is one
};

/// What an effect follows, as far as the fit saw it.
struct Guard {
  std::string channel;     // "current_a", "alpha"
  std::string expression;  // of the channel less `origin`, in the function's body
  double origin = 0.0;
  Interval range = {};       // of the channel
  bool is_computed = false;  // of several readings, so that it rounds
};

struct Constant {
  std::string name;
  std::vector<double> values;
  std::size_t columns = 0;
  std::string comment;
};

struct Correction {
  std::vector<Driver> drivers;
  std::vector<Guard> guards;
  std::vector<std::string> unguarded;  // arguments, and why, in words
  std::vector<Constant> constants;
  std::vector<std::string> statements;           // "const double x_1 = ...;"
  std::map<std::string, std::string> shares;     // by "port.component": a sum, as an expression
  std::vector<std::string> left_to_others = {};  // effects on the reference or the wind
  bool is_cubic = false;                         // m_i + d_i h_i^3 + c_i h_i^2
  bool has_splines = false;

  /// " + " and the sum; empty where nothing acts there.
  std::string added(const std::string& port_component) const;
  bool has(const std::string& port_component) const { return shares.contains(port_component); }
};

/// Throws Error that names the first effect which can't be followed row by row on board.
Correction describe_correction(const Calibration& calibration, const Dialect& dialect);

}  // namespace sepcal::exporting
