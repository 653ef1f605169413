// SPDX-License-Identifier: BSD-3-Clause
#include "diagnosis/wandering_inputs.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace sepcal::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index knots = 16;

/// Of a correction's size, over that of the white noise.
constexpr std::array variances{0.01, 0.03, 0.09, 0.27, 0.81, 2.4, 7.3, 22.0, 66.0, 200.0};

/// Correlation times, over the record's.
constexpr std::array shares{0.02, 0.06, 0.2, 0.6, 2.0};

/// The inverse covariance of a Gauss-Markov process of unit variance at the knots: tridiagonal.
MatrixXd inverse_covariance(double correlation) {
  const double innovation = 1.0 - correlation * correlation;
  MatrixXd inverse = MatrixXd::Zero(knots, knots);
  for (Index i = 0; i < knots; ++i) {
    const bool inner = i > 0 && i + 1 < knots;
    inverse(i, i) = (inner ? 1.0 + correlation * correlation : 1.0) / innovation;
    if (i > 0) inverse(i, i - 1) = inverse(i - 1, i) = -correlation / innovation;
  }
  return inverse;
}

/// ln of the sum of squares that the last of the columns keeps beside the others, by their
/// products.
double log_left(const MatrixXd& products) {
  const Eigen::LLT<MatrixXd> factor(products);
  const Index last = products.cols() - 1;
  return factor.info() == Eigen::Success ? 2.0 * std::log(factor.matrixL()(last, last)) : infinity;
}

}  // namespace

WanderingInputs::WanderingInputs(const TangentBasis& tangent)
    : fit_(tangent.fit()), basis_(tangent.columns()) {
  const double square_sum = fit_.wandering.squaredNorm();
  if (!(square_sum > 0.0)) return;
  scale_ = std::sqrt(static_cast<double>(fit_.wandering.rows()) / square_sum);
  const auto [first, last] = std::ranges::minmax(fit_.times);
  first_ = first;
  span_ = last - first;
  add_members();
}

void WanderingInputs::add_members() {
  const MatrixXd seen = square();
  const MatrixXd known = gather(basis_);
  const double step = span_ / static_cast<double>(knots - 1);
  for (const double share : shares) {
    const double correlation = std::exp(-step / (share * span_));
    const MatrixXd one = inverse_covariance(correlation);
    const double log_knots =
        static_cast<double>((knots - 1) * corrections()) * std::log1p(-correlation * correlation);
    for (const double variance : variances) {
      Member member{.correlation = correlation, .variance = variance};
      MatrixXd after = seen;
      for (Index k = 0; k < corrections(); ++k) {
        after.block(k * knots, k * knots, knots, knots) += one / variance;
      }
      member.factor.compute(after);
      const MatrixXd L = member.factor.matrixL();
      member.log_determinant = 2.0 * L.diagonal().array().log().sum() + log_knots +
                               static_cast<double>(after.rows()) * std::log(variance);
      member.known = L.triangularView<Eigen::Lower>().solve(known);
      members_.push_back(std::move(member));
    }
  }
}

WanderingInputs::Fixed WanderingInputs::fix(const Columns& added) const {
  Fixed fixed{.columns = join(added, basis_), .gathered = gather(added)};
  const Index count = fixed.columns.cols();
  fixed.squares = MatrixXd::Zero(count, count);
  for_each_panel(fit_.layout, [&](Index first, Index rows) {
    const MatrixXd panel = fixed.columns.rows(first, rows);
    fixed.squares.noalias() += panel.transpose() * panel;
  });
  return fixed;
}

std::vector<WanderingInputs::Likelihoods> WanderingInputs::evaluate(
    const Fixed& fixed, const Eigen::Ref<const MatrixXd>& residuals) const {
  const Index p = basis_.cols();
  const Index count = fixed.columns.cols();
  const auto rows = static_cast<double>(residuals.rows());
  MatrixXd products = MatrixXd::Zero(count, residuals.cols());
  for_each_panel(fit_.layout, [&](Index first, Index panel) {
    products.noalias() +=
        fixed.columns.rows(first, panel).transpose() * residuals.middleRows(first, panel);
  });
  const MatrixXd of_residuals = gather(view(residuals));
  std::vector<Likelihoods> found(static_cast<std::size_t>(residuals.cols()));
  const auto offer = [&](const Member* member, const MatrixXd& taken, const MatrixXd& of_each) {
    MatrixXd left(count + 1, count + 1);
    left.topLeftCorner(count, count) = fixed.squares - taken.transpose() * taken;
    for (Index i = 0; i < residuals.cols(); ++i) {
      left.col(count).head(count) = products.col(i) - taken.transpose() * of_each.col(i);
      left.row(count).head(count) = left.col(count).head(count).transpose();
      left(count, count) = residuals.col(i).squaredNorm() - of_each.col(i).squaredNorm();
      const double constant = member == nullptr ? 0.0 : member->log_determinant;
      Likelihoods& best = found[static_cast<std::size_t>(i)];
      const double null = constant + rows * log_left(left.bottomRightCorner(p + 1, p + 1));
      best.with = std::min(best.with, constant + rows * log_left(left));
      if (!(null < best.null)) continue;
      best.null = null;
      best.likeliest = member;
    }
  };
  offer(nullptr, MatrixXd::Zero(1, count), MatrixXd::Zero(1, residuals.cols()));
  for (const Member& member : members_) {
    const MatrixXd L = member.factor.matrixL();
    const auto lower = L.triangularView<Eigen::Lower>();
    MatrixXd taken(L.rows(), count);
    taken << lower.solve(fixed.gathered), member.known;
    offer(&member, taken, lower.solve(of_residuals));
  }
  return found;
}

