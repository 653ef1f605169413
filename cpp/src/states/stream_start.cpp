// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/states/stream_start.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "base/name_list.hpp"
#include "base/thread_pool.hpp"
#include "estimation/problem.hpp"
#include "model/sweep.hpp"
#include "sepcal/detail/triangular_factor.hpp"
#include "sepcal/error.hpp"
#include "states/restricted_likelihood.hpp"

namespace sepcal {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Places of the parameters that keep(parameter) says.
std::vector<int> places_of(const Fit& fit, const auto& keep) {
  std::vector<int> places;
  for (std::size_t k = 0; k < fit.parameters.size(); ++k) {
    if (keep(fit.parameters[k])) places.push_back(static_cast<int>(k));
  }
  return places;
}

/// What a fit says of its parameters and outputs, without R.
StreamStart begin(const Fit& fit) {
  StreamStart start;
  if (fit.method == FitMethod::filter_error) {
    std::vector<double> sizes;
    for (const NoiseSize& size : fit.noise_sizes) sizes.push_back(size.value);
    const auto n_w = static_cast<Index>(sizes.size() - fit.noise.size());  // outputs are behind
    start.process_noise = Eigen::Map<const VectorXd>(sizes.data(), n_w);
  }
  for (const Parameter& parameter : fit.parameters) start.names.push_back(parameter.name);
  start.xi = fit.values();
  start.noise.resize(static_cast<Index>(fit.noise.size()));
  for (Index j = 0; j < start.noise.size(); ++j) {
    const OutputValue& output = fit.noise[static_cast<std::size_t>(j)];
    start.noise[j] = output.value;
    start.outputs.push_back(output.name);
  }
  return start;
}

/// Those that the rows don't determine, or leave at a bound.
std::vector<std::string> open_in(const Fit& fit) {
  std::vector<std::string> names;
  for (const Parameter& parameter : fit.parameters) {
    if (!parameter.fixed && !std::isfinite(parameter.standard_error)) {
      names.push_back(parameter.name);
    }
  }
  return names;
}

void check_rows(const Record& record, std::size_t rows) {
  if (rows > 0 && rows < record.rows()) return;
  throw Error("start_rows is " + std::to_string(rows) + "; the record has " +
              std::to_string(record.rows()) + " rows: take fewer, so that some are left to track");
}

/// T of the rows at the fit, with priors.
MatrixXd factor_of(const estimation::Problem& problem, const Record& record, const VectorXd& x,
                   const VectorXd& noise, int threads) {
  base::ThreadPool pool(threads);
  const model::Measurements measurements(problem.model(), record);
  const model::Sweep sweep(problem.model(), measurements, pool);
  const Index n_1 = problem.model().tables().n_1();
  TriangularFactor factor =
      combine(sweep.tangent_factors(x.head(n_1), x.tail(x.size() - n_1)), noise.cwiseInverse());
  for (const estimation::Prior& prior : problem.prior()) prior.join(factor, x);
  return factor.matrix();
}

}  // namespace

void StreamStart::require_all(int n) const {
  if (static_cast<int>(xi.size()) != n) {
    throw Error("the start has " + std::to_string(xi.size()) + " parameters, the filter " +
                std::to_string(n));
  }
  for (int k = 0; k < n; ++k) {
    if (std::ranges::find(free, k) != free.end()) continue;
    throw Error("'" + names[static_cast<std::size_t>(k)] +
                "' is held; a filter of all parameters needs a start that estimates it");
  }
}

Record first_rows(const Record& record, std::size_t rows) {
  std::vector<Segment> segments;
  for (Segment segment : record.segments()) {
    if (rows == 0) break;
    segment.last = segment.first + std::min(rows, segment.rows());
    rows -= segment.rows();
    segments.push_back(segment);
  }
  Record result = record;
  return result.cut(std::move(segments));
}

StreamStart start_from_rows(const BlockModel& model, const Record& record, std::size_t rows,
                            const FitOptions& options) {
  check_rows(record, rows);
  const Record batch = first_rows(record, rows);
  Fit fit = sepcal::fit(model, batch, options);
  if (options.method == FitMethod::filter_error && fit.status == FitStatus::converged &&
      !states::tells_process_noises(fit)) {
    fit = states::fit_restricted(model, batch, options, fit);
  }
  if (fit.status == FitStatus::not_identifiable) {
    const std::vector<std::string> open = open_in(fit);
    throw Error("the first " + std::to_string(rows) + " rows leave " +
                (open.empty() ? "parameters" : base::list_first(open, 6)) +
                " open: take more of them, hold parameters or give a prior" +
                (fit.message.empty() ? "" : " (" + fit.message + ")"));
  }
  if (options.method == FitMethod::filter_error) {
    if (fit.status == FitStatus::not_converged) {
      throw Error("the fit of the first " + std::to_string(rows) +
                  " rows does not converge: take more of them" +
                  (fit.message.empty() ? "" : " (" + fit.message + ")"));
    }
    if (const std::vector<std::string> open = open_in(fit); !open.empty()) {
      throw Error("the first " + std::to_string(rows) + " rows leave " + base::list_first(open, 6) +
                  " at a bound or open: take more of them, hold parameters or give a prior");
    }
    StreamStart start = start_from_fit(fit);
    start.rows = rows;
    return start;
  }
  StreamStart start = begin(fit);
  start.free = places_of(fit, [](const Parameter& parameter) { return !parameter.fixed; });
  start.rows = rows;
  if (options.noise.empty()) {
    const double values = static_cast<double>(rows) * static_cast<double>(start.noise.size());
    start.noise *= std::sqrt(values / (values - static_cast<double>(start.free.size())));
  }
  const estimation::Problem problem(model, options);
  const auto k = static_cast<Index>(start.free.size());
  start.R = factor_of(problem, batch, start.xi(start.free), start.noise, options.threads)
                .topLeftCorner(k, k);
  return start;
}

StreamStart start_from_fit(const Fit& fit) {
  StreamStart start = begin(fit);
  start.free = places_of(
      fit, [](const Parameter& parameter) { return std::isfinite(parameter.standard_error); });
  if (start.free.empty()) {
    throw Error("the calibration has no standard errors to start from; start from the first rows");
  }
  // P = L L', and (R'R)^-1 = P for R = L^-1, made triangular the other way round.
  const MatrixXd P = fit.covariance(start.free, start.free);
  const MatrixXd L = P.llt().matrixL();
  MatrixXd rows = L.triangularView<Eigen::Lower>().solve(MatrixXd::Identity(P.rows(), P.cols()));
  TriangularFactor factor(static_cast<int>(P.cols()));
  factor.absorb(rows);
  start.R = factor.matrix();
  if (!start.R.allFinite()) {
    throw Error("the calibration's covariance is not positive; start from the first rows");
  }
  return start;
}

}  // namespace sepcal
