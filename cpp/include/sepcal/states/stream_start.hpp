// SPDX-License-Identifier: BSD-3-Clause
// Where a recursive estimator begins: a calibration, or a mini-batch (Sun & Gebre-Egziabher, Sec.
// VI): stages one and two on the first rows, whose triangular factor T itself is the information
// that goes on as a stream. Nothing is inverted on the way.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "sepcal/detail/block_model.hpp"
#include "sepcal/detail/eigen.hpp"
#include "sepcal/fit.hpp"
#include "sepcal/options.hpp"
#include "sepcal/record.hpp"

namespace sepcal {

struct StreamStart {
  std::vector<std::string> names;  // n parameters, linear, then nonlinear
  Eigen::VectorXd xi;              // n
  std::vector<int> free;           // k places in xi: those that are estimated, not held
  Eigen::MatrixXd R;      // k x k, upper triangular: (R'R)^-1 is the covariance of xi(free)
  Eigen::VectorXd noise;  // n_z standard deviations of the outputs
  std::vector<std::string> outputs = {};  // their names; of none, in the model's order
  /// Roots of the process noises' densities (n_w, in the table's order) that the start allows for:
  /// filter error's. Else empty.
  Eigen::VectorXd process_noise = {};
  std::size_t rows = 0;  // of the record's segments, in order, that went into it

  /// R of all parameters, for a filter of fixed size. Throws Error where one of them is held.
  template <int N>
  Eigen::Matrix<double, N, N> information_root() const {
    require_all(N);
    return R;
  }

 private:
  void require_all(int n) const;
};

/// The first `rows` rows of a record's segments.
Record first_rows(const Record& record, std::size_t rows);

/// Fits the first `rows` rows: xi, and R out of T = [R q; 0 rho] of the rows [A | D | r] at it,
/// whitened by their noise, and of the options' priors. An estimated noise allows for the number of
/// parameters, SSE / (N - n). Where noise drives the states the method is filter error, the
/// options' process noise held: an output error's factor is that of white residuals, and is sure of
/// what it doesn't know. Throws Error as fit(), and where these rows are too few: none left
/// to go on with, or parameters that they leave open.
StreamStart start_from_rows(const BlockModel& model, const Record& record, std::size_t rows,
                            const FitOptions& options = {});

template <SeparableModel M>
StreamStart start_from_rows(const M& model, const Record& record, std::size_t rows,
                            const FitOptions& options = {}) {
  return start_from_rows(StaticModel<M>(model), record, rows, options);
}

/// A calibration's: R'R the inverse of its covariance, the one to believe. Parameters without a
/// standard error are held. Throws Error where none has one.
StreamStart start_from_fit(const Fit& fit);

}  // namespace sepcal
