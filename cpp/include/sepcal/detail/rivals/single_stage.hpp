// SPDX-License-Identifier: BSD-3-Clause
// The benchmark of Sun & Gebre-Egziabher, Sec. III.A: all parameters at once by one nonlinear
// programme, from one start (Eq. 16, left-hand side). What the two-stage estimator is measured
// against; who wants estimates calls fit().
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "sepcal/detail/block_model.hpp"
#include "sepcal/detail/eigen.hpp"
#include "sepcal/detail/model.hpp"
#include "sepcal/detail/quantity.hpp"
#include "sepcal/fit.hpp"
#include "sepcal/record.hpp"

namespace sepcal::rivals {

enum class Solver {
  levenberg_marquardt,  // Ceres, which knows that the cost is a sum of squares; where its steps,
                        // clipped to the bounds, end at no minimum, SLSQP goes on
  slsqp  // NLopt's sequential quadratic programming, the nearest to MATLAB's fmincon: it knows only
         // the cost and its gradient, with every parameter in its own unit
};

/// "levenberg_marquardt", "slsqp".
std::string_view to_string(Solver solver);

/// What SLSQP minimises. Its tolerances take a cost to be of order one: a sum over many rows is
/// not, and it may then call something a minimum that is none.
enum class CostScale { mean, sum };

/// "mean", "sum".
std::string_view to_string(CostScale scale);

struct SingleStageOptions {
  std::map<std::string, Interval> bounds = {};  // instead of the model's
  std::map<std::string, double> fix = {};
  std::map<std::string, double> noise = {};  // of every output; empty: R is estimated (Eqs. 24-26)
  std::string segments = {};                 // as in Record::select(); empty: all
  Solver solver = Solver::levenberg_marquardt;
  CostScale cost = CostScale::mean;
  /// R = I at first, then that of the residuals, until no variance changes by this share (Eq. 26).
  double noise_tolerance = 0.05;
  int noise_iterations = 100;
  int evaluations = 1000;  // of the cost, at most, in one minimisation
  int threads = 0;         // the caller's included; 0: one a core
};

struct SingleStageFit {
  bool converged = false;          // a minimum at this R, as the solver says, and R settled
  std::vector<std::string> names;  // n, linear, then nonlinear, fixed ones among them
  Eigen::VectorXd estimates;       // n
  std::vector<OutputValue> noise;  // standard deviations
  double cost = 0.0;               // J of Eq. 6, as Fit::cost
  int evaluations = 0;             // Ceres: iterations
  int noise_iterations = 0;        // of R against the parameters
};

/// Minimises J of Eq. 6 from `start`, by name, linear or nonlinear; parameters not named begin at
/// zero, all within their bounds. Throws Error for misuse, as fit() does.
SingleStageFit fit_single_stage(const BlockModel& model, const Record& record,
                                const std::map<std::string, double>& start,
                                const SingleStageOptions& options = {});

template <SeparableModel M>
SingleStageFit fit_single_stage(const M& model, const Record& record,
                                const std::map<std::string, double>& start,
                                const SingleStageOptions& options = {}) {
  return fit_single_stage(StaticModel<M>(model), record, start, options);
}

}  // namespace sepcal::rivals
