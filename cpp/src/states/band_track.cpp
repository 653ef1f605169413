// SPDX-License-Identifier: BSD-3-Clause
#include "states/band_track.hpp"

#include <cmath>
#include <string>

#include "sepcal/detail/band.hpp"
#include "sepcal/error.hpp"

namespace sepcal::states {

using Eigen::Dynamic;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr double usual_length = 20.0;  // s: frequencies are one over it apart

VectorXd frequencies_in(const sepcal::Band& band) {
  const std::vector<double> frequencies = frequencies_of(band, usual_length);
  return VectorXd::Map(frequencies.data(), static_cast<Index>(frequencies.size()));
}

}  // namespace

void check_band_track(const BlockModel& model, const Record& record, const TrackOptions& options) {
  if (model.tables().n_2() > 0 || model.new_carry() != nullptr) {
    throw Error(
        "rft takes models that are linear in their parameters and have no state; take rls, ekf, "
        "iekf or srif");
  }
  if (!record.has("time")) throw Error("column 'time' is missing, which a band of Hz needs");
  frequencies_of(options.band, usual_length);
}

BandTrack::BandTrack(Index n_z, const VectorXd& x, const TrackOptions& options) : x_(x) {
  const VectorXd frequencies = frequencies_in(options.band);
  const RecursiveBandOptions how{.forgetting = options.forgetting,
                                 .differentiate = options.differentiate};
  for (Index j = 0; j < n_z; ++j) bands_.emplace_back(frequencies, how, x.size());
  estimate_.xi = x;
  estimate_.deviation = VectorXd::Constant(x.size(), not_a_number);
}

bool BandTrack::absorb(double time, const MatrixXd& sample) {
  const Index k = sample.cols() - 1;
  bool is_used = true;
  for (std::size_t j = 0; j < bands_.size(); ++j) {
    const auto row = sample.row(static_cast<Index>(j));
    is_used = bands_[j].absorb(time, row.head(k).transpose(), row[k]) && is_used;
  }
  estimate_ = solve();
  return is_used;
}

BandEstimate<Dynamic> BandTrack::solve() const {
  const Index k = x_.size();
  BandFactor<Dynamic> together{MatrixXd::Zero(k + 1, k + 1), 0.0};
  for (const Band& band : bands_) {
    BandFactor<Dynamic> own = band.factor();
    const double noise = solve_band(own).noise;
    if (!(noise > 0.0)) continue;
    MatrixXd rows = own.T / noise;
    absorb_rows(together.T, rows);
    together.parts += own.parts;
  }
  if (together.parts <= 0.0) return estimate_;
  BandEstimate<Dynamic> found = solve_band(together);
  found.deviation /= found.noise;  // every output has been given its own
  for (Index i = 0; i < k; ++i) {
    if (std::isnan(found.deviation[i])) found.xi[i] = x_[i];
  }
  return found;
}

}  // namespace sepcal::states
