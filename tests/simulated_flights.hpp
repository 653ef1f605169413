// SPDX-License-Identifier: BSD-3-Clause
// What the tests of simulated flights look at: columns by name, and attitude as a matrix.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "sepcal/flight/simulate.hpp"

namespace sepcal::test {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Names = std::array<const char*, 3>;

inline constexpr Names angles{"roll_rad", "pitch_rad", "yaw_rad"};
inline constexpr Names rates{"p_radps", "q_radps", "r_radps"};
inline constexpr Names velocity{"vn_mps", "ve_mps", "vd_mps"};
inline constexpr Names reading{"mx_ut", "my_ut", "mz_ut"};
inline constexpr Names earth_field{"bn_ut", "be_ut", "bd_ut"};

inline double at(const SimulatedFlight& flight, const char* name, std::size_t row) {
  return flight.column(name)[row];
}

inline Vector3d at(const SimulatedFlight& flight, const Names& names, std::size_t row) {
  return {at(flight, names[0], row), at(flight, names[1], row), at(flight, names[2], row)};
}

/// Eq. 39 entry by entry, with cos(psi) in entry (1,2).
inline Matrix3d body_to_ned(const SimulatedFlight& flight, std::size_t row) {
  const Vector3d euler = at(flight, angles, row);
  const Vector3d s = euler.array().sin(), c = euler.array().cos();
  const Vector3d north(c[1] * c[2], s[0] * s[1] * c[2] - c[0] * s[2],
                       c[0] * s[1] * c[2] + s[0] * s[2]);
  const Vector3d east(c[1] * s[2], s[0] * s[1] * s[2] + c[0] * c[2],
                      c[0] * s[1] * s[2] - s[0] * c[2]);
  const Vector3d down(-s[1], s[0] * c[1], c[0] * c[1]);
  return (Matrix3d() << north.transpose(), east.transpose(), down.transpose()).finished();
}

inline Matrix3d cross_matrix(const Vector3d& v) {
  return (Matrix3d() << 0, -v[2], v[1], v[2], 0, -v[0], -v[1], v[0], 0).finished();
}

inline SimulationOptions condensed(std::size_t rows, std::uint64_t seed = 0) {
  return {.rate = 50.0, .rows = rows, .seed = seed};
}

/// The same truth without noise.
template <class Truth>
Truth quiet(Truth truth) {
  truth.noise.fill(0);
  return truth;
}

/// The truth with these effects at work.
template <class Truth>
Truth hiding(Truth truth, std::vector<HiddenEffect> effects) {
  truth.effects = std::move(effects);
  return truth;
}

inline Eigen::ArrayXd values(const SimulatedFlight& flight, const char* name) {
  const std::vector<double>& column = flight.column(name);
  return Eigen::Map<const Eigen::ArrayXd>(column.data(), static_cast<Eigen::Index>(column.size()));
}

/// tau dy/dt + y at every row but two at each end, by central differences over five evenly spaced
/// rows: their error is h^4/30 times the fifth derivative.
inline Eigen::ArrayXd undo_lag(const SimulatedFlight& flight, const char* name, double tau) {
  const Eigen::ArrayXd y = values(flight, name), t = values(flight, "time_s");
  const Eigen::Index n = y.size() - 4;
  const double h = (t[t.size() - 1] - t[0]) / static_cast<double>(t.size() - 1);
  const Eigen::ArrayXd slope =
      (y.segment(0, n) - 8 * y.segment(1, n) + 8 * y.segment(3, n) - y.segment(4, n)) / (12 * h);
  return tau * slope + y.segment(2, n);
}

/// The largest difference of a column from another flight's, `later` rows on.
inline double worst_difference(const SimulatedFlight& flight, const SimulatedFlight& other,
                               const char* name, Eigen::Index later = 0) {
  const Eigen::ArrayXd a = values(flight, name), b = values(other, name);
  const Eigen::Index n = a.size() - later;
  return (a.tail(n) - b.head(n)).abs().maxCoeff();
}

}  // namespace sepcal::test
