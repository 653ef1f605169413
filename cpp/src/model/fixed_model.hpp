// SPDX-License-Identifier: BSD-3-Clause
// A model with some of its parameters held: a fixed linear parameter's column joins b, a fixed
// nonlinear one disappears from xi2. The result is a model like any other.
#pragma once

#include <map>
#include <string>

#include "base/aligned_doubles.hpp"
#include "sepcal/detail/block_model.hpp"

namespace sepcal::model {

class FixedModel final : public BlockModel {
 public:
  /// `fixed`: name and value; names the model doesn't have are the caller's to refuse. `model` must
  /// outlive this.
  FixedModel(const BlockModel& model, const std::map<std::string, double>& fixed);

  void evaluate(const Block& block, const double* xi2, const double* xi1, Carry* carry,
                Eigen::Ref<Eigen::MatrixXd> rows) const override;

  void evaluate_points(const Block& block, const Eigen::MatrixXd& points,
                       std::span<const std::unique_ptr<Carry>> carries, Eigen::MatrixXd& scratch,
                       const VisitRows& visit) const override;

  std::size_t kept_bytes(std::size_t rows) const override { return model_.kept_bytes(rows); }
  void keep_rows(const Block& block, void* to) const override { model_.keep_rows(block, to); }

  std::size_t lane_width() const override { return model_.lane_width(); }
  bool evaluate_lanes(const LaneBlock& block, const PointTiles& points, double* scratch,
                      const VisitTile& visit) const override;

  std::size_t prepared_bytes() const override { return model_.prepared_bytes(); }
  void prepare_rows(const Block& block, void* to) const override { model_.prepare_rows(block, to); }
  void fill_trials(const TrialRows& trials, double* to) const override;

  void input_tangent(const Block& block, const double* xi2, const double* xi1,
                     std::span<const int> inputs,
                     Eigen::Ref<Eigen::MatrixXd> columns) const override;

  bool add_second_derivatives(const Block& block, const double* xi2, const double* xi1,
                              Eigen::Ref<Eigen::MatrixXd> sum) const override;

  Eigen::MatrixXd guess(const Eigen::MatrixXd& u, const Eigen::MatrixXd& z) const override {
    return model_.guess(u, z)(free_2_, Eigen::all);
  }

  std::unique_ptr<Carry> new_carry() const override { return model_.new_carry(); }

 private:
  /// The rows [A | b] or [A | D | b] of the whole model without what is fixed.
  void take_free(const Eigen::MatrixXd& whole, bool tangent,
                 Eigen::Ref<Eigen::MatrixXd> rows) const;

  /// A tile of the whole model, `rows`, to that of what is free; `held` is scratch.
  void take_free(const LaneBlock& whole, const double* rows, double* to,
                 base::AlignedDoubles& held) const;

  const BlockModel& model_;
  Eigen::VectorXd xi1_;  // n_1 and n_2 of the whole model: fixed values, zero where free
  Eigen::VectorXd xi2_;
  std::vector<Eigen::Index> free_1_;  // which parameters of the whole model are free
  std::vector<Eigen::Index> free_2_;
};

}  // namespace sepcal::model
