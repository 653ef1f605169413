// SPDX-License-Identifier: BSD-3-Clause
// One flight of a joint fit, by the method that is asked for.
#include <memory>
#include <utility>

#include "many/filter_error_flight.hpp"
#include "many/output_error_flight.hpp"
#include "sepcal/fit_many.hpp"

namespace sepcal {

using namespace many;  // this room's own

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// One of the two.
struct FlightProblem::Parts {
  std::unique_ptr<const OutputErrorFlight> squares;
  std::unique_ptr<const FilterErrorFlight> likelihood;
};

FlightProblem::FlightProblem(const BlockModel& model, Record record, const ManyOptions& options) {
  Parts parts;
  if (options.fit.method == FitMethod::filter_error) {
    parts.likelihood = std::make_unique<const FilterErrorFlight>(model, std::move(record), options);
  } else {
    parts.squares = std::make_unique<const OutputErrorFlight>(model, std::move(record), options);
  }
  parts_ = std::make_unique<const Parts>(std::move(parts));
}

FlightProblem::~FlightProblem() = default;

FlightStart FlightProblem::start() const {
  return parts_->likelihood ? parts_->likelihood->start() : parts_->squares->start();
}

std::vector<TriangularFactor> FlightProblem::linearise(const VectorXd& x) const {
  return parts_->squares->linearise(x);
}

MatrixXd FlightProblem::score_covariance(const ScoreQuestion& question) const {
  return parts_->squares->score_covariance(question);
}

FlightScore FlightProblem::score(const VectorXd& x) const { return parts_->likelihood->score(x); }

FlightInnovations FlightProblem::innovations(const VectorXd& x) const {
  return parts_->likelihood->innovations(x);
}

std::vector<TriangularFactor> FlightProblem::score_blocks(const VectorXd& x, int blocks) const {
  return parts_->likelihood->score_blocks(x, blocks);
}

}  // namespace sepcal
