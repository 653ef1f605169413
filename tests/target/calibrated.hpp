// SPDX-License-Identifier: BSD-3-Clause
// The probes of the tests on board, each with three effects, and one of a user's own.
#pragma once

#include "sepcal/core.hpp"

namespace target {

namespace effects = sepcal::effects;

inline auto compass(double current, double temperature) {
  return sepcal::Magnetometer{} + effects::Bias<"current_a">{.centre = current} +
         effects::AxisScale<"temp_degc">{.centre = temperature} + effects::CubicNonlinearity{};
}

inline auto compass_by_strength(double strength, double current, double temperature,
                                double voltage) {
  return sepcal::AttitudeIndependentMagnetometer{strength} +
         effects::strength::Bias<"current_a">{.centre = current} +
         effects::strength::Scale<"temp_degc">{.centre = temperature} +
         effects::strength::AxisScale<"voltage_v">{.centre = voltage};
}

inline auto air_data_probe(double k_alpha, double k_beta, double current, double throttle,
                           double altitude) {
  return sepcal::FiveHoleProbe{k_alpha, k_beta} +
         effects::AirspeedScale<"throttle">{.centre = throttle} +
         effects::Wind<"altitude_m">{.centre = altitude} +
         effects::PressureOffset<"current_a">{.centre = current};
}

inline auto tube(double throttle, double altitude, double current) {
  return sepcal::PitotStatic{} + effects::tube::AirspeedScale<"throttle">{.centre = throttle} +
         effects::tube::AirspeedBias<"altitude_m">{.centre = altitude} +
         effects::PressureOffset<"current_a">{.centre = current};
}

/// A Pitot-static tube in a wind that is level, as a user would write it.
struct TubeInLevelWind {
  static constexpr std::array inputs{sepcal::Quantity{"vn", "m/s"}, sepcal::Quantity{"ve", "m/s"},
                                     sepcal::Quantity{"vd", "m/s"}};
  static constexpr auto outputs = sepcal::PitotStatic::outputs;
  static constexpr auto linear = sepcal::PitotStatic::linear;
  static constexpr std::array nonlinear{sepcal::Quantity{"w_n", "m/s", -30, 30},
                                        sepcal::Quantity{"w_e", "m/s", -30, 30}};
  template <class U, class X>
  sepcal::Affine<X, 1, 2> at(const sepcal::Vec<U, 3>& v, const sepcal::Vec<X, 2>& wind) const {
    sepcal::Vec<U, 7> u = sepcal::Vec<U, 7>::Zero();
    u.template head<3>() = v;
    u[6] = U(static_cast<sepcal::Real<U>>(sepcal::PitotStatic::sea_level_density));
    return sepcal::PitotStatic{}.at(
        u, sepcal::Vec<X, 3>(wind[0], wind[1], X(static_cast<sepcal::Real<X>>(0))));
  }
};

}  // namespace target
