// SPDX-License-Identifier: BSD-3-Clause
// The order of findings, and which of them a flight can't tell apart.
#pragma once

#include <vector>

#include "base/thread_pool.hpp"
#include "diagnosis/candidate.hpp"
#include "diagnosis/null_hypothesis.hpp"
#include "diagnosis/trial.hpp"
#include "sepcal/diagnosis.hpp"

namespace sepcal::diagnosis {

/// What findings are compared by: the trials that they come from.
struct Comparisons {
  const CandidateRoom& room;
  const NullHypothesis& null;
  const std::vector<Trial>& trials;
  double correlation;  // from which on two effects are one
};

/// What is found first, then what is surer.
void rank(std::vector<EffectFinding>& findings);

/// The first of those found gives way to one with fewer columns beyond which it explains nothing:
/// of a straight line and a spline, the line.
void prefer_simplest(const Comparisons& among, std::vector<EffectFinding>& findings);

/// Fills in the families of the first dozen. `threshold`: log10 of the probability below which a
/// proxy is significant.
void find_families(const Comparisons& among, double threshold, base::ThreadPool& pool,
                   std::vector<EffectFinding>& findings);

}  // namespace sepcal::diagnosis
