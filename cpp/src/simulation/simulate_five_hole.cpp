// SPDX-License-Identifier: BSD-3-Clause
// A five-hole probe on a small aircraft: the aircraft moves through the air, the wind carries it
// over the ground, the probe feels the air that it meets and reports four pressures.
#include <algorithm>
#include <cmath>

#include "sepcal/error.hpp"
#include "simulation/first_order_lag.hpp"
#include "simulation/five_hole_reading.hpp"
#include "simulation/lateness.hpp"
#include "simulation/simulated_noise.hpp"
#include "simulation/small_aircraft.hpp"

namespace sepcal {
namespace {

using namespace simulation;
using Eigen::Vector3d;

void check(const FiveHoleTruth& truth) {
  check_parameters(truth.source, without_effects(truth.parameters), FiveHoleTruth{}.parameters);
  check_values(truth.source, "lever arm", truth.lever_arm);
  check_values(truth.source, "velocity noise", truth.noise, 0.0);
  for (const auto& [name, k] :
       {std::pair("k_alpha", truth.k_alpha), std::pair("k_beta", truth.k_beta)}) {
    if (k > 0.0 && std::isfinite(k)) continue;
    throw Error(truth.source + ": sensitivity " + format_number(k) + " 1/rad of " + name +
                " must be finite and above 0");
  }
}

/// The aircraft's moment with room for alpha and beta as read [rad].
Moment extend(Moment now, double alpha, double beta) {
  now.values.insert(now.values.end(), {alpha, beta});
  return now;
}

Moment moment_at(const FiveHoleReader& reader, double time, const AircraftState& state) {
  const Moment now = extend(SmallAircraft::moment(time, state), 0.0, 0.0);
  const FiveHoleReading reading = reader.read(state, now);
  return extend(SmallAircraft::moment(time, state), reading.alpha, reading.beta);
}

/// The hidden effects. The knots of a spline over alpha or beta depend on the readings, and these
/// may depend on the spline: both are sought together.
HiddenEffects hide(const FiveHoleTruth& truth, const SmallAircraft& aircraft) {
  if (truth.effects.empty() && without_effects(truth.parameters) == truth.parameters) return {};
  Sources sources = aircraft.sources();
  const std::size_t alpha = sources.names.size();
  sources.names.insert(sources.names.end(), {"alpha", "beta"});
  sources.at = [&aircraft](double time) {
    return extend(SmallAircraft::moment(time, aircraft.at(time)), 0.0, 0.0);
  };
  const auto read_rows = [&](const HiddenEffects& hidden) {
    const FiveHoleReader reader(truth, hidden);
    double change = 0.0;
    for (Moment& row : sources.rows) {
      Moment next = moment_at(reader, row.time, aircraft.at(row.time));
      for (const std::size_t i : {alpha, alpha + 1}) {
        if (i < row.values.size())
          change = std::max(change, std::abs(next.values[i] - row.values[i]));
      }
      row = std::move(next);
    }
    return change;
  };
  read_rows({});
  constexpr int most_rounds = 40;
  for (int round = 0; round < most_rounds; ++round) {
    HiddenEffects hidden(five_hole_effects(), truth.effects, truth.parameters, sources,
                         truth.source);
    if (!hidden.has_spline_over(alpha) && !hidden.has_spline_over(alpha + 1)) return hidden;
    if (read_rows(hidden) < 1e-13) return hidden;
  }
  throw Error(truth.source +
              ": a spline over alpha or beta moves its own knots too far; choose smaller sizes");
}

}  // namespace

SimulatedFlight simulate_five_hole(const FiveHoleTruth& truth, const SimulationOptions& options) {
  check(truth);
  const Vector3d wind(truth.parameters.at("w_n"), truth.parameters.at("w_e"),
                      truth.parameters.at("w_d"));
  const SmallAircraft aircraft(options, wind, truth.altitude);
  const HiddenEffects hidden = hide(truth, aircraft);
  const FiveHoleReader reader(truth, hidden);
  const Lateness late(hidden, aircraft.times(), truth.source);
  FirstOrderLag pressures(truth.source + ": pneumatic_lag", hidden.constant("pneumatic_lag"),
                          aircraft.times().front() - late.at(aircraft.times().front()),
                          [&](double time) -> Eigen::VectorXd {
                            const AircraftState state = aircraft.at(time);
                            const Moment now = extend(SmallAircraft::moment(time, state), 0.0, 0.0);
                            const FiveHoleReading reading = reader.read(state, now);
                            return Eigen::Vector4d(reading.total, reading.fixed,
                                                   reading.alpha_pressure, reading.beta_pressure);
                          });

  SimulatedFlight flight = open_flight(
      {"time_s", "roll_rad",  "pitch_rad",  "yaw_rad",  "p_radps",   "q_radps", "r_radps",
       "vn_mps", "ve_mps",    "vd_mps",     "pt_pa",    "ps_pa",     "dpa_pa",  "dpb_pa",
       "temp_k", "rho_kgpm3", "altitude_m", "throttle", "current_a", "flap"},
      aircraft.times().size());
  const Eigen::MatrixXd noise = make_noise(options.noise, aircraft.times().size(), 3, options.seed);
  const Vector3d sigma(truth.noise.data());
  for (const double time : aircraft.times()) {
    const AircraftState state = aircraft.at(time);
    const Air air = late.none() ? state.air : aircraft.at(time - late.at(time)).air;
    const Eigen::VectorXd read = pressures.advance_to(time - late.at(time));
    Vector3d logged = state.ground;
    if (hidden.has("wind")) {
      const Moment now = moment_at(reader, time, state);
      logged += Vector3d(hidden.sum("wind", now, 0), hidden.sum("wind", now, 1), 0.0);
    }
    const auto row = static_cast<Eigen::Index>(flight.rows());
    logged += noise.row(row).transpose().cwiseProduct(sigma);
    const Attitude& attitude = state.attitude;
    append_row(flight, aircraft.label(time),
               {time,
                wrap(attitude.roll.value),
                attitude.pitch.value,
                wrap(attitude.yaw.value + hidden.constant("heading_bias")),
                state.rates.x(),
                state.rates.y(),
                state.rates.z(),
                logged.x(),
                logged.y(),
                logged.z(),
                read[0],
                read[1],
                read[2],
                read[3],
                air.temperature,
                air.density,
                state.altitude,
                state.throttle,
                state.current,
                state.flap});
  }
  record_truth(flight, truth.parameters, hidden);
  add_decoys(flight, options);
  return flight;
}

}  // namespace sepcal
