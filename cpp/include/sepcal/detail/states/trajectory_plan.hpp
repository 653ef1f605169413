// SPDX-License-Identifier: BSD-3-Clause
// Which column is whose: the tables that a state model has on a record, where its trajectories
// begin, and where each parameter's derivative goes among [A | D | b].
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "sepcal/detail/eigen.hpp"
#include "sepcal/detail/states/trajectory_options.hpp"
#include "sepcal/detail/tables.hpp"
#include "sepcal/record.hpp"

namespace sepcal {

/// A state model's tables at run time, and what it says of them. Inputs and nonlinear parameters
/// without a name aren't in use.
struct StateTables {
  std::vector<Variable> inputs;
  std::vector<Variable> states;
  std::vector<Variable> outputs;
  std::vector<Variable> linear;
  std::vector<Variable> nonlinear;              // p
  std::vector<int> linear_dynamic = {};         // places in p
  bool linear_in_state = false;                 // there is a table linear_dynamic
  std::vector<bool> scales = {};                // of the linear ones: multiplies an output
  std::vector<std::vector<bool>> acts_on = {};  // [linear][output]
  std::vector<Variable> noise = {};             // that drives the states
  bool discrete = false;
};

class TrajectoryPlan {
 public:
  /// Throws Error for options that name what the model doesn't have, and for a table that does.
  /// Without a record: one trajectory that begins wherever a segment does, from one initial state.
  TrajectoryPlan(const StateTables& model, const Record* record, const TrajectoryOptions& options);

  /// The plan of the same model with effects, whose parameters follow its own in `joined`.
  TrajectoryPlan with_effects(const Tables& joined) const;

  const StateTables& model() const { return model_; }
  const TrajectoryOptions& options() const { return options_; }
  const Tables& tables() const { return tables_; }

  const std::vector<int>& outputs() const { return outputs_; }        // the model's that are kept
  const std::vector<int>& linear() const { return linear_; }          // the same
  const std::vector<int>& measured() const { return measured_; }      // states
  const std::vector<int>& integrated() const { return integrated_; }  // the other states
  /// Of the linear ones kept, those that act on a kept output: their places among them.
  const std::vector<int>& acting(std::size_t output) const { return acting_[output]; }
  const std::vector<int>& scales() const {
    return scales_;
  }  // among the linear ones kept,
     // where they begin at zero
  /// The columns of tables().inputs that hold time [s] and each measured state.
  int time_input() const { return time_input_; }
  int measured_input(std::size_t i) const { return measured_inputs_[i]; }

  bool separable() const { return separable_; }
  bool discrete() const { return model_.discrete; }
  /// The variance of each part of the process noises (n_v, noise_parts()) between rows that lie so
  /// far apart [s], from their densities (n_w, of a model in discrete time variances).
  Eigen::VectorXd noise_variances(const Eigen::VectorXd& densities, double duration) const {
    if (discrete()) return densities;
    return densities.replicate(2, 1) / duration;
  }

  /// The column of tables().inputs of the model's input i; -1 where it isn't in use.
  int input(int i) const { return input_places_[static_cast<std::size_t>(i)]; }
  /// The column among [A | D | b] of parameter i of p; -1 where it isn't in use.
  int column_of_parameter(int i) const { return parameter_columns_[static_cast<std::size_t>(i)]; }
  /// The columns of [A | D | b] that are no initial state's, in order: what acts on steps and
  /// outputs.
  const std::vector<int>& acting_columns() const { return acting_columns_; }
  /// The same of a state at the start of a trajectory; -1 where it is measured.
  int column_of_start(int state, int trajectory) const {
    const int first = start_columns_[static_cast<std::size_t>(state)];
    return first < 0 ? first : first + trajectory * start_stride_;
  }

  /// Rows of the record at which trajectories begin; empty: wherever a segment does.
  const std::vector<std::size_t>& starts() const { return starts_; }
  /// The same of this record. Throws Error where it has no rows.
  std::vector<std::size_t> starts_in(const Record& record) const;
  /// The trajectory that begins at a row of the record, or -1. Throws Error where a segment begins
  /// there and none was foreseen.
  int trajectory_at(std::size_t row, bool starts_segment) const;
  int trajectories() const { return static_cast<int>(labels_.size()); }
  /// "alpha_0", "alpha_0[turn]".
  std::string start_name(const std::string& state, int trajectory) const;

 private:
  void choose_outputs(const StateTables& model);
  void find_starts(const Record& record);
  void cut(const Record& record, const Segment& segment);
  void fill_tables(const StateTables& model);
  void place_columns(const StateTables& model);

  StateTables model_;
  TrajectoryOptions options_;
  Tables tables_;
  std::vector<int> outputs_;
  std::vector<int> linear_;
  std::vector<int> measured_;
  std::vector<int> integrated_;
  std::vector<int> scales_;
  std::vector<std::vector<int>> acting_;
  std::vector<int> input_places_;
  std::vector<int> measured_inputs_;
  int time_input_ = 0;
  bool separable_ = false;
  std::vector<int> parameter_columns_;
  std::vector<int> acting_columns_;
  std::vector<int> start_columns_;
  int start_stride_ = 0;
  std::vector<std::size_t> starts_;
  std::vector<std::string> labels_{""};
};

}  // namespace sepcal
