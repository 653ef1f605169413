// SPDX-License-Identifier: BSD-3-Clause
// ChangeTest beside a filter of any size along a record.
#pragma once

#include <cstddef>
#include <deque>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "sepcal/states/change_test.hpp"
#include "sepcal/states/track.hpp"

namespace sepcal::states {

class ChangeWatch {
 public:
  /// `names`: of the last entries of s, n in all.
  ChangeWatch(const Record& record, std::vector<std::string> names, Eigen::Index n,
              TrackChanges what);

  /// Whether to tell it of anything.
  bool looks() const { return test_.has_value(); }

  /// As ChangeTest has them; nothing where it doesn't look.
  void predict(const Eigen::MatrixXd& Phi);
  void restart();

  /// As ChangeTest. What is confirmed at `row` and to be followed is followed from its onset on:
  /// the filter goes back there, opens what jumped, and `again(filter, n)` runs it over the last n
  /// rows anew and returns their V_m (S 5.7). Where no filter is kept of the onset, it moves here.
  template <class Form, class Again>
  void update(Filter<Eigen::Dynamic, Form>& filter, const Eigen::MatrixXd& P,
              const Eigen::MatrixXd& H, const Eigen::VectorXd& y,
              const Innovation<Eigen::Dynamic>& innovation, std::size_t row, const Again& again) {
    if (!test_) return;
    rows_.push_back(row);
    if (innovation.status != FilterStatus::refused) cost_ += innovation.cost();
    if (test_->update(P, H, y, innovation) != ChangeStatus::changed) {
      if (rows_.size() % between_ == 0) keep(filter.x(), filter.form().root());
      return;
    }
    const Jumped jump = test_->jump();
    Change change = change_of(jump, filter.x());
    test_->forget();
    if (what_ == TrackChanges::find) {
      test_.reset();
    } else if (const auto onset = run_from_onset(filter, jump, again)) {
      say_since(*onset, filter.x(), filter.covariance(), change);
    } else {
      follow(filter, jump);
    }
    kept_.clear();
    changes_.push_back(std::move(change));
  }

  std::vector<Change> changes() && { return std::move(changes_); }

 private:
  using Test = ChangeTest<Eigen::Dynamic, Eigen::Dynamic>;
  using Jumped = Jump<Eigen::Dynamic, Eigen::Dynamic>;

  /// A filter at an onset.
  struct Kept {
    std::size_t rows;  // that it had seen
    Eigen::VectorXd s;
    Eigen::MatrixXd root;  // U, U'U the covariance of s
    double cost;           // V_m of these rows
  };

  void keep(const Eigen::VectorXd& s, const Eigen::MatrixXd& root);
  /// Filters from one onset before that of a jump to one behind it.
  std::vector<Kept> about_onset(const Jumped& jump) const;
  /// With the parameters that jumped open.
  static Kept opened(Kept kept, const Jumped& jump);
  Change change_of(const Jumped& jump, const Eigen::VectorXd& s) const;
  /// What a filter that ran from there estimates: s and its covariance.
  void say_since(const Kept& onset, const Eigen::VectorXd& s, const Eigen::MatrixXd& P,
                 Change& change) const;

  /// From the likeliest onset; where it began.
  template <class Form, class Again>
  std::optional<Kept> run_from_onset(Filter<Eigen::Dynamic, Form>& filter, const Jumped& jump,
                                     const Again& again) const {
    double least = std::numeric_limits<double>::infinity();
    std::optional<Kept> onset;
    Filter<Eigen::Dynamic, Form> best = filter;
    for (const Kept& kept : about_onset(jump)) {
      const Kept open = opened(kept, jump);
      Filter<Eigen::Dynamic, Form> anew(open.s, Form::of_covariance_root(open.root));
      const double cost = kept.cost + again(anew, rows_.size() - kept.rows);
      if (!(cost < least)) continue;
      least = cost;
      onset = kept;
      best = std::move(anew);
    }
    filter = std::move(best);
    return onset;
  }

  const Record& record_;
  std::vector<std::string> names_;
  TrackChanges what_;
  std::optional<Test> test_;
  std::size_t between_ = 1;        // rows, from an onset to the next
  std::vector<std::size_t> rows_;  // that the filter saw
  double cost_ = 0.0;              // V_m of these
  std::deque<Kept> kept_;          // a window of onsets
  std::vector<Change> changes_;
};

}  // namespace sepcal::states
