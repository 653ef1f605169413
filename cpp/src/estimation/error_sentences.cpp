// SPDX-License-Identifier: BSD-3-Clause
#include "estimation/error_sentences.hpp"

#include <algorithm>
#include <cmath>

#include "base/name_list.hpp"
#include "base/short_number.hpp"

namespace sepcal::estimation {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using Names = std::vector<std::string>;

/// The largest of some ratios, as words say it.
std::string times(const std::vector<double>& ratios) {
  return base::short_number(std::round(10.0 * std::ranges::max(ratios)) / 10.0) + " times";
}

/// Where noise model and blocks disagree: who is believed, and why.
std::vector<std::string> describe_disagreement(const Names& parameters, const VectorXd& noise_model,
                                               const VectorXd& blocks,
                                               const BlockEvidence& evidence) {
  constexpr double clearly = 1.5;
  Names larger;
  Names smaller;
  Names refuted;
  std::vector<double> above;
  std::vector<double> below;
  std::vector<double> said;
  for (Index k = 0; k < blocks.size(); ++k) {
    const double ratio = blocks[k] / noise_model[k];
    const double allowed = evidence.allowed(k);
    if (allowed * clearly < 1.0) {
      refuted.push_back(parameters[static_cast<std::size_t>(k)]);
      said.push_back(1.0 / evidence.shown[k]);
    } else if (ratio > far_apart) {
      larger.push_back(parameters[static_cast<std::size_t>(k)]);
      above.push_back(ratio);
    } else if (ratio * far_apart < 1.0) {
      smaller.push_back(parameters[static_cast<std::size_t>(k)]);
      below.push_back(1.0 / ratio);
    }
  }
  std::vector<std::string> sentences;
  if (!larger.empty()) {
    sentences.push_back("standard error of " + base::list_names(larger) +
                        " is by blocks of the record, up to " + times(above) +
                        " the noise model's: no noise model here explains how it varies");
  }
  if (!smaller.empty()) {
    sentences.push_back("standard error of " + base::list_names(smaller) +
                        " is by the noise model, up to " + times(below) +
                        " that of blocks: the noise is too slow for blocks of the record to show");
  }
  if (!refuted.empty()) {
    sentences.push_back("standard error of " + base::list_names(refuted) +
                        " is what blocks of the record allow: the noise model says they should "
                        "vary up to " +
                        times(said) + " as much as they do");
  }
  return sentences;
}

/// Outputs whose noise remembers more than a tenth of the record.
std::string describe_memory(const Covariances& covariances, const model::Sweep& sweep) {
  constexpr double enough = 10.0;  // correlation times
  const auto rows = static_cast<double>(sweep.measurements().rows());
  Names slow;
  double fewest = enough;
  for (std::size_t j = 0; j < covariances.noise.size(); ++j) {
    const auto& noise = covariances.noise[j];
    if (!noise) continue;
    const double times = rows / correlation_rows(*noise);
    if (times >= enough) continue;
    slow.push_back(sweep.tables().outputs[j].name);
    fewest = std::min(fewest, times);
  }
  if (slow.empty()) return "";
  const std::string spanned =
      fewest < 1.0 ? "less than one" : "about " + base::short_number(std::floor(fewest));
  return "standard errors are a lower bound: the record spans " + spanned +
         " of the correlation times of the noise of " + base::list_names(slow) +
         ", and ten are needed";
}

/// Outputs of which only one row in several tells something.
std::string describe_strides(const Covariances& covariances, const model::Sweep& sweep) {
  Names smooth;
  Index longest = 1;
  for (std::size_t j = 0; j < covariances.noise.size(); ++j) {
    const auto& noise = covariances.noise[j];
    if (!noise || noise->held == 1) continue;
    smooth.push_back(sweep.tables().outputs[j].name);
    longest = std::max(longest, noise->held);
  }
  if (smooth.empty()) return "";
  return "residual of " + base::list_names(smooth) +
         " was held, interpolated or smoothed: in its noise model " + std::to_string(longest) +
         " rows count as one";
}

/// Outputs whose noise moves with what was fitted.
std::string describe_moving(const Covariances& covariances, const model::Sweep& sweep) {
  Names moving;
  for (std::size_t j = 0; j < covariances.noise.size(); ++j) {
    const auto& noise = covariances.noise[j];
    if (noise && noise->moves_with_columns) moving.push_back(sweep.tables().outputs[j].name);
  }
  if (moving.empty()) return "";
  return "noise of " + base::list_names(moving) +
         " moves with the columns that were fitted, as a noisy input makes it: standard errors are "
         "by blocks of the record where these say more";
}

/// A record in many short pieces, and one of very few rows.
std::string describe_rows(const model::Sweep& sweep) {
  constexpr std::size_t few = 24;
  constexpr std::size_t piece = 200;
  const std::size_t rows = sweep.measurements().rows();
  const std::size_t runs = sweep.measurements().runs().size();
  if (rows < few) {
    return "standard errors of " + std::to_string(rows) +
           " rows are too small: estimate -+ 1.96 of them holds the truth in about 90 % (of 12 "
           "rows in 87 %)";
  }
  if (runs == 1 || rows / runs >= piece) return "";
  return "gaps cut the record into " + std::to_string(runs) + " pieces of about " +
         std::to_string(rows / runs) +
         " rows: noise slower than a piece is not in the noise model's standard errors";
}

}  // namespace

double believed_from(const Covariances& covariances) {
  const bool moves = std::ranges::any_of(
      covariances.noise,
      [](const std::optional<OutputNoise>& noise) { return noise && noise->moves_with_columns; });
  return moves ? 1.0 : far_apart;
}

std::string describe_sample(const Covariances& covariances, const model::Sweep& sweep,
                            const model::Sweep& sampled) {
  const std::string rows = std::to_string(sampled.measurements().rows()) + " of " +
                           std::to_string(sweep.measurements().rows()) + " rows";
  if (covariances.sample_falls_short) {
    return "there is no noise model, but white noise and blocks: " + rows +
           ", from which one would be found, leave a parameter open";
  }
  return "the noise model is from " + rows + ", in stretches spread evenly over the record";
}

std::vector<std::string> describe_errors(const Names& parameters, const Covariances& covariances,
                                         const VectorXd& blocks, const model::Sweep& sweep) {
  const VectorXd noise_model = covariances.noise_model.diagonal().cwiseSqrt();
  std::vector<std::string> sentences =
      describe_disagreement(parameters, noise_model, blocks, covariances.evidence);
  for (const std::string& sentence :
       {describe_memory(covariances, sweep), describe_strides(covariances, sweep),
        describe_moving(covariances, sweep), describe_rows(sweep)}) {
    if (!sentence.empty()) sentences.push_back(sentence);
  }
  return sentences;
}

}  // namespace sepcal::estimation
