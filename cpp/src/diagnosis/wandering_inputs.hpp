// SPDX-License-Identifier: BSD-3-Clause
// Noise that comes in where the model believes: an attitude's error, which a filter lets wander.
// The third family of noise: white outputs beside corrections whose sizes are Gauss-Markov
// processes of one strength and one correlation time. It is joint over the outputs, for one error
// of the heading is in all of them; its covariance is the identity and a part of low rank, by
// Woodbury's identity.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <cstdint>
#include <random>
#include <vector>

#include "diagnosis/projection.hpp"

namespace sepcal::diagnosis {

class WanderingInputs {
 public:
  /// Without corrections that wander (fit.wandering), there is nothing. The tangent's fit must
  /// outlive it.
  explicit WanderingInputs(const TangentBasis& tangent);

  bool is_empty() const { return members_.empty(); }

  /// Twice the logarithm of the likelihood ratio, not negative, for columns that are orthonormal
  /// and orthogonal to the basis: strength and time at their likeliest in either model.
  double ratio(const Columns& added) const;

  /// The same of draws of the noise that is likeliest without the columns; none where that is
  /// white.
  std::vector<double> draw_ratios(const Columns& added, int draws, std::uint64_t seed) const;

 private:
  /// One strength and correlation time.
  struct Member {
    double correlation = 0.0;                 // of neighbouring knots
    double variance = 0.0;                    // of a size, over the white noise's
    Eigen::LLT<Eigen::MatrixXd> factor = {};  // of the knots' inverse covariance after the record
    double log_determinant = 0.0;             // of the rows' covariance
    Eigen::MatrixXd known = {};               // the factor's solution for the basis
  };

  /// Where a row stands among the knots: the one before it, and the weights of that and the next.
  struct Place {
    Eigen::Index knot = 0;
    Eigen::Vector2d hats = {};
  };
  Place place(Eigen::Index row) const;

  /// Columns beside the basis, and what the likelihoods need of them.
  struct Fixed {
    Columns columns = {};           // [added, basis]
    Eigen::MatrixXd squares = {};   // columns'columns
    Eigen::MatrixXd gathered = {};  // of the added
  };

  /// -2 ln L without and with columns, at the likeliest members.
  struct Likelihoods {
    double null = infinity;
    double with = infinity;
    const Member* likeliest = nullptr;  // without them; null: white
  };

  Eigen::Index corrections() const { return fit_.wandering.cols(); }
  double slope(Eigen::Index row, Eigen::Index k) const { return scale_ * fit_.wandering(row, k); }

  /// Z'X: Z interpolates sizes at the knots to the rows, times the slopes.
  Eigen::MatrixXd gather(const Columns& columns) const;
  Eigen::MatrixXd square() const;  // Z'Z
  void add_members();
  Fixed fix(const Columns& added) const;
  std::vector<Likelihoods> evaluate(const Fixed& fixed,
                                    const Eigen::Ref<const Eigen::MatrixXd>& residuals) const;
  Eigen::VectorXd draw(const Member& member, std::mt19937_64& generator) const;

  const LinearisedFit& fit_;
  Columns basis_;
  double scale_ = 1.0;  // makes all slopes' mean square one
  double first_ = 0.0;  // [s]
  double span_ = 0.0;   // [s]
  std::vector<Member> members_;
};

}  // namespace sepcal::diagnosis
