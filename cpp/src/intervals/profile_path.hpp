// SPDX-License-Identifier: BSD-3-Clause
// The walk from the estimate outward along one parameter's profile, to where it crosses a height.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "base/thread_pool.hpp"
#include "estimation/problem.hpp"
#include "estimation/stage_two.hpp"
#include "model/measurements.hpp"
#include "numerics/crossing_bracket.hpp"
#include "sepcal/profile.hpp"

namespace sepcal::intervals {

/// A fit at some value of the profiled parameter.
struct ProfilePoint {
  double distance = 0.0;  // from the minimum, not negative
  double root = 0.0;      // sqrt(2 (J_p - J-hat)), zero where J_p is lower
  bool converged = true;  // false: the refit stopped in a flat valley, within 1e-5 of J_p
  Eigen::VectorXd x;      // all n free parameters
  Eigen::VectorXd noise;  // n_z
};

/// Stage two, repeated where it stops in a flat valley, which it calls not converged, until that
/// gains nothing. Nothing where it goes on gaining or the model is not finite.
std::optional<estimation::StageTwo> find_minimum(const estimation::Problem& problem,
                                                 const model::Measurements& measurements,
                                                 StageOne start, const estimation::Attempt& attempt,
                                                 base::ThreadPool& pool);

/// How far the walk goes.
struct ProfileReach {
  double root = 0.0;   // the height to cross, sqrt(q)
  double first = 0.0;  // length of the first step
  double limit = 0.0;  // beyond it the profile counts as flat
};

class ProfilePath {
 public:
  /// Along parameter k of `problem`, up or down. `model`, `problem`, `measurements` and `minimum`
  /// must outlive it.
  ProfilePath(const BlockModel& model, const estimation::Problem& problem,
              const model::Measurements& measurements, const estimation::StageTwo& minimum,
              Eigen::Index k, bool up);

  struct End {
    double value = not_a_number;  // of the parameter; infinite where open, NaN where failed
    IntervalEnd kind = IntervalEnd::failed;
    std::string message = {};  // of a failed one: one line
  };
  End walk(const ProfileReach& reach);

  /// How far below J-hat the lowest refit came, and the parameter's value there.
  double deficit() const { return deficit_; }
  double lowest_at() const { return lowest_at_; }

 private:
  double at(double distance) const;
  double edge() const;  // distance to the bound, infinite without one

  /// Nothing where the others can't be fitted.
  std::optional<ProfilePoint> evaluate(double distance);
  /// From the nearest point alone, by short steps.
  std::optional<ProfilePoint> evaluate_within_basin(double distance);
  std::optional<ProfilePoint> refit(double distance, const ProfilePoint& start,
                                    const estimation::Attempt& attempt);
  End failed(const numerics::CrossingBracket& bracket, double blocked) const;
  /// On the line through the two nearest points, up to the first bound.
  ProfilePoint predict(double distance) const;
  StageOne start_of(const ProfilePoint& start, bool held) const;
  const ProfilePoint& nearest(double distance) const;

  const BlockModel& model_;
  const estimation::Problem& problem_;
  const model::Measurements& measurements_;
  const estimation::StageTwo& minimum_;
  Eigen::Index k_;
  bool up_;
  base::ThreadPool pool_{1};
  std::vector<ProfilePoint> points_;
  double deficit_ = 0.0;
  double lowest_at_ = 0.0;
};

}  // namespace sepcal::intervals
