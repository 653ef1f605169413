// SPDX-License-Identifier: BSD-3-Clause
#include "diagnosis/noise_test.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include "diagnosis/projection.hpp"
#include "diagnosis/reduced_rows.hpp"
#include "diagnosis/sign_flips.hpp"
#include "numerics/order_statistics.hpp"
#include "numerics/tails.hpp"

namespace sepcal::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using noise::NoiseFamilies;
using noise::NoiseFamily;

void whiten_outputs(const NoiseFamilies& families, const RowLayout& layout,
                    const NoiseMembers& noise, MatrixXd& columns) {
  for (std::size_t j = 0; j < noise.size(); ++j) {
    families.whiten(noise[j], columns.middleRows(layout.first(j), layout.rows));
  }
}

/// Of both families.
const FamilyFit& likeliest(const std::array<FamilyFit, 2>& fits) {
  return *std::ranges::min_element(fits, {}, &FamilyFit::minus_two_log_likelihood);
}

double median(const VectorXd& values) {
  return numerics::upper_median({values.begin(), values.end()});
}

/// Sizes of innovations, output by output: no larger than 4 robust standard deviations.
VectorXd cap_sizes(const RowLayout& layout, const MatrixXd& white) {
  constexpr double robust = 1.4826;
  VectorXd sizes = white.col(0).cwiseAbs();
  for (std::size_t j = 0; j < layout.outputs.size(); ++j) {
    auto own = sizes.segment(layout.first(j), layout.rows);
    own = own.cwiseMin(4.0 * robust * median(own));
  }
  return sizes;
}

/// Noise of members whose innovations have these sizes and signs by chance.
VectorXd draw(const NoiseFamilies& families, const RowLayout& layout, const NoiseMembers& noise,
              const VectorXd& sizes, std::mt19937_64& generator) {
  VectorXd drawn = sizes;
  flip_signs(drawn, generator);
  for (std::size_t j = 0; j < noise.size(); ++j) {
    families.colour(noise[j], drawn.segment(layout.first(j), layout.rows));
  }
  return drawn;
}

/// By how much draws of a ratio are larger than chi-squared's: at the median or at the ninetieth
/// percentile, at least 1.
double enlargement(std::vector<double> ratios, int freedom) {
  if (freedom == 0 || ratios.empty()) return 1.0;
  std::ranges::sort(ratios);
  const auto at = [&](double share) {
    const auto place = static_cast<std::size_t>(share * static_cast<double>(ratios.size()));
    return ratios[place] / numerics::chi_squared_point(1.0 - share, freedom);
  };
  return std::max({1.0, at(0.5), at(0.9)});
}

double log10_tail(double ratio, int freedom) {
  if (ratio == infinity) return -infinity;
  return numerics::log10_chi_squared_tail(ratio, static_cast<double>(freedom));
}

}  // namespace

NoiseTest::NoiseTest(const TangentBasis& tangent, std::vector<int> orders)
    : fit_(tangent.fit()),
      basis_(tangent.columns()),
      orders_(std::move(orders)),
      families_(fit_.layout.runs),
      known_(std::make_unique<const KnownProducts>(families_, fit_.layout, basis_, fit_.residual,
                                                   orders_)),
      inputs_(tangent) {
  const auto products = [this](const NoiseMembers& noise) { return known_->beside(noise, {}); };
  nulls_ = fit_families(families_, fit_.layout, basis_, fit_.residual, orders_, products);
  for (FamilyFit& null : nulls_) finish_fit(products, null);
}

NoiseTest::Ratios NoiseTest::compare(const Columns& added) const {
  const Columns columns = join(basis_, added);
  const auto products = [&](const NoiseMembers& noise) { return known_->beside(noise, added); };
  const auto with =
      fit_families(families_, fit_.layout, columns, fit_.residual, orders_, products, &nulls_);
  Ratios ratios;
  for (std::size_t k = 0; k < nulls_.size(); ++k) {
    ratios.own[k] =
        std::max(0.0, nulls_[k].minus_two_log_likelihood - with[k].minus_two_log_likelihood);
  }
  ratios.with = likeliest(with);
  finish_fit(products, ratios.with);
  double null = likeliest(nulls_).minus_two_log_likelihood;
  double least_with = ratios.with.minus_two_log_likelihood;
  if (!inputs_.is_empty()) {
    const InputDrift::Likelihoods of_inputs = inputs_.compare(added);
    ratios.of_inputs = of_inputs.ratio();
    ratios.inputs_drift = of_inputs.with < least_with;
    null = std::min(null, of_inputs.null);
    least_with = std::min(least_with, of_inputs.with);
  }
  ratios.joint = std::max(0.0, null - least_with);
  return ratios;
}

NoiseTails NoiseTest::tails(const Ratios& ratios, int freedom) {
  return {std::max({log10_tail(ratios.own[0], freedom), log10_tail(ratios.own[1], freedom),
                    log10_tail(ratios.of_inputs, freedom)}),
          log10_tail(ratios.joint, freedom)};
}

