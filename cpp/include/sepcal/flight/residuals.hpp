// SPDX-License-Identifier: BSD-3-Clause
// The residuals of a calibration on a flight, row by row, as a table for those who plot elsewhere.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "sepcal/detail/flight/output_file.hpp"
#include "sepcal/flight/calibration.hpp"
#include "sepcal/flight/comparison.hpp"

namespace sepcal {

/// Rows are the flight's, in its order; where no time tells which were used, those used alone.
struct ResidualTable {
  /// A row each; NaN in rows that the model did not use.
  struct Output {
    std::string name;
    std::string unit;
    std::vector<double> measured = {};  // z, in the unit
    std::vector<double> modelled = {};  // A xi1 + b
    std::vector<double> residual = {};  // z less that; of a fit by filter error the innovation
    std::vector<double> whitened = {};  // the residual over the noise's standard deviation
  };

  std::vector<double> time;  // [s], as the fit has it; empty where none was logged
  std::vector<Output> outputs;
  std::vector<std::string> why_not;  // empty of a row that was used
  std::vector<std::string> notes;    // for people

  std::size_t rows() const { return why_not.size(); }
  std::size_t rows_used() const;
};

/// On the calibration's flight or another one. Throws Error as compare() does.
ResidualTable tabulate_residuals(const Calibration& calibration, const Flight& flight);

/// Of a comparison on that flight, which `log` was chosen of. `noise` is the fit's.
ResidualTable tabulate_residuals(const Comparison& comparison, const Flight& flight,
                                 const LogChoice& log, const std::vector<OutputValue>& noise);

/// A column each: time_s, and of each output mx_measured_ut, mx_modelled_ut, mx_residual_ut,
/// mx_whitened; then used, 1 or 0, and why_not.
std::vector<std::string> headers_of(const ResidualTable& table);

/// As CSV; a cell that is NaN is empty. Throws Error where it can't be written.
void write_csv(const ResidualTable& table, OutputFile& target);

}  // namespace sepcal
