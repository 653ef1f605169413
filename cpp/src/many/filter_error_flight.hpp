// SPDX-License-Identifier: BSD-3-Clause
// One flight of a joint fit by filter error: its own fit, the factor of its score rows with V_m,
// and what its innovations amount to. A point x is [own | shared], the logarithms of noises that
// are not given at its end.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "estimation/problem.hpp"
#include "estimation/theta_layout.hpp"
#include "many/split.hpp"
#include "sepcal/detail/innovation_model.hpp"
#include "sepcal/fit_many.hpp"

namespace sepcal::many {

class FilterErrorFlight {
 public:
  /// `model` must outlive it. Throws Error as fit() does.
  FilterErrorFlight(const BlockModel& model, const Record& record, const ManyOptions& options);

  FlightStart start() const;
  FlightScore score(const Eigen::VectorXd& x) const;
  FlightInnovations innovations(const Eigen::VectorXd& x) const;
  std::vector<TriangularFactor> score_blocks(const Eigen::VectorXd& x, int blocks) const;

 private:
  Eigen::Index noises() const {
    return static_cast<Eigen::Index>(layout_.free().size()) - layout_.free_parameters();
  }
  Eigen::VectorXd theta_of(const Eigen::VectorXd& x) const;

  const BlockModel& model_;
  Record record_;
  estimation::Problem problem_;
  std::unique_ptr<InnovationModel> innovations_;
  estimation::ThetaLayout layout_;
  std::vector<Eigen::Index> places_;  // of x in theta, and the residual's column
};

}  // namespace sepcal::many
