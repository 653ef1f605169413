// SPDX-License-Identifier: BSD-3-Clause
// Where filter error begins: output error's parameters, or of a model that can't be integrated the
// best of samples, each with its linear parameters solved; and sizes of the noises beside them.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "estimation/problem.hpp"
#include "sepcal/detail/innovation_model.hpp"
#include "sepcal/fit.hpp"

namespace sepcal::estimation {

struct FilterErrorStart {
  Eigen::VectorXd theta;  // ln of a process noise that no output shows: minus infinity
  /// Of ln of the noises (n_w + n_z): a process noise there adds nothing that a reading shows, an
  /// output's is what its readings resolve.
  Eigen::VectorXd floor;
  std::optional<Fit> output_error;  // where it could be fitted
  double cost_without = 0.0;        // V_m there without process noise; NaN without output_error
};

/// Throws Error where neither leads anywhere, saying what to give.
FilterErrorStart start_filter_error(const BlockModel& model, const Record& record,
                                    const Problem& problem, const InnovationModel& innovations);

}  // namespace sepcal::estimation
