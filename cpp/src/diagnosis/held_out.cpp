// SPDX-License-Identifier: BSD-3-Clause
#include "diagnosis/held_out.hpp"

#include <algorithm>
#include <cmath>

#include "numerics/tall_products.hpp"
#include "numerics/toeplitz.hpp"
#include "sepcal/detail/triangular_factor.hpp"

namespace sepcal::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int folds_of_blocks = 6;

/// [J G e] of the rows of one fold, triangularised.
std::vector<TriangularFactor> factor_by_fold(const RowLayout& layout, const Columns& columns,
                                             const Folds& folds) {
  std::vector<TriangularFactor> factors(static_cast<std::size_t>(folds.count),
                                        TriangularFactor(static_cast<int>(columns.cols())));
  for (const HeldOutBlock& block : folds.blocks) {
    for (std::size_t j = 0; j < layout.outputs.size(); ++j) {
      for (Index row = block.first; row < block.last; row += panel_rows) {
        MatrixXd panel =
            columns.rows(layout.first(j) + row, std::min(panel_rows, block.last - row));
        factors[static_cast<std::size_t>(block.fold)].absorb(panel);
      }
    }
  }
  return factors;
}

/// The factor of [J e] from that of [J G e], of G's `added` columns.
TriangularFactor leave_out(const TriangularFactor& factor, Index added) {
  const MatrixXd& R = factor.matrix();
  MatrixXd rows(R.rows(), R.cols() - added);
  rows << R.leftCols(rows.cols() - 1), R.rightCols<1>();
  TriangularFactor left(static_cast<int>(rows.cols()));
  left.absorb(rows);
  return left;
}

/// The same factor of [J ...] from that of [Q ...], J = Q coordinates.
TriangularFactor by_parameters(const MatrixXd& R, const MatrixXd& coordinates) {
  const Index others = R.cols() - coordinates.rows();
  MatrixXd rows(R.rows(), coordinates.cols() + others);
  rows << R.leftCols(coordinates.rows()) * coordinates, R.rightCols(others);
  TriangularFactor factor(static_cast<int>(rows.cols()));
  factor.absorb(rows);
  return factor;
}

/// A hundredth of what rows left out tell of the tangent's parameters, that these stay where the
/// fit has them: where a trajectory begins, the rows that follow alone know.
TriangularFactor held_near_the_fit(const TriangularFactor& factor, Index tangent) {
  constexpr double share = 0.1;  // of each row
  MatrixXd rows = MatrixXd::Zero(tangent, factor.columns());
  rows.leftCols(tangent) = share * factor.matrix().topLeftCorner(tangent, tangent);
  TriangularFactor held(factor.columns());
  held.absorb(rows);
  return held;
}

/// The least-squares estimate from all folds but one. What these leave undetermined is a matter of
/// the parameters, not of a basis in their place.
VectorXd estimate_without(const LinearisedFit& fit, const std::vector<TriangularFactor>& factors,
                          int left_out) {
  TriangularFactor others(factors.front().columns());
  for (std::size_t f = 0; f < factors.size(); ++f) {
    if (static_cast<int>(f) != left_out) {
      others.merge(factors[f]);
    } else if (fit.follows_path) {
      others.merge(held_near_the_fit(factors[f], fit.tangent.cols()));
    }
  }
  const MatrixXd& coordinates = fit.coordinates;
  if (coordinates.size() > 0) others = by_parameters(others.matrix(), coordinates);
  const Index n = others.columns() - 1;
  VectorXd estimate =
      solve_triangular(others.matrix().topLeftCorner(n, n), others.matrix().col(n).head(n)).x;
  if (coordinates.size() == 0) return estimate;
  const Index behind = n - coordinates.cols();
  VectorXd of_basis(coordinates.rows() + behind);
  of_basis << coordinates * estimate.head(coordinates.cols()), estimate.tail(behind);
  return of_basis;
}

/// Squared errors of a block over all outputs, of estimates (a column each) for [J G e].
VectorXd squares_of(const RowLayout& layout, const std::vector<double>& weights,
                    const Columns& columns, const MatrixXd& estimates, const HeldOutBlock& block) {
  VectorXd squares = VectorXd::Zero(estimates.cols());
  const Index n = estimates.rows();
  for (std::size_t j = 0; j < layout.outputs.size(); ++j) {
    for (Index row = block.first; row < block.last; row += panel_rows) {
      const MatrixXd panel =
          columns.rows(layout.first(j) + row, std::min(panel_rows, block.last - row));
      MatrixXd errors = panel.col(n).replicate(1, estimates.cols());
      numerics::add_product(panel.leftCols(n), -estimates, errors);
      squares += weights[j] * weights[j] * errors.colwise().squaredNorm().transpose();
    }
  }
  return squares;
}

