// SPDX-License-Identifier: BSD-3-Clause
#include "diagnosis/input_drift.hpp"

#include <Eigen/Cholesky>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <array>
#include <cmath>

#include "numerics/tall_products.hpp"

namespace sepcal::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index knots = 64;  // what wanders between them is taken for noise of the outputs

/// Of a correction's size, over that of the white noise.
constexpr std::array variances{0.01, 0.03, 0.09, 0.27, 0.81, 2.4, 7.3, 22.0, 66.0, 200.0};

/// Correlation times, over the record's.
constexpr std::array shares{0.02, 0.06, 0.2, 0.6, 2.0};

/// Adds the inverse covariance of Gauss-Markov processes of this variance at the knots, one a
/// correction, side by side at each knot.
void add_inverse_covariance(double correlation, double variance, Index corrections, MatrixXd& to) {
  const double innovation = variance * (1.0 - correlation * correlation);
  for (Index i = 0; i < to.rows(); ++i) {
    const bool inner = i >= corrections && i + corrections < to.rows();
    to(i, i) += (inner ? 1.0 + correlation * correlation : 1.0) / innovation;
    if (i < corrections) continue;
    to(i, i - corrections) -= correlation / innovation;
    to(i - corrections, i) -= correlation / innovation;
  }
}

/// Of a banded matrix, positive definite; its own order keeps the band.
Eigen::SparseMatrix<double> cholesky(const MatrixXd& banded) {
  const Eigen::SparseMatrix<double> sparse = banded.sparseView();
  return Eigen::SimplicialLLT<Eigen::SparseMatrix<double>, Eigen::Lower,
                              Eigen::NaturalOrdering<int>>(sparse)
      .matrixL();
}

/// ln of the sum of squares that the last of the columns keeps beside the others, by their
/// products.
double log_left(const MatrixXd& products) {
  const Eigen::LLT<MatrixXd> factor(products);
  const Index last = products.cols() - 1;
  return factor.info() == Eigen::Success ? 2.0 * std::log(factor.matrixL()(last, last)) : infinity;
}

}  // namespace

InputDrift::InputDrift(const TangentBasis& tangent) : fit_(tangent.fit()) {
  const double square_sum = fit_.input_drift.squaredNorm();
  if (!(square_sum > 0.0)) return;
  find_loudness();
  basis_ = by_loudness(tangent.columns());
  residual_ = by_loudness(view(fit_.residual)).dense(fit_.layout);
  const Index rank = basis_.cols();
  basis_squares_ = MatrixXd::Zero(rank, rank);
  for_each_panel(fit_.layout, [&](Index first, Index rows) {
    numerics::add_square(basis_.rows(first, rows), basis_squares_);
  });
  scale_ = std::sqrt(static_cast<double>(fit_.input_drift.rows()) / square_sum);
  const auto [first, last] = std::ranges::minmax(fit_.times);
  first_ = first;
  span_ = last - first;
  add_members();
}

/// Neighbours differ by the white noise of both.
void InputDrift::find_loudness() {
  constexpr double least = 1e-3;  // of the residual's rms, which is one
  const RowLayout& layout = fit_.layout;
  loudness_.resize(static_cast<Index>(layout.outputs.size()));
  for (std::size_t j = 0; j < layout.outputs.size(); ++j) {
    const auto rows = fit_.residual.segment(layout.first(j), layout.rows);
    const Index pairs = layout.rows - 1;
    const double square = (rows.tail(pairs) - rows.head(pairs)).squaredNorm();
    loudness_[static_cast<Index>(j)] =
        std::max(least, std::sqrt(0.5 * square / static_cast<double>(pairs)));
  }
  loudness_ /= std::exp(loudness_.array().log().mean());
}

Columns InputDrift::by_loudness(const Columns& columns) const {
  return {columns.cols(), [columns, loudness = loudness_, N = fit_.layout.rows](
                              Index first, Eigen::Ref<MatrixXd> rows) {
            columns.fill(first, rows);
            rows /= loudness[first / N];
          }};
}

