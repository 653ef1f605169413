// SPDX-License-Identifier: BSD-3-Clause
// Where a recursive estimator begins, found on board: the two-stage estimator on the first rows of
// a flight (Sun & Gebre-Egziabher, Sec. IV and VI), a bounded piece of work a call. Stage one
// solves xi1 by linear least squares at points of xi2 spread over its bounds; stage two refines the
// best of them; their triangular factor goes on as a stream. stream_start.hpp is its sibling on the
// host.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "sepcal/detail/model.hpp"
#include "sepcal/detail/states/information_root.hpp"
#include "sepcal/detail/states/levenberg_marquardt.hpp"
#include "sepcal/detail/states/model_rows.hpp"

namespace sepcal {

struct TwoStageOptions {
  int samples = 64;       // points of xi2 in stage one
  int rows_per_call = 8;  // what work() takes of the model at most, in rows
  RefinementOptions refinement = {.iterations = 40};  // of each start
};

enum class StartStatus {
  collecting,      // rows are still wanted
  working,         // call work() again
  done,            // parameters(), information_root() and noise_ratio() are the start's
  not_converged,   // the best start did not reach a minimum within its iterations
  not_determined,  // the rows leave a parameter open
  refused,         // no more values than parameters, or bounds or noises that are unfit
};

/// Of a model's first `Rows` samples, kept; stage two from the best `Starts` of stage one's points.
template <SeparableModel M, int Rows, int Starts = 3, class Scalar = double>
class TwoStageStart {
 public:
  static constexpr int n_u = Sizes<M>::n_u;
  static constexpr int n_z = Sizes<M>::n_z;
  static constexpr int n_1 = Sizes<M>::n_1;
  static constexpr int n_2 = Sizes<M>::n_2;
  static constexpr int n = n_1 + n_2;
  using Parameters = Vec<Scalar, n>;
  using Inputs = Vec<Scalar, n_u>;
  using Outputs = Vec<Scalar, n_z>;
  using Root = Eigen::Matrix<Scalar, n, n>;

  /// Within the bounds of the model's tables; `noise`: the outputs' standard deviations (n_z), up
  /// to a factor that the rows tell.
  TwoStageStart(M model, const Outputs& noise, const TwoStageOptions& options = {})
      : TwoStageStart(std::move(model), noise, table_bounds(true), table_bounds(false), options) {}

  /// Within these bounds (n: linear, then nonlinear), of which those of xi2 are finite.
  TwoStageStart(M model, const Outputs& noise, const Parameters& lower, const Parameters& upper,
                const TwoStageOptions& options = {})
      : model_(std::move(model)),
        noise_(noise),
        lower_(lower),
        upper_(upper),
        options_(options),
        refinement_(Parameters::Zero(), lower, upper, options.refinement) {
    options_.samples = std::max(options.samples, 0);
    options_.rows_per_call = std::clamp(options.rows_per_call, 1, Rows);
    options_.refinement.iterations = std::max(options.refinement.iterations, 0);
    const auto width = (upper - lower).template tail<n_2>();
    if (!width.allFinite() || !(lower.array() <= upper.array()).all() ||
        !(noise.array() > Scalar(0)).all() || !noise.allFinite())
      status_ = StartStatus::refused;
  }

  /// Keeps a sample (z: NaN where missing). When `Rows` are there, work() begins. False where it is
  /// not kept: no room, infinite outputs, or inputs of which the model makes no number.
  bool add(const Inputs& u, const Outputs& z) {
    if (status_ != StartStatus::collecting || z.array().isInf().any()) return false;
    const Vec<Scalar, n_2> middle = Scalar(0.5) * (lower_ + upper_).template tail<n_2>();
    const auto [A, b] = model_.at(u, middle);
    if (!A.allFinite() || !b.allFinite()) return false;
    u_[static_cast<std::size_t>(rows_)] = u;
    z_[static_cast<std::size_t>(rows_)] = z;
    ++rows_;
    for (int j = 0; j < n_z; ++j) values_ += std::isnan(z[j]) ? 0 : 1;
    if (rows_ == Rows) seal();
    return true;
  }

  /// Begins with the rows that are there.
  void seal() {
    if (status_ != StartStatus::collecting) return;
    status_ = values_ > n ? StartStatus::working : StartStatus::refused;
    if (status_ == StartStatus::working) begin_sample();
  }

  /// A bounded piece of work: at most `rows_per_call` rows, and what follows the last of a pass.
  StartStatus work() {
    if (status_ != StartStatus::working) return status_;
    const int last = std::min(row_ + options_.rows_per_call, rows_);
    for (; row_ < last; ++row_) {
      if (sample_ < options_.samples) {
        absorb_linear(row_);
      } else {
        refinement_.absorb(
            model_rows<M, Scalar>(model_, u(row_), z(row_), noise_, refinement_.trial()));
      }
    }
    if (row_ < rows_) return status_;
    row_ = 0;
    if (sample_ < options_.samples) {
      end_sample();
    } else if (!refinement_.step()) {
      end_start();
    }
    return status_;
  }

  StartStatus status() const { return status_; }
  int rows() const { return rows_; }
  /// xi1, then xi2 (n).
  const Parameters& parameters() const { return best_.p; }
  /// s, by which the noise is larger than it was said to be: s^2 = SSE / (values - n). Of rows
  /// without noise what rounds.
  Scalar noise_ratio() const {
    return std::max(std::sqrt(2 * best_.cost / static_cast<Scalar>(std::max(values_ - n, 1))),
                    states::rounding<Scalar>);
  }
  /// R (n x n), upper triangular: R'R is the inverse of the covariance of the parameters, the noise
  /// being noise_ratio() times what was said: a filter's `Form::of_information_root()`.
  Root information_root() const { return best_.R / noise_ratio(); }
  /// Trial steps of the longest start so far.
  int worst_iterations() const { return worst_iterations_; }
  /// No more calls of work() than this end every start.
  int most_calls() const {
    const int pieces = (Rows + options_.rows_per_call - 1) / options_.rows_per_call;
    return pieces * (options_.samples + Starts * (options_.refinement.iterations + 1));
  }

