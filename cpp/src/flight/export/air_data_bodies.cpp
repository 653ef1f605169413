// SPDX-License-Identifier: BSD-3-Clause
// A Pitot-static tube: V = (z - c_va) / s_va and what the effects add. A five-hole probe: Eq. 36
// with what they add, and the air's direction turned into body axes by C(eps).
#include <fmt/format.h>

#include <algorithm>

#include "flight/export/bodies.hpp"
#include "flight/export/driver_origin.hpp"
#include "flight/export/exporter.hpp"
#include "sepcal/error.hpp"

namespace sepcal::exporting {
namespace {

Constant parameter(const Calibration& calibration, const std::string& name) {
  const Parameter& one = calibration.fit[name];
  return {name, {one.value}, 0, one.name + ", " + one.unit};
}

ProbeBody pitot_static_body(const Calibration& calibration, const Correction& correction,
                            const Dialect& dialect) {
  if (calibration.fit["s_va"].value == 0.0) {
    throw Error(
        "the calibration's s_va is zero, so that it can't be applied; fit it on a flight with more "
        "than one airspeed");
  }
  ProbeBody body;
  body.summary = "V = (z - c_va) / s_va and what the effects add: the true airspeed";
  body.readings = {{"airspeed_mps",
                    1,
                    {"airspeed_mps"},
                    "m/s, as read for the air that is there: sqrt(2 dp / rho)"}};
  body.outputs = {{"airspeed_cal_mps", 1, {"airspeed_cal_mps"}, "m/s, the true airspeed"}};
  body.constants = {parameter(calibration, "s_va"), parameter(calibration, "c_va")};
  body.text = fmt::format(
      "  double met;\n  if (!(airspeed_mps > 0.0)) return {};\n  met = (airspeed_mps - {}) / {};\n",
      dialect.own("bad_input"), dialect.constant("c_va"), dialect.constant("s_va"));
  if (correction.has("pressure_offset.s")) {
    const auto driver = std::ranges::find(correction.drivers, "rho_kgpm3", &Driver::known);
    std::string rho = "rho_kgpm3";
    if (driver == correction.drivers.end()) {
      body.readings.push_back(
          {"rho_kgpm3", 1, {"rho_kgpm3"}, "kg/m^3, density; 1.225 if not known"});
    } else {
      rho = whole_of(driver->argument, driver->origin);
    }
    body.text += fmt::format("  if (!({} > 0.0)) return {};\n", rho, dialect.own("bad_input"));
    body.text += fmt::format("  met = met * met + 2.0 * (0.0{}) / {};\n",
                             correction.added("pressure_offset.s"), rho);
    body.text += "  met = met > 0.0 ? sqrt(met) : 0.0;\n";
  }
  const std::string scale = correction.added("airspeed_scale.s");
  body.text += fmt::format("  *airspeed_cal_mps = met{}{};\n",
                           scale.empty() ? "" : fmt::format(" * (1.0{})", scale),
                           correction.added("airspeed_bias.s"));
  body.trials = {{12.0, 1.2}, {18.0, 1.1}, {25.0, 1.05}};
  for (std::vector<double>& trial : body.trials) trial.resize(body.readings.size());
  return body;
}

ProbeBody five_hole_body(const Calibration& calibration, const Correction& correction,
                         const Dialect& dialect) {
  const auto settings = calibration.probe->settings();
  const double k_alpha = settings.at("k_alpha").front();
  const double k_beta = settings.at("k_beta").front();
  ProbeBody body;
  body.summary = "true airspeed, angle of attack and of sideslip at the probe, in body axes";
  if (dialect.is_single()) {  // a float holds 1e5 Pa to 0.004 Pa
    body.readings = {{"pt_less_ps_pa",
                      1,
                      {"pt_pa", "ps_pa"},
                      "Pa, total less static pressure, as the sensor or double arithmetic has it",
                      true}};
  } else {
    body.readings = {{"pt_pa", 1, {"pt_pa"}, "Pa, total pressure"},
                     {"ps_pa", 1, {"ps_pa"}, "Pa, static pressure"}};
  }
  for (const Quantities& one :
       {Quantities{"dpa_pa", 1, {"dpa_pa"}, "Pa, of the angle-of-attack ports"},
        Quantities{"dpb_pa", 1, {"dpb_pa"}, "Pa, of the sideslip ports"},
        Quantities{"rho_kgpm3", 1, {"rho_kgpm3"}, "kg/m^3, density of the air"}}) {
    body.readings.push_back(one);
  }
  body.outputs = {{"airspeed_cal_mps", 1, {"airspeed_cal_mps"}, "m/s, the true airspeed"},
                  {"alpha_cal_rad", 1, {"alpha_cal_rad"}, "rad, angle of attack"},
                  {"beta_cal_rad", 1, {"beta_cal_rad"}, "rad, angle of sideslip"}};
  for (const char* name :
       {"lambda_va", "b_va", "lambda_alpha", "b_alpha", "lambda_beta", "b_beta", "eps_phi"}) {
    body.constants.push_back(parameter(calibration, name));
  }
  body.constants.push_back({"k_alpha", {k_alpha}, 0, "of the angle-of-attack ports, 1/rad"});
  body.constants.push_back({"k_beta", {k_beta}, 0, "of the sideslip ports, 1/rad"});
  const auto c = [&](const char* name) { return dialect.constant(name); };
  const auto sum = [&](const std::string& port, const char* other) {
    return correction.added(port + ".s") + (*other == 0 ? "" : correction.added(port + other));
  };
  const std::string reading_scale = sum("reading_scale", "");
  body.text = fmt::format(
      "  const double alpha = (1.0 + {la}) * (alpha_read{da}) + {ba};\n"
      "  const double beta = (1.0 + {lb}) * (beta_read{db}) + {bb};\n"
      "  const double square = 2.0 * (pressure{dp}) / rho_kgpm3;\n"
      "  const double read = (square > 0.0 ? sqrt(square) : 0.0){rs};\n"
      "  const double u = cos(alpha) * cos(beta);\n"
      "  const double side = sin(beta);\n"
      "  const double below = sin(alpha) * cos(beta);\n"
      "  const double v = cos({eps}) * side + sin({eps}) * below;\n"
      "  const double w = cos({eps}) * below - sin({eps}) * side;\n"
      "  *airspeed_cal_mps = (1.0 + {lv}{ds}) * read + {bv}{dv};\n"
      "  *alpha_cal_rad = atan2(w, u);\n"
      "  *beta_cal_rad = asin(v > 1.0 ? 1.0 : v < -1.0 ? -1.0 : v);\n",
      fmt::arg("la", c("lambda_alpha")), fmt::arg("ba", c("b_alpha")),
      fmt::arg("lb", c("lambda_beta")), fmt::arg("bb", c("b_beta")), fmt::arg("eps", c("eps_phi")),
      fmt::arg("lv", c("lambda_va")), fmt::arg("bv", c("b_va")),
      fmt::arg("da", sum("alpha_offset", ".k")), fmt::arg("db", sum("beta_offset", ".k")),
      fmt::arg("dp", sum("pressure_offset", "")),
      fmt::arg("rs", reading_scale.empty() ? "" : fmt::format(" * (1.0{})", reading_scale)),
      fmt::arg("ds", sum("airspeed_scale", "")), fmt::arg("dv", sum("airspeed_bias", "")));
  const double ps = 95000.0;
  body.trials = {{ps + 120.0, ps, 6.0 * k_alpha, -3.6 * k_beta, 1.2},
                 {ps + 250.0, ps, -7.5 * k_alpha, 5.0 * k_beta, 1.1},
                 {ps + 400.0, ps, 40.0 * k_alpha, 20.0 * k_beta, 1.05}};
  return body;
}

/// What a five-hole probe reads before anything is corrected: effects may follow it.
std::string read_angles(const Dialect& dialect) {
  return fmt::format(
      "  const double pressure = {};\n"
      "  if (!(pressure > 0.0) || !(rho_kgpm3 > 0.0)) return {};\n"
      "  const double alpha_read = dpa_pa / ({} * pressure);\n"
      "  const double beta_read = dpb_pa / ({} * pressure);\n",
      dialect.is_single() ? "pt_less_ps_pa" : "pt_pa - ps_pa", dialect.own("bad_input"),
      dialect.constant("k_alpha"), dialect.constant("k_beta"));
}

}  // namespace

const Exporter& pitot_static_exporter() {
  static const Exporter exporter{
      .instrument = "a Pitot-static tube",
      .header_name = "pitot_static",
      .readings = {{"airspeed", "airspeed_mps"}, {"airspeed_mps", "airspeed_mps"}},
      .density_scales = "airspeed_scale",
      .held = HeldAs::airspeed,
      .body = pitot_static_body};
  return exporter;
}

const Exporter& five_hole_exporter() {
  static const Exporter exporter{.instrument = "a five-hole probe",
                                 .header_name = "five_hole",
                                 .readings = {{"alpha", "alpha_read"},
                                              {"beta", "beta_read"},
                                              {"pt", "pt_pa"},
                                              {"ps", "ps_pa"},
                                              {"dpa", "dpa_pa"},
                                              {"dpb", "dpb_pa"},
                                              {"rho", "rho_kgpm3"},
                                              {"pt_pa", "pt_pa"},
                                              {"ps_pa", "ps_pa"},
                                              {"dpa_pa", "dpa_pa"},
                                              {"dpb_pa", "dpb_pa"},
                                              {"rho_kgpm3", "rho_kgpm3"}},
                                 .by_difference = true,
                                 .density_scales = "reading_scale",
                                 .body = five_hole_body,
                                 .before_effects = read_angles};
  return exporter;
}

}  // namespace sepcal::exporting
