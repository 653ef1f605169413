// SPDX-License-Identifier: BSD-3-Clause
// The model that compose() gives. A block passes through it so: its inputs are shifted in time and
// corrected, with their derivatives along (corrected_inputs.hpp); the model, the varying parameters
// and the terms are evaluated there (composed_rows.hpp).
#pragma once

#include <Eigen/Core>
#include <memory>
#include <span>
#include <vector>

#include "effects/composed_parts.hpp"
#include "effects/corrected_inputs.hpp"
#include "sepcal/composition.hpp"

namespace sepcal::effects {

class ComposedModel final : public BlockModel {
 public:
  /// Throws Error as compose() does.
  ComposedModel(std::shared_ptr<const BlockModel> model, const std::vector<Effect>& effects,
                const Record& record);

  void evaluate(const Block& block, const double* xi2, const double* xi1, Carry* carry,
                Eigen::Ref<Eigen::MatrixXd> rows) const override;

  /// Lanes of the model itself, where effects only vary parameters by drivers without a shape: what
  /// they add is then the model's own columns times what the record says.
  std::size_t lane_width() const override;
  bool evaluate_lanes(const LaneBlock& block, const PointTiles& points, double* scratch,
                      const VisitTile& visit) const override;

  /// Throws Error for an input that drives an effect and where an effect acts in time.
  void input_tangent(const Block& block, const double* xi2, const double* xi1,
                     std::span<const int> inputs,
                     Eigen::Ref<Eigen::MatrixXd> columns) const override;

  /// The model's own guess, the effects' parameters at zero.
  Eigen::MatrixXd guess(const Eigen::MatrixXd& u, const Eigen::MatrixXd& z) const override;

  /// The model's own; an effect begins at zero.
  std::map<std::string, double> starting_values(const Record& record) const override {
    return model_->starting_values(record);
  }

  std::unique_ptr<Carry> new_carry() const override { return model_->new_carry(); }

 private:
  void evaluate_at(const LagNode& node, const Block& block, const double* xi2, const double* xi1,
                   Carry* carry, Eigen::Ref<Eigen::MatrixXd> rows) const;

  std::shared_ptr<const BlockModel> model_;
  ComposedParts parts_;
  InputCorrections corrections_;
};

}  // namespace sepcal::effects
