// SPDX-License-Identifier: BSD-3-Clause
// A state model with effects, along a record: what compose() gives for a StateBlockModel. Effects
// on inputs act before the state is integrated. What their parameters do to the outputs comes from
// trajectories beside the one asked for, by differences of fourth order; those of a linear
// parameter that varies are exact.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "effects/composed_parts.hpp"
#include "effects/corrected_inputs.hpp"
#include "sepcal/detail/states/state_steps.hpp"
#include "states/differences.hpp"

namespace sepcal::states {

/// A parameter that changes inputs, and the step that its differences take.
struct MovingParameter {
  int place;    // among the nonlinear ones
  double step;  // h
};

class ComposedTrajectory final : public StateBlockModel {
 public:
  /// Throws Error as compose() does, and where outputs lag.
  ComposedTrajectory(std::shared_ptr<const StateBlockModel> model,
                     const std::vector<Effect>& effects, const Record& record);

  const TrajectoryPlan& plan() const override { return plan_; }

  std::unique_ptr<StateSteps> steps(const Record& record, const Eigen::VectorXd& xi) const override;

  void evaluate(const Block& block, const double* xi2, const double* xi1, Carry* carry,
                Eigen::Ref<Eigen::MatrixXd> rows) const override;

  std::unique_ptr<Carry> new_carry() const override;

  std::map<std::string, double> starting_values(const Record& record) const override {
    return model_->starting_values(record);
  }

  const StateBlockModel& model() const { return *model_; }
  const effects::ComposedParts& parts() const { return parts_; }
  const std::vector<MovingParameter>& moving() const { return moving_; }

  /// The record with the model's inputs as the effects leave them at xi2. It views the columns that
  /// are as they were.
  Record correct(const Record& record, const double* xi2) const;

  std::vector<InputSlopes> input_slopes(const Record& record,
                                        const Eigen::VectorXd& xi2) const override;

  std::unique_ptr<PathTangent> path_tangent(const Record& record, const Eigen::VectorXd& xi,
                                            const std::optional<PathNoise>& noise) const override;

 private:
  template <class Visit>
  void visit_inputs(const Record& record, const double* xi2, int slopes, const Visit& visit) const;

  struct Paths;

  void find_moving(const std::vector<Effect>& effects, const Record& record);
  double step_of(int place, const std::vector<InputSlopes>& slopes, const Record& record) const;
  Eigen::VectorXd total(const Block& block, const Eigen::VectorXd& xi2, const double* xi1,
                        Carry* carry) const;

  std::shared_ptr<const StateBlockModel> model_;
  effects::ComposedParts parts_;
  effects::InputCorrections corrections_;
  TrajectoryPlan plan_;
  std::vector<MovingParameter> moving_;
};

}  // namespace sepcal::states
