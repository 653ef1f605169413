// SPDX-License-Identifier: BSD-3-Clause
#include "states/change_watch.hpp"

#include <algorithm>
#include <cmath>

#include "states/joint_track.hpp"

namespace sepcal::states {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr double between_onsets = 0.5;  // s
constexpr double to_confirm = 2.0;      // s
constexpr double patience = 3.5;        // s
constexpr std::size_t onsets = 25;      // filters that are kept: the test's window and its verdict

/// The mean time from a row to the next [s]; 0 where there are none, or no time.
double mean_step(const Record& record) {
  double seconds = 0.0;
  std::size_t steps = 0;
  for (const Segment& segment : record.segments()) {
    seconds += seconds_between(record, segment.first, segment.last - 1);
    steps += segment.last - 1 - segment.first;
  }
  return record.has("time") && steps > 0 ? seconds / static_cast<double>(steps) : 0.0;
}

/// In rows of this record; of one without time as if they were 0.02 s apart.
ChangeTestOptions options_for(const Record& record) {
  ChangeTestOptions options;
  const double step = mean_step(record);
  if (!(step > 0.0)) return options;
  options.rows_between = std::max(1, static_cast<int>(std::lround(between_onsets / step)));
  options.confirm = std::max(1, static_cast<int>(std::lround(to_confirm / step)));
  options.patience = std::max(1, static_cast<int>(std::lround(patience / step)));
  return options;
}

}  // namespace

ChangeWatch::ChangeWatch(const Record& record, std::vector<std::string> names, Index n,
                         TrackChanges what)
    : record_(record), names_(std::move(names)), what_(what) {
  if (what_ == TrackChanges::ignore || names_.empty()) return;
  const ChangeTestOptions options = options_for(record);
  between_ = static_cast<std::size_t>(options.rows_between);
  test_.emplace(options, n, static_cast<Index>(names_.size()));
}

void ChangeWatch::predict(const Eigen::MatrixXd& Phi) {
  if (test_) test_->predict(Phi);
}

void ChangeWatch::restart() {
  if (test_) test_->restart();
  kept_.clear();
}

void ChangeWatch::keep(const VectorXd& s, const MatrixXd& root) {
  if (what_ != TrackChanges::follow) return;
  if (kept_.size() == onsets) kept_.pop_front();
  kept_.push_back({rows_.size(), s, root, cost_});
}

std::vector<ChangeWatch::Kept> ChangeWatch::about_onset(const Jumped& jump) const {
  const std::size_t onset = rows_.size() - static_cast<std::size_t>(jump.rows);
  std::vector<Kept> about;
  for (const Kept& kept : kept_) {
    if (kept.rows + between_ >= onset && kept.rows <= onset + between_) about.push_back(kept);
  }
  return about;
}

ChangeWatch::Kept ChangeWatch::opened(Kept kept, const Jumped& jump) {
  const Index k = jump.reach.size();
  const Index n = kept.s.size();
  kept.s.tail(k) += jump.opened;
  MatrixXd rows = MatrixXd::Zero(k, n);
  rows.rightCols(k) = jump.reach.asDiagonal();
  absorb_rows(kept.root, rows);
  return kept;
}

Change ChangeWatch::change_of(const Jumped& jump, const VectorXd& s) const {
  const auto k = static_cast<Index>(names_.size());
  const VectorXd after = (s + jump.moved).tail(k);
  const std::size_t last = rows_.size() - 1;
  const std::size_t back = std::min(last, static_cast<std::size_t>(jump.rows));
  Change change{.onset = rows_[last - back], .found = rows_[last], .statistic = jump.statistic};
  if (record_.has("time")) {
    change.onset_time = record_.column("time")[change.onset];
    change.found_time = record_.column("time")[change.found];
  }
  for (Index j = 0; j < k; ++j) {
    if (jump.size[j] == 0.0) continue;
    ParameterChange moved{.name = names_[static_cast<std::size_t>(j)],
                          .before = after[j] - jump.size[j],
                          .after = after[j],
                          .standard_deviation = jump.deviation[j]};
    for (Index i = 0; i < k; ++i) {
      if (jump.rivals(j, i) != 0.0) moved.rivals.push_back(names_[static_cast<std::size_t>(i)]);
    }
    change.parameters.push_back(std::move(moved));
  }
  return change;
}

void ChangeWatch::say_since(const Kept& onset, const VectorXd& s, const MatrixXd& P,
                            Change& change) const {
  change.onset = rows_[onset.rows - 1];
  if (record_.has("time")) change.onset_time = record_.column("time")[change.onset];
  const auto k = static_cast<Index>(names_.size());
  const VectorXd before = onset.s.tail(k);
  const VectorXd after = s.tail(k);
  const VectorXd variances =
      P.diagonal().tail(k) + onset.root.rightCols(k).colwise().squaredNorm().transpose();
  for (ParameterChange& moved : change.parameters) {
    const auto j = std::ranges::find(names_, moved.name) - names_.begin();
    moved.before = before[j];
    moved.after = after[j];
    moved.standard_deviation = std::sqrt(variances[j]);
  }
}

}  // namespace sepcal::states