void InputDrift::add_members() {
  const MatrixXd seen = square();
  const MatrixXd known = gather(basis_);
  const double step = span_ / static_cast<double>(knots - 1);
  for (const double share : shares) {
    const double correlation = std::exp(-step / (share * span_));
    const double log_knots =
        static_cast<double>((knots - 1) * corrections()) * std::log1p(-correlation * correlation);
    for (const double variance : variances) {
      Member member{.correlation = correlation, .variance = variance};
      MatrixXd after = seen;
      add_inverse_covariance(correlation, variance, corrections(), after);
      member.L = cholesky(after);
      member.log_determinant = 2.0 * VectorXd(member.L.diagonal()).array().log().sum() + log_knots +
                               static_cast<double>(after.rows()) * std::log(variance);
      member.known = member.solve(known);
      members_.push_back(std::move(member));
    }
  }
}

MatrixXd InputDrift::Member::solve(MatrixXd gathered) const {
  L.triangularView<Eigen::Lower>().solveInPlace(gathered);
  return gathered;
}

InputDrift::Fixed InputDrift::fix(const Columns& added) const {
  const Columns quiet = by_loudness(added);
  Fixed fixed{.columns = join(quiet, basis_), .gathered = gather(quiet)};
  const Index count = fixed.columns.cols();
  const Index more = quiet.cols();
  MatrixXd products = MatrixXd::Zero(more, count);
  for_each_panel(fit_.layout, [&](Index first, Index rows) {
    const MatrixXd panel = fixed.columns.rows(first, rows);
    numerics::add_transposed_product(panel.leftCols(more), panel, products);
  });
  fixed.squares.resize(count, count);
  fixed.squares << products, products.rightCols(count - more).transpose(), basis_squares_;
  return fixed;
}

std::vector<InputDrift::Found> InputDrift::evaluate(
    const Fixed& fixed, const Eigen::Ref<const MatrixXd>& residuals) const {
  const Index p = basis_.cols();
  const Index count = fixed.columns.cols();
  const auto rows = static_cast<double>(residuals.rows());
  MatrixXd products = MatrixXd::Zero(count, residuals.cols());
  for_each_panel(fit_.layout, [&](Index first, Index panel) {
    numerics::add_transposed_product(fixed.columns.rows(first, panel),
                                     residuals.middleRows(first, panel), products);
  });
  const MatrixXd of_residuals = gather(view(residuals));
  std::vector<Found> found(static_cast<std::size_t>(residuals.cols()));
  const auto offer = [&](const Member* member, const MatrixXd& taken, const MatrixXd& of_each) {
    MatrixXd left(count + 1, count + 1);
    left.topLeftCorner(count, count) = fixed.squares - taken.transpose() * taken;
    for (Index i = 0; i < residuals.cols(); ++i) {
      left.col(count).head(count) = products.col(i) - taken.transpose() * of_each.col(i);
      left.row(count).head(count) = left.col(count).head(count).transpose();
      left(count, count) = residuals.col(i).squaredNorm() - of_each.col(i).squaredNorm();
      const double constant =
          (member == nullptr ? 0.0 : member->log_determinant) - rows * std::log(rows);
      Found& best = found[static_cast<std::size_t>(i)];
      const double null = constant + rows * log_left(left.bottomRightCorner(p + 1, p + 1));
      const double with = constant + rows * log_left(left);
      if (null < best.null) best.without = member;
      if (with < best.with) best.beside = member;
      best.null = std::min(best.null, null);
      best.with = std::min(best.with, with);
    }
  };
  offer(nullptr, MatrixXd::Zero(1, count), MatrixXd::Zero(1, residuals.cols()));
  for (const Member& member : members_) {
    MatrixXd taken(of_residuals.rows(), count);
    taken << member.solve(fixed.gathered), member.known;
    offer(&member, taken, member.solve(of_residuals));
  }
  return found;
}