/// The same of every block that is judged, by the estimates without its fold.
std::vector<VectorXd> predict_blocks(const RowLayout& layout, const std::vector<double>& weights,
                                     const Columns& columns, const std::vector<MatrixXd>& estimates,
                                     const Folds& folds) {
  std::vector<VectorXd> squares;
  for (const HeldOutBlock& block : folds.blocks) {
    if (!block.judged) continue;
    const auto f = static_cast<std::size_t>(block.fold);
    squares.push_back(squares_of(layout, weights, columns, estimates[f], block));
  }
  return squares;
}

std::vector<double> own_weights(const RowLayout& layout) {
  std::vector<double> weights;
  for (const UsedOutput& output : layout.outputs) weights.push_back(output.weight);
  return weights;
}

/// Of the outputs of `own`, what makes their rows count as those of `layout` do.
std::vector<double> weights_as_of(const RowLayout& layout, const RowLayout& own) {
  std::vector<double> weights;
  for (const UsedOutput& output : own.outputs) {
    const auto as = std::ranges::find(layout.outputs, output.index, &UsedOutput::index);
    weights.push_back(as == layout.outputs.end() ? 0.0 : as->weight * output.scale / as->scale);
  }
  return weights;
}

/// The readings of the blocks that are judged.
double count_judged(const RowLayout& layout, const Folds& folds) {
  double rows = 0.0;
  for (const HeldOutBlock& block : folds.blocks) {
    if (block.judged) rows += static_cast<double>(block.last - block.first);
  }
  return rows * static_cast<double>(layout.outputs.size());
}

/// The least and the largest value of each column in each block (blocks x columns).
struct Extremes {
  MatrixXd lowest;
  MatrixXd highest;
};

Extremes find_extremes(const MatrixXd& columns, const Folds& folds) {
  const auto blocks = static_cast<Index>(folds.blocks.size());
  Extremes found{MatrixXd(blocks, columns.cols()), MatrixXd(blocks, columns.cols())};
  for (Index b = 0; b < blocks; ++b) {
    const HeldOutBlock& block = folds.blocks[static_cast<std::size_t>(b)];
    const auto rows = columns.middleRows(block.first, block.last - block.first);
    found.lowest.row(b) = rows.colwise().minCoeff();
    found.highest.row(b) = rows.colwise().maxCoeff();
  }
  return found;
}

/// Whether most of a block's rows lie within what the rows of other folds span, column by column.
bool interpolates(const MatrixXd& columns, const Extremes& extremes, const Folds& folds,
                  const HeldOutBlock& block) {
  for (Index k = 0; k < columns.cols(); ++k) {
    double lowest = infinity;
    double highest = -infinity;
    for (std::size_t b = 0; b < folds.blocks.size(); ++b) {
      if (folds.blocks[b].fold == block.fold) continue;
      lowest = std::min(lowest, extremes.lowest(static_cast<Index>(b), k));
      highest = std::max(highest, extremes.highest(static_cast<Index>(b), k));
    }
    const auto rows = columns.col(k).segment(block.first, block.last - block.first).array();
    if (2 * (rows < lowest || rows > highest).count() > rows.size()) return false;
  }
  return true;
}

}  // namespace

Folds whole_segments(const RowLayout& layout) {
  constexpr int fewest = 4;
  Folds folds;
  const std::string* label = nullptr;
  for (const Segment& segment : layout.segments) {
    const auto last = static_cast<Index>(segment.last);
    if (label != nullptr && *label == segment.label) {
      folds.blocks.back().last = last;
      continue;
    }
    label = &segment.label;
    folds.blocks.push_back({static_cast<Index>(segment.first), last, folds.count++});
  }
  return folds.count < fewest ? Folds{} : folds;
}

Folds interleaved_blocks(const RowLayout& layout, double correlation, int fewest) {
  constexpr double least = 2.0 * folds_of_blocks;
  constexpr double most = 10.0 * folds_of_blocks;
  const auto rows = static_cast<double>(layout.rows);
  const double wanted = std::clamp(std::floor(rows / (10.0 * correlation)),
                                   std::clamp<double>(fewest, least, most), most);
  const auto count = static_cast<Index>(std::min(std::max<double>(wanted, fewest), rows));
  Folds folds{{}, folds_of_blocks, true};
  for (Index i = 0; i < count; ++i) {
    const Index first = layout.rows * i / count;
    const Index last = layout.rows * (i + 1) / count;
    folds.blocks.push_back({first, last, static_cast<int>(i % folds_of_blocks)});
  }
  return folds;
}

void judge_interpolated(const RowLayout& layout, const Columns& G, Folds& folds) {
  for (HeldOutBlock& block : folds.blocks) block.judged = true;
  // Output by output: an effect on one output is 0 in the others, which says nothing.
  for (std::size_t j = 0; j < layout.outputs.size(); ++j) {
    const MatrixXd columns = G.rows(layout.first(j), layout.rows);
    const Extremes extremes = find_extremes(columns, folds);
    for (HeldOutBlock& block : folds.blocks) {
      block.judged = block.judged && interpolates(columns, extremes, folds, block);
    }
  }
}

