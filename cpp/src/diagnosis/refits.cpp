// SPDX-License-Identifier: BSD-3-Clause
#include "diagnosis/refits.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "sepcal/error.hpp"

namespace sepcal::diagnosis {
namespace {

/// About so many rows in blocks that lie evenly over every segment; all where there are no more.
std::vector<Segment> spread(const std::vector<Segment>& segments, std::size_t most) {
  constexpr std::size_t fewest_blocks = 10;  // two of them fit anything
  constexpr std::size_t longest_block = 200;
  const std::size_t block = std::min(longest_block, most / fewest_blocks);
  std::size_t rows = 0;
  for (const Segment& segment : segments) rows += segment.rows();
  if (rows <= most) return segments;
  const std::size_t apart = block * rows / most;  // from a block's first row to the next one's
  std::vector<Segment> blocks;
  for (const auto& [label, begin, end] : segments) {
    for (std::size_t first = begin; first < end; first += apart) {
      blocks.push_back({label, first, std::min(first + block, end)});
    }
  }
  return blocks;
}

/// What a fit to some of the rows takes from the fit to all of them.
FitOptions options_from(const Fit& fit) {
  FitOptions options;
  options.method = fit.method;
  if (fit.method ==
      FitMethod::filter_error) {  // in the noise of the fit, as its innovations are judged
    options.process_noise = fit.process_noise();
    for (const OutputValue& noise : fit.noise) options.noise[noise.name] = noise.value;
  }
  options.samples = 0;
  options.noise_tolerance = 1e-4;
  options.threads = 1;
  options.coloured_errors = false;
  for (std::size_t k = 0; k < fit.parameters.size(); ++k) {
    const Parameter& parameter = fit.parameters[k];
    if (parameter.fixed) {
      options.fix[parameter.name] = parameter.value;
      continue;
    }
    options.bounds[parameter.name] = {parameter.lower, parameter.upper};
    if (static_cast<int>(k) >= fit.n_1) options.start[parameter.name] = parameter.value;
  }
  return options;
}

/// The same for the model with the candidate, which begins at zero; its shape is held.
FitOptions options_with(FitOptions options, const Tables& tables, const Candidate& candidate,
                        double shape) {
  if (!candidate.shape.parameter.empty()) options.fix[candidate.shape.parameter] = shape;
  for (const Variable& coefficient : candidate.coefficients) {
    if (std::ranges::find(tables.nonlinear, coefficient.name, &Variable::name) !=
        tables.nonlinear.end()) {
      options.start[coefficient.name] = 0.0;
    }
  }
  return options;
}

/// Holds only those noises that were given to a fit by filter error.
FitOptions with_noise_as_asked(FitOptions options, const Fit& fit) {
  options.process_noise.clear();
  options.noise.clear();
  for (const NoiseSize& size : fit.noise_sizes) {
    const bool was_given = std::isnan(size.standard_error) && !size.at_floor;
    if (!was_given) continue;
    auto& held = size.name.starts_with("q_") ? options.process_noise : options.noise;
    held[size.name.substr(2)] = size.value;
  }
  return options;
}

}  // namespace

double shape_of(const EffectFinding& finding) {
  return finding.shapes.empty() ? not_a_number : finding.shapes.begin()->second;
}

Fit refit_nearly(const CandidateRoom& room, const Candidate& candidate, double shape,
                 std::size_t most_rows, bool coloured_errors) {
  const auto with = room.model_with(candidate.effects);
  Record rows = room.record();
  rows.cut(room.follows_path() ? room.rows() : spread(room.rows(), most_rows));
  FitOptions options = options_with(options_from(room.fitted()), with->tables(), candidate, shape);
  options.coloured_errors = coloured_errors;
  const std::string& of_shape = candidate.shape.parameter;
  if (!of_shape.empty() && candidate.stepping_port.empty()) {  // a step's row is exact
    options.fix.erase(of_shape);
    options.start[of_shape] = shape;
  }
  return fit(*with, rows, options);
}

double error_drop(const Fit& before, const Fit& after) {
  double square = 0.0;
  for (std::size_t j = 0; j < after.rmse.size(); ++j) {
    square += std::pow(after.rmse[j].value / before.rmse[j].value, 2);
  }
  return 1.0 - std::sqrt(square / static_cast<double>(after.rmse.size()));
}

double drop_of_adding(const CandidateRoom& room, const Candidate& candidate, const Fit& fitted) {
  if (fitted.method != FitMethod::filter_error) return error_drop(room.fitted(), fitted);
  Record rows = room.record();
  rows.cut(room.rows());
  const FitOptions options = with_noise_as_asked(options_from(fitted), room.fitted());
  try {
    return error_drop(room.fitted(), fit(*room.model_with(candidate.effects), rows, options));
  } catch (const Error&) {
    return not_a_number;
  }
}

DiagnosedFit with_candidate(const DiagnosedFit& fitted, const Candidate& candidate, Fit fit) {
  DiagnosedFit next = fitted;
  next.effects.insert(next.effects.end(), candidate.settings.begin(), candidate.settings.end());
  next.fit = std::move(fit);
  return next;
}

const Fit& Refits::with(const Candidate& candidate, double shape) {
  const std::string key = fmt::format("{} {}", candidate.name, shape);
  {
    const std::lock_guard lock(making_);
    const auto known = made_.find(key);
    if (known != made_.end() && known->second.error.empty()) return known->second.fit;
    if (known != made_.end()) throw Error(known->second.error);
  }
  Made made;
  try {
    made.fit = refit_nearly(room_, candidate, shape, enough_rows);
  } catch (const Error& error) {
    made.error = error.what();
  }
  const std::lock_guard lock(making_);
  const Made& kept = made_.try_emplace(key, std::move(made)).first->second;
  if (!kept.error.empty()) throw Error(kept.error);
  return kept.fit;
}

HeldOut Refits::hold_out(const Candidate& candidate, double shape, const Folds& folds) {
  if (room_.follows_path()) return {};
  try {
    return diagnosis::hold_out(room_.fit(), linearise(candidate, shape), folds);
  } catch (const Error&) {
    return {};
  }
}

LinearisedFit Refits::linearise(const Candidate& candidate, double shape) {
  const DiagnosedFit with_it = with_candidate(room_.diagnosed(), candidate, with(candidate, shape));
  base::ThreadPool alone(1);
  return CandidateRoom(with_it, alone).fit();
}

std::size_t Refits::count() const {
  const std::lock_guard lock(making_);
  return made_.size();
}

}  // namespace sepcal::diagnosis
