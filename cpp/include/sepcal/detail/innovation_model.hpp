// SPDX-License-Identifier: BSD-3-Clause
// The waist beside BlockModel, for what it can't say: rows that come whitened with a determinant.
// A model with a state that noise drives, along one record: the likelihood of its innovations
// (system identification summary, S 5.1 to 5.7), and its score as rows for a triangular factor.
#pragma once

#include <cstddef>
#include <functional>

#include "sepcal/detail/eigen.hpp"

namespace sepcal {

/// What scoring minimises. The last of theta are logarithms: of process noises, then of outputs'
/// noises.
class ScoredLikelihood {
 public:
  struct Value {
    double cost = 0.0;  // V_m of S 5.7; infinite where the filter can't go on, for `row` says where
    std::size_t readings = 0;  // outputs that were there; -ln L = cost + readings ln(2 pi) / 2
    std::size_t row = 0;
  };

  ScoredLikelihood() = default;
  ScoredLikelihood(const ScoredLikelihood&) = delete;
  ScoredLikelihood& operator=(const ScoredLikelihood&) = delete;
  virtual ~ScoredLikelihood() = default;

  virtual Eigen::Index noises() const = 0;   // n_w
  virtual Eigen::Index outputs() const = 0;  // n_z
  virtual Eigen::Index size() const = 0;     // of theta

  virtual Value value(const Eigen::VectorXd& theta) const = 0;

  /// The same with score rows, [rows | residual] of size() + 1 columns, in the record's order:
  /// `visit` sees some of them at a time, from `row` of the record on. Their factor [R q] holds
  /// Fisher's information R'R and minus the gradient R'q. The rows are scratch.
  using VisitScores = std::function<void(std::size_t row, Eigen::MatrixXd& rows)>;
  virtual Value scores(const Eigen::VectorXd& theta, const VisitScores& visit) const = 0;
};

/// theta: the model's n parameters, linear, then nonlinear, the initial states among them; ln of
/// each process noise's root of spectral density (n_w, in the order and units of process_noises());
/// ln of each output's standard deviation (n_z). Score rows are `rows_a_sample` a sample.
class InnovationModel : public ScoredLikelihood {
 public:
  /// Which of theta change the gains (size()); the others change the innovations alone, linearly.
  virtual Eigen::Array<bool, Eigen::Dynamic, 1> moves() const = 0;

  Eigen::Index rows_a_sample() const { return outputs() + outputs() * (outputs() + 1) / 2; }

  /// Of theta that moves no gains alone: [rows | residual], n_z rows a sample, columns in theta's
  /// order. Where all of xi1 is that, |residual - rows d|^2 / 2 is how V_m changes by d, exactly.
  virtual Value linear_scores(const Eigen::VectorXd& theta, const VisitScores& visit) const = 0;

  /// n_z x n_w: the standard deviation that a unit of each noise alone brings to each output that
  /// nothing has measured for up to 50 rows, rms over the record.
  virtual Eigen::MatrixXd reach(const Eigen::VectorXd& theta) const = 0;

  /// rows x n_z: y - h(x(k|k-1)), and its standard deviation; NaN where y is missing.
  struct Innovations {
    Eigen::MatrixXd e;
    Eigen::MatrixXd sd;
  };
  virtual Innovations innovations(const Eigen::VectorXd& theta) const = 0;

  /// rows x n_z: the standard deviation that the process noises bring to each output of a
  /// trajectory that no reading corrects, to first order; NaN outside segments.
  virtual Eigen::MatrixXd spread(const Eigen::VectorXd& theta) const = 0;

  /// rows x n_z: readings of trajectories that the noises drive, with their own; NaN outside
  /// segments. `normal` gives the next of independent standard normal numbers.
  virtual Eigen::MatrixXd draw(const Eigen::VectorXd& theta,
                               const std::function<double()>& normal) const = 0;
};

}  // namespace sepcal
