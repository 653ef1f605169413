// SPDX-License-Identifier: BSD-3-Clause
// Profile-likelihood intervals. With J of Eq. 6 and J_p(t) its least value where one parameter is
// held at t and all others, and R, are fitted again, the interval is {t : 2 (J_p(t) - J-hat) <= q},
//   q = M ln(1 + c t_q^2 / (M - n))   R estimated (of one output and white noise, the F test)
//   q = c z_q^2                       R given
// M = rows x outputs, n free parameters, t_q and z_q the quantiles of Student and of the normal. c
// = (standard_error / standard_error_white)^2 makes the likelihood vary as the residuals' colour
// does (the vertical adjustment of Pace, Salvan & Sartori, Statistica Sinica 21, 2011); it stands
// within the logarithm so that of a linear model both intervals are the same. A loss is no
// likelihood: R stays that of the fit, and c sets the sandwich against the cost's own curvature.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "sepcal/detail/block_model.hpp"
#include "sepcal/detail/model.hpp"
#include "sepcal/fit.hpp"

namespace sepcal {

/// What ends an interval on one side.
enum class IntervalEnd {
  crossed,  // the profile rises above q there
  bound,    // the parameter's bound, where it has not
  open,     // nothing: it doesn't rise, however far the parameter goes
  failed    // unknown: on the way there the other parameters could not be fitted
};

/// "crossed", "bound", "open", "failed".
std::string_view to_string(IntervalEnd end);

/// The part about the estimate, where the set is not connected. In the parameter's unit.
struct ProfileInterval {
  std::string name = {};
  std::string unit = {};
  double value = 0.0;
  Interval gaussian = {};  // value -+ t_q (or z_q) standard errors; NaN where there is none
  Interval profile = {};   // infinite where open, NaN where failed
  IntervalEnd lower_end = IntervalEnd::crossed;
  IntervalEnd upper_end = IntervalEnd::crossed;
  std::string message = {};  // one line; empty where there is nothing to say
};

struct ProfileOptions {
  double level = 0.95;
  std::vector<std::string> names = {};  // empty: all that are free, in the fit's order
  FitProgress progress = {};
};

/// Both intervals of every named parameter of `fit`. `model`, `record` and `options` are those of
/// the fit; what it held stays held. A parameter at its bound has no c: the largest of the others'
/// and of 1 stands for it. Throws Error for a level outside (0, 1), a name that is unknown or of a
/// parameter that is held, and where the estimates of a converged fit are no minimum here.
std::vector<ProfileInterval> profile_intervals(const BlockModel& model, const Record& record,
                                               const Fit& fit, const FitOptions& options = {},
                                               const ProfileOptions& asked = {});

template <SeparableModel M>
std::vector<ProfileInterval> profile_intervals(const M& model, const Record& record, const Fit& fit,
                                               const FitOptions& options = {},
                                               const ProfileOptions& asked = {}) {
  return profile_intervals(StaticModel<M>(model), record, fit, options, asked);
}

}  // namespace sepcal
