// SPDX-License-Identifier: BSD-3-Clause
// Stage one by Eigen's pivoted QR: one matrix A of the whole record, refilled at every sample.
#include <Eigen/QR>
#include <cmath>
#include <limits>

#include "peers/peers.hpp"

namespace benchmark {
namespace {

using Eigen::Index;

class PivotedQr {
 public:
  explicit PivotedQr(const std::vector<HoistedRow>& rows)
      : rows_(rows),
        N_(static_cast<Index>(rows.size())),
        A_(Eigen::MatrixXd::Zero(3 * N_, linear)),
        y_(3 * N_),
        qr_(3 * N_, linear) {
    for (Index j = 0; j < 3; ++j) A_.col(2 + j).segment(j * N_, N_).setOnes();
  }

  /// The sum of squares with the best xi1 at xi2.
  double square(const double* xi2) {
    const double cos_eps = std::cos(xi2[4]);
    const double sin_eps = std::sin(xi2[4]);
    for (Index i = 0; i < N_; ++i) {
      const HoistedRow& row = rows_[static_cast<std::size_t>(i)];
      double F[3];
      air_direction(row, xi2, cos_eps, sin_eps, F);
      for (Index j = 0; j < 3; ++j) {
        const Index k = j * N_ + i;
        A_(k, 0) = F[j] * row.airspeed;
        A_(k, 1) = F[j];
        y_[k] = row.z[j] - (A_(k, 0) - row.rotation[j]);
      }
    }
    qr_.compute(A_);
    y_.applyOnTheLeft(qr_.householderQ().setLength(linear).adjoint());
    return y_.tail(3 * N_ - linear).squaredNorm();
  }

  /// xi1 at the xi2 that square() was asked for last.
  Eigen::Matrix<double, linear, 1> estimate() const {
    return qr_.colsPermutation() *
           qr_.matrixR().topLeftCorner<linear, linear>().triangularView<Eigen::Upper>().solve(
               y_.head<linear>());
  }

 private:
  const std::vector<HoistedRow>& rows_;
  Index N_;
  Eigen::MatrixXd A_;
  Eigen::VectorXd y_;
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr_;
};

}  // namespace

Sampled sample_by_eigen(const std::vector<HoistedRow>& rows, const FiveHoleFile& file) {
  PivotedQr qr(rows);
  Sampled sampled;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t s = 0; s < file.samples; ++s) {
    const double* xi2 = file.points + s * nonlinear;
    sampled.squares.push_back(qr.square(xi2));
    if (sampled.squares.back() >= least) continue;
    least = sampled.squares.back();
    const auto xi1 = qr.estimate();
    sampled.best.assign(xi1.begin(), xi1.end());
    sampled.best.insert(sampled.best.end(), xi2, xi2 + nonlinear);
  }
  return sampled;
}

std::array<double, 5> linear_estimate(const std::vector<HoistedRow>& rows, const double* xi2) {
  PivotedQr qr(rows);
  qr.square(xi2);
  const auto xi1 = qr.estimate();
  return {xi1[0], xi1[1], xi1[2], xi1[3], xi1[4]};
}

}  // namespace benchmark
