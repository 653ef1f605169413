// SPDX-License-Identifier: BSD-3-Clause
// One flight of a joint fit: its own fit, its factors, the covariance of its score.
#include <cmath>
#include <optional>

#include "estimation/residual_colour.hpp"
#include "many/split.hpp"
#include "model/sweep.hpp"
#include "sepcal/check_model.hpp"
#include "sepcal/fit_many.hpp"

namespace sepcal {

using namespace many;  // this room's own

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

/// For each flight alone.
FitOptions alone(FitOptions options) {
  options.coloured_errors = false;  // nobody asks for them
  options.progress = {};
  return options;
}

}  // namespace

struct FlightProblem::Parts {
  Parts(const BlockModel& model, Record given, const ManyOptions& options)
      : record(std::move(given)),
        problem(model, alone(options.fit)),
        parting(split(problem, options.own)),
        second(record.select(options.fit.stage_two_segments)),
        measurements(problem.model(), second),
        pool(options.fit.threads),
        whole(model) {
    problem.check_measurements(measurements.rows());
  }

  /// The model's order from [own | shared].
  VectorXd in_order(const VectorXd& x) const {
    VectorXd ordered(x.size());
    ordered(parting.order()) = x;
    return ordered;
  }

  model::Sweep sweep() const { return {problem.model(), measurements, pool}; }

  Record record;
  estimation::Problem problem;
  Split parting;
  Record second;
  model::Measurements measurements;
  mutable base::ThreadPool pool;
  const BlockModel& whole;
};

FlightProblem::FlightProblem(const BlockModel& model, Record record, const ManyOptions& options)
    : parts_(std::make_unique<const Parts>(model, std::move(record), options)) {}

FlightProblem::~FlightProblem() = default;

FlightStart FlightProblem::start() const {
  const Parts& parts = *parts_;
  const Fit fitted = fit(parts.whole, parts.record, parts.problem.options());
  FlightStart start{.status = fitted.status, .message = fitted.message};
  const Index n_z = parts.problem.model().tables().n_z();
  VectorXd x(static_cast<Index>(parts.problem.parameters().size()));
  for (Index k = 0; k < x.size(); ++k) {
    x[k] = fitted[parts.problem.parameters()[static_cast<std::size_t>(k)].name].value;
  }
  start.x = x(parts.parting.order());
  start.noise.resize(n_z);
  start.output_squares.resize(n_z);
  for (Index j = 0; j < n_z; ++j) {
    start.noise[j] = fitted.noise[static_cast<std::size_t>(j)].value;
    start.output_squares[j] = parts.measurements.output_square(static_cast<int>(j));
  }
  start.factors = linearise(start.x);
  start.rows = fitted.rows;
  return start;
}

std::vector<TriangularFactor> FlightProblem::linearise(const VectorXd& x) const {
  const VectorXd ordered = parts_->in_order(x);
  const Index n_1 = parts_->problem.model().tables().n_1();
  std::vector<TriangularFactor> factors;
  for (const TriangularFactor& factor :
       parts_->sweep().tangent_factors(ordered.head(n_1), ordered.tail(x.size() - n_1))) {
    factors.push_back(reorder(factor, parts_->parting.order()));
  }
  return factors;
}

MatrixXd FlightProblem::score_covariance(const ScoreQuestion& question) const {
  const VectorXd x = parts_->in_order(question.x);
  const Index n_1 = parts_->problem.model().tables().n_1();
  std::vector<MatrixXd> tangents =
      parts_->sweep().tangent_rows(x.head(n_1), x.tail(x.size() - n_1));
  const std::vector<Index> order = parts_->parting.order();
  std::vector<Index> columns;
  for (const Index k : question.columns) columns.push_back(order[static_cast<std::size_t>(k)]);
  const MatrixXd residuals = own_residuals(tangents, columns, question.noise);
  const auto freedom = static_cast<double>(residuals.size() - x.size());
  if (!(freedom > 0.0) || !residuals.allFinite()) return {};
  const std::vector<Segment>& runs = parts_->measurements.runs();
  const auto models = estimation::find_output_noise(tangents, columns, residuals, runs,
                                                    question.rounding, parts_->pool);
  const estimation::ScoreNoise noise{question.noise, models, runs};
  MatrixXd covariance = estimation::find_score_covariance(std::move(tangents), noise, columns,
                                                          question.K, parts_->pool);
  if (!covariance.allFinite()) return {};
  return covariance;
}

}  // namespace sepcal
