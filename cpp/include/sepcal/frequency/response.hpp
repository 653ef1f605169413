// SPDX-License-Identifier: BSD-3-Clause
// Frequency responses without a model: averages over windows that overlap by half (Welch), of one
// output on several inputs at once (Bendat & Piersol, Random Data, Ch. 7 and 9):
//   H = Gxx^-1 Gxy,   coherence of input i given the others: |H_i|^2 / (|H_i|^2 + v Gxx^-1_ii),
// v = Gyy - H' Gxx H what the inputs leave of the output.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "sepcal/detail/frequency/transform.hpp"
#include "sepcal/record.hpp"

namespace sepcal {

struct ResponseOptions {
  Band band = {};       // its spacing, where 0: one over the window
  double window = 0.0;  // s; 0: a fifth of the longest segment, at least two periods of band.low
  double level = 0.95;  // of `radius`
};

struct FrequencyResponse {
  std::vector<std::string> inputs;
  std::string output;
  std::vector<double> frequencies;  // Hz
  Eigen::MatrixXcd response;        // frequencies x inputs, output's unit over the input's
  Eigen::MatrixXd coherence;        // the same, of each input with what the others leave
  Eigen::VectorXd coherence_all;    // frequencies, of all inputs together
  Eigen::MatrixXd standard_error;   // frequencies x inputs, of the real and of the imaginary part
  Eigen::MatrixXd radius;  // the same: the truth lies within it of the response, at the level
  double window = 0.0;     // s
  int windows = 0;
  double averages = 0.0;  // independent windows that they are worth
};

/// H by its magnitude, its phase [rad], of an input unwrapped along the frequencies, and their
/// ranges at the level; a phase has no range, NaN, where the circle holds zero.
struct MagnitudeAndPhase {
  Eigen::MatrixXd magnitude, magnitude_low, magnitude_high;  // frequencies x inputs
  Eigen::MatrixXd phase, phase_low, phase_high;
};
MagnitudeAndPhase magnitude_and_phase(const FrequencyResponse& response);

/// Columns by name, and `time` [s]. Windows don't cross a segment's edge; one that holds a value
/// that is not finite is left out. Each is freed of its straight line and tapered (Hann), and all
/// count alike. Errors are those of a noise of the output that the inputs don't know.
/// Throws Error for a column that is missing or is both input and output, no input, a level beyond
/// (0, 1), a window that holds less than two periods of the band's low end or is longer than each
/// segment, and fewer independent windows than two more than inputs.
FrequencyResponse frequency_response(const Record& record, const std::vector<std::string>& inputs,
                                     const std::string& output,
                                     const ResponseOptions& options = {});

}  // namespace sepcal
