// SPDX-License-Identifier: BSD-3-Clause
#include "many/filter_error_flight.hpp"

#include <cmath>

#include "estimation/filter_error.hpp"
#include "estimation/innovation_summary.hpp"
#include "many/alone.hpp"
#include "sepcal/fit.hpp"

namespace sepcal::many {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// The flight's record is of stage two's segments already.
FitOptions whole_record(FitOptions options) {
  options.stage_one_segments.clear();
  options.stage_two_segments.clear();
  return options;
}

}  // namespace

FilterErrorFlight::FilterErrorFlight(const BlockModel& model, const Record& record,
                                     const ManyOptions& options)
    : model_(model),
      record_(record.select(options.fit.stage_two_segments)),
      problem_(model, whole_record(alone(options.fit))),
      innovations_(estimation::innovations_of(model, record_, problem_.options())),
      layout_(model, problem_, *innovations_) {
  const Split parting = split_with_noises(problem_, options.own, noises());
  for (const Index k : parting.order()) {
    places_.push_back(layout_.free()[static_cast<std::size_t>(k)]);
  }
  places_.push_back(layout_.size());
}

FlightStart FilterErrorFlight::start() const {
  const Fit fitted = fit(model_, record_, problem_.options());
  FlightStart start{.status = fitted.status, .message = fitted.message, .rows = fitted.rows};
  const auto n = static_cast<Index>(places_.size()) - 1;
  const VectorXd theta = estimation::theta_of(fitted);
  const VectorXd floor = layout_.floor_of(fitted);
  start.x = theta(std::vector<Index>(places_.begin(), places_.end() - 1));
  start.floor.resize(noises());
  for (Index k = 0; k < noises(); ++k) {
    start.floor[k] = floor[places_[static_cast<std::size_t>(n - noises() + k)] - layout_.n()];
  }
  start.noise = theta.tail(innovations_->outputs()).array().exp();
  start.factors = {score(start.x).factor};
  return start;
}

FlightScore FilterErrorFlight::score(const VectorXd& x) const {
  FlightScore score{.factor = TriangularFactor(static_cast<int>(places_.size()))};
  const InnovationModel::Value value =
      innovations_->scores(theta_of(x), [&](std::size_t /*row*/, MatrixXd& rows) {
        MatrixXd chosen = rows(Eigen::all, places_);
        score.factor.absorb(chosen);
      });
  score.cost = value.cost;
  score.readings = value.readings;
  score.row = value.row;
  return score;
}

FlightInnovations FilterErrorFlight::innovations(const VectorXd& x) const {
  const estimation::InnovationSummary summary =
      estimation::summarise(*innovations_, model_, record_, theta_of(x));
  return {summary.squares, summary.counts, summary.readings, summary.memory};
}

std::vector<TriangularFactor> FilterErrorFlight::score_blocks(const VectorXd& x, int blocks) const {
  return estimation::score_blocks(*innovations_, record_, theta_of(x), places_, blocks);
}

VectorXd FilterErrorFlight::theta_of(const VectorXd& x) const {
  VectorXd theta = layout_.given();
  for (Index k = 0; k < x.size(); ++k) theta[places_[static_cast<std::size_t>(k)]] = x[k];
  return theta;
}

}  // namespace sepcal::many
