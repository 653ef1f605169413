// SPDX-License-Identifier: BSD-3-Clause
#include "many/trial_starts.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <limits>
#include <vector>

namespace sepcal::many {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr std::size_t most_values = 4'000'000;  // of all samples' Q at a time: 32 MB
constexpr std::size_t trials_a_product = 64;

/// A and b at one sample, and what their own products are.
struct Sample {
  MatrixXd Q;       // M x n_1, orthonormal columns
  MatrixXd to_xi1;  // n_1 x n_1: xi1 = to_xi1 Q' (z - b)
  VectorXd b;       // M
  VectorXd Qb;      // Q' b
  double b_square = 0.0;
  bool finite = false;
};

Sample factor(const TrialDesign& design, const VectorXd& xi2) {
  MatrixXd rows = design.evaluate(xi2);
  const Index n_1 = rows.cols() - 1;
  Sample sample;
  sample.finite = rows.allFinite();
  sample.b = rows.col(n_1);
  sample.Q = MatrixXd::Zero(rows.rows(), n_1);
  sample.to_xi1 = MatrixXd::Zero(n_1, n_1);
  if (sample.finite && n_1 > 0) {
    const Eigen::ColPivHouseholderQR<MatrixXd> qr(rows.leftCols(n_1));
    const Index rank = qr.rank();
    sample.Q.leftCols(rank) = qr.householderQ() * MatrixXd::Identity(rows.rows(), rank);
    MatrixXd inverse = MatrixXd::Zero(n_1, n_1);
    inverse.topLeftCorner(rank, rank) = qr.matrixR()
                                            .topLeftCorner(rank, rank)
                                            .template triangularView<Eigen::Upper>()
                                            .solve(MatrixXd::Identity(rank, rank));
    sample.to_xi1 = qr.colsPermutation() * inverse;
  }
  sample.Qb = sample.Q.transpose() * sample.b;
  sample.b_square = sample.b.squaredNorm();
  return sample;
}

/// A few samples, their columns [Q | b] side by side so that one product serves them all.
class Samples {
 public:
  Samples(const TrialDesign& design, const MatrixXd& points, base::ThreadPool& pool)
      : points_(points),
        samples_(static_cast<std::size_t>(points.cols())),
        n_1_(design.model().tables().n_1()) {
    pool.for_each(samples_.size(), [&](std::size_t s) {
      samples_[s] = factor(design, points.col(static_cast<Index>(s)));
    });
    columns_.resize(samples_.front().b.size(), points.cols() * (n_1_ + 1));
    for (Index s = 0; s < points.cols(); ++s) {
      Sample& sample = samples_[static_cast<std::size_t>(s)];
      columns_.middleCols(s * (n_1_ + 1), n_1_) = sample.Q;
      columns_.col(s * (n_1_ + 1) + n_1_) = sample.b;
      sample.Q.resize(0, 0);
      sample.b.resize(0);
    }
  }

  /// z: M x trials. Takes what is better than `least`, each trial's Tr[R] so far.
  void improve(const MatrixXd& z, Eigen::Ref<VectorXd> least, Eigen::Ref<MatrixXd> starts) const {
    const MatrixXd products = columns_.transpose() * z;
    for (Index t = 0; t < z.cols(); ++t) {
      const double z_square = z.col(t).squaredNorm();
      Index best = -1;
      for (Index s = 0; s < points_.cols(); ++s) {
        const Sample& sample = samples_[static_cast<std::size_t>(s)];
        if (!sample.finite) continue;
        const double* const of_sample = products.col(t).data() + s * (n_1_ + 1);
        double square = z_square - 2.0 * of_sample[n_1_] + sample.b_square;
        for (Index k = 0; k < n_1_; ++k) {
          const double along = of_sample[k] - sample.Qb[k];
          square -= along * along;
        }
        if (square < least[t]) {
          least[t] = square;
          best = s;
        }
      }
      if (best < 0) continue;
      const Sample& sample = samples_[static_cast<std::size_t>(best)];
      // By a product of its own: the large one's last digits depend on the trials beside this one.
      const VectorXd Qz = columns_.middleCols(best * (n_1_ + 1), n_1_).transpose() * z.col(t);
      starts.col(t).head(n_1_) = sample.to_xi1 * (Qz - sample.Qb);
      starts.col(t).tail(points_.rows()) = points_.col(best);
    }
  }

 private:
  MatrixXd points_;
  std::vector<Sample> samples_;
  MatrixXd columns_;  // M x S (n_1 + 1)
  Index n_1_;
};

}  // namespace

MatrixXd find_starts(const TrialDesign& design, const MatrixXd& points, base::ThreadPool& pool) {
  const auto K = static_cast<Index>(design.trials());
  const Index n_1 = design.model().tables().n_1();
  const auto M = static_cast<Index>(design.outputs() * design.rows());
  MatrixXd starts =
      MatrixXd::Constant(n_1 + points.rows(), K, std::numeric_limits<double>::quiet_NaN());
  VectorXd least = VectorXd::Constant(K, infinity);
  const auto at_a_time = std::max<Index>(1, static_cast<Index>(most_values) / (M * (n_1 + 1)));
  for (Index first = 0; first < points.cols(); first += at_a_time) {
    const Samples samples(
        design, points.middleCols(first, std::min(at_a_time, points.cols() - first)), pool);
    pool.for_each(
        (design.trials() + trials_a_product - 1) / trials_a_product, [&](std::size_t part) {
          const auto begin = static_cast<Index>(part * trials_a_product);
          const Index count = std::min(static_cast<Index>(trials_a_product), K - begin);
          MatrixXd z(M, count);
          for (Index t = 0; t < count; ++t) {
            design.gather(static_cast<std::size_t>(begin + t), z.col(t).data());
          }
          samples.improve(z, least.segment(begin, count), starts.middleCols(begin, count));
        });
  }
  return starts;
}

}  // namespace sepcal::many
