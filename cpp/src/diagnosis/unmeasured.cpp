// SPDX-License-Identifier: BSD-3-Clause
#include "diagnosis/unmeasured.hpp"

#include <algorithm>
#include <cmath>

#include "diagnosis/common_cause.hpp"
#include "diagnosis/spectral_line.hpp"
#include "numerics/tails.hpp"

namespace sepcal::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

/// Of the squares of two outputs, while they move together: what takes less is no finding, however
/// sure.
constexpr double least_share = 0.2;

/// From which probability on a line is asked whether an input swings so.
constexpr double worth_asking = 0.05;

/// Where and in which outputs a cause shows.
UnmeasuredCause place(UnmeasuredKind kind, double p_value, const std::vector<std::size_t>& outputs,
                      const Window& strongest, const RowLayout& layout,
                      const std::vector<double>& time) {
  UnmeasuredCause cause{.kind = kind, .p_value = p_value};
  for (const std::size_t j : outputs) cause.outputs.push_back(layout.outputs[j].name);
  const auto first = static_cast<std::size_t>(row_of(strongest.first, layout.rows));
  const auto last = static_cast<std::size_t>(row_of(strongest.last, layout.rows));
  cause.all_along = strongest.is_whole();
  cause.first_s = time[first];
  cause.last_s = time[last - 1];
  return cause;
}

}  // namespace

std::vector<UnmeasuredCause> find_unmeasured(const CandidateRoom& room, const NullHypothesis& null,
                                             const InputNoise* inputs, std::uint64_t seed) {
  std::vector<UnmeasuredCause> causes;
  const RowLayout& layout = room.fit().layout;
  if (layout.rows < window_steps) return causes;
  const MatrixXd white = null.white_outputs();
  const std::vector<double> time = room.times();
  const EvenGrid grid = place_on_grid(time);
  const CommonCause common =
      find_common_cause(inputs == nullptr ? white : inputs->take_out(white), seed);
  if (!common.outputs.empty() && common.share >= least_share) {
    causes.push_back(place(UnmeasuredKind::common_cause, common.p_value, common.outputs,
                           common.strongest, layout, time));
    const Index first = row_of(common.strongest.first, layout.rows);
    const Index rows = row_of(common.strongest.last, layout.rows) - first;
    causes.back().frequency =
        strongest_frequency(common.together.segment(first, rows), grid, first) / grid.interval;
  }
  const SpectralLine line = find_line(white, grid);
  const bool is_of_inputs =
      line.p_value < worth_asking && swings_as_inputs(line, room.input_columns(), grid);
  if (!line.outputs.empty() && !is_of_inputs) {
    causes.push_back(place(UnmeasuredKind::spectral_line, line.p_value, line.outputs,
                           line.strongest, layout, time));
    causes.back().frequency = line.frequency / grid.interval;
  }
  return causes;
}

void correct_together(double significance, Omnibus& offsets, std::vector<UnmeasuredCause>& causes) {
  std::vector<double> log10_p{std::log10(offsets.p_value)};
  for (const UnmeasuredCause& cause : causes) log10_p.push_back(std::log10(cause.p_value));
  const std::vector<double> adjusted = numerics::adjust_by_holm(log10_p);
  offsets.p_adjusted = adjusted.front();
  offsets.significant = offsets.p_adjusted < significance;
  for (std::size_t i = 0; i < causes.size(); ++i) causes[i].p_adjusted = adjusted[i + 1];
  std::erase_if(causes,
                [&](const UnmeasuredCause& cause) { return !(cause.p_adjusted < significance); });
  std::ranges::stable_sort(causes, {}, &UnmeasuredCause::p_value);
}

}  // namespace sepcal::diagnosis
