// SPDX-License-Identifier: BSD-3-Clause
// What effects ask of a model that integrates a state: how they join it, and what they do to the
// outputs along the path of a fit.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sepcal/detail/block_model.hpp"
#include "sepcal/detail/effect.hpp"
#include "sepcal/detail/eigen.hpp"
#include "sepcal/record.hpp"

namespace sepcal {

/// What directions do to one input of a model: length of the record x directions.
struct InputSlopes {
  std::string input;
  Eigen::MatrixXd slopes;
};

/// What directions do along a path, of N rows: to inputs, to the state at the row after (n_x * N x
/// directions, row after row), and to the outputs as the state is (n_z * N x directions, output by
/// output). What is empty is nothing.
struct PathChange {
  std::vector<InputSlopes> inputs = {};
  Eigen::MatrixXd steps = {};
  Eigen::MatrixXd readings = {};
};

/// Noise in which a filter follows a path.
struct PathNoise {
  Eigen::VectorXd process;  // n_w, roots of spectral densities
  Eigen::VectorXd outputs;  // n_z, standard deviations
};

/// The path of a fit, linearised: what small changes along it do to the rows that were fitted. Of
/// output error these are the outputs,
///   s(k+1) = Phi s(k) + ds(k+1),  s = 0 where a trajectory begins,  column(k) = H s(k) + dz(k),
/// ds and dz what the change does to the step and the reading. Of filter error they are the
/// innovations over the root S of their covariance, with the gains K as they are:
///   s(k+1) = Phi (s(k) - K [H s(k) + dz(k)]) + ds(k+1),  column(k) = S'^-1 [H s(k) + dz(k)].
class PathTangent {
 public:
  PathTangent() = default;
  PathTangent(const PathTangent&) = delete;
  PathTangent& operator=(const PathTangent&) = delete;
  virtual ~PathTangent() = default;

  /// n_z * N x directions, output by output. May be called from several threads.
  virtual Eigen::MatrixXd columns(const PathChange& change) const = 0;

  /// What parameters of a model do that has all of this one's and more, at xi (n) where it is the
  /// same: `places` among all n. `record`: the same rows, with columns more where the model asks.
  virtual PathChange change(const BlockModel& with, const Record& record, const Eigen::VectorXd& xi,
                            const std::vector<Eigen::Index>& places) const = 0;
};

class PathModel {
 public:
  PathModel() = default;
  PathModel(const PathModel&) = delete;
  PathModel& operator=(const PathModel&) = delete;
  virtual ~PathModel() = default;

  /// What compose() gives for it. `self` is this model.
  virtual std::shared_ptr<const BlockModel> compose_with(std::shared_ptr<const BlockModel> self,
                                                         const std::vector<Effect>& effects,
                                                         const Record& record) const = 0;

  /// What a unit of each nonlinear parameter of effects does to inputs at xi2 (n_2), one direction
  /// a parameter; none of a model without effects on inputs.
  virtual std::vector<InputSlopes> input_slopes(const Record& record,
                                                const Eigen::VectorXd& xi2) const = 0;

  /// Along the record's segments at parameters (n); with noise that of a filter. Model and record
  /// must outlive it. Throws Error where a filter can't go on.
  virtual std::unique_ptr<PathTangent> path_tangent(
      const Record& record, const Eigen::VectorXd& xi,
      const std::optional<PathNoise>& noise) const = 0;
};

}  // namespace sepcal
