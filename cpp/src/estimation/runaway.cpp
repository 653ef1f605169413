// SPDX-License-Identifier: BSD-3-Clause
#include "estimation/runaway.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <string>

#include "base/sentences.hpp"

namespace sepcal {
namespace {

constexpr double too_much = 1e4;            // growth of a state's error along a trajectory
constexpr double nothing_explained = 0.98;  // of an output's spread is left
// Steps of integration beside the fastest rate of the dynamics: of fourth order a rate is off by
// (its share)^4 / 120, and from 2.8 on a damped one is taken for another.
constexpr double fine_step = 0.5;
constexpr double useless_step = 1.0;

/// About its mean, over the segments; NaN of none.
double spread_of(const Record& record, const std::string& name) {
  double count = 0.0;
  double mean = 0.0;
  double square = 0.0;  // of deviations from the running mean
  const std::span<const double> column = record.column(name);
  for (const Segment& segment : record.segments()) {
    for (const double value : column.subspan(segment.first, segment.rows())) {
      count += 1.0;
      const double off = value - mean;
      mean += off / count;
      square += off * (value - mean);
    }
  }
  return std::sqrt(square / count);
}

/// An output that its mean would explain as well; empty where there is none.
std::string unexplained_output(const Fit& result, const Record& record) {
  for (const OutputValue& rmse : result.rmse) {
    if (rmse.value >= nothing_explained * spread_of(record, rmse.name)) return rmse.name;
  }
  return "";
}

std::string describe(const Fit& result, const BlockModel& model, const Record& record) {
  if (!(model.growth(record, result.values()) < too_much)) {
    return "a state runs away along a segment, so that the rest says little: cut long segments "
           "(shoot), or bound what makes it unstable";
  }
  const std::string output = unexplained_output(result, record);
  if (output.empty()) return "";
  return "the model follows " + output +
         " no better than its mean would: where a state may run away, cut long segments (shoot)";
}

void put_first(Fit& result, const std::string& sentence) {
  result.message = base::join_sentences({sentence, result.message});
}

}  // namespace

void estimation::warn_of_coarse_steps(Fit& result, const BlockModel& model, const Record& record) {
  if (model.new_carry() == nullptr) return;
  const double coarse = model.coarseness(record, result.values());
  if (!(coarse > fine_step)) return;
  if (coarse > useless_step && result.status == FitStatus::converged) {
    result.status = FitStatus::not_converged;
  }
  const int factor = static_cast<int>(std::ceil(std::min(coarse / fine_step, 1e6)));
  put_first(result,
            "steps of integration are too long for the fastest rate of the dynamics; take " +
                std::to_string(factor) + " times as many (substeps)");
}

void estimation::warn_of_runaway(Fit& result, const BlockModel& model, const Record& record) {
  const bool amiss = result.status != FitStatus::converged ||
                     std::ranges::any_of(result.parameters, &Parameter::at_bound);
  if (!amiss || model.new_carry() == nullptr) return;
  const std::string sentence = describe(result, model, record);
  if (sentence.empty()) return;
  if (result.status == FitStatus::converged) result.status = FitStatus::not_converged;
  put_first(result, sentence);
}

}  // namespace sepcal
