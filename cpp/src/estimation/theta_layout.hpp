// SPDX-License-Identifier: BSD-3-Clause
// How filter error's theta stands (InnovationModel): which of it is estimated, within which bounds
// and priors, by which names.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "estimation/objective.hpp"
#include "estimation/problem.hpp"
#include "estimation/scored_estimate.hpp"
#include "numerics/box.hpp"
#include "sepcal/detail/innovation_model.hpp"
#include "sepcal/fit.hpp"

namespace sepcal::estimation {

/// "q_alpha", "r_alpha_m".
std::string process_noise_name(const Variable& noise);
std::string output_noise_name(const Variable& output);

/// The noises that are not given: process noises, then outputs'.
std::vector<Estimated> estimable_noises(const BlockModel& model, const FitOptions& options);

/// Where a fit by filter error ended: theta of InnovationModel.
Eigen::VectorXd theta_of(const Fit& fit);

class ThetaLayout {
 public:
  /// All of them must outlive it.
  ThetaLayout(const BlockModel& model, const Problem& problem, const InnovationModel& innovations);

  Eigen::Index n() const { return n_; }  // the model's parameters
  Eigen::Index size() const { return innovations_.size(); }
  Eigen::Index noises() const { return innovations_.noises(); }

  /// Places of what is estimated: the free parameters first, in the problem's order.
  const std::vector<Eigen::Index>& free() const { return free_; }
  Eigen::Index free_parameters() const;

  /// Holds noises whose logarithm in theta is minus infinity, which are none.
  void hold_silent(const Eigen::VectorXd& theta);

  /// "Za", "q_alpha", "r_alpha_m".
  std::string name_of(Eigen::Index place) const;
  /// What is estimated, in free()'s order.
  std::vector<Estimated> estimated() const;
  /// Of a process noise, then of an output, k from 0.
  const Variable& noise(Eigen::Index k) const;

  /// Of theta: the problem's bounds, and `floor` (n_w + n_z) below the noises.
  numerics::Box box(const Eigen::VectorXd& floor) const;
  /// Of theta; no noise has one.
  Prior prior() const;

  /// What is held has its value, the rest 0.
  Eigen::VectorXd given() const;

  /// Floors that a fit reached or that lie far below it.
  Eigen::VectorXd floor_of(const Fit& fit) const;

 private:
  bool is_given(Eigen::Index k) const;  // noise k

  const BlockModel& model_;
  const Problem& problem_;
  const InnovationModel& innovations_;
  std::vector<Variable> all_;
  Eigen::Index n_;
  std::vector<Eigen::Index> free_;
};

}  // namespace sepcal::estimation
