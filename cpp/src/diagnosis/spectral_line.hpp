// SPDX-License-Identifier: BSD-3-Clause
// A line in the spectrum of what should be white: the strongest frequency, where its power P stands
// out from its neighbours' mean, P / mean ~ F(2, 2m) for m neighbours. They are near, so that a
// resonance, wider than they are far, is none.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "diagnosis/nested_windows.hpp"

namespace sepcal::diagnosis {

/// Rows as cells of an even grid in time.
struct EvenGrid {
  double interval = 1.0;                 // of a cell: the median between rows [s]
  std::vector<Eigen::Index> cells = {};  // of each row, ascending

  Eigen::Index length() const { return cells.empty() ? 0 : cells.back() + 1; }
};

/// Rows that are missing leave cells empty; a gap is at most 64 long: beyond, the phase is lost.
EvenGrid place_on_grid(const std::vector<double>& time);

struct SpectralLine {
  double p_value = 1.0;                   // corrected for frequencies and outputs
  std::vector<std::size_t> outputs = {};  // that show it; none where the record is too short
  double frequency = 0.0;                 // [cycles a cell]
  Window strongest = {};
};

/// `white`: whitened residuals, rows x outputs. Tries each output and the sum of their powers.
SpectralLine find_line(const Eigen::MatrixXd& white, const EvenGrid& grid);

/// Whether what a unit of some input does to the outputs (`slopes`, output after output, m N x
/// inputs) swings near the line: a heading that wanders slowly errs at the rate of the turns.
bool swings_as_inputs(const SpectralLine& line, const Eigen::MatrixXd& slopes,
                      const EvenGrid& grid);

/// The frequency [cycles a cell] that holds more of a few rows' power than chance would give it
/// once in a hundred times, by Fisher's g; NaN where none does. `first`: the first of the rows.
double strongest_frequency(const Eigen::VectorXd& values, const EvenGrid& grid, Eigen::Index first);

}  // namespace sepcal::diagnosis
