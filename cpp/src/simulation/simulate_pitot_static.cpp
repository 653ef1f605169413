// SPDX-License-Identifier: BSD-3-Clause
// A plain Pitot-static tube on a small aircraft: it meets the air at the speed at which the
// aircraft moves through it, whatever the direction, and reads s_va times that and c_va more.
#include <algorithm>
#include <cmath>

#include "sepcal/error.hpp"
#include "simulation/first_order_lag.hpp"
#include "simulation/five_hole_reading.hpp"
#include "simulation/hidden_effects.hpp"
#include "simulation/lateness.hpp"
#include "simulation/simulated_noise.hpp"
#include "simulation/small_aircraft.hpp"

namespace sepcal {
namespace {

using namespace simulation;
using Eigen::Vector3d;

constexpr KnownEffect tube_effects[] = {
    {"wind", "wind", "*", "n e"},
    {"airspeed_scale", "airspeed_scale", "*", "s"},
    {"airspeed_bias", "airspeed_bias", "*", "s"},
    {"pressure_offset", "pressure_offset", "*", "s"},
    {"pressure_offset", "pressure_offset", "", "s"},
    {"time_offset", "time_offset", "", "tau"},
    {"clock_drift", "clock_drift", "", "tau"},
    {"pneumatic_lag", "pneumatic_lag", "", "tau"},
    {"density_error", "density_error", "", "s"},
    {"compressibility", "compressibility", "", "s"},
    {"icing_ramp", "airspeed_scale", "ramp(time)", "s"},
    {"water_blockage", "airspeed_scale", "step(time)", "s"},
};
constexpr HiddenCatalogue tube_catalogue{"pitot-static tube", tube_effects, air_data_aliases};

void check(const PitotStaticTruth& truth) {
  const std::map<std::string, double> own = without_effects(truth.parameters);
  check_parameters(truth.source, own, PitotStaticTruth{}.parameters);
  check_values(truth.source, "airspeed noise", truth.noise, 0.0);
  if (own.at("s_va") > 0.0) return;
  throw Error(truth.source + ": scale s_va = " + format_number(own.at("s_va")) +
              " leaves no signal; choose it above 0");
}

HiddenEffects hide(const PitotStaticTruth& truth, const SmallAircraft& aircraft) {
  if (truth.effects.empty() && without_effects(truth.parameters) == truth.parameters) return {};
  return {tube_catalogue, truth.effects, truth.parameters, aircraft.sources(), truth.source};
}

/// The airspeed that the tube reads, free of noise and lag [m/s].
double read_tube(const PitotStaticTruth& truth, const HiddenEffects& hidden,
                 const AircraftState& state, const Moment& now) {
  const auto fail = [&]() -> double {
    throw Error(truth.source + ": at " + format_number(now.time) +
                " s the tube has nothing to read; choose c_va and the hidden effects smaller");
  };
  const double s_va = truth.parameters.at("s_va");
  const double c_va = truth.parameters.at("c_va");
  const double airspeed = state.velocity.norm();
  const double bias = hidden.sum("airspeed_bias", now);
  const double scale = 1.0 + hidden.sum("airspeed_scale", now) +
                       hidden.constant("density_error") / (2.0 * state.air.temperature);
  const double offset = 2.0 * hidden.sum("pressure_offset", now) / state.air.density;
  // The excess of compressible air depends on the reading, weakly: each round gains three digits.
  double read = s_va * airspeed + c_va;
  constexpr int rounds = 12;
  for (int k = 0; k < (hidden.has("compressibility") ? rounds : 1); ++k) {
    if (!(read > 0.0)) return fail();
    const double excess = hidden.has("compressibility") ? hidden.constant("compressibility") *
                                                              compressible_excess(read, state.air)
                                                        : 0.0;
    const double free = (airspeed - bias) / (scale + excess);
    const double met_squared = free * free - offset;
    if (!(free > 0.0 && met_squared > 0.0)) return fail();
    read = s_va * std::sqrt(met_squared) + c_va;
  }
  return read > 0.0 ? read : fail();
}

}  // namespace

SimulatedFlight simulate_pitot_static(const PitotStaticTruth& truth,
                                      const SimulationOptions& options) {
  check(truth);
  const Vector3d wind(truth.parameters.at("w_n"), truth.parameters.at("w_e"),
                      truth.parameters.at("w_d"));
  const SmallAircraft aircraft(options, wind, truth.altitude);
  const HiddenEffects hidden = hide(truth, aircraft);
  const Lateness late(hidden, aircraft.times(), truth.source);
  FirstOrderLag airspeed(truth.source + ": pneumatic_lag", hidden.constant("pneumatic_lag"),
                         aircraft.times().front() - late.at(aircraft.times().front()),
                         [&](double time) -> Eigen::VectorXd {
                           const AircraftState state = aircraft.at(time);
                           const Moment now = SmallAircraft::moment(time, state);
                           return Eigen::VectorXd::Constant(1,
                                                            read_tube(truth, hidden, state, now));
                         });

  SimulatedFlight flight =
      open_flight({"time_s", "roll_rad", "pitch_rad", "yaw_rad", "p_radps", "q_radps", "r_radps",
                   "vn_mps", "ve_mps", "vd_mps", "dp_pa", "ps_pa", "temp_k", "rho_kgpm3",
                   "airspeed_mps", "altitude_m", "throttle", "current_a", "flap"},
                  aircraft.times().size());
  const Eigen::MatrixXd noise = make_noise(options.noise, aircraft.times().size(), 1, options.seed);
  for (const double time : aircraft.times()) {
    const AircraftState state = aircraft.at(time);
    const Moment now = SmallAircraft::moment(time, state);
    const Vector3d ground =
        state.ground + Vector3d(hidden.sum("wind", now, 0), hidden.sum("wind", now, 1), 0.0);
    const auto row = static_cast<Eigen::Index>(flight.rows());
    const double read =
        airspeed.advance_to(time - late.at(time))[0] + truth.noise[0] * noise(row, 0);
    const Attitude& attitude = state.attitude;
    append_row(flight, aircraft.label(time),
               {time, wrap(attitude.roll.value), attitude.pitch.value, wrap(attitude.yaw.value),
                state.rates.x(), state.rates.y(), state.rates.z(), ground.x(), ground.y(),
                ground.z(), std::copysign(0.5 * state.air.density * read * read, read),
                state.air.pressure, state.air.temperature, state.air.density, read, state.altitude,
                state.throttle, state.current, state.flap});
  }
  record_truth(flight, truth.parameters, hidden);
  add_decoys(flight, options);
  return flight;
}

}  // namespace sepcal