InputDrift::Likelihoods InputDrift::compare(const Columns& added) const {
  return evaluate(fix(added), residual_).front();
}

VectorXd InputDrift::draw(const Member& member, std::mt19937_64& generator) const {
  std::normal_distribution<double> normal;
  VectorXd sizes(knots * corrections());
  for (Index i = 0; i < sizes.size(); ++i) {
    const double innovation = std::sqrt(member.variance) * normal(generator);
    sizes[i] = i < corrections()
                   ? innovation
                   : member.correlation * sizes[i - corrections()] +
                         std::sqrt(1.0 - member.correlation * member.correlation) * innovation;
  }
  VectorXd drawn(fit_.layout.count());
  Weights at;
  for (Index row = 0; row < drawn.size(); ++row) {
    weigh(row, at);
    drawn[row] = normal(generator) + at.of.dot(sizes.segment(at.first, at.of.size()));
  }
  return drawn;
}

std::vector<double> InputDrift::draw_ratios(const Columns& added, Noise noise, int draws,
                                            std::uint64_t seed) const {
  constexpr int most_at_once = 8;  // in memory
  const Fixed fixed = fix(added);
  const Found own = evaluate(fixed, residual_).front();
  const Member* likeliest = noise == Noise::without ? own.without : own.beside;
  std::vector<double> ratios;
  if (likeliest == nullptr) return ratios;
  std::mt19937_64 generator(seed);
  for (int done = 0; done < draws; done += most_at_once) {
    MatrixXd residuals(fit_.layout.count(), std::min(most_at_once, draws - done));
    for (auto residual : residuals.colwise()) residual = draw(*likeliest, generator);
    for (const Found& found : evaluate(fixed, residuals)) ratios.push_back(found.ratio());
  }
  return ratios;
}

void InputDrift::weigh(Index row, Weights& weights) const {
  const double time = fit_.times[static_cast<std::size_t>(row % fit_.layout.rows)];
  const double at = (time - first_) * (static_cast<double>(knots - 1) / span_);
  const Index knot = std::min(static_cast<Index>(at), knots - 2);
  const double after = at - static_cast<double>(knot);
  const auto slopes =
      scale_ / loudness_[row / fit_.layout.rows] * fit_.input_drift.row(row).transpose();
  weights.first = knot * corrections();
  weights.of.resize(2 * corrections());
  weights.of << (1.0 - after) * slopes, after * slopes;
}

MatrixXd InputDrift::gather(const Columns& columns) const {
  const Index sizes = 2 * corrections();  // of two knots
  MatrixXd sums = MatrixXd::Zero(knots * corrections(), columns.cols());
  MatrixXd weights(panel_rows, sizes);
  Weights at;
  for_each_panel(fit_.layout, [&](Index first, Index rows) {
    const MatrixXd panel = columns.rows(first, rows);
    Index begin = 0;  // of the rows between the same knots
    Index knot = 0;   // the first of their sizes
    const auto add = [&](Index end) {
      const Index count = end - begin;
      numerics::add_transposed_product(weights.topRows(count), panel.middleRows(begin, count),
                                       sums.middleRows(knot, sizes));
      begin = end;
    };
    for (Index row = 0; row < rows; ++row) {
      weigh(first + row, at);
      if (at.first != knot && row > begin) add(row);
      knot = at.first;
      weights.row(row - begin) = at.of.transpose();
    }
    add(rows);
  });
  return sums;
}

MatrixXd InputDrift::square() const {
  const Index sizes = knots * corrections();
  MatrixXd sums = MatrixXd::Zero(sizes, sizes);
  Weights at;
  for (Index row = 0; row < fit_.input_drift.rows(); ++row) {
    weigh(row, at);
    sums.block(at.first, at.first, at.of.size(), at.of.size()).noalias() +=
        at.of * at.of.transpose();
  }
  return sums;
}

}  // namespace sepcal::diagnosis
