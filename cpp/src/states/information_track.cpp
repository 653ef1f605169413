// SPDX-License-Identifier: BSD-3-Clause
#include "states/information_track.hpp"

#include <Eigen/Cholesky>
#include <cmath>

namespace sepcal::states {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

MatrixXd inverse_of(const MatrixXd& R) {
  return R.triangularView<Eigen::Upper>().solve(MatrixXd::Identity(R.rows(), R.cols()));
}

}  // namespace

MatrixXd covariance_root(const MatrixXd& R) {
  MatrixXd rows = inverse_of(R).transpose();
  TriangularFactor factor(static_cast<int>(R.cols()));
  factor.absorb(rows);
  return factor.matrix();
}

InformationTrack::InformationTrack(const MatrixXd& R) : factor_(static_cast<int>(R.cols()) + 1) {
  MatrixXd rows(R.rows(), R.cols() + 1);
  rows << R, VectorXd::Zero(R.rows());
  factor_.absorb(rows);
}

bool InformationTrack::absorb(const MatrixXd& sample) {
  if (!sample.allFinite()) return false;
  MatrixXd rows = sample;
  factor_.absorb(rows);
  return true;
}

VectorXd InformationTrack::whitened(const MatrixXd& sample) const {
  const Index k = sample.cols() - 1;
  const MatrixXd H = sample.leftCols(k);
  const MatrixXd spread = H * inverse_of(root());
  const MatrixXd S = MatrixXd::Identity(sample.rows(), sample.rows()) + spread * spread.transpose();
  const VectorXd e = sample.col(k) - H * solution();
  return S.llt().matrixL().solve(e);
}

void InformationTrack::forget(double by) {
  if (by == 1.0) return;
  MatrixXd rows = std::sqrt(by) * factor_.matrix();
  factor_ = TriangularFactor(factor_.columns());
  factor_.absorb(rows);
}

MatrixXd InformationTrack::root() const {
  const Index k = factor_.columns() - 1;
  return factor_.matrix().topLeftCorner(k, k);
}

VectorXd InformationTrack::solution() const {
  const Index k = factor_.columns() - 1;
  return root().triangularView<Eigen::Upper>().solve(factor_.matrix().col(k).head(k));
}

VectorXd InformationTrack::deviations() const { return inverse_of(root()).rowwise().norm(); }

}  // namespace sepcal::states
