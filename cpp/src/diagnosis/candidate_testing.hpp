// SPDX-License-Identifier: BSD-3-Clause
// Candidates in testing: made, screened, tested, calibrated and held out at one fit.
#pragma once

#include <cstddef>
#include <functional>
#include <initializer_list>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/thread_pool.hpp"
#include "diagnosis/candidate.hpp"
#include "diagnosis/input_noise.hpp"
#include "diagnosis/instrument_noise.hpp"
#include "diagnosis/null_hypothesis.hpp"
#include "diagnosis/refits.hpp"
#include "diagnosis/trial.hpp"
#include "sepcal/diagnosis.hpp"

namespace sepcal::diagnosis {

using Trials = std::vector<Trial>;

/// Whether what there is of it could be a slow change, were its noise known not to wander.
/// `threshold`: log10 of the probability below which it is significant.
bool may_be_slow(const Trial& trial, double threshold);

/// The places of the best `most` among those that `counts`, by each of some tails: of either
/// screen.
std::vector<std::size_t> best_of(const Trials& trials, std::size_t most,
                                 const std::function<bool(const Trial&)>& counts,
                                 std::initializer_list<double Trial::*> tails = {
                                     &Trial::log10_white, &Trial::log10_plain});

class CandidateTesting {
 public:
  /// All must outlive it. Throws Error as CandidateRoom does.
  CandidateTesting(const DiagnosedFit& fitted, const DiagnosisOptions& options,
                   base::ThreadPool& pool);
  /// Where the fit has the candidate, as if it had not: see CandidateRoom.
  CandidateTesting(const DiagnosedFit& fitted, const Candidate& released,
                   const DiagnosisOptions& options, base::ThreadPool& pool);
  /// The same fit with other regressors, in the noise of `first`, which must outlive it: for
  /// bounded_tail() alone.
  CandidateTesting(const CandidateTesting& first, Regressors regressors);
  CandidateTesting(const CandidateTesting&) = delete;  // the null hypothesis points into it
  CandidateTesting& operator=(const CandidateTesting&) = delete;
  ~CandidateTesting() = default;

  const DiagnosedFit& fitted() const { return fitted_; }
  CandidateRoom& room() { return room_; }
  const CandidateRoom& room() const { return room_; }
  const NullHypothesis& null() const { return null_; }
  base::ThreadPool& pool() const { return pool_; }
  Refits& refits() const { return *refits_; }
  /// None of a model with a state, whose noise remembers.
  const InstrumentNoise* instruments() const { return instruments_.get(); }
  const InputNoise* inputs() const { return inputs_.get(); }
  const DiagnosisOptions& options() const { return options_; }

  /// What was done so far; count() adds what was done elsewhere.
  DiagnosisWork work() const;
  void count(const DiagnosisWork& elsewhere) const { work_ += elsewhere; }

  void report_progress(std::string_view task, double fraction) const;

  /// Whether every output's residual is zero: then there is no null to hold anything against.
  bool is_exact() const { return room_.fit().layout.outputs.empty(); }

  /// Each once; those that the record can't make are left out.
  Trials make(const std::vector<std::string>& names);

  void screen_all(Trials& trials) const;

  /// Tests the best `most` of either screen: in noise as instruments have it, and where that makes
  /// the log10 of a tail less than the threshold, or with `slow_too` it may be a slow change, in
  /// noise of free size.
  void test_best(Trials& trials, std::size_t most, double threshold, bool slow_too) const;

  /// Rows are held out of those tested and of others that are significant, with `promising_too` of
  /// those that promise much.
  void hold_out_significant(Trials& trials, bool promising_too) const;

  /// Corrects the tails of what would be significant, with `slow_too` of what could be a slow
  /// change; what was only screened is not significant, nor surer than the least sure of what was
  /// tested.
  void calibrate_significant(Trials& trials, double threshold, bool slow_too) const;

  /// log10 of a candidate's tail in noise as instruments have it, that beside it alone; none where
  /// such noise doesn't say.
  std::optional<double> bounded_tail(const std::string& name);

  /// One step may fail an effect that bends the model: those that explain more than the best that
  /// passed get real fits.
  void confirm_best(Trials& trials, double threshold) const;

 private:
  void know_instruments();
  void bound_all(const std::vector<Trial*>& chosen) const;

  const DiagnosedFit& fitted_;
  const DiagnosisOptions& options_;
  base::ThreadPool& pool_;
  CandidateRoom room_;
  NullHypothesis null_;
  std::unique_ptr<Refits> refits_;
  std::unique_ptr<InstrumentNoise> instruments_ = {};
  std::unique_ptr<InputNoise> inputs_ = {};
  mutable DiagnosisWork work_ = {};
};

}  // namespace sepcal::diagnosis
