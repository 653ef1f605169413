// SPDX-License-Identifier: BSD-3-Clause
// Estimates against time: a recursive estimator runs along a record from a calibration or from the
// first rows, as it would in flight. Models of samples have their parameters for a state; models
// with a state are filtered jointly, in the numbers of the JointFilter that a vehicle carries.
#pragma once

#include <array>
#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "sepcal/detail/band.hpp"
#include "sepcal/detail/choices.hpp"
#include "sepcal/states/iterated_update.hpp"
#include "sepcal/states/stream_start.hpp"
#include "sepcal/states/trajectory_model.hpp"

namespace sepcal {

enum class TrackMethod {
  rls,   // recursive least squares: rows linearised at the start. Linear models: the batch's digits
  ekf,   // extended filter: every row linearised at the estimate before it
  iekf,  // iterated extended filter: at the estimate after it
  srif,  // the extended filter as square-root information
  rml,   // recursive maximum likelihood: sizes of the noises are estimated too. Of models with a
         // state, from a start by filter error
  rft    // recursive Fourier transform: equation error over a band. Of models that are linear
};

/// Whether it is a Kalman filter, of states and their covariance.
constexpr bool is_filter(TrackMethod method) {
  return method == TrackMethod::ekf || method == TrackMethod::iekf || method == TrackMethod::srif;
}

template <>
struct ChoiceNames<TrackMethod> {
  static constexpr std::array<std::string_view, 6> names{"rls",  "ekf", "iekf",
                                                         "srif", "rml", "rft"};
};

/// What becomes of a parameter that jumps on the way: see ChangeTest.
enum class TrackChanges {
  ignore,  // nothing is looked for
  find,    // the first is said; estimates stay as they are
  follow   // what jumped is opened, from the onset on, and the next is looked for
};

template <>
struct ChoiceNames<TrackChanges> {
  static constexpr std::array<std::string_view, 3> names{"ignore", "find", "follow"};
};

struct TrackOptions {
  TrackMethod method = TrackMethod::ekf;
  /// Noise standard deviation of every output; empty: the start's. By rml these are held.
  std::map<std::string, double> noise = {};
  /// Of a model with a state: standard deviation by the names and in the units of its table
  /// `noise`, per sqrt(s); those not named have none, and where none is named they are the start's.
  /// A start from first rows is then one by filter error. By rml these are held, and those not
  /// named are estimated, from the start's on.
  std::map<std::string, double> process_noise = {};
  /// Random walks of parameters that may change in flight, by name: the standard deviation that one
  /// gathers in a second [its unit / sqrt(s)], or from a row to the next where the record has no
  /// time. Of ekf, iekf and srif.
  std::map<std::string, double> walk = {};
  /// Of ekf, iekf and srif: a test on innovations says when the parameters ceased to hold, and
  /// which of them moved.
  TrackChanges changes = TrackChanges::ignore;
  /// Standard deviation of states where a segment begins that no mini-batch has fitted, about the
  /// model's start(u, z); of those not named ten times the largest value that the state has on the
  /// way, as good as unknown.
  std::map<std::string, double> initial_states = {};
  IterationOptions iterations = {};  // of iekf
  /// What a sample counts for after the next, above 0, at most 1.
  double forgetting = 1.0;
  /// Of rls, ekf, iekf and srif: forgetting that follows the innovations, in place of a constant
  /// one (T. R. Fortescue, L. S. Kershenbaum & B. E. Ydstie, Implementation of self-tuning
  /// regulators with variable forgetting factors, Automatica 17, 1981). So many rows count while
  /// innovations are as large as expected, fewer where they are larger; at least 20. 0: none.
  double memory = 0.0;
  int every = 10;  // of rml: samples from a step of the parameters to the next
  /// Of rft; spacing 0 is 0.05 Hz.
  Band band = {};
  /// Of rft: outputs hold what the model gives the derivatives of.
  bool differentiate = false;
};

struct ParameterChange {
  std::string name;
  double before = 0.0;
  double after = 0.0;
  double standard_deviation = 0.0;  // of after - before
  /// Parameters whose jump in its place would explain the innovations nearly as well.
  std::vector<std::string> rivals = {};
};

/// Parameters that jumped at one time.
struct Change {
  std::size_t onset = 0;  // the record's row after which they jumped, to half a second or so
  std::size_t found = 0;  // the row at which it was said
  double onset_time = not_a_number;  // s, of these rows; NaN where the record has none
  double found_time = not_a_number;
  double statistic = 0.0;  // what it explains: chi squared, of one degree a parameter, without it
  std::vector<ParameterChange> parameters = {};
};

struct Track {
  /// n: integrated states, then parameters, linear ones first; by rml then "q_alpha" ...
  /// "r_alpha_m" of the noises' sizes.
  std::vector<std::string> names;
  std::vector<std::size_t> rows;        // of the record, one an estimate
  std::vector<double> time;             // s; empty where the record has none
  Eigen::MatrixXd estimates;            // rows x n
  Eigen::MatrixXd standard_deviations;  // rows x n; 0 for what is held
  Eigen::MatrixXd innovations;          // rows x n_z: reading less what was expected; NaN: missing
  std::vector<Change> changes;          // in their order
  std::size_t refused = 0;              // rows that were not finite, left out
  std::size_t not_converged = 0;        // rows at which iekf's cap ended it
};

/// The track's names with their units, as its model has them.
std::vector<Variable> table_of(const Track& track, const BlockModel& model);

/// Options of the fit of first rows that such a track begins with: by filter error where noise
/// drives the states, and for rml; but for rml, which estimates it, with no noise but the track's.
FitOptions fit_of_start(const BlockModel& model, FitOptions fit, const TrackOptions& how);

/// Goes on where `start` ends, after start.rows rows. Outputs that are NaN are missing. A model
/// with a state is one for this record; it starts by start_from_rows(), or from another flight's
/// calibration by start_from_fit(). By rls it is linearised along the whole trajectory from the
/// start. Throws Error where the start is of another model, for options that name what the model
/// doesn't have, for `shoot` and `scales_about_start`, and where srif meets what is known exactly.
Track track(const BlockModel& model, const Record& record, const StreamStart& start,
            const TrackOptions& options = {});

template <SeparableModel M>
Track track(const M& model, const Record& record, const StreamStart& start,
            const TrackOptions& options = {}) {
  return track(StaticModel<M>(model), record, start, options);
}

/// The mini-batch of a model with a state: its trajectory over the first rows, x(0) among xi.
template <StateModel M>
StreamStart start_from_rows(const M& model, const Record& record, std::size_t rows,
                            const FitOptions& options = {},
                            const TrajectoryOptions& trajectory = {}) {
  return start_from_rows(TrajectoryModel<M>(model, first_rows(record, rows), trajectory), record,
                         rows, options);
}

template <StateModel M>
Track track(const M& model, const Record& record, const StreamStart& start,
            const TrackOptions& options = {}, const TrajectoryOptions& trajectory = {}) {
  return track(TrajectoryModel<M>(model, record, trajectory), record, start, options);
}

}  // namespace sepcal
