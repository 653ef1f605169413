// SPDX-License-Identifier: BSD-3-Clause
// The units that a flight log may be in, and their conversion to the one unit that is used inside:
// SI, but microtesla for magnetic fields. Every factor is a ratio of two numbers that are exact by
// definition (The International System of Units, 9th ed., BIPM; 1 lbf = 4.4482216152605 N; of
// mercury and water the conventional columns, NIST SP 811, B.8).
#pragma once

#include <span>
#include <string_view>

namespace sepcal::files {

/// Kinds of physical quantity that a probe's columns have.
enum class UnitKind {
  time,
  angle,
  rate,
  angular_acceleration,
  length,
  speed,
  acceleration,
  mass,
  force,
  pressure,
  field,
  temperature,
  density,
  share,  // of one
  own     // in the unit of a model of the user's own, and in no other
};

/// A unit as CSV headers spell it: "kt" of "vn_kt".
struct Unit {
  std::string_view suffix;
  UnitKind kind;
  double numerator = 1;  // value inside = value * numerator / denominator + offset
  double denominator = 1;
  double offset = 0;

  /// True for the unit used inside, which is taken bit for bit.
  bool is_inside() const { return numerator == denominator && offset == 0; }

  /// `value`, in this unit, in the unit used inside.
  double convert(double value) const {
    if (is_inside()) return value;
    const double scaled = value * numerator / denominator;
    return offset == 0 ? scaled : scaled + offset;
  }
};

/// All units of a kind, the one used inside first; none of `own`.
std::span<const Unit> known_units(UnitKind kind);

/// The unit of `kind` with that suffix ("kt"), or nullptr.
const Unit* find_unit(UnitKind kind, std::string_view suffix);

}  // namespace sepcal::files
