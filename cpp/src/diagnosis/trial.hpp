// SPDX-License-Identifier: BSD-3-Clause
// The trial of one candidate: screened by the score test over its shapes, tested by a likelihood
// ratio, estimated by one step.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "diagnosis/candidate.hpp"
#include "diagnosis/held_out.hpp"
#include "diagnosis/instrument_noise.hpp"
#include "diagnosis/null_hypothesis.hpp"
#include "diagnosis/projection.hpp"
#include "diagnosis/refits.hpp"

namespace sepcal::diagnosis {

/// A candidate at one of its shapes.
struct ShapeScore {
  double shape = not_a_number;
  int freedom = 0;         // directions that can be seen
  double white = 0.0;      // log10 of the score's tail in the null's noise model
  double plain = 0.0;      // the same as if the residual were white
  double reduction = 0.0;  // of the residual's sum of squares, in units of the RMSE
};

struct Trial {
  Candidate candidate = {};
  double visibility = 0.0;
  double least_visibility = visible_from;
  bool visible = false;  // in one direction at least
  std::vector<ShapeScore> scores = {};
  double shape = not_a_number;  // where it explains most
  double log10_white = 0.0;     // of the best score's tail, corrected for the scan
  double log10_plain = 0.0;
  double log10_p = 0.0;  // of the test where it was made, else of the score
  bool tested = false;
  NoiseTest::Ratios ratios = {};  // with the noise beside the effect
  double floor = infinity;        // innovations alone with the effect, over all outputs
  int freedom = 0;
  Eigen::VectorXd estimate = {};
  Eigen::MatrixXd covariance = {};
  NoiseTails tails = {};  // of the ratios, corrected for the scan as log10_p is
  std::optional<InstrumentTail> bounded = {};  // likewise, in noise as instruments have it
  double inflation = 1.0;  // of the variance of its coefficients, by noise of the inputs
  bool slow = false;       // its driver changes as slowly as noise may wander
  double predicted_drop = 0.0;
  HeldOut held_out = {};
  bool refitted = false;  // held_out is that of real fits
  Folds folds = {};
  Eigen::VectorXd absorbed = {};  // shift of each column of the tangent
};

/// The trial's columns at a shape, beside the tangent.
Projection project_trial(const CandidateRoom& room, const NullHypothesis& null, const Trial& trial,
                         double shape);

/// log10 of the number of shapes tried, by which the best one's probability is multiplied.
double log10_scan(const Trial& trial);

/// Scores every shape in the directions that can be seen.
void screen(const CandidateRoom& room, const NullHypothesis& null, Trial& trial);

/// The estimate of one step, as if the residual were white.
void estimate_plainly(const RowLayout& layout, const Projection& added,
                      const Eigen::VectorXd& residual, Trial& trial);

/// The shapes that score best, by either screen: one or two.
std::vector<double> best_shapes(const Trial& trial);

/// The likelihood ratio in noise of free size at the shapes that score best, with the estimate at
/// the surer one; where noise as instruments have it decides, at the shape that this has chosen.
void test(const CandidateRoom& room, const NullHypothesis& null, Trial& trial);

/// Whether the columns hardly change within a hundredth of the record: noise that is as slow
/// imitates them.
bool is_smooth(const RowLayout& layout, const Columns& columns);

/// Whether it takes slow noise for its own, as functions of time of any form do.
bool is_flexible_in_time(const Candidate& candidate);

/// Whether that holds of all that drives it, or of its columns where nothing does.
bool is_slow(const CandidateRoom& room, const Candidate& candidate, double shape);

/// Whether noise as instruments have it sees enough of it to say how sure it is.
bool is_bounded(const Trial& trial);

/// Whether noise as instruments have it decides alone: the effect is slow, so that noise of free
/// size would take it for its own, and what is left is within what these noises allow.
bool is_decided_by_bounds(const Trial& trial);

/// log10_p from the tails. Noise of free size tells what changes fast from noise, and takes what is
/// slow for its own; noise within an instrument's bounds tells both, where the log's noise is such.
void combine_tails(Trial& trial);

/// Takes what noise as instruments have it makes of the trial into its log10_p. Returns false where
/// it is surer already at another shape.
bool bound(const InstrumentTail& tail, Trial& trial);

/// Corrects the test's tail for what draws of the noise do to the ratios. Whether the columns are
/// smooth is asked here.
void calibrate(const CandidateRoom& room, const NullHypothesis& null, NoiseTest::Drawing drawing,
               base::ThreadPool& pool, Trial& trial);

/// Of a path: no surer than blocks of the record, each by itself, make it (block_jackknife.hpp).
void doubt(const CandidateRoom& room, const NullHypothesis& null, Trial& trial);

/// Cross-validation by one step from the fit: of whole segments where the effect isn't smooth and
/// there are a few, else of blocks in between.
void hold_out(const CandidateRoom& room, const NullHypothesis& null, Trial& trial);

/// The same by real fits, which replace the steps.
void confirm(Refits& refits, Trial& trial);

}  // namespace sepcal::diagnosis
