// SPDX-License-Identifier: BSD-3-Clause
// What a record says of the aircraft's motion at each row, moved to the centre of gravity.
#pragma once

#include <Eigen/Core>
#include <array>
#include <span>
#include <string>
#include <vector>

#include "sepcal/aircraft/geometry.hpp"
#include "sepcal/record.hpp"

namespace sepcal::aircraft {

/// At the centre of gravity, SI; NaN where the record has no such channel.
struct Motion {
  Eigen::Vector3d acceleration;  // specific force
  Eigen::Vector3d rates;         // p q r
  Eigen::Vector3d rates_dot;
  double airspeed;
  double alpha;
  double beta;
  double qbar;    // Pa
  double mass;    // kg
  double thrust;  // N; 0 where it isn't logged
};

class Channels {
 public:
  /// Throws Error for what is missing or can't be, as aero_coefficients() says.
  Channels(const Record& record, const AircraftGeometry& geometry,
           const std::vector<std::string>& coefficients, double window);

  Motion at(std::size_t row) const;

  /// Of the local cubic, s; NaN where nothing is differentiated.
  double window() const { return window_; }
  bool differentiates() const { return !slopes_[0].empty(); }
  const std::vector<double>& derivative(std::size_t rate) const { return slopes_[rate]; }

 private:
  double read(std::string_view name, std::size_t row) const;
  Eigen::Vector3d read(const std::array<std::string_view, 3>& names, std::size_t row) const;
  void differentiate(double window);

  const Record& record_;
  const AircraftGeometry& geometry_;
  Eigen::Vector3d imu_;   // from the centre of gravity
  Eigen::Vector3d vane_;  // the same
  std::array<std::vector<double>, 3> slopes_;
  double window_ = not_a_number;
};

}  // namespace sepcal::aircraft
