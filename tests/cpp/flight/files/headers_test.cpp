// SPDX-License-Identifier: BSD-3-Clause
// Accepted headers, and a header that was nearly one.
#include "flight/files/headers.hpp"

#include <doctest/doctest.h>

namespace headers_test {

using sepcal::OptionError;
using sepcal::files::accepted_headers;
using sepcal::files::UnitKind;
using Headers = std::vector<std::string>;

namespace {

std::string said(OptionError::Message message) { return OptionError(std::move(message)).what(); }

std::string asked_for(std::string_view quantity, UnitKind kind, const Headers& others) {
  return said(sepcal::files::ask_for_near_miss(quantity, kind, others));
}

std::string described(std::string_view quantity, UnitKind kind, const Headers& others) {
  return said(sepcal::files::describe_missing(quantity, kind, others));
}

/// How a message asks about that header.
std::string meant(const std::string& header, const std::string& accepted) {
  const std::string pair = accepted + "=" + header;
  const bool is_plain = header.find_first_of(" []()") == std::string::npos;
  return "did you mean '" + header + "'? map " + (is_plain ? pair : "'" + pair + "'") +
         " reads it so";
}

constexpr const char* roll_missing = "column 'roll_rad' is missing (roll_deg would do as well)";

/// What a log with that one header is told of a missing roll.
std::string miss_roll(const std::string& header) {
  return described("roll", UnitKind::angle, Headers{header});
}

}  // namespace

TEST_CASE("a quantity's headers, the unit used inside first") {
  CHECK(accepted_headers("vn", UnitKind::speed) ==
        Headers{"vn_mps", "vn_kt", "vn_kmh", "vn_ftps", "vn_fpm", "vn_cmps", "vn_mph"});
  CHECK(accepted_headers("rho", UnitKind::density) == Headers{"rho_kgpm3", "rho_slugpft3"});
}

TEST_CASE("a missing column is named with the other spellings, if there are any") {
  CHECK(described("roll", UnitKind::angle, Headers{}) == roll_missing);
  CHECK(
      described("time", UnitKind::time, Headers{}) ==
      "column 'time_s' is missing (time_ms, time_us, time_ns, time_min, time_h would do as well)");
  CHECK(described("rho", UnitKind::density, Headers{}) ==
        "column 'rho_kgpm3' is missing (rho_slugpft3 would do as well)");
}

TEST_CASE("case, punctuation and a slip or two are seen through") {
  const std::string asked = std::string(roll_missing) + "; ";
  for (const char* header :
       {"ROLL_RAD", "Roll_rad", "roll[rad]", "rollrad", "roll_rads", "rol_rad", "roll rad"}) {
    CHECK(miss_roll(header) == asked + meant(header, "roll_rad"));
  }
  CHECK(miss_roll("Roll (deg)") == asked + meant("Roll (deg)", "roll_deg"));
  CHECK(described("airspeed", UnitKind::speed, Headers{"airspd_mps"})
            .ends_with(meant("airspd_mps", "airspeed_mps")));
  for (const char* header : {"roll_rate", "banked_rad", "rpm", "altitude_m", "_"}) {
    CHECK(miss_roll(header) == roll_missing);
  }
}

TEST_CASE("upper case, and units as people write them") {
  const auto asked = [](const char* quantity, const std::string& header) {
    return asked_for(quantity, UnitKind::speed, Headers{"altitude_m", header});
  };
  CHECK(asked("vn", "VN_MPS") == "; " + meant("VN_MPS", "vn_mps"));
  CHECK(asked("airspeed", "airspeed (m/s)") == "; " + meant("airspeed (m/s)", "airspeed_mps"));
  CHECK(asked("airspeed", "Airspeed [kt]") == "; " + meant("Airspeed [kt]", "airspeed_kt"));
  CHECK(asked("airspeed", "windspeed").empty());
}

TEST_CASE("of several near ones the nearest is asked about") {
  CHECK(described("roll", UnitKind::angle, Headers{"roll_rd", "Roll_Deg", "rol_rad"})
            .ends_with(meant("Roll_Deg", "roll_deg")));
}

TEST_CASE("a letter makes another quantity of a short name, and only its unit may slip") {
  const auto miss_north = [](const std::string& header) {
    return described("vn", UnitKind::speed, Headers{header});
  };
  CHECK(miss_north("VN_mps").ends_with(meant("VN_mps", "vn_mps")));
  CHECK(miss_north("vn_m/s").ends_with(meant("vn_m/s", "vn_mps")));
  CHECK(miss_north("vx_mps").ends_with("would do as well)"));
  CHECK(described("hx", UnitKind::field, Headers{"mx_ut"}).ends_with("would do as well)"));
}

TEST_CASE("names and units as other logs write them") {
  const auto asked = [](const char* quantity, UnitKind kind, const std::string& header) {
    return asked_for(quantity, kind, Headers{"altitude_m", header});
  };
  const auto rename = [](const std::string& header, const std::string& to) {
    return "; " + meant(header, to);
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

TEST_CASE("of two that are as near the option decides") {
  CHECK(asked_for("vn", UnitKind::speed, Headers{"VN_mps", "vn (m/s)"}) ==
        "; 'VN_mps' and 'vn (m/s)' could both be it: map vn_mps=VN_mps decides");
}

TEST_CASE("a slip to the next key of a short name is asked about, and no other") {
  CHECK(asked_for("vn", UnitKind::speed, Headers{"VM_mps"}) == "; " + meant("VM_mps", "vn_mps"));
  CHECK(asked_for("vn", UnitKind::speed, Headers{"vx_mps"}).empty());
}

TEST_CASE("another axis is not asked about") {
  CHECK(asked_for("mx", UnitKind::field, Headers{"Mag_Y [nT]"}).empty());
  CHECK(asked_for("roll", UnitKind::angle, Headers{"roll_rate_degps"}).empty());
  CHECK(asked_for("roll", UnitKind::angle, Headers{"Roll Rate (deg/s)"}).empty());
}

TEST_CASE("a unit is never guessed") {
  struct Case {
    const char* quantity;
    UnitKind kind;
    const char* header;
  };
  using enum UnitKind;
  for (const auto& [quantity, kind, header] : {Case{"airspeed", speed, "Airspeed"},
                                               {"vn", speed, "VN_MMPS"},
                                               {"vn", speed, "vn (km/s)"},
                                               {"temp", temperature, "Temp"},
                                               {"pt", pressure, "PT_MPA"},
                                               {"roll", angle, "roll (mrad)"},
                                               {"roll", angle, "ROLL_GRAD"},
                                               {"mx", field, "MX_PT"},
                                               {"mx", field, "mx (pT)"},
                                               {"time", time, "TIME_D"}}) {
    const std::string asked = asked_for(quantity, kind, Headers{header});
    const std::string quoted = "; '" + std::string(header) + "' ";
    CHECK_MESSAGE((asked.starts_with(quoted + "says no unit that is known: map ") ||
                   asked.starts_with(quoted + "is in a unit that is not known: convert it to one")),
                  header);
  }
  for (const auto& [quantity, kind, header] : {Case{"mx", field, "Mag_X [pT]"},
                                               {"pt", pressure, "total pressure [MPa]"},
                                               {"vn", speed, "GPS_VN"},
                                               {"vn", speed, "GPS_VN (km/s)"}}) {
    const std::string asked = asked_for(quantity, kind, Headers{header});
    CHECK_MESSAGE(asked.find("did you mean") == std::string::npos, header);
  }
}

TEST_CASE("a unit's other spellings are known where they are no other unit's") {
  const auto asked = [](const char* quantity, UnitKind kind, const std::string& header) {
    return asked_for(quantity, kind, Headers{header});
  };
  const auto reads = [&](const char* quantity, UnitKind kind, const std::string& header,
                         const std::string& accepted) {
    return asked(quantity, kind, header) == "; " + meant(header, accepted);
  };
  CHECK(reads("airspeed", UnitKind::speed, "IAS_kts", "airspeed_kt"));
  CHECK(reads("temp", UnitKind::temperature, "Temp (C)", "temp_degc"));
  CHECK(reads("mx", UnitKind::field, "mx (mG)", "mx_mgauss"));
  CHECK(reads("time", UnitKind::time, "TIME_MS", "time_ms"));
  CHECK(reads("pt", UnitKind::pressure, "Pt [mbar]", "pt_hpa"));
}

}  // namespace headers_test
