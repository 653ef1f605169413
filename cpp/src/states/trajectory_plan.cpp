// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/detail/states/trajectory_plan.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "base/name_list.hpp"
#include "sepcal/error.hpp"

namespace sepcal {
namespace {

/// Places in a table of the names that an option lists.
std::vector<int> find_places(const std::vector<std::string>& names,
                             const std::vector<Variable>& table, const std::string& what) {
  std::vector<int> places;
  for (const std::string& name : names) {
    const auto at = std::ranges::find(table, name, &Variable::name);
    if (at == table.end()) {
      throw Error("the model has no " + what + " '" + name + "'; it has " +
                  base::list_names(table));
    }
    places.push_back(static_cast<int>(at - table.begin()));
  }
  std::ranges::sort(places);
  const auto repeated = std::ranges::unique(places);
  places.erase(repeated.begin(), repeated.end());
  return places;
}

std::vector<std::string> names_of(const std::vector<Variable>& table) {
  std::vector<std::string> names;
  for (const Variable& variable : table) names.push_back(variable.name);
  return names;
}

void check_numbers(const TrajectoryOptions& options) {
  if (options.substeps < 1) throw Error("substeps must be at least 1");
  if (!(options.shoot > 0.0)) throw Error("shoot must be a time above 0 s");
}

void check_increases(std::span<const double> time, const Segment& segment) {
  for (std::size_t row = segment.first + 1; row < segment.last; ++row) {
    if (time[row] > time[row - 1]) continue;
    throw Error("time doesn't increase in row " + std::to_string(row) +
                " (counted from 0); sort the rows, or cut segments there");
  }
}

}  // namespace

TrajectoryPlan::TrajectoryPlan(const StateTables& model, const Record* record,
                               const TrajectoryOptions& options)
    : model_(model), options_(options) {
  check_numbers(options);
  measured_ = find_places(options.measured, model.states, "state");
  if (measured_.size() == model.states.size()) {
    throw Error("all states are measured; there is nothing to integrate");
  }
  for (int i = 0; i < static_cast<int>(model.states.size()); ++i) {
    if (std::ranges::find(measured_, i) == measured_.end()) integrated_.push_back(i);
  }
  separable_ = options.separable && model.linear_in_state;
  choose_outputs(model);
  if (record != nullptr) {
    find_starts(*record);
  } else if (std::isfinite(options.shoot)) {
    throw Error("shoot cuts a record's segments; make the model of the record");
  }
  fill_tables(model);
  place_columns(model);
}

void TrajectoryPlan::choose_outputs(const StateTables& model) {
  outputs_ = find_places(options_.outputs.empty() ? names_of(model.outputs) : options_.outputs,
                         model.outputs, "output");
  for (std::size_t k = 0; k < model.linear.size(); ++k) {
    const bool acts = std::ranges::any_of(
        outputs_, [&](int j) { return model.acts_on[k][static_cast<std::size_t>(j)]; });
    if (!acts) continue;
    if (options_.scales_about_start && model.scales[k]) {
      scales_.push_back(static_cast<int>(linear_.size()));
    }
    linear_.push_back(static_cast<int>(k));
  }
  for (const int j : outputs_) {
    acting_.emplace_back();
    for (std::size_t k = 0; k < linear_.size(); ++k) {
      const auto column = static_cast<std::size_t>(linear_[k]);
      if (!model.acts_on[column][static_cast<std::size_t>(j)]) continue;
      acting_.back().push_back(static_cast<int>(k));
    }
  }
}

void TrajectoryPlan::find_starts(const Record& record) {
  labels_.clear();
  for (const Segment& segment : record.segments()) cut(record, segment);
  constexpr std::size_t fewest_rows = 4;  // of a piece, which has initial states to pay for
  if (std::isfinite(options_.shoot) && record.rows() < fewest_rows * labels_.size()) {
    throw Error("shoot cuts " + std::to_string(record.rows()) + " rows into " +
                std::to_string(labels_.size()) +
                " pieces, each with initial states of its own; take a longer time");
  }
  const std::set<std::string> distinct(labels_.begin(), labels_.end());
  if (labels_.size() == 1) {
    starts_.clear();
    labels_ = {""};
  } else if (distinct.size() < labels_.size() || distinct.contains("")) {
    for (std::size_t i = 0; i < labels_.size(); ++i) labels_[i] = std::to_string(i + 1);
  }
}

void TrajectoryPlan::cut(const Record& record, const Segment& segment) {
  const std::span<const double> time = record.column("time");
  check_increases(time, segment);
  double begin = time[segment.first];
  for (std::size_t row = segment.first, piece = 1; row < segment.last; ++row) {
    if (row > segment.first && !(time[row] - begin >= options_.shoot)) continue;
    begin = time[row];
    starts_.push_back(row);
    const bool further = piece > 1 && !segment.label.empty();
    labels_.push_back(segment.label + (further ? "." + std::to_string(piece) : ""));
    ++piece;
  }
}

void TrajectoryPlan::fill_tables(const StateTables& model) {
  for (const Variable& input : model.inputs) {
    input_places_.push_back(input.name.empty() ? -1 : tables_.n_u());
    if (!input.name.empty()) tables_.inputs.push_back(input);
  }
  for (const int i : measured_) {
    const Variable& state = model.states[static_cast<std::size_t>(i)];
    measured_inputs_.push_back(tables_.n_u());
    tables_.inputs.emplace_back(state.name, state.unit);
  }
  const auto time = std::ranges::find(tables_.inputs, "time", &Variable::name);
  time_input_ = static_cast<int>(time - tables_.inputs.begin());
  if (time == tables_.inputs.end()) tables_.inputs.emplace_back("time", "s");

  for (const int j : outputs_) {
    tables_.outputs.push_back(model.outputs[static_cast<std::size_t>(j)]);
  }
  for (const int k : linear_) {
    tables_.linear.push_back(model.linear[static_cast<std::size_t>(k)]);
  }
  for (std::size_t i = 0; i < model.nonlinear.size(); ++i) {
    if (model.nonlinear[i].name.empty()) continue;
    const bool linear =
        separable_ &&
        std::ranges::find(model.linear_dynamic, static_cast<int>(i)) != model.linear_dynamic.end();
    (linear ? tables_.linear : tables_.nonlinear).push_back(model.nonlinear[i]);
  }
}

void TrajectoryPlan::place_columns(const StateTables& model) {
  auto& of_starts = separable_ ? tables_.linear : tables_.nonlinear;
  int first = static_cast<int>(of_starts.size());
  for (std::size_t i = 0; i < model.states.size(); ++i) {
    const bool measured = std::ranges::find(measured_, static_cast<int>(i)) != measured_.end();
    start_columns_.push_back(measured ? -1 : first++);
  }
  start_stride_ = static_cast<int>(model.states.size() - measured_.size());
  for (int trajectory = 0; trajectory < trajectories(); ++trajectory) {
    for (std::size_t i = 0; i < model.states.size(); ++i) {
      if (start_columns_[i] < 0) continue;
      const Variable& state = model.states[i];
      of_starts.emplace_back(start_name(state.name, trajectory), state.unit, state.lower,
                             state.upper);
    }
  }
  if (!separable_) {  // D comes after A
    for (int& column : start_columns_) column += column < 0 ? 0 : tables_.n_1();
  }
  for (const Variable& parameter : model.nonlinear) {
    const std::vector<Variable> all = tables_.parameters();
    const auto at = std::ranges::find(all, parameter.name, &Variable::name);
    parameter_columns_.push_back(at == all.end() ? -1 : static_cast<int>(at - all.begin()));
  }
  const int starts = start_stride_ * trajectories();
  const int end = separable_ ? tables_.n_1() : tables_.n_1() + tables_.n_2();  // of the starts
  for (int column = 0; column < tables_.n_1() + tables_.n_2(); ++column) {
    if (column < end - starts || column >= end) acting_columns_.push_back(column);
  }
}

TrajectoryPlan TrajectoryPlan::with_effects(const Tables& joined) const {
  const int own_1 = tables_.n_1();
  const int own = own_1 + tables_.n_2();
  const int more_1 = joined.n_1() - own_1;
  const auto move = [&](int& column) {
    if (column >= own_1) column += more_1;  // D comes after A
  };
  TrajectoryPlan plan = *this;
  plan.tables_ = joined;
  std::ranges::for_each(plan.parameter_columns_, move);
  std::ranges::for_each(plan.start_columns_, move);
  std::ranges::for_each(plan.acting_columns_, move);
  for (int k = 0; k < more_1; ++k) plan.acting_columns_.push_back(own_1 + k);
  for (int k = own + more_1; k < joined.n_1() + joined.n_2(); ++k)
    plan.acting_columns_.push_back(k);
  std::ranges::sort(plan.acting_columns_);
  return plan;
}

std::vector<std::size_t> TrajectoryPlan::starts_in(const Record& record) const {
  if (!starts_.empty()) return starts_;
  if (record.segments().empty()) throw Error("the record has no rows; a trajectory needs some");
  return {record.segments().front().first};
}

int TrajectoryPlan::trajectory_at(std::size_t row, bool starts_segment) const {
  if (starts_.empty()) return starts_segment ? 0 : -1;
  const auto at = std::ranges::lower_bound(starts_, row);
  if (at != starts_.end() && *at == row) return static_cast<int>(at - starts_.begin());
  if (!starts_segment) return -1;
  throw Error("a segment begins in row " + std::to_string(row) +
              " (counted from 0), where the model has no initial state; make the model of the "
              "record that it is fitted to, and select whole segments");
}

std::string TrajectoryPlan::start_name(const std::string& state, int trajectory) const {
  const std::string& label = labels_[static_cast<std::size_t>(trajectory)];
  return state + "_0" + (label.empty() ? "" : "[" + label + "]");
}

}  // namespace sepcal
