// SPDX-License-Identifier: BSD-3-Clause
// Stage one by Eigen's pivoted QR: one matrix A of the whole record, refilled at every sample.
#include <Eigen/QR>
#include <cmath>
#include <limits>

#include "peers/five_hole.hpp"

namespace benchmark {
namespace {

using Eigen::Index;

class PivotedQr {
 public:
  /// With a drift of the wind, north and east, where there is one.
  PivotedQr(const std::vector<HoistedRow>& rows, const std::vector<double>& drift)
      : rows_(rows),
        N_(static_cast<Index>(rows.size())),
        columns_(drift.empty() ? linear : linear + 2),
        A_(Eigen::MatrixXd::Zero(3 * N_, columns_)),
        y_(3 * N_),
        qr_(3 * N_, columns_) {
    for (Index j = 0; j < 3; ++j) A_.col(2 + j).segment(j * N_, N_).setOnes();
    for (Index j = 0; j + linear < columns_; ++j) {
      A_.col(linear + j).segment(j * N_, N_) = Eigen::Map<const Eigen::VectorXd>(drift.data(), N_);
    }
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
    y_.applyOnTheLeft(qr_.householderQ().setLength(columns_).adjoint());
    return y_.tail(3 * N_ - columns_).squaredNorm();
  }

  /// (xi1, xi2, drift) at the xi2 that square() was asked for last.
  Answer estimate(const double* xi2) const {
    const Eigen::VectorXd xi1 = qr_.colsPermutation() * qr_.matrixR()
                                                            .topLeftCorner(columns_, columns_)
                                                            .triangularView<Eigen::Upper>()
                                                            .solve(y_.head(columns_));
    Answer x(xi1.begin(), xi1.begin() + linear);
    x.insert(x.end(), xi2, xi2 + nonlinear);
    x.insert(x.end(), xi1.begin() + linear, xi1.end());
    return x;
  }

 private:
  const std::vector<HoistedRow>& rows_;
  Index N_;
  Index columns_;
  Eigen::MatrixXd A_;
  Eigen::VectorXd y_;
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr_;
};

}  // namespace

Sampled sample_by_eigen(const std::vector<HoistedRow>& rows, const FiveHoleFile& file,
                        const std::vector<double>& drift) {
  PivotedQr qr(rows, drift);
  Sampled sampled;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t s = 0; s < file.samples; ++s) {
    const double* xi2 = file.points + s * nonlinear;
    const double square = qr.square(xi2);
    if (s < file.descents) sampled.starts.push_back(qr.estimate(xi2));
    if (square >= least) continue;
    least = square;
    sampled.best = qr.estimate(xi2);
  }
  return sampled;
}

}  // namespace benchmark
