// SPDX-License-Identifier: BSD-3-Clause
// A state model along a record as a filter meets it: one row at a time, linearised about an
// estimate. What a smoother needs of any of them, whoever wrote it.
#pragma once

#include <cstddef>
#include <memory>

#include "sepcal/detail/block_model.hpp"
#include "sepcal/detail/eigen.hpp"
#include "sepcal/detail/path_model.hpp"
#include "sepcal/detail/states/second_order_step.hpp"
#include "sepcal/detail/states/trajectory_plan.hpp"
#include "sepcal/record.hpp"

namespace sepcal {

/// States are those that are integrated, n_x of them; a measured one is known. Parameters xi are
/// all n of the model's tables, linear, then nonlinear; initial states, among them, act on no step.
class StateSteps {
 public:
  /// S 3.7 to 3.10: from a row to the next.
  struct Step {
    Eigen::VectorXd x;      // n_x, at the next row
    Eigen::MatrixXd Phi;    // n_x x n_x, its derivative by x
    Eigen::MatrixXd Gamma;  // n_x x n_v, by the parts of process noises (noise_parts())
  };
  /// What is expected of the outputs, A xi1 + b.
  struct Reading {
    Eigen::VectorXd z;  // n_z
    Eigen::MatrixXd H;  // n_z x n_x
  };
  /// A step with the parameters in doubt.
  struct JointStep {
    Eigen::VectorXd x;    // n_x
    Eigen::MatrixXd Phi;  // n_x x (n_x + n), by x and xi
    Eigen::MatrixXd Q_d;  // n_x x n_x, what the process noise adds
  };

  StateSteps() = default;
  StateSteps(const StateSteps&) = delete;
  StateSteps& operator=(const StateSteps&) = delete;
  virtual ~StateSteps() = default;

  /// At other parameters from now on.
  virtual void set_parameters(const Eigen::VectorXd& xi) = 0;

  /// Of rows of the record. Not finite where the model isn't.
  virtual Step advance(std::size_t row, const Eigen::VectorXd& x) const = 0;
  virtual Reading read(std::size_t row, const Eigen::VectorXd& x) const = 0;

  /// Their x and z alone.
  virtual Eigen::VectorXd next(std::size_t row, const Eigen::VectorXd& x) const {
    return advance(row, x).x;
  }
  virtual Eigen::VectorXd expect(std::size_t row, const Eigen::VectorXd& x) const {
    return read(row, x).z;
  }

  /// F = df/dx, n_x x n_x [1/s], at a row; zero of a model in discrete time.
  virtual Eigen::MatrixXd rate_slopes(std::size_t row, const Eigen::VectorXd& x) const = 0;

  /// The same by x and xi. `density`: of each noise, its table's unit squared (n_w).
  virtual JointStep advance_jointly(std::size_t row, const Eigen::VectorXd& x,
                                    const Eigen::VectorXd& density) const = 0;
  virtual Reading read_jointly(std::size_t row, const Eigen::VectorXd& x) const = 0;  // n_x + n

  /// With second derivatives. Their parameters are those of TrajectoryPlan::acting_columns().
  using SecondOrderStep = sepcal::SecondOrderStep<Eigen::Dynamic, Eigen::Dynamic, Eigen::Dynamic>;
  using SecondOrderReading =
      sepcal::SecondOrderReading<Eigen::Dynamic, Eigen::Dynamic, Eigen::Dynamic>;
  using SecondOrderNoise = sepcal::SecondOrderNoise<Eigen::Dynamic, Eigen::Dynamic, Eigen::Dynamic>;
  virtual SecondOrderStep advance_to_second_order(std::size_t row,
                                                  const Eigen::VectorXd& x) const = 0;
  virtual SecondOrderReading read_to_second_order(std::size_t row,
                                                  const Eigen::VectorXd& x) const = 0;

  /// n_x, what the model's start(u, z) says of a row; zero where it has none.
  virtual Eigen::VectorXd start(std::size_t row) const = 0;
};

/// A state model laid along a record: what TrajectoryModel and its like have in common.
class StateBlockModel : public BlockModel, public PathModel {
 public:
  using BlockModel::BlockModel;

  virtual const TrajectoryPlan& plan() const = 0;

  /// At xi (n); model and record must outlive it.
  virtual std::unique_ptr<StateSteps> steps(const Record& record,
                                            const Eigen::VectorXd& xi) const = 0;

  /// The largest eigenvalue of a trajectory's transition matrix, in size; 1 where none is larger.
  double growth(const Record& record, const Eigen::VectorXd& xi) const override;

  /// dt / substeps times the largest eigenvalue of F, in size, at some 200 rows.
  double coarseness(const Record& record, const Eigen::VectorXd& xi) const override;

  std::vector<std::string> idle_parameters(const Record& record) const override;

  std::span<const Variable> process_noises() const override { return plan().model().noise; }

  Eigen::MatrixXd score_noise(const Record& record, const Eigen::VectorXd& xi,
                              const Eigen::VectorXd& noise,
                              const Eigen::VectorXd& density) const override;

  std::unique_ptr<InnovationModel> innovations(const Record& record) const override;

  /// A state model again. Inputs go on straight beyond a segment's edges where they are late.
  std::shared_ptr<const BlockModel> compose_with(std::shared_ptr<const BlockModel> self,
                                                 const std::vector<Effect>& effects,
                                                 const Record& record) const override;

  std::vector<InputSlopes> input_slopes(const Record& /*record*/,
                                        const Eigen::VectorXd& /*xi2*/) const override {
    return {};
  }

  std::unique_ptr<PathTangent> path_tangent(const Record& record, const Eigen::VectorXd& xi,
                                            const std::optional<PathNoise>& noise) const override;
};

}  // namespace sepcal
