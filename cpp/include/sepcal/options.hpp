// SPDX-License-Identifier: BSD-3-Clause
// Every choice of a fit, with its default. Names of parameters and outputs are the tables' names.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <string_view>

#include "sepcal/quantity.hpp"

namespace sepcal {

struct Interval {
  double lower = -infinity;
  double upper = infinity;
};

/// A normal prior of a nonlinear parameter, for drawing samples (the paper's N(0, 2^2)).
struct Normal {
  double mean = 0.0;
  double standard_deviation = 1.0;
};

/// How stage one spreads its samples of xi2 within the bounds.
enum class Sampling {
  uniform,          // independent draws; normal where options.priors names the parameter
  low_discrepancy,  // a Halton sequence, shifted at random: fills the box more evenly
};

enum class SecondStage {
  automatic,  // the paper's Step 5: projected where stage one saw a unique minimum or a start was
              // given, else joint
  joint,      // over (xi1, xi2)
  projected,  // over xi2, xi1 solved inside (variable projection)
};

/// Hears what is being done and how far it is, a fraction within [0, 1]; from any thread, one call
/// at a time.
using FitProgress = std::function<void(std::string_view task, double fraction)>;

struct FitOptions {
  /// Bounds in the parameters' units, instead of the model's. Parameters not named keep the
  /// model's.
  std::map<std::string, Interval> bounds = {};
  /// Parameters held at a value and not estimated.
  std::map<std::string, double> fixed = {};
  /// Noise standard deviation of every output; empty: R is estimated (Eqs. 24-26).
  std::map<std::string, double> noise = {};

  /// Segments that each stage uses, as in Record::select(); empty: all.
  std::string stage_one_segments = {};
  std::string stage_two_segments = {};

  /// Samples of xi2 in stage one; 0: none, stage two starts from the middle of the bounds.
  int samples = 500;
  Sampling sampling = Sampling::uniform;
  std::map<std::string, Normal> priors = {};
  std::uint64_t seed = 0;
  /// Where stage two starts, by nonlinear parameter: then stage one samples nothing. Those not
  /// named start from the middle of their bounds.
  std::map<std::string, double> start = {};
  /// Nonlinear parameters that stage one does not sample but holds at these values, where stage two
  /// starts with them: corrections that begin at zero.
  std::map<std::string, double> unsampled = {};
  /// Stage one descends into at most this many of its samples' basins to tell minima apart.
  int descents = 8;

  SecondStage second_stage = SecondStage::automatic;
  /// R and the parameters alternate until every |r_jj - r_jj before| / r_jj before is below this
  /// (Eq. 26; the paper's is 0.05), at most noise_iterations times.
  double noise_tolerance = 1e-10;
  int noise_iterations = 100;
  /// Iterations of one nonlinear minimisation.
  int iterations = 200;

  /// Standard errors allow for residuals that are not white, by a noise model of each output's;
  /// false: they equal the white ones, and the fit does without that pass.
  bool coloured_errors = true;

  /// Threads, the caller's included; 0: one a core. The result does not depend on it.
  int threads = 0;
  FitProgress progress = {};
};

}  // namespace sepcal
