// SPDX-License-Identifier: BSD-3-Clause
// How a quantity's column may be headed, and which header of a log comes near: "Roll_Deg" for
// roll_deg.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "flight/files/units.hpp"
#include "sepcal/error.hpp"
#include "sepcal/flight/flight.hpp"

namespace sepcal::files {

/// The column of flights that were joined: which of them a row is of, from 0 on. No effect can be
/// driven by such a name.
inline constexpr const char* flight_number = "flight number";

/// The unit in which a header says that it logs the quantity: the one of `kind` that its suffix
/// names, or `bare` where it is the quantity's name alone or ends with its suffix (nullptr: there
/// is none such). nullptr where the header is no such quantity's, or in a unit that is not known.
const Unit* unit_in(std::string_view header, std::string_view quantity, UnitKind kind,
                    const Unit* bare = nullptr);

/// Every header that `quantity` is read from, the unit used inside first: roll_rad, roll_deg; the
/// name alone, where `bare` is its unit, last.
std::vector<std::string> accepted_headers(std::string_view quantity, UnitKind kind,
                                          const Unit* bare = nullptr);

/// The name of a column with the unit as headers have it: "ax_cal_mps2"; of a number without a
/// dimension and of a coefficient by radians, Cm_alpha, the name alone.
std::string header_of(const std::string& name, const std::string& unit);

/// A quantity as a flight has it.
struct LoggedQuantity {
  const Flight::Column* column = nullptr;
  const Unit* unit = nullptr;

  /// In the unit used inside.
  double at(std::size_t row) const { return unit->convert(column->values[row]); }

  /// A value a row, in the unit used inside.
  std::vector<double> values() const;
};

/// The flight's first column under one of these headers, or, of a quantity that may be named alone,
/// that the log has under one; nothing where there is none.
std::optional<LoggedQuantity> find_quantity(const Flight& flight, std::string_view quantity,
                                            UnitKind kind, const Unit* bare = nullptr);

/// Its values(); empty where there is none.
std::vector<double> read_quantity(const Flight& flight, std::string_view quantity, UnitKind kind);

/// Whether angles under a header in degrees are in radians: within a turn of 2 pi, and jumping by
/// one from row to row, or all round it.
bool turns_over_in_radians(std::span<const double> degrees);

/// "roll_deg='Roll, left [deg]'", as the option map takes it.
std::string map_pair(std::string_view accepted, std::string_view header);

/// "; did you mean 'rol_deg'? map roll_deg=rol_deg reads it so": the one of `others`, a log's
/// headers without the quantities found, that differs from an accepted one in case and punctuation
/// or by a slip of a letter or two in the quantity, or is what others write: "GPS_VN (m/s)", "Mag X
/// [nT]". Of several that are as near: which option decides. Where the quantity stands there with
/// another unit or none: "; 'Airspeed' says no unit that is known ...". Empty where there is none.
OptionError::Message ask_for_near_miss(std::string_view quantity, UnitKind kind,
                                       std::span<const std::string> others);

/// A column of a log and the header under which --map reads it.
struct MappedColumn {
  std::string accepted;  // "vn_mps"
  std::string header;    // "GPS_N"
  UnitKind kind = UnitKind::own;
  bool says_unit = false;  // else the first of its kind stands there
};

/// The one of `others` that ask_for_near_miss() maps; nothing where there is none, or several.
std::optional<MappedColumn> find_near_column(std::string_view quantity, UnitKind kind,
                                             std::span<const std::string> others);

/// The unit of `kind` in which the values under a log's own header are most likely: times by their
/// step, angles by their size, fields by the Earth's; else the one used inside.
const Unit& likely_unit(const Flight& flight, std::string_view logged, UnitKind kind);

/// "; no unit that is known is said by 'VN', 'VE': map vn_mps=VN,ve_mps=VE reads them so; known
/// too: kt". One option for all of them; no header may hold what parts its pairs. One alone is
/// asked for as ask_for_near_miss() does.
OptionError::Message ask_for_columns(std::span<const MappedColumn> columns);

/// One message of what stands before a hint, the hint and what follows it.
OptionError::Message around(std::string before, OptionError::Message hint, std::string after);

/// "column 'roll_rad' is missing (roll_deg would do as well)".
std::string say_missing(std::string_view quantity, UnitKind kind, const Unit* bare = nullptr);

/// The same, and ask_for_near_miss().
OptionError::Message describe_missing(std::string_view quantity, UnitKind kind,
                                      std::span<const std::string> others,
                                      const Unit* bare = nullptr);

}  // namespace sepcal::files
