// SPDX-License-Identifier: BSD-3-Clause
// A candidate judged where its own fit ends. A fit that lacks an effect may have bent its other
// parameters to it, so far that one step from there doesn't find it again; from the fit that has
// it, looking back at what its absence would leave, the model is as straight as it gets.
#pragma once

#include <memory>
#include <vector>

#include "diagnosis/candidate_testing.hpp"

namespace sepcal::diagnosis {

/// The candidate of a trial at its own fit.
class OwnFit {
 public:
  /// `fit`: of Refits, at that shape. `testing`: of the fit without it.
  OwnFit(const CandidateTesting& testing, const Candidate& candidate, double shape, Fit fit);
  OwnFit(const OwnFit&) = delete;  // the testing refers to the fit
  OwnFit& operator=(const OwnFit&) = delete;
  ~OwnFit() = default;

  const CandidateTesting& testing() const { return testing_; }

  /// The candidate tested there, held out and calibrated. `threshold`: as of
  /// CandidateTesting::calibrate_significant().
  Trial test(double threshold);

 private:
  Candidate candidate_;
  double shape_;
  DiagnosisOptions options_;
  DiagnosedFit fitted_;
  CandidateTesting testing_;
};

/// Of a model with a state those of the best of `trials` that take most of the error in a fit, the
/// best first; none that takes less than a hundredth.
std::vector<std::unique_ptr<OwnFit>> find_hidden(const CandidateTesting& testing,
                                                 const Trials& trials);

}  // namespace sepcal::diagnosis