double correlation_rows(const RowLayout& layout, const VectorXd& residual) {
  constexpr double negligible = 0.05;
  double longest = 1.0;
  for (std::size_t j = 0; j < layout.outputs.size(); ++j) {
    VectorXd products = VectorXd::Zero(std::max<Index>(1, layout.rows / 4));  // by lag
    for (const Segment& segment : layout.segments) {
      const auto rows = static_cast<Index>(segment.rows());
      const Index lags = std::min(products.size(), rows);
      const auto e = residual.segment(layout.first(j) + static_cast<Index>(segment.first), rows);
      products.head(lags) += static_cast<double>(rows) * numerics::autocovariance(e, lags - 1);
    }
    if (!(products[0] > 0)) continue;
    double time = 1.0;
    for (Index lag = 1; lag < products.size(); ++lag) {
      const double correlation = products[lag] / products[0];
      if (correlation < negligible) break;
      time += 2.0 * correlation;
    }
    longest = std::max(longest, time);
  }
  return longest;
}

double total_rmse(const RowLayout& layout, const VectorXd& residual) {
  double square = 0.0;
  for (std::size_t j = 0; j < layout.outputs.size(); ++j) {
    const double weight = layout.outputs[j].weight;
    square += weight * weight * residual.segment(layout.first(j), layout.rows).squaredNorm();
  }
  return std::sqrt(square / static_cast<double>(layout.count()));
}

HeldOut summarise(const std::vector<double>& before, const std::vector<double>& after,
                  double measurements) {
  constexpr std::size_t fewest_judged = 4;
  HeldOut result;
  if (before.size() < fewest_judged) return result;
  const auto count = static_cast<Index>(before.size());
  const Eigen::Map<const VectorXd> old(before.data(), count);
  const Eigen::Map<const VectorXd> now(after.data(), count);
  const VectorXd gain = old - now;
  const auto blocks = static_cast<double>(count);
  const double variance = (gain.array() - gain.mean()).square().sum() / (blocks - 1.0);
  result.judged = true;
  result.before = std::sqrt(old.sum() / measurements);
  result.after = std::sqrt(now.sum() / measurements);
  result.gain = 1.0 - result.after / result.before;
  result.passed = gain.mean() > std::sqrt(variance / blocks);
  return result;
}

HeldOut hold_out(const LinearisedFit& fit, const Columns& G, const Folds& folds) {
  const Columns columns = join(join(view(fit.tangent), G), view(fit.residual));
  const auto factors_with = factor_by_fold(fit.layout, columns, folds);
  std::vector<TriangularFactor> factors_without;
  for (const TriangularFactor& factor : factors_with) {
    factors_without.push_back(leave_out(factor, G.cols()));
  }
  std::vector<MatrixXd> estimates;  // without G and with it
  for (int f = 0; f < folds.count; ++f) {
    MatrixXd both = MatrixXd::Zero(columns.cols() - 1, 2);
    both.col(0).head(fit.tangent.cols()) = estimate_without(fit, factors_without, f);
    both.col(1) = estimate_without(fit, factors_with, f);
    estimates.push_back(std::move(both));
  }
  const std::vector<VectorXd> squares =
      predict_blocks(fit.layout, own_weights(fit.layout), columns, estimates, folds);
  std::vector<double> before;
  std::vector<double> after;
  for (const VectorXd& both : squares) {
    before.push_back(both[0]);
    after.push_back(both[1]);
  }
  return summarise(before, after, count_judged(fit.layout, folds));
}

HeldOut hold_out(const LinearisedFit& without, const LinearisedFit& with, const Folds& folds) {
  const auto errors_of = [&](const LinearisedFit& fit) {
    const Columns columns = join(view(fit.tangent), view(fit.residual));
    const auto factors = factor_by_fold(fit.layout, columns, folds);
    std::vector<MatrixXd> estimates;
    for (int f = 0; f < folds.count; ++f) {
      estimates.emplace_back(estimate_without(fit, factors, f));
    }
    const std::vector<double> weights = weights_as_of(without.layout, fit.layout);
    std::vector<double> errors;
    for (const VectorXd& square : predict_blocks(fit.layout, weights, columns, estimates, folds)) {
      errors.push_back(square[0]);
    }
    return errors;
  };
  return summarise(errors_of(without), errors_of(with), count_judged(without.layout, folds));
}

Folds few_folds(const LinearisedFit& fit, const Columns& G) {
  constexpr int count = 3;
  constexpr int fewest_blocks = 12;
  Folds folds =
      interleaved_blocks(fit.layout, correlation_rows(fit.layout, fit.residual), fewest_blocks);
  for (HeldOutBlock& block : folds.blocks) block.fold %= count;
  folds.count = count;
  judge_interpolated(fit.layout, G, folds);
  return folds;
}

}  // namespace sepcal::diagnosis
