// SPDX-License-Identifier: BSD-3-Clause
// What a flight can't tell from an effect: its family.
#pragma once

#include <Eigen/Core>

#include "diagnosis/candidate.hpp"
#include "diagnosis/null_hypothesis.hpp"
#include "diagnosis/trial.hpp"

namespace sepcal::diagnosis {

/// Whether the columns of two visible effects are alike, whatever the residual: their canonical
/// correlation beyond the tangent exceeds `correlation`.
bool are_alike(const Trial& first, const Trial& other, double correlation);

/// One effect, tested and visible, made ready to be compared with others by what they explain. Its
/// functions may be called from several threads.
class Family {
 public:
  /// All must outlive it. `correlation`: from which on two effects are one.
  Family(const CandidateRoom& room, const NullHypothesis& null, const Trial& first,
         double correlation);

  /// `other` explains a good part of what the first does and, beyond it, next to nothing of that,
  /// at the same port: a proxy of the same cause. `threshold`: log10 of the probability below which
  /// it is significant.
  bool is_proxy(const Trial& other, double threshold) const;

  /// Each explains the residual, and neither significantly more of it than the other: the effect
  /// is too small here to say which it is.
  bool is_rival(const Trial& other) const;

  /// The first explains nothing significant beyond `other`.
  bool is_enough(const Trial& other) const;

 private:
  /// What the residual falls by, in squares of the noise beside the first.
  struct Drops {
    double first = 0.0;
    double other = 0.0;
    double both = 0.0;
  };
  Drops drops_with(const Trial& other) const;

  Eigen::MatrixXd beyond_tangent(const Trial& trial) const;
  Eigen::MatrixXd whiten_beside(const Eigen::MatrixXd& columns) const;

  const CandidateRoom& room_;
  const NullHypothesis& null_;
  const Trial& first_;
  double correlation_;
  Eigen::VectorXd residual_;     // beyond the tangent
  Eigen::MatrixXd basis_;        // orthonormal, of the first's columns beyond the tangent
  Eigen::MatrixXd white_null_;   // the tangent's basis in the noise beside the first, orthonormal
  Eigen::MatrixXd white_basis_;  // the first's, beyond that
  Eigen::VectorXd white_residual_;
};

}  // namespace sepcal::diagnosis