double WanderingInputs::ratio(const Columns& added) const {
  const Likelihoods found = evaluate(fix(added), fit_.residual).front();
  return std::max(0.0, found.null - found.with);
}

VectorXd WanderingInputs::draw(const Member& member, std::mt19937_64& generator) const {
  std::normal_distribution<double> normal;
  VectorXd sizes(knots * corrections());
  for (Index i = 0; i < sizes.size(); ++i) {
    const double innovation = std::sqrt(member.variance) * normal(generator);
    sizes[i] = i % knots == 0
                   ? innovation
                   : member.correlation * sizes[i - 1] +
                         std::sqrt(1.0 - member.correlation * member.correlation) * innovation;
  }
  VectorXd drawn(fit_.layout.count());
  for (Index row = 0; row < drawn.size(); ++row) {
    const Place at = place(row);
    drawn[row] = normal(generator);
    for (Index k = 0; k < corrections(); ++k) {
      drawn[row] += slope(row, k) * at.hats.dot(sizes.segment<2>(k * knots + at.knot));
    }
  }
  return drawn;
}

std::vector<double> WanderingInputs::draw_ratios(const Columns& added, int draws,
                                                 std::uint64_t seed) const {
  constexpr int most_at_once = 8;  // in memory
  const Fixed fixed = fix(added);
  const Member* likeliest = evaluate(fixed, fit_.residual).front().likeliest;
  std::vector<double> ratios;
  if (likeliest == nullptr) return ratios;
  std::mt19937_64 generator(seed);
  for (int done = 0; done < draws; done += most_at_once) {
    MatrixXd residuals(fit_.layout.count(), std::min(most_at_once, draws - done));
    for (auto residual : residuals.colwise()) residual = draw(*likeliest, generator);
    for (const Likelihoods& found : evaluate(fixed, residuals)) {
      ratios.push_back(std::max(0.0, found.null - found.with));
    }
  }
  return ratios;
}

WanderingInputs::Place WanderingInputs::place(Index row) const {
  const double time = fit_.times[static_cast<std::size_t>(row % fit_.layout.rows)];
  const double at = (time - first_) * (static_cast<double>(knots - 1) / span_);
  const Index knot = std::min(static_cast<Index>(at), knots - 2);
  const double after = at - static_cast<double>(knot);
  return {knot, {1.0 - after, after}};
}

MatrixXd WanderingInputs::gather(const Columns& columns) const {
  MatrixXd sums = MatrixXd::Zero(knots * corrections(), columns.cols());
  for_each_panel(fit_.layout, [&](Index first, Index rows) {
    const MatrixXd panel = columns.rows(first, rows);
    for (Index row = 0; row < rows; ++row) {
      const Place at = place(first + row);
      for (Index k = 0; k < corrections(); ++k) {
        sums.middleRows<2>(k * knots + at.knot) += slope(first + row, k) * at.hats * panel.row(row);
      }
    }
  });
  return sums;
}

MatrixXd WanderingInputs::square() const {
  const Index k = corrections();
  MatrixXd sums = MatrixXd::Zero(knots * k, knots * k);
  for (Index row = 0; row < fit_.wandering.rows(); ++row) {
    const Place at = place(row);
    for (Index a = 0; a < k; ++a) {
      for (Index b = 0; b < k; ++b) {
        sums.block<2, 2>(a * knots + at.knot, b * knots + at.knot) +=
            slope(row, a) * slope(row, b) * at.hats * at.hats.transpose();
      }
    }
  }
  return sums;
}

}  // namespace sepcal::diagnosis
