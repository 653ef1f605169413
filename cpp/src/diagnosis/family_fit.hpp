// SPDX-License-Identifier: BSD-3-Clause
// Columns and noise of a family, estimated together by maximum likelihood: generalised least
// squares in the noise, and the likeliest member for what that leaves, in turn.
#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>
#include <memory>
#include <vector>

#include "diagnosis/columns.hpp"
#include "noise/noise_families.hpp"

namespace sepcal::diagnosis {

using NoiseMembers = std::vector<noise::NoiseMember>;  // of each used output, in units of its RMSE

struct FamilyFit {
  NoiseMembers noise = {};
  double minus_two_log_likelihood = 0.0;
  Eigen::VectorXd coefficients = {};  // of the columns
  Eigen::MatrixXd covariance = {};

  /// Whether the coefficients are those for the noise, not for the one of the round before.
  bool is_finished() const { return covariance.size() > 0 || coefficients.size() == 0; }
};

/// [X e]' [X e] of columns X and a residual e, white in these noises.
using WhiteProducts = std::function<Eigen::MatrixXd(const NoiseMembers& noise)>;

/// The fit of orthonormal columns to a residual in each of noise::noise_families, as far as the
/// likelihoods need it: finish_fit() does the rest. `orders`: of each output's autoregression in
/// the fractional one; `products`: of these columns and this residual; `nested`: the fits of the
/// first of the columns, where there are some, than which these are no less likely.
std::array<FamilyFit, 2> fit_families(const noise::NoiseFamilies& families, const RowLayout& layout,
                                      const Columns& columns, const Eigen::VectorXd& residual,
                                      const std::vector<int>& orders, const WhiteProducts& products,
                                      const std::array<FamilyFit, 2>* nested = nullptr);

/// The coefficients and their covariance in the noise that was found.
void finish_fit(const WhiteProducts& products, FamilyFit& fit);

/// Those of any columns and any residual.
Eigen::MatrixXd family_products(const noise::NoiseFamilies& families, const RowLayout& layout,
                                const NoiseMembers& noise, const Columns& X,
                                const Eigen::VectorXd& e);

/// The same fits for many residuals of few rows: what the columns are in a member's noise is found
/// once. Const and thread-safe; `families` and `layout` must outlive it.
class FamilyRegression {
 public:
  /// Orthonormal columns, count() rows.
  FamilyRegression(const noise::NoiseFamilies& families, const RowLayout& layout,
                   Eigen::MatrixXd columns, std::vector<int> orders);
  ~FamilyRegression();
  FamilyRegression(const FamilyRegression&) = delete;
  FamilyRegression& operator=(const FamilyRegression&) = delete;
  FamilyRegression(FamilyRegression&&) = delete;
  FamilyRegression& operator=(FamilyRegression&&) = delete;

  Eigen::Index columns() const { return columns_.cols(); }

  class Residual {
   public:
    /// In this family, of the first `count` columns.
    FamilyFit fit(noise::NoiseFamily family, Eigen::Index count) const;

    /// -2 ln L of the first `fewer` columns and of all of them, which are no less likely: each the
    /// maximum that steps from generalised least squares in the noise `near` lead to, in its
    /// family. Of a residual that was drawn, whose noise is known.
    struct Nested {
      double without = 0.0;
      double with = 0.0;
    };
    Nested compare(const NoiseMembers& near, Eigen::Index fewer) const;

   private:
    friend class FamilyRegression;
    struct InFamily;

    const FamilyRegression* regression_ = nullptr;
    Eigen::VectorXd e_ = {};
    std::vector<Eigen::MatrixXd> differences_ = {};  // of each output
  };
  /// The regression must outlive it.
  Residual take(const Eigen::VectorXd& e) const;

 private:
  struct Output;

  Eigen::VectorXd of_output(const Eigen::VectorXd& e, std::size_t j) const {
    return e.segment(layout_.first(j), layout_.rows);
  }

  const noise::NoiseFamilies& families_;
  const RowLayout& layout_;
  Eigen::MatrixXd columns_;
  std::vector<int> orders_;
  std::vector<std::unique_ptr<Output>> outputs_;
};

}  // namespace sepcal::diagnosis
