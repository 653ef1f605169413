// SPDX-License-Identifier: BSD-3-Clause
// x is a driver about its centre, s a coefficient, v the airspeed as read and V the corrected one,
// W the wind, h the true field in body axes, C the magnetometer's matrix. They are made in
// air_data_effects.cpp and magnetic_effects.cpp.
#include "sepcal/flight/effect_catalogue.hpp"

#include <array>

namespace sepcal {
namespace {

// A DRIVER is any numeric column by its header, time, or a state function; as x, x^2 ... x^9, x^n
// (the exponent is fitted), spline(x,k), step(time), ramp(time), decay(time) or delay(x).
constexpr std::string_view any = "any DRIVER";

constexpr std::array five_hole{
    CataloguedEffect{"wind[DRIVER]", "W + s x (n, e)", any, "m/s per x"},
    CataloguedEffect{"wind[altitude_m]", "shear: W + s (h - h0) (n, e)", "altitude_m", "m/s per m"},
    CataloguedEffect{"wind[time]", "drift: W + s (t - t0) (n, e)", "time", "m/s per s"},
    CataloguedEffect{"wind[spline(time,6)]", "W + a smooth of time, 6 knots (n, e)", "time", "m/s"},
    CataloguedEffect{"wind[maneuver]", "a wind for every label but the first (n, e)", "maneuver",
                     "m/s"},
    CataloguedEffect{"airspeed_scale[DRIVER]", "V + s x v", any, "1 per x"},
    CataloguedEffect{"airspeed_scale[alpha^2]", "pressure loss: V + s alpha^2 v", "alpha as read",
                     "1 per rad^2"},
    CataloguedEffect{"airspeed_scale[beta^2]", "pressure loss: V + s beta^2 v", "beta as read",
                     "1 per rad^2"},
    CataloguedEffect{"airspeed_bias[DRIVER]", "V + s x", any, "m/s per x"},
    CataloguedEffect{"pressure_offset[DRIVER]", "v from (pt - ps) + s x, angles as read", any,
                     "Pa per x"},
    CataloguedEffect{"pressure_offset[throttle]", "propwash: v from (pt - ps) + s T", "throttle",
                     "Pa"},
    CataloguedEffect{"alpha_offset[DRIVER]", "alpha as read + s x", any, "rad per x"},
    CataloguedEffect{"beta_offset[DRIVER]", "beta as read + s x", any, "rad per x"},
    CataloguedEffect{"heading_bias", "logged yaw = true yaw + delta", "attitude", "rad"},
    CataloguedEffect{"time_offset", "air data late by tau", "none", "s"},
    CataloguedEffect{"pneumatic_lag", "tau dp/dt + p = p0 on every pressure", "none", "s"},
    CataloguedEffect{"lever_arm", "- C_b^n (w x dr) (x, y, z)", "p, q, r", "m"},
    CataloguedEffect{"density_error", "v (1 + s / 2T): the temperature is off by s", "temp_k", "K"},
    CataloguedEffect{"compressibility", "V + s (v_c - v), v_c of compressible air", "ps, density",
                     "1"},
    CataloguedEffect{"upwash", "alpha as read + k q / v", "q", "m"},
    CataloguedEffect{"sidewash", "beta as read + k p / v", "p", "m"},
    CataloguedEffect{"icing_ramp", "V + s (t - t0)+ v, t0 fitted", "time", "1 per s"},
    CataloguedEffect{"water_blockage", "V + s v from t0 on, t0 by a scan", "time", "1"},
    CataloguedEffect{"mounting_error", "C_b^n R_z(yaw) R_y(pitch): b_alpha, b_beta absorb it",
                     "attitude", "rad"},
    CataloguedEffect{"wind_shear", "alias of wind[altitude_*]", "altitude_*", "m/s per m"},
    CataloguedEffect{"wind_drift", "alias of wind[time]", "time", "m/s per s"},
    CataloguedEffect{"propwash", "alias of pressure_offset[throttle]", "throttle", "Pa"},
};

constexpr std::array pitot_static{
    CataloguedEffect{"wind[DRIVER]", "W + s x (n, e)", any, "m/s per x"},
    CataloguedEffect{"wind[altitude_m]", "shear: W + s (h - h0) (n, e)", "altitude_m", "m/s per m"},
    CataloguedEffect{"wind[time]", "drift: W + s (t - t0) (n, e)", "time", "m/s per s"},
    CataloguedEffect{"wind[spline(time,6)]", "W + a smooth of time, 6 knots (n, e)", "time", "m/s"},
    CataloguedEffect{"wind[maneuver]", "a wind for every label but the first (n, e)", "maneuver",
                     "m/s"},
    CataloguedEffect{"airspeed_scale[DRIVER]", "V = V_met + s x V_met", any, "1 per x"},
    CataloguedEffect{"airspeed_bias[DRIVER]", "V = V_met + s x", any, "m/s per x"},
    CataloguedEffect{"pressure_offset[DRIVER]", "rho V^2 / 2 = rho V_met^2 / 2 + s x",
                     "any DRIVER, and density", "Pa per x"},
    CataloguedEffect{"time_offset", "airspeed late by tau", "none", "s"},
    CataloguedEffect{"pneumatic_lag", "tau dz/dt + z = z0", "none", "s"},
    CataloguedEffect{"density_error", "V = V_met + s V_met / 2T: the temperature is off by s",
                     "temp_k", "K"},
    CataloguedEffect{"icing_ramp", "V = V_met + s (t - t0)+ V_met, t0 fitted", "time", "1 per s"},
    CataloguedEffect{"water_blockage", "V = V_met + s V_met from t0 on, t0 by a scan", "time", "1"},
    CataloguedEffect{"wind_shear", "alias of wind[altitude_*]", "altitude_*", "m/s per m"},
    CataloguedEffect{"wind_drift", "alias of wind[time]", "time", "m/s per s"},
    CataloguedEffect{"propwash", "alias of pressure_offset[throttle]", "throttle, density", "Pa"},
};

constexpr std::array magnetometer{
    CataloguedEffect{"bias[DRIVER]", "m + s x (x, y, z)", any, "uT per x"},
    CataloguedEffect{"bias[current_a]", "field of a current: m + s I (x, y, z)", "current_a",
                     "uT per A"},
    CataloguedEffect{"bias[throttle^n]", "m + s T^n (x, y, z), n fitted", "throttle", "uT"},
    CataloguedEffect{"bias[delay(current_a)]", "m + s I(t - tau) (x, y, z), tau fitted",
                     "current_a", "uT per A"},
    CataloguedEffect{"bias[temp_degc]", "m + s dT (x, y, z)", "temp_degc", "uT per degC"},
    CataloguedEffect{"bias[temp_degc^2]", "m + s dT^2 (x, y, z)", "temp_degc", "uT per degC^2"},
    CataloguedEffect{"bias[time]", "drift: m + s (t - t0) (x, y, z)", "time", "uT per s"},
    CataloguedEffect{"scale[DRIVER]", "m + s x h", any, "1 per x"},
    CataloguedEffect{"axis_scale[DRIVER]", "m_i + s_i x h_i (x, y, z)", any, "1 per x"},
    CataloguedEffect{"bias_step", "m + s from t0 on (x, y, z), t0 by a scan", "time", "uT"},
    CataloguedEffect{"warm_up", "m + s exp(-(t - t_first) / tau) (x, y, z), tau fitted", "time",
                     "uT"},
    CataloguedEffect{"cubic_nonlinearity", "m_i + d_i h_i^3 + c_i h_i^2", "none", "1/uT^2, 1/uT"},
    CataloguedEffect{"eddy_currents", "m + E dh/dt, E 3 x 3", "p, q, r or attitude", "s"},
    CataloguedEffect{"time_offset", "magnetometer late by tau", "attitude", "s"},
    CataloguedEffect{"sensor_lag", "tau dm/dt + m = m0", "attitude", "s"},
    CataloguedEffect{"field_declination", "h turned by delta about down", "attitude", "rad"},
    CataloguedEffect{"attitude_bias", "h + h x (x, y, 0): a misalignment absorbs it", "none",
                     "rad"},
    CataloguedEffect{"bias_drift", "alias of bias[time]", "time", "uT per s"},
};

constexpr std::array attitude_independent{
    CataloguedEffect{"bias[DRIVER]", "m + s x (x, y, z)", any, "uT per x"},
    CataloguedEffect{"scale[DRIVER]", "(C + s x I) h", any, "1 per x"},
    CataloguedEffect{"axis_scale[DRIVER]", "(C + diag(s_i x)) h (x, y, z)", any, "1 per x"},
    CataloguedEffect{"bias_step", "m + s from t0 on (x, y, z), t0 by a scan", "time", "uT"},
    CataloguedEffect{"warm_up", "m + s exp(-(t - t_first) / tau) (x, y, z), tau fitted", "time",
                     "uT"},
    CataloguedEffect{"bias_drift", "alias of bias[time]", "time", "uT per s"},
};

}  // namespace

std::span<const CataloguedEffect> effect_catalogue(std::string_view model) {
  if (model == "five-hole") return five_hole;
  if (model == "pitot-static") return pitot_static;
  if (model == "magnetometer") return magnetometer;
  if (model == "magnetometer-norm") return attitude_independent;
  return {};
}

}  // namespace sepcal
