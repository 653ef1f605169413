// SPDX-License-Identifier: BSD-3-Clause
// How a header's text differs between C and C++: names, constants and heads of functions. The
// bodies are the same.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace sepcal::exporting {

class Dialect {
 public:
  /// `name`: what the header's names begin with, or the namespace: "sepcal_magnetometer".
  Dialect(bool cpp, std::string name) : cpp_(cpp), name_(std::move(name)) {}

  const std::string& name() const { return name_; }
  bool is_cpp() const { return cpp_; }

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

  /// "static inline int NAME_correct(" with the arguments, and the brace.
  std::string function(std::string_view type, std::string_view name,
                       const std::vector<std::string>& arguments) const;

  std::string_view status_type() const { return cpp_ ? "Status" : "int"; }

 private:
  bool cpp_;
  std::string name_;
};

/// A number as a literal that reads back as the same double. Throws Error for one that is none.
std::string literal(double value);

}  // namespace sepcal::exporting
