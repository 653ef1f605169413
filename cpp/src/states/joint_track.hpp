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

/// By how much, from row to row.
class Forgetting {
 public:
  explicit Forgetting(const TrackOptions& options)
      : constant_(options.memory > 0.0 ? 1.0 - 1.0 / options.memory : options.forgetting),
        memory_(options.memory),
        next_(constant_) {}

  /// Where innovations are as large as expected.
  double constant() const { return constant_; }
  /// Behind the row of the last innovation.
  double next() const { return next_; }

  /// A row's whitened innovation: unit variance is expected of each of the `count` that are there.
  /// What is beyond three deviations is no more than that: an outlier is no reason to forget all.
  void follow(const Eigen::VectorXd& w, int count) {
    if (memory_ <= 0.0 || count == 0) return;
    constexpr double most = 9.0;
    next_ = 1.0 - w.cwiseAbs2().cwiseMin(most).sum() / count / memory_;
  }

 private:
  double constant_;
  double memory_;  // rows; 0: constant
  double next_;
};

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
