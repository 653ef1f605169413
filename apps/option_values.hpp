// SPDX-License-Identifier: BSD-3-Clause
// What stands behind an option, from its text to a value. All throw with the option's name and the
// form that it should have.
#pragma once

#include <CLI/App.hpp>
#include <array>
#include <concepts>
#include <cstdint>
#include <limits>
#include <map>
#include <string>

#include "flight/schema/typed_options.hpp"
#include "sepcal/detail/band.hpp"

namespace sepcal::app {

using schema::parse_assignment;
using schema::parse_value;
using schema::split;

/// "X,Y,Z": exactly three finite numbers. Throws Error with the example.
std::array<double, 3> parse_triple(const std::string& option, const std::string& text,
                                   const std::string& example);

/// The same, or the four numbers of a quaternion w,x,y,z from the sensor's axes to the body's, as
/// roll, pitch and yaw [deg]. Throws Error for one that is not of length one too.
std::array<double, 3> parse_turn(const std::string& option, const std::string& text,
                                 const std::string& example);

/// --band "0.1:2"; of nothing what a rigid aircraft does. Throws Error for another form, and a band
/// that is none.
Band parse_band(const std::string& text);

/// Digits alone, at most `highest`. Throws CLI::ValidationError.
std::uint64_t parse_whole_number(const std::string& option, const std::string& text,
                                 std::uint64_t highest);

/// An option that takes a whole number from 0 to `highest`; CLI11's own would wrap "-1" round.
template <std::integral T>
CLI::Option* add_whole_number(CLI::App& verb, const std::string& name, T& value,
                              const std::string& description,
                              T highest = std::numeric_limits<T>::max()) {
  const auto read = [&value, name, highest](const std::string& text) {
    value = static_cast<T>(parse_whole_number(name, text, static_cast<std::uint64_t>(highest)));
  };
  return verb.add_option_function<std::string>(name, read, description)
      ->type_name("N")
      ->default_str(std::to_string(value));
}

/// An option NAME=SD, which may be repeated.
void add_deviations(CLI::App& verb, const std::string& name, std::vector<std::string>& texts,
                    const std::string& description);

/// What such an option was given. Throws Error for what is no pair, and for a name twice.
std::map<std::string, double> parse_deviations(const std::string& option,
                                               const std::vector<std::string>& texts);

/// An option or argument that names a file; an empty name (an unset variable of the shell) is
/// refused. "-" is standard output for --output, and standard input for an argument.
CLI::Option* add_file(CLI::App& verb, const std::string& name, std::string& file,
                      const std::string& description);

/// The argument MORE: other logs, which by their ending are told from what may follow.
void add_more_flights(CLI::App& verb, std::vector<std::string>& files, const std::string& what);

/// The option --reference: an independent sensor's columns.
void add_references(CLI::App& verb, std::vector<std::string>& references);

}  // namespace sepcal::app
