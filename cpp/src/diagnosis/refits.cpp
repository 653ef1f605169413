// SPDX-License-Identifier: BSD-3-Clause
#include "diagnosis/refits.hpp"

#include <algorithm>
#include <cmath>

#include "model/measurements.hpp"
#include "model/sweep.hpp"
#include "sepcal/error.hpp"

namespace sepcal::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Rows [first, last) of the layout as segments of the record.
void append_rows(const CandidateRoom& room, Index first, Index last, std::vector<Segment>& rows) {
  const std::vector<Segment>& layout = room.fit().layout.segments;
  for (std::size_t i = 0; i < layout.size(); ++i) {
    const auto begin = std::max(static_cast<std::size_t>(first), layout[i].first);
    const auto end = std::min(static_cast<std::size_t>(last), layout[i].last);
    if (begin >= end) continue;
    const Segment& whole = room.rows()[i];
    const std::size_t shift = whole.first - layout[i].first;
    rows.push_back({whole.label, begin + shift, end + shift});
  }
}

/// About so many rows in blocks that lie evenly over every segment; all where there are no more.
std::vector<Segment> spread(const std::vector<Segment>& segments, std::size_t most) {
  constexpr std::size_t block = 200;
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
  options.method = fit.by;
  if (fit.by ==
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
      options.fixed[parameter.name] = parameter.value;
      continue;
    }
    options.bounds[parameter.name] = {parameter.lower, parameter.upper};
    if (static_cast<int>(k) >= fit.n_1) options.start[parameter.name] = parameter.value;
  }
  return options;
}

/// The same for the model with the candidate, which begins at zero; its shape is held.
FitOptions with_candidate(FitOptions options, const Tables& tables, const Candidate& candidate,
                          double shape) {
  if (!candidate.shape.parameter.empty()) options.fixed[candidate.shape.parameter] = shape;
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

/// The same starts at the estimates of a fit to all rows.
FitOptions start_from(FitOptions options, const Fit& fit) {
  for (auto& [name, start] : options.start) start = fit[name].value;
  return options;
}

/// Squared error of each block of one fold, in the outputs' unit.
VectorXd errors(const BlockModel& model, const CandidateRoom& room, const FitOptions& options,
                const Folds& folds, int fold) {
  std::vector<Segment> others;
  std::vector<std::vector<Segment>> left_out;
  for (const HeldOutBlock& block : folds.blocks) {
    if (block.fold == fold) {
      if (block.judged) append_rows(room, block.first, block.last, left_out.emplace_back());
    } else {
      append_rows(room, block.first, block.last, others);
    }
  }
  Record rows = room.record();
  rows.cut(spread(others, enough_rows));
  const Fit fitted = fit(model, rows, options);
  base::ThreadPool alone(1);
  VectorXd squares(static_cast<Index>(left_out.size()));
  for (std::size_t b = 0; b < left_out.size(); ++b) {
    rows.cut(left_out[b]);
    const model::Measurements measurements(model, rows);
    squares[static_cast<Index>(b)] = model::Sweep(model, measurements, alone)
                                         .squared_residuals(fitted.xi1(), fitted.xi2())
                                         .sum();
  }
  return squares;
}

}  // namespace

double shape_of(const EffectFinding& finding) {
  return finding.shapes.empty() ? not_a_number : finding.shapes.begin()->second;
}

Fit refit_with(const CandidateRoom& room, const Candidate& candidate, double shape) {
  return refit_nearly(room, candidate, shape, room.record().length());
}

Fit refit_nearly(const CandidateRoom& room, const Candidate& candidate, double shape,
                 std::size_t most_rows, bool coloured_errors) {
  const auto with = room.model_with(candidate.effects);
  Record rows = room.record();
  rows.cut(room.follows_path() ? room.rows() : spread(room.rows(), most_rows));
  FitOptions options =
      with_candidate(options_from(room.fitted()), with->tables(), candidate, shape);
  options.coloured_errors = coloured_errors;
  const std::string& of_shape = candidate.shape.parameter;
  if (!of_shape.empty() && candidate.stepping_port.empty()) {  // a step's row is exact
    options.fixed.erase(of_shape);
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
  if (fitted.by != FitMethod::filter_error) return error_drop(room.fitted(), fitted);
  Record rows = room.record();
  rows.cut(room.rows());
  const FitOptions options = with_noise_as_asked(options_from(fitted), room.fitted());
  try {
    return error_drop(room.fitted(), fit(*room.model_with(candidate.effects), rows, options));
  } catch (const Error&) {
    return not_a_number;
  }
}

HeldOut hold_out_by_refits(const CandidateRoom& room, const Candidate& candidate, double shape,
                           const Folds& folds, base::ThreadPool& pool) {
  if (room.follows_path()) return {};  // no row of one is left out of the others' path
  const auto without = room.model();
  const auto with = room.model_with(candidate.effects);
  constexpr int most_iterations = 30;  // a fold's fit begins at that to all rows
  FitOptions base = options_from(room.fitted());
  base.iterations = most_iterations;
  FitOptions extended = with_candidate(base, with->tables(), candidate, shape);
  const auto count = static_cast<std::size_t>(folds.count);
  std::vector<VectorXd> before(count);
  std::vector<VectorXd> after(count);
  try {
    Record rows = room.record();
    rows.cut(spread(room.rows(), enough_rows));
    extended = start_from(extended, fit(*with, rows, extended));
    pool.for_each(2 * count, [&](std::size_t task) {
      const std::size_t f = task / 2;
      if (task % 2 == 0) {
        before[f] = errors(*without, room, base, folds, static_cast<int>(f));
      } else {
        after[f] = errors(*with, room, extended, folds, static_cast<int>(f));
      }
    });
  } catch (const Error&) {
    return {};
  }
  std::vector<double> old;
  std::vector<double> now;
  double rows = 0.0;
  for (std::size_t f = 0; f < count; ++f) {
    old.insert(old.end(), before[f].begin(), before[f].end());
    now.insert(now.end(), after[f].begin(), after[f].end());
  }
  for (const HeldOutBlock& block : folds.blocks) {
    if (block.judged) rows += static_cast<double>(block.last - block.first);
  }
  return summarise(old, now, rows * static_cast<double>(without->tables().n_z()));
}

}  // namespace sepcal::diagnosis