 private:
  struct Candidate {
    Scalar cost = std::numeric_limits<Scalar>::infinity();
    Parameters xi = Parameters::Zero();
  };
  struct Best {
    Scalar cost = std::numeric_limits<Scalar>::infinity();
    Parameters p = Parameters::Constant(std::numeric_limits<Scalar>::quiet_NaN());
    Root R = Root::Zero();
  };

  static Parameters table_bounds(bool lower) {
    Parameters bounds;
    for (int k = 0; k < n; ++k) {
      const Quantity& one = k < n_1 ? M::linear[static_cast<std::size_t>(k)]
                                    : M::nonlinear[static_cast<std::size_t>(k - n_1)];
      bounds[k] = static_cast<Scalar>(lower ? one.lower : one.upper);
    }
    return bounds;
  }

  const Inputs& u(int row) const { return u_[static_cast<std::size_t>(row)]; }
  const Outputs& z(int row) const { return z_[static_cast<std::size_t>(row)]; }

  /// The next point of xi2: Halton's sequence over the bounds, whose bases are primes.
  void begin_sample() {
    constexpr std::array primes{2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37, 41, 43, 47, 53};
    static_assert(n_2 <= static_cast<int>(primes.size()), "at most 16 nonlinear parameters");
    for (int i = 0; i < n_2; ++i) {
      const int base = primes[static_cast<std::size_t>(i)];
      Scalar place = 0;
      Scalar digit = 1;
      for (int rest = sample_ + 1; rest > 0; rest /= base) {
        digit /= static_cast<Scalar>(base);
        place += digit * static_cast<Scalar>(rest % base);
      }
      xi2_[i] = lower_[n_1 + i] + place * (upper_[n_1 + i] - lower_[n_1 + i]);
    }
    linear_ = InformationRoot<n_1, Scalar>();
  }

  void absorb_linear(int row) {
    const auto [A, b] = model_.at(u(row), xi2_);
    const Eigen::Matrix<Scalar, n_z, n_z> W = noise_.cwiseAbs2().asDiagonal();
    linear_.template absorb<n_z>(A, z(row) - b, W);
  }

  /// Sorts the point in among the best.
  void end_sample() {
    Candidate next{linear_.cost(), Parameters::Zero()};
    next.xi << linear_.solution(), xi2_;
    if (next.xi.allFinite() && linear_.count() == values_) {  // the model is a number in every row
      for (Candidate& one : candidates_) {
        if (next.cost < one.cost) std::swap(next, one);
      }
    }
    ++sample_;
    if (sample_ < options_.samples) {
      begin_sample();
    } else {
      begin_start();
    }
  }

  void begin_start() {
    while (start_ < Starts && !std::isfinite(candidates_[static_cast<std::size_t>(start_)].cost)) {
      ++start_;
    }
    if (start_ == Starts) return finish();
    refinement_ = Refinement(candidates_[static_cast<std::size_t>(start_)].xi, lower_, upper_,
                             options_.refinement);
  }

  void end_start() {
    worst_iterations_ = std::max(worst_iterations_, refinement_.iterations());
    const LeastSquaresStatus ended = refinement_.status();
    // Of starts that ended alike the one that converged, else the least cost.
    const Scalar alike = std::sqrt(states::rounding<Scalar>) * refinement_.cost();
    const bool surer = ended == LeastSquaresStatus::converged && ended != of_best_;
    const bool better = refinement_.cost() < best_.cost + (surer ? alike : -alike);
    if (better && ended != LeastSquaresStatus::refused) {
      best_ = {refinement_.cost(), refinement_.p(), refinement_.rows().root()};
      of_best_ = ended;
    }
    ++start_;
    begin_start();
  }

  void finish() {
    if (of_best_ == LeastSquaresStatus::converged) {
      status_ = StartStatus::done;
    } else if (of_best_ == LeastSquaresStatus::not_determined) {
      status_ = StartStatus::not_determined;
    } else if (of_best_ == LeastSquaresStatus::not_converged) {
      status_ = StartStatus::not_converged;
    } else {
      status_ = StartStatus::refused;
    }
  }

  using Refinement = LevenbergMarquardt<n, Scalar>;

  M model_;
  Outputs noise_;
  Parameters lower_;
  Parameters upper_;
  TwoStageOptions options_;
  std::array<Inputs, static_cast<std::size_t>(Rows)> u_;
  std::array<Outputs, static_cast<std::size_t>(Rows)> z_;
  std::array<Candidate, static_cast<std::size_t>(Starts)> candidates_ = {};
  Vec<Scalar, n_2> xi2_ = Vec<Scalar, n_2>::Zero();
  InformationRoot<n_1, Scalar> linear_ = {};
  Refinement refinement_;
  Best best_ = {};
  LeastSquaresStatus of_best_ = LeastSquaresStatus::refused;
  StartStatus status_ = StartStatus::collecting;
  int rows_ = 0;
  int values_ = 0;  // of z, that are there
  int row_ = 0;     // of the pass
  int sample_ = 0;  // of stage one
  int start_ = 0;   // of stage two
  int worst_iterations_ = 0;
};

}  // namespace sepcal
