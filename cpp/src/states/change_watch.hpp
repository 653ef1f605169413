// SPDX-License-Identifier: BSD-3-Clause
// ChangeTest beside a filter of any size along a record.
#pragma once

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

  /// As ChangeTest; a jump that is confirmed at `row` moves the filter, if it is to be followed.
  template <class Form>
  void update(Filter<Eigen::Dynamic, Form>& filter, const Eigen::MatrixXd& P,
              const Eigen::MatrixXd& H, const Eigen::VectorXd& y,
              const Innovation<Eigen::Dynamic>& innovation, std::size_t row) {
    if (!test_) return;
    rows_.push_back(row);
    if (test_->update(P, H, y, innovation) != ChangeStatus::changed) return;
    const auto jump = test_->jump();
    changes_.push_back(change_of(jump, filter.x()));
    test_->forget();
    if (what_ == TrackChanges::follow) {
      follow(filter, jump);
    } else {
      test_.reset();
    }
  }

  std::vector<Change> changes() && { return std::move(changes_); }

 private:
  using Test = ChangeTest<Eigen::Dynamic, Eigen::Dynamic>;

  Change change_of(const Jump<Eigen::Dynamic, Eigen::Dynamic>& jump,
                   const Eigen::VectorXd& s) const;

  const Record& record_;
  std::vector<std::string> names_;
  TrackChanges what_;
  std::optional<Test> test_;
  std::vector<std::size_t> rows_;  // that the filter saw
  std::vector<Change> changes_;
};

}  // namespace sepcal::states
