// SPDX-License-Identifier: BSD-3-Clause
#include "diagnosis/likelihood_ratio.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include "diagnosis/held_out.hpp"
#include "diagnosis/projection.hpp"
#include "numerics/tails.hpp"

namespace sepcal::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Each stride-th row of every run, without segments.
struct Thinned {
  RowLayout layout;
  std::vector<Index> rows;  // among count()
};

Thinned thin_out(const RowLayout& layout, Index most_rows) {
  const Index stride = (layout.rows + most_rows - 1) / most_rows;
  Thinned thinned;
  std::vector<Index> of_output;
  for (const Segment& run : layout.runs) {
    const auto first = of_output.size();
    for (std::size_t row = run.first; row < run.last; row += static_cast<std::size_t>(stride))
      of_output.push_back(static_cast<Index>(row));
    thinned.layout.runs.push_back({run.label, first, of_output.size()});
  }
  thinned.layout.outputs = layout.outputs;
  thinned.layout.rows = static_cast<Index>(of_output.size());
  for (std::size_t j = 0; j < layout.outputs.size(); ++j) {
    for (const Index row : of_output) thinned.rows.push_back(layout.first(j) + row);
  }
  return thinned;
}

MatrixXd join(const MatrixXd& left, const MatrixXd& right) {
  MatrixXd both(left.rows(), left.cols() + right.cols());
  both << left, right;
  return both;
}

}  // namespace

NullHypothesis find_null(const Linearisation& fit) {
  NullHypothesis null{.fit = &fit};
  null.basis = orthonormal_basis(fit.tangent);
  const VectorXd residual = remove_span(null.basis, fit.residual);
  const NoiseModels noise = fit_noise_models(fit.layout, residual);
  null.best = maximise(fit.layout, null.basis, residual, {noise, forget_colour(noise)});
  MatrixXd white = join(null.basis, residual);
  whiten(fit.layout, null.best.noise, white);
  null.white_basis = orthonormal_basis(white.leftCols(null.basis.cols()));
  null.white_residual = remove_span(null.white_basis, white.rightCols<1>());
  return null;
}

double predict_drop(const NullHypothesis& null, const MatrixXd& added) {
  const Linearisation& fit = *null.fit;
  const VectorXd left = remove_span(added, remove_span(null.basis, fit.residual));
  return 1.0 - total_rmse(fit.layout, left) / total_rmse(fit.layout, fit.residual);
}

LikelihoodRatio compare_with_null(const NullHypothesis& null, const MatrixXd& added) {
  const RowLayout& layout = null.fit->layout;
  const VectorXd& residual = null.fit->residual;
  const MatrixXd columns = join(null.basis, added);
  std::vector<NoiseModels> starts{null.best.noise};
  // Where the effect looks like slow noise, the search must also begin with the effect taken out
  // and noise without colour.
  if (std::ranges::any_of(null.best.noise, is_coloured)) {
    const VectorXd left = remove_span(added, remove_span(null.basis, residual));
    NoiseModels plain = forget_colour(null.best.noise);
    for (std::size_t j = 0; j < plain.size(); ++j) {
      const double square = left.segment(layout.first(j), layout.rows).squaredNorm();
      plain[j].sigma = std::max(1e-9, std::sqrt(square / static_cast<double>(layout.rows)));
    }
    starts.push_back(std::move(plain));
  }
  LikelihoodRatio ratio;
  ratio.with = maximise(layout, columns, residual, starts);
  ratio.value =
      std::max(0.0, null.best.minus_two_log_likelihood - ratio.with.minus_two_log_likelihood);
  return ratio;
}

VectorXd simulate_ratios(const NullHypothesis& null, const MatrixXd& added, int simulations,
                         std::uint64_t seed, base::ThreadPool& pool) {
  constexpr Index most_rows = 400;
  constexpr double roughly = 0.05;  // in -2 ln L, of the search for the noise model
  const Thinned thinned = thin_out(null.fit->layout, most_rows);
  const MatrixXd basis = orthonormal_basis(null.basis(thinned.rows, Eigen::all));
  const MatrixXd columns =
      join(basis, orthonormal_basis(remove_span(basis, added(thinned.rows, Eigen::all))));
  const RowLayout& layout = thinned.layout;
  const NoiseModels& noise = null.best.noise;
  std::mt19937_64 generator(seed);
  const VectorXd innovations = null.white_residual(thinned.rows);
  MatrixXd draws(layout.count(), simulations);
  for (std::size_t j = 0; j < layout.outputs.size(); ++j) {
    draws.middleRows(layout.first(j), layout.rows) =
        simulate_noise(noise[j], layout.runs, simulations, generator,
                       innovations.segment(layout.first(j), layout.rows));
  }
  const WhitenedColumns small(layout, basis, noise);
  const WhitenedColumns large(layout, columns, noise);
  VectorXd ratios(simulations);
  pool.for_each(static_cast<std::size_t>(simulations), [&](std::size_t i) {
    const VectorXd residual = draws.col(static_cast<Index>(i));
    ratios[static_cast<Index>(i)] =
        std::max(0.0, small.step(residual, roughly, true).minus_two_log_likelihood -
                          large.step(residual, roughly, true).minus_two_log_likelihood);
  });
  return ratios;
}

Inflation inflation_of(const VectorXd& ratios, int freedom) {
  VectorXd sorted = ratios;
  std::ranges::sort(sorted);
  const auto larger = [&](double share) {
    const auto at = static_cast<Index>(share * static_cast<double>(sorted.size()));
    return std::max(1.0, sorted[at] / numerics::chi_squared_point(1.0 - share, freedom));
  };
  return {larger(0.5), larger(0.9)};
}

double log10_ratio_tail(double ratio, int freedom, const Inflation& inflation) {
  // By chance the ninetieth percentile may be inflated less: no reason for a shorter tail.
  const double median =
      std::min(inflation.median, inflation.ninetieth) * numerics::chi_squared_point(0.5, freedom);
  const double ninetieth = inflation.ninetieth * numerics::chi_squared_point(0.1, freedom);
  double few = 0.02;  // the freedom of a chi-squared whose percentiles have that ratio
  double many = 4.0 * freedom + 100.0;
  for (int i = 0; i < 60; ++i) {
    const double middle = std::sqrt(few * many);
    const double spread =
        numerics::chi_squared_point(0.1, middle) / numerics::chi_squared_point(0.5, middle);
    (spread > ninetieth / median ? few : many) = middle;
  }
  const double scale = median / numerics::chi_squared_point(0.5, few);
  // Both have the ninetieth percentile; the first is too strict far out, the second of many
  // columns.
  const double stretched = numerics::log10_chi_squared_tail(ratio / scale, few);
  const double larger = std::max(inflation.median, inflation.ninetieth);
  const double scaled = numerics::log10_chi_squared_tail(ratio / larger, freedom);
  return std::max(std::min(stretched, scaled), numerics::log10_chi_squared_tail(ratio, freedom));
}

}  // namespace sepcal::diagnosis
