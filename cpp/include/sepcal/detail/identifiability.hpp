// SPDX-License-Identifier: BSD-3-Clause
// What a record determines and what it does not: singular directions of the triangular factor,
// written as combinations of named parameters ("0.8 w_n - 0.6 lambda_va").
#pragma once

#include <string>
#include <vector>

#include "sepcal/detail/eigen.hpp"

namespace sepcal {

/// A linear combination of parameters that a record leaves open or determines poorly.
struct Combination {
  std::vector<std::string> parameters;  // those that take part, largest share first
  std::string text;                     // "0.8 w_n - 0.6 lambda_va", coefficients of unit length
  double standard_error = 0.0;          // of the combination; infinite where it is singular
};

struct Identifiability {
  std::vector<Combination> unobservable;  // singular, or uncertain beyond the scale of plausibility
  std::vector<Combination> weak;          // singular value below 1/50 of the largest, weakest first
  std::vector<std::string> sentences;     // unobservable ones by groups, then a weak one each
  int rank = 0;

  /// The first few sentences in one line, the others counted; empty where everything is well
  /// determined.
  std::string message() const;
};

/// Reads the whitened factor R of [A D] (n x n).
///   names  the n parameters
///   scale  n lengths, in the parameters' units, beyond which an uncertainty means "not
///   determined":
///          half the width of the bounds, or rms(z) / rms(column) for an unbounded parameter
///   noise_factor  what standard errors are multiplied by (sqrt(M / (M - n)) for an estimated R)
/// A direction is unobservable where it is singular or its standard error in units of `scale` is
/// over 1; weak where its singular value, columns scaled to unit length, is below 1/50 of the
/// largest.
Identifiability identify(const Eigen::MatrixXd& R, const std::vector<std::string>& names,
                         const Eigen::VectorXd& scale, double noise_factor);

/// Whether identify() would list anything as unobservable (noise_factor 1), without the words.
bool leaves_open(const Eigen::MatrixXd& R, const Eigen::VectorXd& scale);

/// "0.8 w_n - 0.6 lambda_va": coefficients below a hundredth of the largest are left out.
std::string combination_text(const Eigen::VectorXd& coefficients,
                             const std::vector<std::string>& names);

/// An orthonormal basis (n x k) turned, within its span, towards few nonzero entries a vector, so
/// that two parameters that nothing sees are named by themselves and not as two mixtures.
Eigen::MatrixXd sparsify(const Eigen::MatrixXd& basis);

}  // namespace sepcal
