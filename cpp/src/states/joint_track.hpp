// SPDX-License-Identifier: BSD-3-Clause
// States and parameters estimated together along a record: JointFilter's sibling for models of any
// size, on a computer that has a heap; the tests hold the two beside each other.
#pragma once

#include <cmath>

#include "sepcal/detail/states/state_steps.hpp"
#include "sepcal/states/filter.hpp"
#include "sepcal/states/track.hpp"

namespace sepcal::states {

/// Variances that random walks add in a second, one for each name; zero for those that don't walk.
/// Throws Error for names that are not there, which the start holds or the model has not, and for
/// deviations that are none.
Eigen::VectorXd walk_of(const std::vector<std::string>& names, const TrackOptions& options);

/// Seconds from a row to a later one; rows where the record has no time.
double seconds_between(const Record& record, std::size_t row, std::size_t later);

/// Fading memory: what the filter knows counts for so much less, its covariance by the inverse.
template <class Form>
void forget(Filter<Eigen::Dynamic, Form>& filter, double by) {
  if (by == 1.0) return;
  const double root = std::sqrt(by);
  if constexpr (requires(const Form& form) { form.information_root(); }) {
    filter = Filter<Eigen::Dynamic, Form>(
        filter.x(), Form::of_information_root(root * filter.form().information_root()));
  } else {
    filter = Filter<Eigen::Dynamic, Form>(filter.x(),
                                          Form::of_covariance_root(filter.form().root() / root));
  }
}

/// `method` is ekf, iekf or srif. Throws Error as track().
Track track_jointly(const StateBlockModel& model, const Record& record, const StreamStart& start,
                    const TrackOptions& options);

/// n_z: the options', or the start's. Throws Error where an output has none.
Eigen::VectorXd noise_of(const std::vector<Variable>& outputs, const StreamStart& start,
                         const TrackOptions& options);

/// Where the start has a parameter. Throws Error where it has none of this name.
Eigen::Index place_in(const StreamStart& start, const std::string& name);

/// An empty track for `rows` rows.
Track empty_track(std::vector<std::string> names, std::size_t rows, int n_z);

/// Puts a row's estimate behind the others.
void append(Track& track, std::size_t row, const Record& record, const Eigen::VectorXd& estimate,
            const Eigen::VectorXd& deviation, const Eigen::VectorXd& innovation);

}  // namespace sepcal::states
