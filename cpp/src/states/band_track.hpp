// SPDX-License-Identifier: BSD-3-Clause
// RecursiveBand of any number of outputs along a record.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "sepcal/detail/block_model.hpp"
#include "sepcal/frequency/recursive_band.hpp"
#include "sepcal/record.hpp"
#include "sepcal/states/track.hpp"

namespace sepcal::states {

/// Throws Error for a model that isn't linear in its parameters, a record without `time`, and a
/// band that is none.
void check_band_track(const BlockModel& model, const Record& record, const TrackOptions& options);

/// Outputs share k parameters; each has the weight of its own residual over the band.
class BandTrack {
 public:
  /// `x` (k): what is estimated while the band doesn't tell it.
  BandTrack(Eigen::Index n_z, const Eigen::VectorXd& x, const TrackOptions& options);

  /// A sample's rows [H | r] (n_z x k + 1). False where one is not finite or time doesn't rise:
  /// that output has no row here.
  bool absorb(double time, const Eigen::MatrixXd& sample);
  Eigen::VectorXd solution() const { return estimate_.xi; }           // k
  Eigen::VectorXd deviations() const { return estimate_.deviation; }  // k; NaN: not told

 private:
  using Band = RecursiveBand<Eigen::Dynamic, Eigen::Dynamic>;

  BandEstimate<Eigen::Dynamic> solve() const;

  std::vector<Band> bands_;  // n_z
  Eigen::VectorXd x_;        // k
  BandEstimate<Eigen::Dynamic> estimate_;
};

}  // namespace sepcal::states
