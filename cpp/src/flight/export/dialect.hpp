// SPDX-License-Identifier: BSD-3-Clause
// How a header's text differs between C and C++, double and float: names, constants and heads of
// functions. The bodies are the same.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace sepcal::exporting {

class Dialect {
 public:
  /// `single`: it computes in float. `name`: what the header's names begin with, or the namespace:
  /// "sepcal_magnetometer".
  Dialect(bool cpp, bool single, std::string name)
      : cpp_(cpp), single_(single), name_(std::move(name)) {}

  const std::string& name() const { return name_; }
  bool is_cpp() const { return cpp_; }
  bool is_single() const { return single_; }

  std::string own(std::string_view name) const {
    return cpp_ ? std::string(name) : name_ + "_" + std::string(name);
  }
  std::string constant(std::string_view name) const {
    return cpp_ ? "constants::" + std::string(name) : own(name);
  }

  /// "#include", the status, and the namespace's beginning.
  std::string opening() const;
  std::string closing() const;

  /// A table of numbers, `columns` a row, 0: one row alone, and of a single number no table.
  std::string define(std::string_view name, const std::vector<double>& values, std::size_t columns,
                     std::string_view comment) const;

  /// A double, of a header in float too: the compiler computes with it, not the vehicle.
  std::string define_double(std::string_view name, double value, std::string_view comment) const;

  /// The calibration's id and the constants' CRC.
  std::string define_identity(std::string_view id, std::uint32_t crc) const;

  /// A number as a literal that reads back as the same double, or as the nearest float. Throws
  /// Error for one that is none, or beyond what a float holds.
  std::string literal(double value) const;

  /// Statements that were written for double, in the header's precision.
  std::string in_precision(const std::string& code) const;

  /// "static inline int NAME_correct(" with the arguments, and the brace.
  std::string function(std::string_view type, std::string_view name,
                       const std::vector<std::string>& arguments) const;

  std::string_view status_type() const { return cpp_ ? "Status" : "int"; }

 private:
  std::string define_as(std::string_view type, std::string_view name, const std::string& values,
                        std::string_view comment) const;
  std::string row_of(const std::vector<double>& values, std::size_t first, std::size_t last) const;

  bool cpp_;
  bool single_;
  std::string name_;
};

}  // namespace sepcal::exporting
