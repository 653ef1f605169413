// SPDX-License-Identifier: BSD-3-Clause
#include "effects/corrected_inputs.hpp"

#include <algorithm>
#include <array>
#include <set>
#include <utility>

#include "effects/composed_tables.hpp"

namespace sepcal::effects {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

std::span<const LagNode> nodes_for(const std::vector<DelayPart>& delays) {
  // Gauss-Laguerre: the integral of exp(-x) f(x) over x > 0, exact to x^15. The last three nodes
  // weigh 1e-4 together and may lie before a segment's begin, where columns go on straight.
  static constexpr std::array average{LagNode{0.17027963230510093, 0.36918858934163495},
                                      LagNode{0.90370177679938, 0.4187867808143447},
                                      LagNode{2.251086629866131, 0.17579498663717255},
                                      LagNode{4.266700170287659, 0.033343492261215794},
                                      LagNode{oldest_age, 0.0027945362352256834},
                                      LagNode{10.758516010180996, 9.076508773358139e-05},
                                      LagNode{15.740678641278004, 8.48574671627257e-07},
                                      LagNode{22.863131736889265, 1.0480011748715153e-09}};
  static constexpr std::array now{LagNode{}};
  const bool lags = std::ranges::any_of(
      delays, [](const DelayPart& delay) { return delay.kind() == Delay::Kind::outputs_lagging; });
  return lags ? std::span<const LagNode>(average) : std::span<const LagNode>(now);
}

std::vector<InputColumn> as_logged(const Block& block) {
  std::vector<InputColumn> columns(block.inputs.size());
  for (std::size_t i = 0; i < columns.size(); ++i) columns[i].values = block.inputs[i];
  return columns;
}

}  // namespace

/// What the delays make of one input: u(t + seconds) + lag u'(t + seconds), seconds the sum of
/// what each takes of its parameter.
struct InputCorrections::Shift {
  struct Rate {
    const DelayPart* part;
    double rate;  // d seconds / d parameter, but for the share of a clock that drifts
  };

  std::vector<Rate> rates = {};
  double lag = 0.0;
  int lag_parameter = -1;
};

InputCorrections::InputCorrections(const Tables& tables, const ComposedParts& parts,
                                   const Record& record)
    : parts_(parts), nodes_(nodes_for(parts.delays)) {
  std::set<int> shifted;
  for (const DelayPart& delay : parts.delays) {
    shifted.insert(delay.inputs.begin(), delay.inputs.end());
  }
  for (const int input : shifted) {
    const Variable& variable = tables.inputs[static_cast<std::size_t>(input)];
    if (!record.has(variable.name)) continue;  // a constant is the same at any time
    interpolated_.emplace(
        input, numerics::InterpolatedColumn(record, variable.name, variable.unit == "rad"));
  }
  const auto grows = [](const DelayPart& part) { return part.delay.grows.has_value(); };
  if (std::ranges::none_of(parts.delays, grows)) return;
  const auto time = record.column("time");
  time_.assign(time.begin(), time.end());
}

InputCorrections::Shift InputCorrections::shift_of(int input, const double* xi2,
                                                   const LagNode& node) const {
  Shift shift;
  for (const DelayPart& delay : parts_.delays) {
    if (std::ranges::find(delay.inputs, input) == delay.inputs.end()) continue;
    if (delay.kind() == Delay::Kind::inputs_lagging) {
      shift.lag = xi2[delay.parameter];
      shift.lag_parameter = delay.parameter;
      continue;
    }
    const double rate = delay.kind() == Delay::Kind::inputs_late    ? 1.0
                        : delay.kind() == Delay::Kind::outputs_late ? -1.0
                                                                    : -node.age;
    shift.rates.push_back({&delay, rate});
  }
  return shift;
}

double InputCorrections::share_at(const DelayPart& part, std::size_t row) const {
  return part.delay.grows ? part.delay.share_at(time_[row]) : 1.0;
}

