// SPDX-License-Identifier: BSD-3-Clause
// Flights by their frequencies: what `sepcal-aircraft response` and `design` do.
#pragma once

#include <Eigen/Core>
#include <string>
#include <utility>
#include <vector>

#include "sepcal/detail/flight/log_choice.hpp"
#include "sepcal/detail/flight/output_file.hpp"
#include "sepcal/flight/calibration.hpp"
#include "sepcal/flight/flight.hpp"
#include "sepcal/frequency/input_design.hpp"
#include "sepcal/frequency/response.hpp"

namespace sepcal {

struct FlightResponse {
  FrequencyResponse found;
  std::string file;
  std::size_t rows = 0;
  std::vector<std::string> notes = {};
};

/// frequency_response() of a log's columns by their headers, in the log's own units. Throws Error
/// as it does, for a column that is not there, and for a time that does not increase.
FlightResponse find_response(const Flight& flight, const std::vector<std::string>& inputs,
                             const std::string& output, const ResponseOptions& options = {},
                             const LogChoice& log = {});

/// Writes frequency_hz and, of each input, `elevator_rad_magnitude` with `_low` and `_high`,
/// `_phase_rad` with `_phase_low_rad` and `_phase_high_rad`, and `_coherence`; a row a frequency.
void write_csv(const FlightResponse& response, OutputFile& target);
std::string to_text(const FlightResponse& response, Detail detail = Detail::brief);
std::string to_json(const FlightResponse& response);

/// Inputs to be flown.
struct InputDesign {
  std::string kind;                              // "multisine" or "3-2-1-1"
  std::vector<std::string> inputs;               // headers, "elevator_rad"
  std::vector<double> time;                      // s, N
  Eigen::MatrixXd signals;                       // N x inputs
  std::vector<std::vector<double>> frequencies;  // Hz, of each multisine
  std::vector<double> peak_factors;              // of each multisine
  double step = not_a_number;                    // s, of 3-2-1-1
  double share = not_a_number;                   // of its energy that lies in the band
};

/// Names of columns with the largest deflection of each.
using Amplitudes = std::vector<std::pair<std::string, double>>;

/// As multisines() and three_two_one_one(), which takes one input. Throws Error as these do, and
/// for a name that is empty, `time_s` or used twice.
InputDesign design_multisines(const Amplitudes& amplitudes, const MultisineOptions& options = {});
InputDesign design_steps(const Amplitudes& amplitudes, const StepsOptions& options = {});

/// Writes time_s and the signals.
void write_csv(const InputDesign& design, OutputFile& target);
std::string to_text(const InputDesign& design, Detail detail = Detail::brief);
std::string to_json(const InputDesign& design);

}  // namespace sepcal
