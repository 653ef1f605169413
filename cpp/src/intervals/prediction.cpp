// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/prediction.hpp"

#include <algorithm>
#include <cmath>

#include "base/thread_pool.hpp"
#include "estimation/theta_layout.hpp"
#include "model/measurements.hpp"
#include "numerics/quantiles.hpp"
#include "sepcal/detail/innovation_model.hpp"
#include "sepcal/error.hpp"

namespace sepcal {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

void check_parameters(const BlockModel& model, const Fit& fit) {
  if (std::ranges::equal(fit.parameters, model.tables().parameters(), {}, &Parameter::name,
                         &Variable::name) &&
      fit.noise.size() == model.tables().outputs.size()) {
    return;
  }
  throw Error("the fit's parameters are not the model's; give the model that was fitted");
}

/// The record's inputs, with outputs of zeros: what was measured has no part here.
Record inputs_of(const BlockModel& model, const Record& record) {
  Record inputs;
  for (const Variable& input : model.tables().inputs) {
    if (record.has(input.name)) inputs.view(input.name, record.column(input.name));
  }
  for (const Variable& output : model.tables().outputs) {
    inputs.add(output.name, std::vector<double>(record.length(), 0.0));
  }
  inputs.cut(record.segments());
  return inputs;
}

/// The covariance with zeros for what is held or at a bound.
MatrixXd known_covariance(const Fit& fit) {
  MatrixXd covariance = fit.covariance;
  for (std::size_t k = 0; k < fit.parameters.size(); ++k) {
    if (!fit.parameters[k].fixed && !fit.parameters[k].at_bound) continue;
    covariance.row(static_cast<Index>(k)).setZero();
    covariance.col(static_cast<Index>(k)).setZero();
  }
  return covariance;
}

double measurements_of(const Fit& fit) { return static_cast<double>(fit.rows * fit.noise.size()); }

/// Measurements less free parameters.
double freedom_of(const Fit& fit) {
  const auto free = std::ranges::count(fit.parameters, false, &Parameter::fixed);
  return measurements_of(fit) - static_cast<double>(free);
}

double quantile_of(const Fit& fit, const FitOptions& options, double level) {
  return options.noise.empty() ? numerics::student_reach(level, freedom_of(fit))
                               : numerics::normal_reach(level);
}

/// The variance of output j's noise: as given, or R-hat times M / (M - n), as the covariance has
/// it.
double variance_of(const Fit& fit, const FitOptions& options, Index j) {
  const double noise = fit.noise[static_cast<std::size_t>(j)].value;
  const double ratio = options.noise.empty() ? measurements_of(fit) / freedom_of(fit) : 1.0;
  return ratio * noise * noise;
}

/// What the process noises of a fit by filter error add to the outputs' variance, over the rows of
/// the segments.
MatrixXd stirred_variance(const BlockModel& model, const Record& record, const Fit& fit) {
  const MatrixXd spread = model.innovations(record)->spread(estimation::theta_of(fit));
  MatrixXd variance(static_cast<Index>(record.rows()), spread.cols());
  Index at = 0;
  for (const Segment& segment : record.segments()) {
    const auto rows = static_cast<Index>(segment.rows());
    variance.middleRows(at, rows) =
        spread.middleRows(static_cast<Index>(segment.first), rows).cwiseAbs2();
    at += rows;
  }
  return variance;
}

/// sqrt(g' C g) of every row g; a variance that rounding made negative is zero, NaN stays.
VectorXd errors_of(const MatrixXd& rows, const MatrixXd& covariance) {
  const VectorXd squares = (rows * covariance).cwiseProduct(rows).rowwise().sum();
  return squares.unaryExpr([](double square) { return square < 0 ? 0.0 : std::sqrt(square); });
}

}  // namespace

Prediction predict(const BlockModel& model, const Record& record, const Fit& fit,
                   const FitOptions& options, double level) {
  check_parameters(model, fit);
  const Record inputs = inputs_of(model, record);
  const model::Measurements measurements(model, inputs);
  const auto rows = static_cast<Index>(measurements.rows());
  const Index n_1 = model.tables().n_1();
  const Index n = fit.values().size();
  const Index n_z = model.tables().n_z();
  const VectorXd xi1 = fit.xi1();
  const VectorXd xi2 = fit.xi2();
  const MatrixXd covariance = known_covariance(fit);

  Prediction result{MatrixXd(rows, n_z), MatrixXd(rows, n_z), MatrixXd(rows, n_z),
                    quantile_of(fit, options, level)};
  base::ThreadPool pool(options.threads);
  pool.for_each(measurements.chunks().size(), [&](std::size_t c) {
    const auto carry = model.new_carry();
    std::vector<const double*> pointers;
    for (const model::Measurements::Range& range : measurements.chunks()[c]) {
      const auto count = static_cast<Index>(range.rows);
      MatrixXd block(n_z * count, n + 1);
      model.evaluate(measurements.block(range, pointers), values_of(xi2), values_of(xi1),
                     carry.get(), block);
      const VectorXd value = block.leftCols(n_1) * xi1 + block.col(n);
      const VectorXd error = errors_of(block.leftCols(n), covariance);
      const auto at = static_cast<Index>(range.offset);
      for (Index j = 0; j < n_z; ++j) {
        result.value.col(j).segment(at, count) = value.segment(j * count, count);
        result.standard_error.col(j).segment(at, count) = error.segment(j * count, count);
      }
    }
  });
  MatrixXd noise = result.standard_error.cwiseAbs2();
  if (fit.method == FitMethod::filter_error) noise += stirred_variance(model, inputs, fit);
  for (Index j = 0; j < n_z; ++j) {
    result.measurement_error.col(j) = (noise.col(j).array() + variance_of(fit, options, j)).sqrt();
  }
  return result;
}

}  // namespace sepcal
