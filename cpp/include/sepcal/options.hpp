// SPDX-License-Identifier: BSD-3-Clause
// Every choice of a fit, with its default. Names of parameters and outputs are the tables' names.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "sepcal/detail/choices.hpp"
#include "sepcal/detail/quantity.hpp"

namespace sepcal {

/// A normal distribution, in the parameter's unit.
struct Normal {
  double mean = 0.0;
  double standard_deviation = 1.0;
};

/// Hears what is being done and how far it is, a fraction within [0, 1]; from any thread, one call
/// at a time.
using FitProgress = std::function<void(std::string_view task, double fraction)>;

/// The paper's conditions on a sample of xi2 (Eqs. 17, 18): those that break one are not used.
struct Screens {
  double t_1 = infinity;  // at most |dA/dxi2| l_2 / |A|, Eq. 17
  double t_2 = infinity;  // at most |db/dxi2| l_2 / |b|; met where b is zero throughout
  /// l_2, how far the solution may lie from a sample; 0: as far as the farthest corner of the
  /// bounds.
  double l_2 = 0.0;
  /// Eq. 18 rejects too. Its sums of second derivatives change sign with the sign of a column, so
  /// that it is no more than reported unless asked for.
  bool convex = false;
};

struct FitOptions {
  /// Bounds in the parameters' units, instead of the model's. Parameters not named keep the
  /// model's.
  std::map<std::string, Interval> bounds = {};
  /// Parameters held at a value and not estimated.
  std::map<std::string, double> fix = {};
  /// Noise standard deviation of every output; empty: R is estimated (Eqs. 24-26).
  std::map<std::string, double> noise = {};
  /// Normal priors of parameters, linear or nonlinear: each adds the square of (x - mean) /
  /// standard_deviation to the cost, as one more measurement would (a row of the factor).
  std::map<std::string, Normal> prior = {};

  /// Segments that each stage uses, as in Record::select(); empty: all.
  std::string stage_one_segments = {};
  std::string stage_two_segments = {};

  Search search = Search::sampling;
  /// Samples of xi2 in stage one; 0: none, stage two starts from the middle of the bounds. Of a
  /// global search: how often it may ask for the profile cost.
  int samples = 500;
  Sampling sampling = Sampling::uniform;
  /// What samples of nonlinear parameters are drawn from instead of uniformly within the bounds
  /// (the paper's N(0, 2^2)); it takes no part in the fit, as `prior` does.
  std::map<std::string, Normal> sampling_distribution = {};
  /// Unset: Eqs. 17 and 18 are not evaluated.
  std::optional<Screens> screens = {};
  std::uint64_t seed = 0;
  /// Where stage two starts, by nonlinear parameter: then stage one samples nothing. Those not
  /// named start from the middle of their bounds, or from zero without. Where the first descent
  /// from here fails, others follow (see docs/method.md).
  std::map<std::string, double> start = {};
  /// Nonlinear parameters that stage one does not sample but holds at these values, where stage two
  /// starts with them: corrections that begin at zero.
  std::map<std::string, double> unsampled = {};
  /// Stage one descends into at most this many of its samples' basins to tell minima apart.
  int descents = 8;

  SecondStage second_stage = SecondStage::automatic;
  ProjectedJacobian jacobian = ProjectedJacobian::kaufman;
  /// A loss that forgives outliers makes stage two joint: xi1 is then no linear least squares.
  Loss loss = Loss::squares;
  /// k of the loss, in standard deviations of the noise; 0: 1.345 for huber, 2.385 for cauchy, with
  /// which normal noise costs 5 % of the efficiency of squares.
  double loss_width = 0.0;
  /// R and the parameters alternate until every |r_jj - r_jj before| / r_jj before is below this
  /// (Eq. 26; the paper's is 0.05), at most noise_iterations times.
  double noise_tolerance = 1e-10;
  int noise_iterations = 100;
  /// Iterations of one nonlinear minimisation.
  int iterations = 200;

  /// Standard errors allow for residuals that are not white, by a noise model of each output's;
  /// false: they equal the white ones, and the fit does without that pass.
  bool coloured_errors = true;

  /// Of a model with a state.
  FitMethod method = FitMethod::output_error;
  Hessian hessian = Hessian::fisher;  // of filter error
  /// Of a model with a state: noise that drives it, by the names of its table `noise`, as the root
  /// of the spectral density in the table's unit (of a model in discrete time as the standard
  /// deviation a row). By output error it takes no part in the fit, and standard errors allow for
  /// it; by filter error these are held, and those not named are estimated.
  std::map<std::string, double> process_noise = {};

  /// Threads, the caller's included; 0: one a core. The result does not depend on it.
  int threads = 0;
  FitProgress progress = {};
};

}  // namespace sepcal
