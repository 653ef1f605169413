// SPDX-License-Identifier: BSD-3-Clause
// What the tests of simulated flights look at: columns by name, and attitude as a matrix.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "sepcal/simulation/simulate.hpp"

namespace sepcal::test {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Names = std::array<const char*, 3>;

inline constexpr Names angles{"roll_rad", "pitch_rad", "yaw_rad"};
inline constexpr Names rates{"p_radps", "q_radps", "r_radps"};
inline constexpr Names velocity{"vn_mps", "ve_mps", "vd_mps"};
inline constexpr Names reading{"mx_ut", "my_ut", "mz_ut"};
inline constexpr Names earth_field{"bn_ut", "be_ut", "bd_ut"};

double at(const SimulatedFlight& flight, const char* name, std::size_t row);

Vector3d at(const SimulatedFlight& flight, const Names& names, std::size_t row);

/// Eq. 39 entry by entry, with cos(psi) in entry (1,2).
Matrix3d body_to_ned(const SimulatedFlight& flight, std::size_t row);

Matrix3d cross_matrix(const Vector3d& v);

SimulationOptions condensed(std::size_t rows, std::uint64_t seed = 0);

/// The same truth without noise.
template <class Truth>
Truth quiet(Truth truth) {
  truth.noise.fill(0);
  return truth;
}

/// The truth with these effects at work.
template <class Truth>
Truth hiding(Truth truth, std::vector<SizedEffect> effects) {
  truth.effects = std::move(effects);
  return truth;
}

Eigen::ArrayXd values(const SimulatedFlight& flight, const char* name);

/// tau dy/dt + y at every row but two at each end, by central differences over five evenly spaced
/// rows: their error is h^4/30 times the fifth derivative.
Eigen::ArrayXd undo_lag(const SimulatedFlight& flight, const char* name, double tau);

/// The largest difference of a column from another flight's, `later` rows on.
double worst_difference(const SimulatedFlight& flight, const SimulatedFlight& other,
                        const char* name, Eigen::Index later = 0);

}  // namespace sepcal::test
