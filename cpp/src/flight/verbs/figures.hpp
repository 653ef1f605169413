// SPDX-License-Identifier: BSD-3-Clause
// What pictures of a calibration on a flight are drawn from: the rows compared, what was measured
// and modelled in them, and the readings behind them, all in the units used inside.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "sepcal/detail/eigen.hpp"
#include "sepcal/flight/calibration.hpp"
#include "sepcal/record.hpp"

namespace sepcal {

/// N rows, those of compare()'s residuals and in their order.
struct FlightFigures {
  std::vector<std::size_t> rows;  // (N) the flight's row of each
  std::vector<Segment> segments;  // of the N rows, cut at gaps and changes of label
  std::vector<Segment> runs;      // of the N rows, cut at gaps alone: noise runs on
  // The 0.1, 0.5 and 0.9 quantiles of the time from row to row [s]; ones where there is one row.
  std::array<double, 3> interval{};
  Eigen::MatrixXd measured;       // N x n_z, in the outputs' units
  Eigen::MatrixXd modelled;       // N x n_z
  std::vector<double> within_95;  // (n_z) share of the residuals in 1.96 deviations of fit.noise
  std::vector<double> airspeed;   // (N) [m/s] as read; empty where the probe reads none
  // Yaw, else the track over ground (N) [rad, 0 to 2 pi]; NaN in a row without; empty where neither
  // is logged.
  std::vector<double> heading;
  bool heading_is_track = false;
  Record channels;  // all that a comparison's ChannelMisfit may name, cut to the N rows
};

/// Of an output that is zero by construction, the difference to a field's given strength [uT], the
/// strength and the calibrated field's stand in `modelled` and `measured`, whose difference is
/// minus the residual. Throws Error for bad input, as compare() does.
FlightFigures gather_figures(const Calibration& calibration, const Flight& flight);

}  // namespace sepcal
