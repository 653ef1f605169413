// SPDX-License-Identifier: BSD-3-Clause
#include "diagnosis/input_noise.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "numerics/bounded_least_squares.hpp"

namespace sepcal::diagnosis {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::RowVectorXd;
using Eigen::VectorXd;

InputNoise::InputNoise(const MatrixXd& white, MatrixXd slopes)
    : rows_(white.rows()), slopes_(white.cols() > 1 ? std::move(slopes) : MatrixXd()) {
  if (!is_known()) return;
  constexpr double largest = 4.0;  // of an output's rms: outliers are no variance
  constexpr double ridge = 1e-10;  // inputs that do the same share what they do
  constexpr double least = 1e-4;   // of an output's variance
  const Index m = white.cols();
  const Index count = m + slopes_.cols();
  const auto n = static_cast<double>(rows_);
  for (auto column : slopes_.colwise()) column *= std::sqrt(n) / std::max(column.norm(), 1e-300);
  const RowVectorXd rms = (white.colwise().squaredNorm() / n).cwiseSqrt();
  MatrixXd squares = MatrixXd::Zero(count, count);
  VectorXd products = VectorXd::Zero(count);
  VectorXd regressors(count);
  for (Index row = 0; row < rows_; ++row) {
    const RowVectorXd e = white.row(row).cwiseMax(-largest * rms).cwiseMin(largest * rms);
    const MatrixXd s = slopes_of(row);
    for (Index j = 0; j < m; ++j) {
      for (Index k = 0; k <= j; ++k) {
        regressors.setZero();
        if (j == k) regressors[j] = 1.0;
        regressors.tail(slopes_.cols()) = s.row(j).cwiseProduct(s.row(k)).transpose();
        squares.selfadjointView<Eigen::Lower>().rankUpdate(regressors);
        products += e[j] * e[k] * regressors;
      }
    }
  }
  squares.diagonal() *= 1.0 + ridge;
  const Eigen::LLT<MatrixXd> factor(squares.selfadjointView<Eigen::Lower>());
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const numerics::Box positive{VectorXd::Zero(count), VectorXd::Constant(count, infinity)};
  const VectorXd variances = numerics::solve_bounded(MatrixXd(factor.matrixU()),
                                                     factor.matrixL().solve(products), positive)
                                 .x;
  own_ = variances.head(m).cwiseMax(least * rms.cwiseAbs2().transpose());
  inputs_ = variances.tail(slopes_.cols());
}

/// What a unit of each input does to the outputs of one row, m x inputs.
MatrixXd InputNoise::slopes_of(Index row) const {
  const Index m = slopes_.rows() / rows_;
  MatrixXd of_row(m, slopes_.cols());
  for (Index j = 0; j < m; ++j) of_row.row(j) = slopes_.row(j * rows_ + row);
  return of_row;
}

MatrixXd InputNoise::take_out(const MatrixXd& white) const {
  if (!is_known()) return white;
  MatrixXd independent(white.rows(), white.cols());
  for (Index row = 0; row < rows_; ++row) {
    const MatrixXd s = slopes_of(row);
    MatrixXd covariance = s * inputs_.asDiagonal() * s.transpose();
    covariance.diagonal() += own_;
    const Eigen::SelfAdjointEigenSolver<MatrixXd> parts(covariance);
    independent.row(row) = white.row(row) * parts.operatorInverseSqrt();
  }
  return independent;
}

double InputNoise::inflation(const MatrixXd& columns) const {
  if (!is_known() || columns.cols() == 0) return 1.0;
  const Index m = own_.size();
  const Index q = columns.cols();
  const auto part = [&](Index j) { return columns.middleRows(j * rows_, rows_); };
  const auto slope = [&](Index input, Index j) {
    return slopes_.col(input).segment(j * rows_, rows_).array();
  };
  MatrixXd thrown = MatrixXd::Zero(q, q);
  MatrixXd supposed = MatrixXd::Zero(q, q);
  for (Index j = 0; j < m; ++j) {
    double variance = own_[j];
    for (Index i = 0; i < inputs_.size(); ++i) {
      variance += inputs_[i] * slope(i, j).square().mean();
    }
    const MatrixXd squares = part(j).transpose() * part(j);
    thrown += own_[j] * squares;
    supposed += variance * squares;
  }
  for (Index i = 0; i < inputs_.size(); ++i) {
    if (!(inputs_[i] > 0.0)) continue;
    MatrixXd together = MatrixXd::Zero(rows_, q);
    for (Index j = 0; j < m; ++j) together.array() += part(j).array().colwise() * slope(i, j);
    thrown += inputs_[i] * together.transpose() * together;
  }
  const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> ratios(thrown, supposed,
                                                                  Eigen::EigenvaluesOnly);
  if (ratios.info() != Eigen::Success) return 1.0;
  const VectorXd& each = ratios.eigenvalues();
  return std::max(1.0, each.squaredNorm() / each.sum());
}

}  // namespace sepcal::diagnosis
