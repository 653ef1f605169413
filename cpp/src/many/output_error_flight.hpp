// SPDX-License-Identifier: BSD-3-Clause
// One flight of a joint fit by output error: its own fit, its factors, the covariance of its score.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "base/thread_pool.hpp"
#include "estimation/problem.hpp"
#include "many/split.hpp"
#include "model/measurements.hpp"
#include "model/sweep.hpp"
#include "sepcal/fit_many.hpp"

namespace sepcal::many {

class OutputErrorFlight {
 public:
  /// `model` must outlive it. Throws Error as fit() does.
  OutputErrorFlight(const BlockModel& model, Record given, const ManyOptions& options);

  FlightStart start() const;
  std::vector<TriangularFactor> linearise(const Eigen::VectorXd& x) const;
  Eigen::MatrixXd score_covariance(const ScoreQuestion& question) const;

 private:
  /// The model's order from [own | shared].
  Eigen::VectorXd in_order(const Eigen::VectorXd& x) const;
  model::Sweep sweep() const { return {problem_.model(), measurements_, pool_}; }

  Record record_;
  estimation::Problem problem_;
  Split parting_;
  Record second_;
  model::Measurements measurements_;
  mutable base::ThreadPool pool_;
  const BlockModel& whole_;
};

}  // namespace sepcal::many
