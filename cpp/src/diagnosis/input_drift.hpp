// SPDX-License-Identifier: BSD-3-Clause
// Noise that comes in where the model believes: an attitude's error, which a filter lets wander.
// The third family of noise: white outputs beside corrections whose sizes are Gauss-Markov
// processes of one strength and one correlation time. It is joint over the outputs, for one error
// of the heading is in all of them; its covariance is the identity and a part of low rank, by
// Woodbury's identity. How loud the outputs are beside each other is told by neighbouring rows,
// from which nothing has wandered.
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cstdint>
#include <random>
#include <vector>

#include "diagnosis/projection.hpp"

namespace sepcal::diagnosis {

class InputDrift {
 public:
  /// Without corrections that wander (fit.input_drift), there is nothing. The tangent's fit must
  /// outlive it.
  explicit InputDrift(const TangentBasis& tangent);

  bool is_empty() const { return members_.empty(); }

  /// -2 ln L without and with columns, strength and time at their likeliest in either, as
  /// noise::NoiseFamilies has it.
  struct Likelihoods {
    double null = infinity;
    double with = infinity;

    /// Twice the logarithm of the ratio, not negative.
    double ratio() const { return std::max(0.0, null - with); }
  };
  Likelihoods compare(const Columns& added) const;

  /// In which noise a ratio is drawn.
  enum class Noise { without, beside };  // likeliest without the columns, or with them

  /// The ratio of draws of a noise; none where that is white.
  std::vector<double> draw_ratios(const Columns& added, Noise noise, int draws,
                                  std::uint64_t seed) const;

 private:
  /// One strength and correlation time.
  struct Member {
    double correlation = 0.0;         // of neighbouring knots
    double variance = 0.0;            // of a size, over the white noise's
    Eigen::SparseMatrix<double> L{};  // L L': the sizes' inverse covariance after the record
    double log_determinant = 0.0;     // of the rows' covariance
    Eigen::MatrixXd known = {};       // L^-1 of what is gathered of the basis

    Eigen::MatrixXd solve(Eigen::MatrixXd gathered) const;  // L^-1 of it
  };

  /// A row of Z: sizes stand knot by knot, the corrections' side by side.
  struct Weights {
    Eigen::Index first = 0;   // size
    Eigen::VectorXd of = {};  // the sizes at the knot before the row and at the next
  };
  void weigh(Eigen::Index row, Weights& weights) const;

  /// Columns beside the basis, and what the likelihoods need of them.
  struct Fixed {
    Columns columns = {};           // [added, basis]
    Eigen::MatrixXd squares = {};   // columns'columns
    Eigen::MatrixXd gathered = {};  // of the added
  };

  /// With the members where they are likeliest; null: white.
  struct Found : Likelihoods {
    const Member* without = nullptr;
    const Member* beside = nullptr;
  };

  Eigen::Index corrections() const { return fit_.input_drift.cols(); }

  /// Z'X: Z interpolates sizes at the knots to the rows, times the slopes.
  Eigen::MatrixXd gather(const Columns& columns) const;
  Eigen::MatrixXd square() const;  // Z'Z
  void add_members();
  Fixed fix(const Columns& added) const;
  std::vector<Found> evaluate(const Fixed& fixed,
                              const Eigen::Ref<const Eigen::MatrixXd>& residuals) const;
  void find_loudness();
  Columns by_loudness(const Columns& columns) const;
  Eigen::VectorXd draw(const Member& member, std::mt19937_64& generator) const;

  const LinearisedFit& fit_;
  Eigen::VectorXd loudness_;       // of each output's white noise; their geometric mean is one
  Columns basis_;                  // over the loudness, as what follows
  Eigen::MatrixXd basis_squares_;  // basis'basis
  Eigen::VectorXd residual_;
  double scale_ = 1.0;  // makes all slopes' mean square one
  double first_ = 0.0;  // [s]
  double span_ = 0.0;   // [s]
  std::vector<Member> members_;
};

}  // namespace sepcal::diagnosis
