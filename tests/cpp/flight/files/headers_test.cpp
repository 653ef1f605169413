// SPDX-License-Identifier: BSD-3-Clause
// Accepted headers, and a header that was nearly one.
#include "flight/files/headers.hpp"

#include <doctest/doctest.h>

namespace headers_test {

using sepcal::files::accepted_headers;
using sepcal::files::ask_for_near_miss;
using sepcal::files::describe_missing;
using sepcal::files::UnitKind;
using Headers = std::vector<std::string>;

namespace {

constexpr const char* roll_missing = "column 'roll_rad' is missing (roll_deg would do as well)";

/// What a log with that one header is told of a missing roll.
std::string miss_roll(const std::string& header) {
  return describe_missing("roll", UnitKind::angle, Headers{header});
}

}  // namespace

TEST_CASE("a quantity's headers, the unit used inside first") {
  CHECK(accepted_headers("vn", UnitKind::speed) ==
        Headers{"vn_mps", "vn_kt", "vn_kmh", "vn_ftps", "vn_fpm"});
  CHECK(accepted_headers("rho", UnitKind::density) == Headers{"rho_kgpm3", "rho_slugpft3"});
}

TEST_CASE("a missing column is named with the other spellings, if there are any") {
  CHECK(describe_missing("roll", UnitKind::angle, {}) == roll_missing);
  CHECK(describe_missing("time", UnitKind::time, {}) ==
        "column 'time_s' is missing (time_ms, time_us would do as well)");
  CHECK(describe_missing("rho", UnitKind::density, {}) ==
        "column 'rho_kgpm3' is missing (rho_slugpft3 would do as well)");
}

TEST_CASE("case, punctuation and a slip or two are seen through") {
  const std::string asked = std::string(roll_missing) + "; did you mean '";
  for (const char* header :
       {"ROLL_RAD", "Roll_rad", "roll[rad]", "rollrad", "roll_rads", "rol_rad", "roll rad"}) {
    CHECK(miss_roll(header) == asked + header + "'? Rename it to roll_rad");
  }
  CHECK(miss_roll("Roll (deg)") == asked + "Roll (deg)'? Rename it to roll_deg");
  CHECK(describe_missing("airspeed", UnitKind::speed, Headers{"airspd_mps"})
            .ends_with("did you mean 'airspd_mps'? Rename it to airspeed_mps"));
  for (const char* header : {"roll_rate", "bank_rad", "rpm", "altitude_m", "_"}) {
    CHECK(miss_roll(header) == roll_missing);
  }
}

TEST_CASE("upper case, and units as people write them") {
  const auto asked = [](const char* quantity, const std::string& header) {
    return ask_for_near_miss(quantity, UnitKind::speed, Headers{"altitude_m", header});
  };
  CHECK(asked("vn", "VN_MPS") == "; did you mean 'VN_MPS'? Rename it to vn_mps");
  CHECK(asked("airspeed", "airspeed (m/s)") ==
        "; did you mean 'airspeed (m/s)'? Rename it to airspeed_mps");
  CHECK(asked("airspeed", "Airspeed [kt]") ==
        "; did you mean 'Airspeed [kt]'? Rename it to airspeed_kt");
  CHECK(asked("airspeed", "windspeed").empty());
}

TEST_CASE("of several near ones the nearest is asked about") {
  CHECK(describe_missing("roll", UnitKind::angle, Headers{"roll_rd", "Roll_Deg", "rol_rad"})
            .ends_with("did you mean 'Roll_Deg'? Rename it to roll_deg"));
}

TEST_CASE("a letter makes another quantity of a short name, and only its unit may slip") {
  const auto miss_north = [](const std::string& header) {
    return describe_missing("vn", UnitKind::speed, Headers{header});
  };
  CHECK(miss_north("VN_mps").ends_with("'VN_mps'? Rename it to vn_mps"));
  CHECK(miss_north("vn_m/s").ends_with("'vn_m/s'? Rename it to vn_mps"));
  CHECK(miss_north("vx_mps").ends_with("would do as well)"));
  CHECK(describe_missing("hx", UnitKind::field, Headers{"mx_ut"}).ends_with("would do as well)"));
}

TEST_CASE("names and units as other logs write them") {
  const auto asked = [](const char* quantity, UnitKind kind, const std::string& header) {
    return ask_for_near_miss(quantity, kind, Headers{"altitude_m", header});
  };
  const auto rename = [](const std::string& header, const std::string& to) {
    return "; did you mean '" + header + "'? Rename it to " + to;
  };
  CHECK(asked("vn", UnitKind::speed, "GPS_VN (M/S)") == rename("GPS_VN (M/S)", "vn_mps"));
  CHECK(asked("vd", UnitKind::speed, "ins vel D [kt]") == rename("ins vel D [kt]", "vd_kt"));
  CHECK(asked("mx", UnitKind::field, "Mag_X [nT]") == rename("Mag_X [nT]", "mx_nt"));
  CHECK(asked("q", UnitKind::rate, "Pitch Rate (deg/s)") ==
        rename("Pitch Rate (deg/s)", "q_degps"));
  CHECK(asked("pt", UnitKind::pressure, "Total_Pressure[hPa]") ==
        rename("Total_Pressure[hPa]", "pt_hpa"));
  CHECK(asked("temp", UnitKind::temperature, "OAT degC") == rename("OAT degC", "temp_degc"));
}

TEST_CASE("another axis is not asked about") {
  CHECK(ask_for_near_miss("mx", UnitKind::field, Headers{"Mag_Y [nT]"}).empty());
  CHECK(ask_for_near_miss("roll", UnitKind::angle, Headers{"roll_rate_degps"}).empty());
  CHECK(ask_for_near_miss("roll", UnitKind::angle, Headers{"Roll Rate (deg/s)"}).empty());
}

TEST_CASE("a unit is never guessed") {
  struct Case {
    const char* quantity;
    UnitKind kind;
    const char* header;
  };
  using enum UnitKind;
  for (const auto& [quantity, kind, header] : {Case{"airspeed", speed, "AIRSPEED_MPH"},
                                               {"airspeed", speed, "Airspeed [fps]"},
                                               {"airspeed", speed, "Airspeed"},
                                               {"vn", speed, "VN_FPS"},
                                               {"vn", speed, "VN_CMPS"},
                                               {"vn", speed, "vn (km/s)"},
                                               {"temp", temperature, "TEMP_F"},
                                               {"temp", temperature, "Temp"},
                                               {"pt", pressure, "PT_MPA"},
                                               {"pt", pressure, "PT_INHG"},
                                               {"roll", angle, "roll (mrad)"},
                                               {"roll", angle, "ROLL_GRAD"},
                                               {"mx", field, "MX_T"},
                                               {"mx", field, "mx (mT)"},
                                               {"time", time, "TIME_NS"},
                                               {"time", time, "TIME_H"}}) {
    CHECK_MESSAGE(
        ask_for_near_miss(quantity, kind, Headers{header}) ==
            "; '" + std::string(header) + "' says no unit that is known: convert it or rename it",
        header);
  }
  for (const auto& [quantity, kind, header] : {Case{"mx", field, "Mag_X [mT]"},
                                               {"pt", pressure, "total pressure [MPa]"},
                                               {"vn", speed, "GPS_VN"},
                                               {"vn", speed, "GPS_VN (km/s)"}}) {
    CHECK_MESSAGE(ask_for_near_miss(quantity, kind, Headers{header}).empty(), header);
  }
}

TEST_CASE("a unit's other spellings are known where they are no other unit's") {
  const auto asked = [](const char* quantity, UnitKind kind, const std::string& header) {
    return ask_for_near_miss(quantity, kind, Headers{header});
  };
  CHECK(asked("airspeed", UnitKind::speed, "IAS_kts").ends_with("airspeed_kt"));
  CHECK(asked("temp", UnitKind::temperature, "Temp (C)").ends_with("temp_degc"));
  CHECK(asked("mx", UnitKind::field, "mx (mG)").ends_with("mx_mgauss"));
  CHECK(asked("time", UnitKind::time, "TIME_MS").ends_with("time_ms"));
  CHECK(asked("pt", UnitKind::pressure, "Pt [mbar]").ends_with("pt_hpa"));
}

}  // namespace headers_test
