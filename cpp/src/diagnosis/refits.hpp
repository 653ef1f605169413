// SPDX-License-Identifier: BSD-3-Clause
// Real fits with a candidate: what one step from the fit can't judge, as effects that bend the
// model or leave it poorly determined.
#pragma once

#include <map>
#include <mutex>
#include <string>

#include "diagnosis/candidate.hpp"
#include "diagnosis/held_out.hpp"

namespace sepcal::diagnosis {

/// The fit with the candidate's effects as its last.
DiagnosedFit with_candidate(const DiagnosedFit& fitted, const Candidate& candidate, Fit fit);

/// Rows that a fit of a long record needs, where one step or a prediction follows.
inline constexpr std::size_t enough_rows = 20000;

/// Where a scanned effect was found; NaN for others.
double shape_of(const EffectFinding& finding);

/// The fit of the model with the candidate, from the estimates without it and from the shape, which
/// a step keeps; to about `most_rows` where there are more, in blocks that lie evenly over every
/// segment, and to all of them along a path. `coloured_errors`: as of FitOptions; without them
/// standard errors are those of white noise.
Fit refit_nearly(const CandidateRoom& room, const Candidate& candidate, double shape,
                 std::size_t most_rows, bool coloured_errors = false);

/// By how much the error over all outputs, each in units of its own, falls from one fit to another,
/// 1 - after / before: as adding an effect reports it along a path.
double error_drop(const Fit& before, const Fit& after);

/// What that is of adding the candidate to a model with a state, of which `fitted` is such a fit:
/// by filter error noises are free again, as adding leaves them. NaN where that can't be fitted.
double drop_of_adding(const CandidateRoom& room, const Candidate& candidate, const Fit& fitted);

/// The fits of a room's model with candidates, each made once. Thread-safe; the room must outlive
/// it.
class Refits {
 public:
  explicit Refits(const CandidateRoom& room) : room_(room) {}

  /// refit_nearly() to enough rows. Throws the Error again that the fit ended in.
  const Fit& with(const Candidate& candidate, double shape);

  /// How well the two fits, without the candidate and with it, predict rows left out. Not judged of
  /// a model with a state, where no row is left out of the others' path, and where a fit fails.
  HeldOut hold_out(const Candidate& candidate, double shape, const Folds& folds);

  /// The neighbourhood of the fit with the candidate. Throws Error as with() does.
  LinearisedFit linearise(const Candidate& candidate, double shape);

  std::size_t count() const;

 private:
  struct Made {
    Fit fit = {};
    std::string error = {};
  };

  const CandidateRoom& room_;
  mutable std::mutex making_;
  std::map<std::string, Made> made_;
};

}  // namespace sepcal::diagnosis
