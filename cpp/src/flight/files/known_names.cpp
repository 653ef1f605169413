// SPDX-License-Identifier: BSD-3-Clause
#include "flight/files/known_names.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <numeric>

namespace sepcal::files {
namespace {

using enum UnitKind;

constexpr std::array quantities{
    KnownQuantity{"time", time},
    KnownQuantity{"gps_tow", time},
    KnownQuantity{"roll", angle},
    KnownQuantity{"pitch", angle},
    KnownQuantity{"yaw", angle},
    KnownQuantity{"mag_heading", angle},
    KnownQuantity{"p", rate},
    KnownQuantity{"q", rate},
    KnownQuantity{"r", rate},
    KnownQuantity{"vn", speed},
    KnownQuantity{"ve", speed},
    KnownQuantity{"vd", speed},
    KnownQuantity{"vu", speed},
    KnownQuantity{"gs", speed},
    KnownQuantity{"track", angle},
    KnownQuantity{"mag_track", angle},
    KnownQuantity{"magvar", angle},
    KnownQuantity{"lat", angle},
    KnownQuantity{"lon", angle},
    KnownQuantity{"altitude", length},
    KnownQuantity{"airspeed", speed},
    KnownQuantity{"pt", pressure},
    KnownQuantity{"ps", pressure},
    KnownQuantity{"dp", pressure},
    KnownQuantity{"dpa", pressure},
    KnownQuantity{"dpb", pressure},
    KnownQuantity{"qbar", pressure},
    KnownQuantity{"rho", density},
    KnownQuantity{"temp", temperature},
    KnownQuantity{"alpha", angle},
    KnownQuantity{"beta", angle},
    KnownQuantity{"mx", field},
    KnownQuantity{"my", field},
    KnownQuantity{"mz", field},
    KnownQuantity{"hx", field},
    KnownQuantity{"hy", field},
    KnownQuantity{"hz", field},
    KnownQuantity{"bn", field},
    KnownQuantity{"be", field},
    KnownQuantity{"bd", field},
    KnownQuantity{"field_strength", field},
    KnownQuantity{"ax", acceleration},
    KnownQuantity{"ay", acceleration},
    KnownQuantity{"az", acceleration},
    KnownQuantity{"elevator", angle},
    KnownQuantity{"aileron", angle},
    KnownQuantity{"rudder", angle},
    KnownQuantity{"throttle", share},
    KnownQuantity{"thrust", force},
    KnownQuantity{"mass", mass},
    KnownQuantity{"pdot", angular_acceleration},
    KnownQuantity{"qdot", angular_acceleration},
    KnownQuantity{"rdot", angular_acceleration},
};

/// What a quantity or a unit is called elsewhere, without what parts the words.
struct OtherName {
  std::string_view ours;
  std::string_view name;
  int rank = 1;
};

constexpr int asked_about = 9;  // a rank of names that are not taken: magnetic is not true

constexpr std::array other_quantities{
    OtherName{"time", "t"},
    OtherName{"time", "timestamp"},
    OtherName{"time", "elapsedtime"},
    OtherName{"time", "sessiontime"},  // Dynon
    OtherName{"time", "timeus", 2},    // ArduPilot's TimeUS says its unit
    OtherName{"gps_tow", "tow"},
    OtherName{"gps_tow", "timeofweek"},
    OtherName{"gps_tow", "itow"},
    OtherName{"roll", "phi"},
    OtherName{"roll", "bank"},
    OtherName{"roll", "bankangle"},
    OtherName{"roll", "rollangle"},
    OtherName{"pitch", "theta"},
    OtherName{"pitch", "pitchangle"},
    OtherName{"yaw", "psi"},
    OtherName{"yaw", "yawangle"},
    OtherName{"yaw", "trueheading", 1},
    OtherName{"yaw", "headingtrue", 1},
    OtherName{"yaw", "hdt", 1},
    OtherName{"yaw", "heading", 2},
    OtherName{"yaw", "hdg", asked_about},
    OtherName{"yaw", "magneticheading", asked_about},
    OtherName{"mag_heading", "magneticheading"},
    OtherName{"mag_heading", "headingmagnetic"},
    OtherName{"mag_heading", "maghdg"},
    OtherName{"mag_heading", "hdg"},  // Garmin's
    OtherName{"mag_heading", "hdm"},
    OtherName{"p", "rollrate"},
    OtherName{"q", "pitchrate"},
    OtherName{"r", "yawrate"},
    OtherName{"p", "gyrox"},
    OtherName{"q", "gyroy"},
    OtherName{"r", "gyroz"},
    OtherName{"p", "rollspeed"},
    OtherName{"q", "pitchspeed"},
    OtherName{"r", "yawspeed"},
    OtherName{"vn", "veln"},
    OtherName{"vn", "vnorth"},
    OtherName{"vn", "velnorth"},
    OtherName{"vn", "northvel"},
    OtherName{"vn", "velocityn"},
    OtherName{"vn", "velocitynorth"},
    OtherName{"vn", "northvelocity"},
    OtherName{"vn", "gpsveln"},  // Garmin G3X
    OtherName{"ve", "gpsvele"},
    OtherName{"vu", "gpsvelu"},
    OtherName{"vn", "speednorth"},  // FlightGear
    OtherName{"ve", "speedeast"},
    OtherName{"vd", "speeddown"},
    OtherName{"vn", "northspeed"},
    OtherName{"ve", "eastspeed"},
    OtherName{"vd", "downspeed"},
    OtherName{"vn", "gpsn", asked_about},  // a position, maybe
    OtherName{"ve", "gpse", asked_about},
    OtherName{"vd", "gpsd", asked_about},
    OtherName{"ve", "vele"},
    OtherName{"ve", "veast"},
    OtherName{"ve", "veleast"},
    OtherName{"ve", "eastvel"},
    OtherName{"ve", "velocitye"},
    OtherName{"ve", "velocityeast"},
    OtherName{"ve", "eastvelocity"},
    OtherName{"vd", "veld"},
    OtherName{"vd", "vdown"},
    OtherName{"vd", "veldown"},
    OtherName{"vd", "downvel"},
    OtherName{"vd", "velocityd"},
    OtherName{"vd", "velocitydown"},
    OtherName{"vd", "downvelocity"},
    OtherName{"vu", "vs"},
    OtherName{"vu", "vspd"},  // Garmin
    OtherName{"vu", "vup"},
    OtherName{"vu", "velu"},
    OtherName{"vu", "velup"},
    OtherName{"vu", "velocityu"},
    OtherName{"vu", "velocityup"},
    OtherName{"vu", "climbrate"},
    OtherName{"vu", "verticalspeed"},
    OtherName{"vu", "verticalvelocity"},
    OtherName{"vu", "vario", 2},
    OtherName{"gs", "gndspd"},  // Garmin
    OtherName{"gs", "groundspeed"},
    OtherName{"gs", "gndspeed"},
    OtherName{"gs", "gspd"},  // EdgeTX
    OtherName{"gs", "sog"},
    OtherName{"gs", "gsp"},  // IGC
    OtherName{"gs", "gpsspeed"},
    OtherName{"gs", "gpsspd"},
    OtherName{"gs", "gnssspeed"},
    OtherName{"track", "trk"},  // Garmin
    OtherName{"track", "groundtrack"},
    OtherName{"track", "truetrack"},
    OtherName{"track", "tracktrue"},
    OtherName{"track", "trt"},  // IGC
    OtherName{"track", "cog"},
    OtherName{"track", "course", 2},
    OtherName{"track", "groundcourse"},
    OtherName{"track", "gcrs"},  // ArduPilot
    OtherName{"track", "courseoverground"},
    OtherName{"mag_track", "magnetictrack"},
    OtherName{"mag_track", "trackmagnetic"},
    OtherName{"mag_track", "magtrk"},
    OtherName{"mag_track", "trm"},  // IGC
    OtherName{"magvar", "magneticvariation"},
    OtherName{"magvar", "magneticdeclination"},
    OtherName{"magvar", "declination"},
    OtherName{"magvar", "variation"},
    OtherName{"lat", "latitude"},
    OtherName{"lon", "longitude"},
    OtherName{"lon", "lng"},
    OtherName{"lon", "long"},
    OtherName{"altitude", "altmsl"},  // Garmin
    OtherName{"altitude", "gpsaltitude"},
    OtherName{"altitude", "gnssaltitude"},
    OtherName{"altitude", "gnssalt"},
    OtherName{"altitude", "alt"},
    OtherName{"altitude", "gpsalt"},
    OtherName{"altitude", "altgps", 2},
    OtherName{"altitude", "altp", 3},
    OtherName{"altitude", "altb", 3},
    OtherName{"altitude", "altind", 3},
    OtherName{"altitude", "pressurealtitude", 3},
    OtherName{"altitude", "pressurealt", 3},
    OtherName{"airspeed", "trueairspeed"},
    OtherName{"airspeed", "tas"},
    OtherName{"airspeed", "airspd"},
    OtherName{"airspeed", "aspd"},
    OtherName{"airspeed", "arspd"},
    OtherName{"airspeed", "calibratedairspeed", 2},
    OtherName{"airspeed", "cas", 2},
    OtherName{"airspeed", "indicatedairspeed", 3},
    OtherName{"airspeed", "ias", 3},
    OtherName{"pt", "totalpressure"},
    OtherName{"pt", "pitotpressure"},
    OtherName{"pt", "stagnationpressure"},
    OtherName{"ps", "staticpressure"},
    OtherName{"ps", "baropressure"},
    OtherName{"ps", "barometricpressure"},
    OtherName{"dp", "differentialpressure"},
    OtherName{"dp", "diffpressure"},
    OtherName{"dp", "diffpress"},
    OtherName{"dp", "impactpressure"},
    OtherName{"dp", "qc"},
    OtherName{"qbar", "dynamicpressure"},
    OtherName{"rho", "density"},
    OtherName{"rho", "airdensity"},
    OtherName{"temp", "oat"},
    OtherName{"temp", "outsideairtemperature"},
    OtherName{"temp", "outsideairtemp"},
    OtherName{"temp", "sat"},
    OtherName{"temp", "staticairtemperature"},
    OtherName{"temp", "airtemperature"},
    OtherName{"temp", "airtemp"},
    OtherName{"temp", "ambienttemperature"},
    OtherName{"temp", "temperature", 2},
    OtherName{"alpha", "aoa"},
    OtherName{"alpha", "angleofattack"},
    OtherName{"beta", "aos"},
    OtherName{"beta", "ssa"},
    OtherName{"beta", "angleofsideslip"},
    OtherName{"beta", "sideslip"},
    OtherName{"beta", "sideslipangle"},
    OtherName{"mx", "magx"},
    OtherName{"mx", "bx"},
    OtherName{"my", "by"},
    OtherName{"mz", "bz"},
    OtherName{"my", "magy"},
    OtherName{"mz", "magz"},
    OtherName{"mx", "magfieldx"},
    OtherName{"my", "magfieldy"},
    OtherName{"mz", "magfieldz"},
    OtherName{"mx", "magnetometerx"},
    OtherName{"my", "magnetometery"},
    OtherName{"mz", "magnetometerz"},
    OtherName{"mx", "magneticfieldx"},
    OtherName{"my", "magneticfieldy"},
    OtherName{"mz", "magneticfieldz"},
    OtherName{"mx", "xmag"},
    OtherName{"my", "ymag"},
    OtherName{"mz", "zmag"},
    OtherName{"ax", "accx"},
    OtherName{"ay", "accy"},
    OtherName{"az", "accz"},
    OtherName{"ax", "accelx"},
    OtherName{"ay", "accely"},
    OtherName{"az", "accelz"},
};

constexpr std::array other_units{
    OtherName{"kt", "kts"},
    OtherName{"kt", "kn"},
    OtherName{"kt", "knot"},
    OtherName{"kt", "knots"},
    OtherName{"kt", "nmih"},
    OtherName{"kt", "nmph"},
    OtherName{"kmh", "kph"},
    OtherName{"kmh", "kmph"},
    OtherName{"mps", "ms1"},
    OtherName{"mps", "meterssecond"},
    OtherName{"mps", "msec"},
    OtherName{"mps", "meterpersecond"},
    OtherName{"mps", "meterspersecond"},
    OtherName{"kmh", "kmhr"},
    OtherName{"ftps", "fps"},
    OtherName{"fpm", "ftmin"},
    OtherName{"fpm", "ftpm"},
    OtherName{"fpm", "feetmin"},
    OtherName{"mph", "mih"},
    OtherName{"rad", "rads"},
    OtherName{"rad", "radian"},
    OtherName{"rad", "radians"},
    OtherName{"deg", "degs"},
    OtherName{"deg", "degt"},  // from true north
    OtherName{"deg", "degree"},
    OtherName{"deg", "degrees"},
    OtherName{"radps", "rads1"},
    OtherName{"degps", "dps"},
    OtherName{"degps", "degs1"},
    OtherName{"degps", "degsec"},
    OtherName{"radps", "radsec"},
    OtherName{"s", "sec"},
    OtherName{"s", "second"},
    OtherName{"s", "seconds"},
    OtherName{"ms", "msec"},
    OtherName{"ms", "milliseconds"},
    OtherName{"us", "usec"},
    OtherName{"us", "microseconds"},
    OtherName{"ns", "nsec"},
    OtherName{"ns", "nanoseconds"},
    OtherName{"min", "minutes"},
    OtherName{"h", "hours"},
    OtherName{"m", "meter"},
    OtherName{"m", "meters"},
    OtherName{"m", "metre"},
    OtherName{"m", "metres"},
    OtherName{"ft", "feet"},
    OtherName{"ft", "foot"},
    OtherName{"ft", "ftmsl"},
    OtherName{"ft", "ftbaro"},
    OtherName{"ft", "ftwgs"},
    OtherName{"degc", "c"},
    OtherName{"degc", "celsius"},
    OtherName{"degc", "degreesc"},
    OtherName{"degf", "f"},
    OtherName{"degf", "fahrenheit"},
    OtherName{"k", "kelvin"},
    OtherName{"gauss", "g"},
    OtherName{"gauss", "oe"},  // in air
    OtherName{"gauss", "oersted"},
    OtherName{"gauss", "gs"},
    OtherName{"gauss", "ga"},  // PX4
    OtherName{"mgauss", "mg"},
    OtherName{"mgauss", "milligauss"},
    OtherName{"t", "tesla"},
    OtherName{"mt", "millitesla"},
    OtherName{"ut", "microtesla"},
    OtherName{"nt", "nanotesla"},
    OtherName{"hpa", "mbar"},
    OtherName{"hpa", "mb"},
    OtherName{"hpa", "millibar"},
    OtherName{"pa", "pascal"},
    OtherName{"inhg", "inchhg"},
    OtherName{"inhg", "incheshg"},
    OtherName{"psi", "psid"},
    OtherName{"psi", "psia"},
    OtherName{"psf", "lbft2"},
    OtherName{"pct", "percent"},
    OtherName{"lb", "lbs"},
};

/// Words that say whose a quantity is, and nothing else about it.
constexpr std::array sources{
    "gps",      "gnss", "ins",      "imu",   "ahrs", "ekf",      "nav",   "ned",      "att",
    "attitude", "body", "vehicle",  "air",   "adc",  "aircraft", "euler", "sensor",   "fc",
    "local",    "meas", "measured", "probe", "boom", "vane",     "pitot", "estimated"};

/// Whether `name` is what the table calls `ours`, and how far that is.
std::optional<int> rank_in(std::string_view ours, std::string_view name,
                           std::span<const OtherName> table) {
  if (name == ours) return 0;
  const auto found = std::ranges::find_if(
      table, [&](const OtherName& other) { return other.ours == ours && other.name == name; });
  return found == table.end() ? std::nullopt : std::optional(found->rank);
}

/// The degree and micro signs in UTF-8, and percent, as letters.
std::string spell_signs(std::string_view header) {
  struct Sign {
    std::string_view sign;
    std::string_view letters;
  };
  constexpr std::array signs{Sign{"\xc2\xb0", " deg"}, Sign{"\xc2\xb5", "u"},
                             Sign{"\xce\xbc", "u"},    Sign{"%", " pct"},
                             Sign{"\xc2\xb2", "2"},    Sign{"\xc2\xb3", "3"}};
  std::string text(header);
  for (const auto& [sign, letters] : signs) {
    for (std::size_t at = text.find(sign); at != std::string::npos; at = text.find(sign, at + 1)) {
      text.replace(at, sign.size(), letters);
    }
  }
  return text;
}

/// The quantity's own name without what parts its words.
std::string letters_of(std::string_view quantity) {
  std::string letters(quantity);
  std::erase(letters, '_');
  return letters;
}

}  // namespace

std::span<const KnownQuantity> known_quantities() { return quantities; }

std::vector<std::string> split_words(std::string_view header) {
  std::vector<std::string> words(1);
  for (const char c : spell_signs(header)) {
    const auto byte = static_cast<unsigned char>(c);
    if (std::isalnum(byte) != 0) {
      words.back() += static_cast<char>(std::tolower(byte));
    } else if (!words.back().empty()) {
      words.emplace_back();
    }
  }
  if (words.back().empty()) words.pop_back();
  return words;
}

std::string join_words(Words words) {
  return std::accumulate(words.begin(), words.end(), std::string());
}

std::optional<int> rank_name(std::string_view quantity, Words words, bool whose) {
  const std::string own = letters_of(quantity);
  const auto rank = [&](Words name) -> std::optional<int> {
    const std::string letters = join_words(name);
    return letters == own ? 0 : rank_in(quantity, letters, other_quantities);
  };
  if (const auto whole = rank(words)) return whole;
  for (std::size_t first = 1; whose && first < words.size(); ++first) {
    if (std::ranges::find(sources, words[first - 1]) == sources.end()) break;
    if (const auto behind = rank(words.subspan(first))) return std::max(*behind, 1);
  }
  return std::nullopt;
}

bool spell_unit(Words words, const Unit& unit) {
  if (words.empty()) return false;
  const std::string letters = join_words(words);
  if (words.size() == 1) return rank_in(unit.suffix, letters, other_units).has_value();
  if (letters == unit.suffix) return true;  // "km/h"
  if (rank_in(unit.suffix, letters, other_units)) return true;
  const std::size_t per = unit.suffix.rfind('p');
  const bool has_per = per != std::string_view::npos && unit.kind != UnitKind::pressure;
  return has_per && letters == std::string(unit.suffix).erase(per, 1);
}

std::optional<Recognised> recognise(std::string_view header, const KnownQuantity& quantity) {
  const std::vector<std::string> words = split_words(header);
  const bool whose = quantity.kind != UnitKind::temperature;  // of an IMU it is not the air's
  std::optional<Recognised> nearest;
  for (const Unit& unit : known_units(quantity.kind)) {
    for (std::size_t cut = 1; cut < words.size(); ++cut) {
      if (!spell_unit(Words(words).subspan(cut), unit)) continue;
      const auto rank = rank_name(quantity.name, Words(words).first(cut), whose);
      if (!rank || *rank >= asked_about) continue;
      if (!nearest || *rank < nearest->rank) nearest = {&unit, *rank};
    }
  }
  return nearest;
}

bool is_indicated(std::string_view header) {
  const std::vector<std::string> words = split_words(header);
  constexpr std::array names{"ias", "indicated",  "indicatedairspeed",
                             "cas", "calibrated", "calibratedairspeed"};
  return std::ranges::any_of(words, [&](const std::string& word) {
    return std::ranges::find(names, word) != names.end();
  });
}

}  // namespace sepcal::files
