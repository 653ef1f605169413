// SPDX-License-Identifier: BSD-3-Clause
// A model along a record, in ranges: rows of [A | b] and measurements, each to be weighted by its
// output's 1/sigma.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "model/measurements.hpp"
#include "sepcal/detail/block_model.hpp"
#include "sepcal/detail/enclosure.hpp"

namespace sepcal::certificate {

using Ranges = std::vector<Enclosure>;  // of xi2 (n_2), or of xi1 (n_1)

class EnclosedProblem {
 public:
  /// `sigma`: of each output. All must outlive it. Throws Error where the model can't be enclosed.
  EnclosedProblem(const BlockModel& model, const Record& record, const Eigen::VectorXd& sigma);

  const BlockModel& model() const { return model_; }
  Eigen::Index rows() const { return static_cast<Eigen::Index>(z_.size()); }  // n_z * N
  int n_1() const { return model_.tables().n_1(); }
  int n_2() const { return model_.tables().n_2(); }
  double z(Eigen::Index row) const { return z_[static_cast<std::size_t>(row)]; }
  double weight(Eigen::Index row) const { return weights_[static_cast<std::size_t>(row)]; }

  /// [A | b] and its derivatives of all rows, not weighted.
  EnclosedRows over(const Ranges& xi2) const;

  /// J, which the model's parameters have exactly there.
  Enclosure cost(const Eigen::VectorXd& xi1, const Eigen::VectorXd& xi2) const;

 private:
  const BlockModel& model_;
  model::Measurements measurements_;
  std::vector<double> z_;
  std::vector<double> weights_;
};

Ranges points(const Eigen::VectorXd& x);

}  // namespace sepcal::certificate
