// SPDX-License-Identifier: BSD-3-Clause
#include "many/output_error_flight.hpp"

#include <cmath>
#include <optional>
#include <utility>

#include "estimation/residual_colour.hpp"
#include "many/alone.hpp"
#include "sepcal/check_model.hpp"
#include "sepcal/fit.hpp"

namespace sepcal::many {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// The columns of a factor in another order, the last one where it is.
TriangularFactor reorder(const TriangularFactor& factor, std::vector<Index> order) {
  order.push_back(factor.columns() - 1);
  MatrixXd rows = factor.matrix()(Eigen::all, order);
  TriangularFactor reordered(factor.columns());
  reordered.absorb(rows);
  return reordered;
}

/// What the flight's own linear fit of some columns leaves of every output: rows x n_z.
MatrixXd own_residuals(const std::vector<MatrixXd>& tangents, const std::vector<Index>& columns,
                       const VectorXd& noise) {
  const auto k = static_cast<Index>(columns.size());
  TriangularFactor factor(static_cast<int>(k + 1));
  for (std::size_t j = 0; j < tangents.size(); ++j) {
    MatrixXd rows(tangents[j].rows(), k + 1);
    rows << tangents[j](Eigen::all, columns), tangents[j].rightCols<1>();
    rows /= noise[static_cast<Index>(j)];
    factor.absorb(rows);
  }
  const MatrixXd& T = factor.matrix();
  const VectorXd step = solve_triangular(T.topLeftCorner(k, k), T.col(k).head(k)).x;
  MatrixXd residuals(tangents.front().rows(), static_cast<Index>(tangents.size()));
  for (std::size_t j = 0; j < tangents.size(); ++j) {
    residuals.col(static_cast<Index>(j)) =
        tangents[j].rightCols<1>() - tangents[j](Eigen::all, columns) * step;
  }
  return residuals;
}

}  // namespace

OutputErrorFlight::OutputErrorFlight(const BlockModel& model, Record given,
                                     const ManyOptions& options)
    : record_(std::move(given)),
      problem_(model, alone(options.fit)),
      parting_(split(problem_, options.own)),
      second_(record_.select(options.fit.stage_two_segments)),
      measurements_(problem_.model(), second_),
      pool_(options.fit.threads),
      whole_(model) {
  problem_.check_measurements(measurements_.rows());
}

FlightStart OutputErrorFlight::start() const {
  const Fit fitted = fit(whole_, record_, problem_.options());
  FlightStart start{.status = fitted.status, .message = fitted.message};
  const Index n_z = problem_.model().tables().n_z();
  VectorXd x(static_cast<Index>(problem_.parameters().size()));
  for (Index k = 0; k < x.size(); ++k) {
    x[k] = fitted[problem_.parameters()[static_cast<std::size_t>(k)].name].value;
  }
  start.x = x(parting_.order());
  start.noise.resize(n_z);
  start.output_squares.resize(n_z);
  for (Index j = 0; j < n_z; ++j) {
    start.noise[j] = fitted.noise[static_cast<std::size_t>(j)].value;
    start.output_squares[j] = measurements_.output_square(static_cast<int>(j));
  }
  start.factors = linearise(start.x);
  start.rows = fitted.rows;
  return start;
}

std::vector<TriangularFactor> OutputErrorFlight::linearise(const VectorXd& x) const {
  const VectorXd ordered = in_order(x);
  const Index n_1 = problem_.model().tables().n_1();
  std::vector<TriangularFactor> factors;
  for (const TriangularFactor& factor :
       sweep().tangent_factors(ordered.head(n_1), ordered.tail(x.size() - n_1))) {
    factors.push_back(reorder(factor, parting_.order()));
  }
  return factors;
}

MatrixXd OutputErrorFlight::score_covariance(const ScoreQuestion& question) const {
  const VectorXd x = in_order(question.x);
  const Index n_1 = problem_.model().tables().n_1();
  std::vector<MatrixXd> tangents = sweep().tangent_rows(x.head(n_1), x.tail(x.size() - n_1));
  const std::vector<Index> order = parting_.order();
  std::vector<Index> columns;
  for (const Index k : question.columns) columns.push_back(order[static_cast<std::size_t>(k)]);
  const MatrixXd residuals = own_residuals(tangents, columns, question.noise);
  const auto freedom = static_cast<double>(residuals.size() - x.size());
  if (!(freedom > 0.0) || !residuals.allFinite()) return {};
  const std::vector<Segment>& runs = measurements_.runs();
  const auto models =
      estimation::find_output_noise(tangents, columns, residuals, runs, question.rounding, pool_);
  const estimation::ScoreNoise noise{question.noise, models, runs};
  MatrixXd covariance =
      estimation::find_score_covariance(std::move(tangents), noise, columns, question.K, pool_);
  if (!covariance.allFinite()) return {};
  return covariance;
}

VectorXd OutputErrorFlight::in_order(const VectorXd& x) const {
  VectorXd ordered(x.size());
  ordered(parting_.order()) = x;
  return ordered;
}

}  // namespace sepcal::many
