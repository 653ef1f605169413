// SPDX-License-Identifier: BSD-3-Clause
// What quantities and units are called: by sepcal, by people and by the makers of logs (Garmin
// G1000, G3X and G5, Dynon SkyView, IGC, PX4, ArduPilot).
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "flight/files/units.hpp"

namespace sepcal::files {

/// A quantity that is read from logs, by the base name of its columns.
struct KnownQuantity {
  std::string_view name;
  UnitKind kind;
};

/// All that a probe, an aircraft or read_as() reads.
std::span<const KnownQuantity> known_quantities();

/// "GPS_VN (m/s)" as its words, in lower case: gps, vn, m, s. A degree sign is the word deg.
std::vector<std::string> split_words(std::string_view header);

using Words = std::span<const std::string>;

/// "gpsvn", of gps and vn.
std::string join_words(Words words);

/// How far a name is from the quantity's own: 0 for that, in any case and however its words are
/// parted, then the more the less it is meant: a true airspeed comes before an indicated one.
/// Nothing where the words are no name of the quantity. `whose`: words before the name may say
/// whose it is; only those that say no more than that, "gps", "ahrs", but not "setpoint".
std::optional<int> rank_name(std::string_view quantity, Words words, bool whose = true);

/// Whether words spell the unit: "mps", "kts" in one, or "m", "s" for what is per something.
bool spell_unit(Words words, const Unit& unit);

/// What a header says without a doubt.
struct Recognised {
  const Unit* unit = nullptr;
  int rank = 0;
};

/// Of the ways to cut the header into a name of the quantity and a unit that is spelled, the
/// nearest; nothing where there is none.
std::optional<Recognised> recognise(std::string_view header, const KnownQuantity& quantity);

/// Whether the header's name is that of an airspeed for the air at sea level.
bool is_indicated(std::string_view header);

}  // namespace sepcal::files
