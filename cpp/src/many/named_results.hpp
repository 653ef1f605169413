// SPDX-License-Identifier: BSD-3-Clause
// Where a joint fit ended, by names, whatever the method.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "estimation/problem.hpp"
#include "many/split.hpp"
#include "sepcal/fit_many.hpp"

namespace sepcal::many {

/// Without standard errors.
Parameter to_parameter(const Variable& variable, double value, bool at_bound);

/// `places`: of those that have a standard error, the covariances' k.
void set_errors(std::vector<Parameter>& parameters, const std::vector<Eigen::Index>& places,
                const Eigen::MatrixXd& coloured, const Eigen::MatrixXd& white);

struct SharedParameters {
  std::vector<Parameter> parameters;  // in the model's order, fixed ones among them
  std::vector<Eigen::Index> places;   // of each free one there, in the split's order
};

/// `x`, `at_bound`: of the free shared parameters.
SharedParameters list_shared(const BlockModel& model, const estimation::Problem& problem,
                             const Split& parting, const Eigen::VectorXd& x,
                             const std::vector<bool>& at_bound);

/// A departure whose differences are those of `names` at `places`.
Departure named(Departure departure, const std::vector<std::string>& names,
                const std::vector<Eigen::Index>& places);

}  // namespace sepcal::many
