// SPDX-License-Identifier: BSD-3-Clause
// Standard errors of fits over a band: the sandwich with the residual's own spectrum in its middle,
//   B [sum_j Re(J_j^H S_j^(1/2) C S_j^(1/2) J_j) / r_j^4 + W] B,  B = [sum_j Re(J_j^H J_j) / r_j^2
//   + W]^-1,
// S the variance of the residual's parts by frequency, smoothed; C what frequencies closer than
// independent ones share; W the prior.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "sepcal/fit.hpp"
#include "sepcal/options.hpp"

namespace sepcal::frequency {

/// Where the frequencies are.
struct Grid {
  std::vector<double> frequencies = {};  // Hz, segment after segment
  std::vector<double> seconds = {};      // how long the segment of each lasts
  std::vector<std::size_t> segment = {};
  std::size_t segments = 0;
  double total = 0.0;  // s, of all segments that have frequencies

  /// Those of the next segment, none where it is too short.
  void add(const std::vector<double>& of_segment, double lasts);
};

/// One output at the estimate.
struct BandTangent {
  Eigen::MatrixXcd J;         // frequencies x n, by the fit's parameters
  Eigen::VectorXd J_0;        // n, of a row beside them at zero frequency; zeros: none
  Eigen::VectorXcd residual;  // frequencies
};

/// Puts them into the place of those of independent rows. `fit.noise` is what weighed the outputs.
void put_band_errors(const std::vector<BandTangent>& outputs, const Grid& grid,
                     const FitOptions& options, Fit& fit);

}  // namespace sepcal::frequency
