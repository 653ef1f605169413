// SPDX-License-Identifier: BSD-3-Clause
// Inputs that excite a band: orthogonal multisines for several surfaces at once (Morelli, Journal
// of Aircraft 2012), and 3-2-1-1 for one.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "sepcal/detail/frequency/transform.hpp"

namespace sepcal {

struct MultisineOptions {
  Band band = {};          // its spacing is not looked at: harmonics are 1 / duration apart
  double duration = 20.0;  // s, one period of them all
  double rate = 50.0;      // rows a second
  bool optimised = true;   // phases of least relative peak factor; false: Schroeder's
};

struct Multisines {
  std::vector<double> time;                 // s, N
  Eigen::MatrixXd signals;                  // N x inputs; zero in the first row and the last
  std::vector<std::vector<int>> harmonics;  // of each input: k of its frequencies k / duration
  std::vector<std::vector<double>> phases;  // of each: sum of A_k sin(2 pi k t / duration + p_k)
  std::vector<double> peak_factors;         // (max - min) / (2 sqrt(2) rms), 1 of a single sine
};

/// One signal for each amplitude (its largest deflection, in any unit), of equal power over the
/// band; harmonics go to the inputs in turn, so that signals are orthogonal over the duration.
/// Throws Error as check_band(), for no amplitude or one that is not above 0, a rate below four
/// rows a period of the band's high end, fewer than two harmonics an input, and more than 200,000
/// rows.
Multisines multisines(const std::vector<double>& amplitudes, const MultisineOptions& options = {});

struct StepsOptions {
  Band band = {};       // most of the input's energy lies there
  double rate = 50.0;   // rows a second
  double before = 1.0;  // s of rest before the steps
  double after = 5.0;   // s of rest after them
};

struct StepInput {
  std::vector<double> time;    // s, N
  std::vector<double> signal;  // N
  double step = 0.0;           // s, the length of a "1"
  double share = 0.0;          // of its energy that lies in the band
};

/// 3-2-1-1: steps of three, two, one and one times `step`, to the one side and the other, rounded
/// to rows. `step` puts as much of the energy as it can into the band. Throws Error as
/// check_band(), for an amplitude that is not above 0, a rate as of multisines(), and times below
/// 0.
StepInput three_two_one_one(double amplitude, const StepsOptions& options = {});

}  // namespace sepcal
