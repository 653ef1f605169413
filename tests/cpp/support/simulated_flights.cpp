// SPDX-License-Identifier: BSD-3-Clause
#include "simulated_flights.hpp"

namespace sepcal::test {

double at(const SimulatedFlight& flight, const char* name, std::size_t row) {
  return flight.column(name)[row];
}

Vector3d at(const SimulatedFlight& flight, const Names& names, std::size_t row) {
  return {at(flight, names[0], row), at(flight, names[1], row), at(flight, names[2], row)};
}

Matrix3d body_to_ned(const SimulatedFlight& flight, std::size_t row) {
  const Vector3d euler = at(flight, angles, row);
  const Vector3d s = euler.array().sin(), c = euler.array().cos();
  const Vector3d north(c[1] * c[2], s[0] * s[1] * c[2] - c[0] * s[2],
                       c[0] * s[1] * c[2] + s[0] * s[2]);
  const Vector3d east(c[1] * s[2], s[0] * s[1] * s[2] + c[0] * c[2],
                      c[0] * s[1] * s[2] - s[0] * c[2]);
  const Vector3d down(-s[1], s[0] * c[1], c[0] * c[1]);
  return (Matrix3d() << north.transpose(), east.transpose(), down.transpose()).finished();
}

Matrix3d cross_matrix(const Vector3d& v) {
  return (Matrix3d() << 0, -v[2], v[1], v[2], 0, -v[0], -v[1], v[0], 0).finished();
}

SimulationOptions condensed(std::size_t rows, std::uint64_t seed) {
  return {.rate = 50.0, .rows = rows, .seed = seed};
}

Eigen::ArrayXd values(const SimulatedFlight& flight, const char* name) {
  const std::vector<double>& column = flight.column(name);
  return Eigen::Map<const Eigen::ArrayXd>(column.data(), static_cast<Eigen::Index>(column.size()));
}

Eigen::ArrayXd undo_lag(const SimulatedFlight& flight, const char* name, double tau) {
  const Eigen::ArrayXd y = values(flight, name), t = values(flight, "time_s");
  const Eigen::Index n = y.size() - 4;
  const double h = (t[t.size() - 1] - t[0]) / static_cast<double>(t.size() - 1);
  const Eigen::ArrayXd slope =
      (y.segment(0, n) - 8 * y.segment(1, n) + 8 * y.segment(3, n) - y.segment(4, n)) / (12 * h);
  return tau * slope + y.segment(2, n);
}

double worst_difference(const SimulatedFlight& flight, const SimulatedFlight& other,
                        const char* name, Eigen::Index later) {
  const Eigen::ArrayXd a = values(flight, name), b = values(other, name);
  const Eigen::Index n = a.size() - later;
  return (a.tail(n) - b.head(n)).abs().maxCoeff();
}

}  // namespace sepcal::test
