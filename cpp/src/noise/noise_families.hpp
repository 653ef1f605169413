// SPDX-License-Identifier: BSD-3-Clause
// Two families of noise on a grid, for tests that ask both. Fractional: an AR(p) behind (1 - B)^d.
// Gauss-Markov: white noise plus Gauss & Markov's, g_{t+1} = a g_t + q_t, what the velocity of a
// satellite receiver has, which no fractional noise imitates. Every member is a proper distribution
// of the rows themselves, so that likelihoods of the two can be held against each other.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "noise/arfima_factor.hpp"
#include "noise/lagged_squares.hpp"
#include "sepcal/record.hpp"

namespace sepcal::noise {

enum class NoiseFamily { fractional, gauss_markov };
inline constexpr std::array noise_families{NoiseFamily::fractional, NoiseFamily::gauss_markov};

/// A member of a family with its scale.
struct NoiseMember {
  NoiseFamily family = NoiseFamily::fractional;
  std::size_t at = 0;                     // of the family's grid
  Eigen::VectorXd partial = {};           // of the fractional's AR(p)
  double sigma = 1.0;                     // what whiten() divides by
  double minus_two_log_likelihood = 0.0;  // less its constant
};

class NoiseFamilies {
 public:
  /// For rows that follow each other within `runs`. Const and thread-safe.
  explicit NoiseFamilies(const std::vector<Segment>& runs);

  /// The likeliest member for a residual `e`. Fractional: with an AR of this order.
  NoiseMember find(NoiseFamily family, const Eigen::VectorXd& e, int order) const;
  /// The same in the fractional family of what differences() makes of `e`.
  NoiseMember find_fractional(const Eigen::Ref<const Eigen::MatrixXd>& differences,
                              int order) const;

  /// How many d the fractional family has; `at` is one of them.
  std::size_t fractions() const { return fractions_.size(); }

  /// How many members the Gauss-Markov family has; `at` is one of them.
  std::size_t gauss_markovs() const { return gauss_markov_.size(); }

  /// What the fractional family's differences make of e, a column each, which is linear in e.
  Eigen::MatrixXd differences(const Eigen::VectorXd& e) const;

  /// Columns become white, of variance 1.
  void whiten(const NoiseMember& member, Eigen::Ref<Eigen::MatrixXd> columns) const;
  /// The same of columns that a fractional member's difference has made.
  void whiten_differenced(const NoiseMember& member, Eigen::Ref<Eigen::MatrixXd> columns) const;
  /// The transpose of whiten(), which makes R^-1 e of it.
  void whiten_backwards(const NoiseMember& member, Eigen::Ref<Eigen::VectorXd> column) const;

  /// What whiten() makes of products X'X for every fractional member of this d (`at`) and order.
  LaggedSquares lagged_squares(std::size_t at, Eigen::MatrixXd columns, int order) const;

  /// The inverse: innovations become noise.
  void colour(const NoiseMember& member, Eigen::Ref<Eigen::VectorXd> innovations) const;

  /// The standard deviation of what the past does not predict.
  double innovation(const NoiseMember& member) const {
    if (member.family == NoiseFamily::fractional) return member.sigma;
    const Eigen::VectorXd& deviation = gauss_markov_[member.at].deviation;
    return member.sigma * deviation[deviation.size() - 1];
  }

 private:
  /// One d of the fractional family. From 1/2 on a run's rows are differences, but for its first,
  /// which lies as far from zero as the noise goes in a run's length.
  struct Fraction {
    bool differences;
    std::vector<Eigen::Index> blocks;  // rows that the AR runs through
    ArfimaFactor factor;
    std::vector<double> first_deviation;  // of each run, where `differences`
    double log_determinant;
  };

  /// One correlation time and share of white noise; gains of the Kalman filter settle.
  struct GaussMarkov {
    double a;
    Eigen::VectorXd gain;
    Eigen::VectorXd deviation;  // of the innovations
  };

  Fraction make_fraction(double d) const;
  GaussMarkov make_gauss_markov(double rows, double white) const;
  void difference(const Fraction& fraction, Eigen::Ref<Eigen::VectorXd> x) const;
  void difference_backwards(const Fraction& fraction, Eigen::Ref<Eigen::VectorXd> x) const;
  Eigen::VectorXd gather_blocks(const Fraction& fraction, const Eigen::VectorXd& x) const;
  NoiseMember find_gauss_markov(const Eigen::VectorXd& e) const;

  std::vector<Eigen::Index> lengths_;
  Eigen::Index rows_ = 0;
  std::vector<Fraction> fractions_;
  std::vector<GaussMarkov> gauss_markov_;
  Eigen::VectorXd decays_;         // a of each member and of those that fill the last lanes
  Eigen::MatrixXd gains_;          // such members x rows of a run until all have settled
  Eigen::MatrixXd precisions_;     // of the innovations
  Eigen::VectorXd log_variances_;  // summed over the rows, of each member
};

}  // namespace sepcal::noise
