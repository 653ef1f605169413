// SPDX-License-Identifier: BSD-3-Clause
// The correction that probes of speed and flow angles share.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "flight/probes/corrected_columns.hpp"
#include "sepcal/detail/model.hpp"

namespace sepcal::probes {

/// A row's reading, before any correction but that of the pressure behind the airspeed.
struct AirAsRead {
  double airspeed;  // [m/s]
  double alpha;     // [rad], in the probe's own terms
  double beta;
};

inline const std::vector<std::string> corrected_air_headers{"airspeed_cal_mps", "alpha_cal_rad",
                                                            "beta_cal_rad"};

/// Eq. 36 with what effects add, and the air's direction turned into body axes by C(eps): the speed
/// [m/s], alpha = atan2(w, u) and beta = asin(v / V) [rad], whatever the probe's own angles are.
/// Air is the probe's AirVelocity; `values` are its parameters, linear then nonlinear; `read(row)`
/// is asked of valid rows alone.
template <class Air, class Read>
std::vector<CorrectedColumn> correct_air(const ProbeReadings& readings,
                                         const Eigen::VectorXd& values,
                                         const ReadingEffects& effects, const Read& read) {
  const Vec<double, 5> xi2 = values.tail<5>();
  auto columns = empty_columns(corrected_air_headers, readings.valid.size());
  for (std::size_t i = 0; i < readings.valid.size(); ++i) {
    if (!readings.valid[i]) continue;
    const AirAsRead as_read = read(i);
    const auto angles = Air::template flow_angles<double, double>(
        as_read.alpha + effects.at("alpha_offset.s", i) + effects.at("alpha_offset.k", i),
        as_read.beta + effects.at("beta_offset.s", i) + effects.at("beta_offset.k", i), xi2);
    const auto air = Air::template air_direction<double>(angles[0], angles[1],
                                                         Air::template settle<double>(xi2));
    columns[0].values[i] = (1.0 + values[0] + effects.at("airspeed_scale.s", i)) *
                               (as_read.airspeed * (1.0 + effects.at("reading_scale.s", i))) +
                           values[1] + effects.at("airspeed_bias.s", i);
    columns[1].values[i] = std::atan2(air[2], air[0]);
    columns[2].values[i] = std::asin(std::clamp(air[1], -1.0, 1.0));
  }
  return columns;
}

}  // namespace sepcal::probes
