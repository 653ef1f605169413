// SPDX-License-Identifier: BSD-3-Clause
// x is a driver about its centre, s a coefficient, v the airspeed as read, F the air's direction in
// navigation axes (Eq. 41), h the true field in body axes, C the magnetometer's matrix.
#include "sepcal/flight/effect_catalogue.hpp"

#include <array>

namespace sepcal {
namespace {

constexpr std::array five_hole{
    CataloguedEffect{"wind[altitude_m]", "W + s x (n, e)", "altitude_m", "m/s per m"},
    CataloguedEffect{"wind[time]", "W + s x (n, e)", "time", "m/s per s"},
    CataloguedEffect{"wind[COLUMN]", "W + s x (n, e)", "any numeric column", "m/s per its unit"},
    CataloguedEffect{"airspeed_scale[alpha^2]", "V + s alpha^2 v", "alpha", "1/rad^2"},
    CataloguedEffect{"airspeed_scale[beta^2]", "V + s beta^2 v", "beta", "1/rad^2"},
    CataloguedEffect{"airspeed_scale[COLUMN]", "V + s x v", "any numeric column", "1 per its unit"},
    CataloguedEffect{"airspeed_bias[COLUMN]", "V + s x", "any numeric column", "m/s per its unit"},
    CataloguedEffect{"pressure_offset[throttle]", "(pt - ps) + s x, angles as read", "throttle",
                     "Pa"},
    CataloguedEffect{"pressure_offset[COLUMN]", "(pt - ps) + s x, angles as read",
                     "any numeric column", "Pa per its unit"},
    CataloguedEffect{"alpha_offset[COLUMN]", "alpha + s x", "any numeric column",
                     "rad per its unit"},
    CataloguedEffect{"beta_offset[COLUMN]", "beta + s x", "any numeric column", "rad per its unit"},
    CataloguedEffect{"heading_bias", "yaw - delta", "attitude", "rad"},
    CataloguedEffect{"time_offset", "air data late by tau", "none", "s"},
    CataloguedEffect{"pneumatic_lag", "tau dp/dt + p = p0", "none", "s"},
    CataloguedEffect{"lever_arm", "- C_b^n (w x dr)", "p, q, r", "m"},
};

constexpr std::array magnetometer{
    CataloguedEffect{"bias[current_a]", "m + s x (x, y, z)", "current_a", "uT/A"},
    CataloguedEffect{"bias[throttle^n]", "m + s x^n (x, y, z), n fitted", "throttle", "uT"},
    CataloguedEffect{"bias[temp_degc]", "m + s x (x, y, z)", "temp_degc", "uT/K"},
    CataloguedEffect{"bias[time]", "m + s x (x, y, z)", "time", "uT/s"},
    CataloguedEffect{"bias[COLUMN]", "m + s x (x, y, z)", "any numeric column", "uT per its unit"},
    CataloguedEffect{"scale[COLUMN]", "m + s x h", "any numeric column", "1 per its unit"},
    CataloguedEffect{"axis_scale[COLUMN]", "m_i + s_i x h_i", "any numeric column",
                     "1 per its unit"},
    CataloguedEffect{"bias_step", "m + s (t >= t0)", "time", "uT"},
    CataloguedEffect{"cubic_nonlinearity", "m_i + d_i h_i^3 + c_i h_i^2", "none", "1/uT^2, 1/uT"},
    CataloguedEffect{"time_offset", "magnetometer late by tau", "attitude or rates", "s"},
    CataloguedEffect{"sensor_lag", "m - C dh/dt tau", "attitude or rates", "s"},
    CataloguedEffect{"field_declination", "m + C C_n^b (e_D x B) delta", "attitude", "rad"},
};

}  // namespace

std::span<const CataloguedEffect> effect_catalogue(std::string_view model) {
  if (model == "five-hole") return five_hole;
  if (model == "magnetometer") return magnetometer;
  return {};
}

}  // namespace sepcal