void InputCorrections::shift_in_time(std::vector<InputColumn>& columns, const Block& block,
                                     const double* xi2, const LagNode& node, int directions) const {
  const auto rows = static_cast<Index>(block.rows);
  std::vector<NaturalSpline::Value> values(block.rows);
  std::vector<double> seconds(block.rows);
  for (const auto& [input, spline] : interpolated_) {
    const Shift shift = shift_of(input, xi2, node);
    std::ranges::fill(seconds, 0.0);
    for (const auto& [part, rate] : shift.rates) {
      const double tau = rate * xi2[part->parameter];
      for (std::size_t i = 0; i < seconds.size(); ++i) {
        seconds[i] += tau * share_at(*part, block.first + i);
      }
    }
    spline.fill(block.first, seconds, values);
    InputColumn& column = columns[static_cast<std::size_t>(input)];
    column.own.resize(block.rows);
    if (directions > 0) column.slopes = MatrixXd::Zero(rows, directions);
    for (Index i = 0; i < rows; ++i) {
      const auto& [value, slope, curvature] = values[static_cast<std::size_t>(i)];
      column.own[static_cast<std::size_t>(i)] = value + shift.lag * slope;
      if (directions == 0) continue;
      for (const auto& [part, rate] : shift.rates) {
        column.slopes(i, part->parameter) =
            rate * share_at(*part, block.first + static_cast<std::size_t>(i)) *
            (slope + shift.lag * curvature);
      }
      if (shift.lag_parameter >= 0) column.slopes(i, shift.lag_parameter) = slope;
    }
    column.values = column.own.data();
  }
}

void InputCorrections::apply(const CorrectionPart& part, std::vector<InputColumn>& columns,
                             const Block& block, const double* xi2, int directions,
                             bool by_parameters) const {
  const Correction& correction = *part.correction;
  const auto rows = static_cast<Index>(block.rows);
  const auto n_u = static_cast<Index>(part.inputs.size());
  const auto n_2 = static_cast<Index>(correction.nonlinear().size());
  const auto column_of = [&](Index i) -> InputColumn& {
    return columns[static_cast<std::size_t>(part.inputs[static_cast<std::size_t>(i)])];
  };
  const auto is_driver = [&](Index i) { return correction.is_driver(static_cast<int>(i)); };

  std::vector<const double*> inputs;
  for (Index i = 0; i < n_u; ++i) {
    const auto index = static_cast<std::size_t>(part.inputs[static_cast<std::size_t>(i)]);
    inputs.push_back(is_driver(i) ? block.inputs[index] : column_of(i).values);
  }
  MatrixXd values(rows, correction.corrected());
  MatrixXd slopes(directions > 0 ? rows : 0, correction.corrected() * (n_u + n_2));
  correction.evaluate({inputs, block.rows, block.first, block.starts_segment},
                      xi2 + part.first_nonlinear, values, directions > 0 ? &slopes : nullptr);

  std::vector<MatrixXd> chains;  // all of them before an input changes
  for (Index c = 0; c < correction.corrected() && directions > 0; ++c) {
    const auto own = slopes.middleCols(c * (n_u + n_2), n_u + n_2);
    MatrixXd& chain = chains.emplace_back(MatrixXd::Zero(rows, directions));
    for (Index i = 0; i < n_u; ++i) {
      if (is_driver(i) || column_of(i).slopes.cols() == 0) continue;
      chain += own.col(i).asDiagonal() * column_of(i).slopes;
    }
    if (by_parameters) chain.middleCols(part.first_nonlinear, n_2) += own.rightCols(n_2);
  }
  for (Index c = 0; c < correction.corrected(); ++c) {
    InputColumn& column = column_of(c);
    column.own.assign(values.col(c).begin(), values.col(c).end());
    column.values = column.own.data();
    if (directions > 0) column.slopes = std::move(chains[static_cast<std::size_t>(c)]);
  }
}

std::vector<InputColumn> InputCorrections::correct(const Block& block, const double* xi2,
                                                   const LagNode& node, int directions) const {
  std::vector<InputColumn> columns = as_logged(block);
  shift_in_time(columns, block, xi2, node, directions);
  for (const CorrectionPart& part : parts_.corrections) {
    apply(part, columns, block, xi2, directions, true);
  }
  return columns;
}

std::vector<InputColumn> InputCorrections::correct_moving(const Block& block, const double* xi2,
                                                          std::span<const int> moving) const {
  std::vector<InputColumn> columns = as_logged(block);
  const auto directions = static_cast<int>(moving.size());
  for (int k = 0; k < directions; ++k) {
    const int input = moving[static_cast<std::size_t>(k)];
    MatrixXd& slopes = columns[static_cast<std::size_t>(input)].slopes;
    if (slopes.cols() == 0) slopes = MatrixXd::Zero(static_cast<Index>(block.rows), directions);
    slopes.col(k).setOnes();
  }
  for (const CorrectionPart& part : parts_.corrections) {
    apply(part, columns, block, xi2, directions, false);
  }
  return columns;
}

}  // namespace sepcal::effects
