// SPDX-License-Identifier: BSD-3-Clause
// Noise as instruments have it. Each output is white, or goes together over a few rows, as loud as
// rows near each other differ, beside errors that wander, Gauss-Markov processes of what is
// measured, of what the model believes (a velocity, an attitude) and of the air (gusts), none
// larger than instruments of the kind have it. What no instrument does excuses nothing: the tail of
// a candidate is the largest over a set of such noises, each made larger where what no candidate
// explains is more than it allows.
#pragma once

#include <Eigen/Core>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "diagnosis/candidate.hpp"
#include "diagnosis/gauss_markov_filter.hpp"
#include "diagnosis/null_hypothesis.hpp"
#include "diagnosis/reduced_rows.hpp"

namespace sepcal::diagnosis {

/// What of an output's noise is forgotten within a few rows: white noise beside a Gauss-Markov
/// process.
struct ShortNoise {
  double white = 0.0;     // variance
  double variance = 0.0;  // of the process
  double rows = 0.0;      // its correlation time
};

/// The same of a residual (all rows of these runs), by how rows near each other differ: what is
/// slow hardly shows there.
ShortNoise short_noise(const std::vector<Segment>& runs, const Eigen::VectorXd& e);

/// What noise as instruments have it makes of a candidate.
struct InstrumentTail {
  double log10_p = 0.0;  // the largest tail over the noises
  /// What is left beside it or beside all candidates over what the noises allow, of that which
  /// allows most, a ratio of variances: noise far beyond the bounds is none that these tests know.
  double left = infinity;
  /// Of the candidate's sum of squares what is seen here: means of neighbouring rows, where there
  /// are many, lose what changes from one to the next.
  double share_seen = 0.0;
};

inline constexpr double most_left = 2.5;  // a ratio of variances

class InstrumentNoise {
 public:
  /// Errors wander as the kit has them, at most as far as `sizes` says by their names; those with a
  /// correlation time of their own (gusts) as far as what goes together over seconds, too; of a
  /// model whose kit has none, each output's by as much as its white noise. Throws Error for a name
  /// that there is not. The room and the null hypothesis must outlive it.
  InstrumentNoise(CandidateRoom& room, const EffectKit& kit, const NullHypothesis& null,
                  const std::map<std::string, double>& sizes);
  ~InstrumentNoise();
  InstrumentNoise(const InstrumentNoise&) = delete;
  InstrumentNoise& operator=(const InstrumentNoise&) = delete;
  InstrumentNoise(InstrumentNoise&&) = delete;
  InstrumentNoise& operator=(InstrumentNoise&&) = delete;

  /// What wanders, and how far at most.
  const std::vector<ErrorBound>& bounds() const { return bounds_; }

  /// Takes what is left beside columns, those of all that may well be missing, for noise: how loud
  /// it is from row to row, and as a whole.
  void set_beside(const Columns& columns);

  /// Of candidates whose columns are orthonormal and orthogonal to the tangent.
  std::vector<InstrumentTail> tails(const std::vector<Columns>& candidates) const;

  /// Whether noise is as these tests know it: what is left beside all candidates is within what the
  /// noises allow, or not far beyond.
  bool knows_the_noise() const;

  /// -2 ln L of another fit to the same rows, one step from it, in the noise that is likeliest for
  /// it, but for a constant.
  double minus_two_log_likelihood(const LinearisedFit& fit) const;

  /// The same of a fit with a candidate of so many coefficients, to the same rows, in place of one
  /// step: of what bends the model.
  InstrumentTail tail_of_fit(const LinearisedFit& with, Eigen::Index coefficients) const;

  /// How many times as far as their bounds errors would have to wander to give a candidate that
  /// tail, from `least` on and to a factor of 2; infinite where 64 times that is too little.
  double excuse(const Columns& candidate, double log10_tail, double least) const;

  /// How large columns are in standard errors, in the noise that hides them best.
  Eigen::VectorXd sigmas(const Columns& columns) const;

 private:
  struct Source;
  struct Noise;

  void add_sources(CandidateRoom& room, const EffectKit& kit);
  void find_short_noise(const Eigen::VectorXd& residual);
  /// Of each bound, for each form of noise.
  using Shares = std::vector<Eigen::VectorXd>;

  Shares whole() const;
  Eigen::VectorXd find_share(const Eigen::VectorXd& whole, double time_s) const;
  Shares find_shares() const;
  std::vector<Noise> make_noises(const std::vector<double>& times, const Shares& shares) const;
  GaussMarkovFilter filter(const Eigen::VectorXd& shares, double time_s) const;
  Noise make_noise(const Eigen::VectorXd& shares, double time_s) const;
  Eigen::MatrixXd reduce(const Columns& columns) const;
  /// [tangent, residual] of another fit, in this one's units; none where it leaves nothing of an
  /// output.
  Eigen::MatrixXd reduce(const LinearisedFit& fit) const;

  const NullHypothesis& null_;
  ReducedRows rows_;
  std::vector<double> times_;      // of these rows [s]
  std::vector<ShortNoise> short_;  // of each output in them
  Eigen::MatrixXd known_;          // [basis, residual] of the null hypothesis
  std::vector<ErrorBound> bounds_;
  std::vector<double> gusts_at_least_;  // of each bound; NaN: as stated, not as loud as the log
  std::vector<Source> sources_;
  std::vector<Noise> noises_;
};

}  // namespace sepcal::diagnosis