NoiseTails NoiseTest::calibrate(const Ratios& ratios, const Columns& added, const Drawing& drawing,
                                base::ThreadPool& pool) const {
  constexpr Index most_rows = 600;
  const RowLayout& layout = fit_.layout;
  const Columns columns = join(basis_, added);
  const ReducedRows reduction(layout, most_rows, drawing.smooth);
  const bool whole = reduction.stride == 1;
  MatrixXd basis = reduction.apply(layout, basis_);
  MatrixXd reduced_added = reduction.apply(layout, added);
  if (!whole) {
    basis = orthonormal_basis(std::move(basis));
    reduced_added = orthonormal_basis(remove_span(basis, reduced_added));
  }
  const NoiseFamilies reduced_families(reduction.layout.runs);
  MatrixXd reduced(basis.rows(), basis.cols() + reduced_added.cols());
  reduced << basis, reduced_added;
  const FamilyRegression regression(reduced_families, reduction.layout, std::move(reduced),
                                    orders_);

  // What a step leaves in its own row must not be drawn as noise.
  MatrixXd beside = subtract(layout, fit_.residual, columns, ratios.with.coefficients);
  whiten_outputs(families_, layout, ratios.with.noise, beside);
  const VectorXd beside_sizes = cap_sizes(layout, beside);
  VectorXd largest = beside.col(0).cwiseAbs();
  for (std::size_t j = 0; j < layout.outputs.size(); ++j) {
    auto own = largest.segment(layout.first(j), layout.rows);
    own.array() += 3.0 * median(own);
  }
  // What is drawn has the noise of this record.
  const FamilyRegression::Residual recorded =
      regression.take(reduction.apply(layout, view(fit_.residual)).col(0));
  const auto enlarge = [&](const FamilyFit& noise, const VectorXd& sizes, std::size_t which) {
    std::vector<VectorXd> residuals;
    std::mt19937_64 generator(drawing.seed + which);
    for (int i = 0; i < drawing.draws; ++i) {
      const VectorXd full = draw(families_, layout, noise.noise, sizes, generator);
      residuals.emplace_back(reduction.apply(layout, full).col(0));
    }
    std::vector<NoiseMembers> near;
    for (const NoiseFamily family : noise::noise_families) {
      const bool is_own = which >= 2 || family == noise::noise_families[which];
      if (is_own)
        near.push_back(recorded.fit(family, which < 2 ? basis.cols() : regression.columns()).noise);
    }
    std::vector<double> drawn(residuals.size());
    pool.for_each(residuals.size(), [&](std::size_t i) {
      const FamilyRegression::Residual drawn_residual = regression.take(residuals[i]);
      double without = infinity;
      double with = infinity;
      for (const NoiseMembers& noise_near : near) {
        const auto nested = drawn_residual.compare(noise_near, basis.cols());
        without = std::min(without, nested.without);
        with = std::min(with, nested.with);
      }
      drawn[i] = without - with;
    });
    return enlargement(std::move(drawn), static_cast<int>(reduced_added.cols()));
  };
  const auto freedom = static_cast<int>(added.cols());
  const auto enlarge_by_inputs = [&](InputDrift::Noise noise) {
    return enlargement(inputs_.draw_ratios(added, noise, drawing.draws, drawing.seed), freedom);
  };
  const double of_joint = ratios.inputs_drift ? enlarge_by_inputs(InputDrift::Noise::beside)
                                              : enlarge(ratios.with, beside_sizes, 2);
  Ratios enlarged = ratios;
  enlarged.joint /= of_joint;
  if (!inputs_.is_empty()) {
    enlarged.of_inputs /=
        drawing.beside_alone ? of_joint : enlarge_by_inputs(InputDrift::Noise::without);
  }
  for (std::size_t k = 0; k < nulls_.size(); ++k) {
    if (drawing.beside_alone) {
      enlarged.own[k] /= of_joint;
      continue;
    }
    MatrixXd white = subtract(layout, fit_.residual, basis_, nulls_[k].coefficients);
    whiten_outputs(families_, layout, nulls_[k].noise, white);
    enlarged.own[k] /= enlarge(nulls_[k], cap_sizes(layout, white).cwiseMin(largest), k);
  }
  return tails(enlarged, freedom);
}

MatrixXd NoiseTest::products(const NoiseMembers& noise, const Columns& X, const VectorXd& e) const {
  return family_products(families_, fit_.layout, noise, X, e);
}

double NoiseTest::floor(const NoiseMembers& noise) const {
  double square = 0.0;
  for (std::size_t j = 0; j < noise.size(); ++j) {
    const double sigma = families_.innovation(noise[j]) * fit_.layout.outputs[j].weight;
    square += sigma * sigma;
  }
  return std::sqrt(square / static_cast<double>(noise.size()));
}

}  // namespace sepcal::diagnosis
