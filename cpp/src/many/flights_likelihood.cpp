// SPDX-License-Identifier: BSD-3-Clause
#include "many/flights_likelihood.hpp"

namespace sepcal::many {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

ScoredLikelihood::Value FlightsLikelihood::value(const VectorXd& theta) const {
  Value sum;
  for (const FlightScore& score : ask(theta)) {
    sum.cost += score.cost;
    sum.readings += score.readings;
  }
  return sum;
}

ScoredLikelihood::Value FlightsLikelihood::scores(const VectorXd& theta,
                                                  const VisitScores& visit) const {
  const Value sum = value(theta);
  for (Index i = 0; i < layout_.flights; ++i) {
    MatrixXd rows = spread(scores_[static_cast<std::size_t>(i)].factor, i);
    visit(static_cast<std::size_t>(i), rows);
  }
  return sum;
}

const std::vector<FlightScore>& FlightsLikelihood::ask(const VectorXd& theta) const {
  if (at_.size() == theta.size() && at_ == theta) return scores_;
  scores_ = source_.scores(points(theta));
  at_ = theta;
  ++passes_;
  return scores_;
}

std::vector<FlightPoint> FlightsLikelihood::points(const VectorXd& theta) const {
  std::vector<FlightPoint> points;
  for (Index i = 0; i < layout_.flights; ++i) {
    points.push_back({flights_[static_cast<std::size_t>(i)], layout_.point(theta, i)});
  }
  return points;
}

MatrixXd FlightsLikelihood::spread(const TriangularFactor& factor, Index flight) const {
  MatrixXd rows = MatrixXd::Zero(factor.columns(), size() + 1);
  for (Index k = 0; k < layout_.own + layout_.shared; ++k) {
    rows.col(layout_.place(flight, k)) = factor.matrix().col(k);
  }
  rows.rightCols<1>() = factor.matrix().rightCols<1>();
  return rows;
}

}  // namespace sepcal::many
