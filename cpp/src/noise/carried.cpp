// SPDX-License-Identifier: BSD-3-Clause
#include "noise/carried.hpp"

#include <algorithm>
#include <cmath>

#include "noise/noise_room.hpp"
#include "noise/stationary_lags.hpp"

namespace sepcal::noise {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

/// S X of rows that follow each other, S the covariance of a Gauss-Markov noise.
MatrixXd multiply(const GaussMarkovNoise& noise, const MatrixXd& X) {
  const double a = std::exp(-1.0 / noise.rows);
  MatrixXd around = MatrixXd::Zero(X.rows(), X.cols());  // sum_{s != t} a^|t-s| x_s
  Eigen::RowVectorXd before = Eigen::RowVectorXd::Zero(X.cols());
  for (Index t = 1; t < X.rows(); ++t) {
    before = a * (before + X.row(t - 1));
    around.row(t) += before;
  }
  Eigen::RowVectorXd after = Eigen::RowVectorXd::Zero(X.cols());
  for (Index t = X.rows() - 2; t >= 0; --t) {
    after = a * (after + X.row(t + 1));
    around.row(t) += after;
  }
  return noise.sigma * noise.sigma * (X + (1.0 - noise.white) * around);
}

/// `multiply(piece, rows)`: S X of rows of a run that follow each other, from them alone.
template <class Multiply>
Carried carry_pieces(const std::vector<Segment>& runs, const std::vector<Index>& cuts,
                     const MatrixXd& X, const Multiply& multiply) {
  Carried carried{MatrixXd(X.rows(), X.cols()), {}};
  carried.own.assign(cuts.size() - 1, MatrixXd::Zero(X.cols(), X.cols()));
  for (const Piece& run : cut_runs(runs, {0, X.rows()})) {
    carried.whole.middleRows(run.first, run.rows) =
        multiply(run, X.middleRows(run.first, run.rows));
  }
  for (const Piece& piece : cut_runs(runs, cuts)) {
    const auto rows = X.middleRows(piece.first, piece.rows);
    carried.own[piece.stretch] += rows.transpose() * multiply(piece, rows);
  }
  return carried;
}

}  // namespace

std::vector<Piece> cut_runs(const std::vector<Segment>& runs, const std::vector<Index>& cuts) {
  std::vector<Piece> pieces;
  Index run_first = 0;
  for (const Index run_rows : find_lengths(runs)) {
    for (std::size_t b = 0; b + 1 < cuts.size(); ++b) {
      const Index first = std::max(run_first, cuts[b]);
      const Index last = std::min(run_first + run_rows, cuts[b + 1]);
      if (first < last) pieces.push_back({b, first, last - first, run_first, run_rows});
    }
    run_first += run_rows;
  }
  return pieces;
}

Carried carry(const NoiseModel& model, const std::vector<Segment>& runs,
              const std::vector<Index>& cuts, const MatrixXd& X) {
  const StationaryLags lags(model, find_lengths(runs));
  return carry_pieces(runs, cuts, X, [&](const Piece& piece, const MatrixXd& rows) -> MatrixXd {
    return lags.multiply(rows, piece.run_rows, piece.first - piece.run_first);
  });
}

Carried carry(const GaussMarkovNoise& noise, const std::vector<Segment>& runs,
              const std::vector<Index>& cuts, const MatrixXd& X) {
  return carry_pieces(runs, cuts, X, [&](const Piece&, const MatrixXd& rows) -> MatrixXd {
    return multiply(noise, rows);
  });
}

}  // namespace sepcal::noise
