// SPDX-License-Identifier: BSD-3-Clause
// Alternatives for the first place, each fitted for real: one step from the fit can't rank what
// bends the model, nor say what would do as well instead.
#pragma once

#include <Eigen/Core>
#include <map>
#include <string>
#include <vector>

#include "diagnosis/advice.hpp"
#include "diagnosis/candidate_testing.hpp"

namespace sepcal::diagnosis {

inline constexpr double as_likely = 9.2;     // in -2 ln L: 1 % of chi-squared's with two degrees
inline constexpr double clearly_less = 0.8;  // of the error on rows held out
inline constexpr double alike = 0.94;  // cosine of 20 deg, between what two take of the residual

/// Whether what leaves so much of the error takes nearly all of what that takes which leaves the
/// least.
inline bool takes_nearly_all(double left, double least) {
  return 1.0 - left >= 0.85 * (1.0 - least);
}

/// Whether it does nearly as well: it takes nearly all, or half where the other does not leave
/// clearly less.
inline bool does_nearly_as_well(double left, double least) {
  return takes_nearly_all(left, least) ||
         (1.0 - left >= 0.5 * (1.0 - least) && clearly_less * left <= least);
}

/// The fit of the model with one more effect.
struct Alternative {
  Candidate candidate = {};
  double shape = not_a_number;  // where it was found
  Fit fit = {};                 // undefined where the criterion is infinite
  double minus_two_log_likelihood =
      infinity;                 // in the selection's noise; infinite: can't be fitted
  double criterion = infinity;  // the same with Schwarz's penalty for coefficients and shapes tried
  double drop = not_a_number;   // of the RMSE over all outputs, where the fit leaves each something
  Eigen::VectorXd taken = {};   // what the fit takes of the residual (N n_z), in units of that one
};

/// All are judged in one noise: that beside all of them at once.
struct ModelSelection {
  NoiseMembers noise = {};
  std::vector<Alternative> alternatives = {};
  std::map<std::string, Objection> objections = {};  // that were asked for
};

/// What of the error it leaves, on all rows or on rows held out, whichever is more.
double error_left(const Alternative& alternative, const EffectFinding& finding);

/// find_objection(), once an effect.
const Objection& object(CandidateTesting& testing, ModelSelection& selection,
                        const EffectFinding& finding);

/// Whether a third of the coefficients is enough for it, as for a lag beside a matrix.
bool is_far_simpler(const Candidate& one, const Candidate& other);

/// Schwarz's penalty for a candidate's coefficients and for the number of shapes tried.
double schwarz_penalty(const Candidate& candidate, Eigen::Index measurements);

/// Fits all to the record and judges them in that noise.
void fit_all(const CandidateTesting& testing, const NoiseMembers& noise,
             std::vector<Alternative>& asked);

/// Fits the best of the findings that may stand for what is missing.
ModelSelection fit_alternatives(CandidateTesting& testing,
                                const std::vector<EffectFinding>& findings);

/// Of those found the one whose fit has the least criterion comes first, or the simplest of those
/// that data can't tell from it, the preferred before others that are as simple. What would do as
/// well in its place, being as likely or taking the same of the residual, is marked equivalent and
/// comes next. Returns the first's alternative; null where
/// none could be fitted.
const Alternative* put_first(const ModelSelection& selection,
                             const std::vector<std::string>& preferred,
                             std::vector<EffectFinding>& findings);

/// Along a path a fit, not one step, says what of the error goes with each alternative.
void promise_by_fits(const CandidateTesting& testing, const ModelSelection& selection,
                     std::vector<EffectFinding>& findings);

/// What of the other effects found fades beside the first and what counts: tested anew at its fit.
/// Puts what counts before what fades.
void test_beside(CandidateTesting& testing, const Alternative& first,
                 std::vector<EffectFinding>& findings);

}  // namespace sepcal::diagnosis
