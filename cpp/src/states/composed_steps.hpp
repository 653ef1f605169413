// SPDX-License-Identifier: BSD-3-Clause
// A state model with effects as a filter meets it: the model's own steps on inputs as the effects
// leave them, and what linear parameters that vary and terms add to its readings. Derivatives by
// parameters that change inputs come from steps beside these, by differences.
#pragma once

#include <array>
#include <memory>
#include <span>
#include <vector>

#include "states/composed_trajectory.hpp"

namespace sepcal::states {

class ComposedSteps final : public StateSteps {
 public:
  /// Model and record must outlive this.
  ComposedSteps(const ComposedTrajectory& model, const Record& record, const Eigen::VectorXd& xi);

  void set_parameters(const Eigen::VectorXd& xi) override;
  Step advance(std::size_t row, const Eigen::VectorXd& x) const override;
  Reading read(std::size_t row, const Eigen::VectorXd& x) const override;
  Eigen::VectorXd next(std::size_t row, const Eigen::VectorXd& x) const override;
  Eigen::VectorXd expect(std::size_t row, const Eigen::VectorXd& x) const override;
  Eigen::MatrixXd rate_slopes(std::size_t row, const Eigen::VectorXd& x) const override;
  JointStep advance_jointly(std::size_t row, const Eigen::VectorXd& x,
                            const Eigen::VectorXd& density) const override;
  Reading read_jointly(std::size_t row, const Eigen::VectorXd& x) const override;
  SecondOrderStep advance_to_second_order(std::size_t row, const Eigen::VectorXd& x) const override;
  SecondOrderReading read_to_second_order(std::size_t row, const Eigen::VectorXd& x) const override;
  Eigen::VectorXd start(std::size_t row) const override { return own_->start(row); }

  /// Of the model without effects.
  Eigen::VectorXd own_parameters() const;

  /// What the effects add to its linear parameters in each row of the record (length x n_1); empty
  /// where none varies.
  Eigen::MatrixXd drift() const;

 private:
  /// The same with one parameter moved by a node's share of its step.
  using Beside = std::array<std::unique_ptr<ComposedSteps>, difference_nodes.size()>;

  struct Drive {
    Eigen::MatrixXd values;  // phi, rows x functions
    Eigen::MatrixXd slopes;  // d phi / d shape; empty where there is no shape
  };

  /// What one parameter of the effects adds to the outputs of a row: a share of the column of the
  /// model's linear parameter `target`, or a column of its own.
  struct Column {
    int parameter;
    int target;  // -1: none
    double share;
    Eigen::VectorXd own;  // n_z
  };

  ComposedSteps(const ComposedTrajectory& model, const Record& record) noexcept
      : model_(model), record_(record) {}

  void move_to(const Eigen::VectorXd& xi);
  Drive drive(const effects::VaryingPart& part) const;
  Eigen::MatrixXd evaluate(const effects::TermPart& part) const;
  std::span<const double> input(int place) const;
  double input_at(int place, std::size_t row) const;  // what the record lacks is constant

  std::vector<Column> columns_at(std::size_t row) const;
  Eigen::VectorXd read_effects(std::size_t row, const std::vector<Column>& columns) const;

  Eigen::Index n_x() const { return static_cast<Eigen::Index>(model_.plan().integrated().size()); }
  Eigen::Index n_z() const { return model_.tables().n_z(); }
  std::vector<Eigen::Index> own_columns() const;
  std::vector<Eigen::Index> own_acting() const;
  Eigen::Index acting_place(Eigen::Index parameter) const;
  template <class Give>
  Eigen::VectorXd difference(std::size_t moving, const Give& give) const;

  const ComposedTrajectory& model_;
  const Record& record_;
  Eigen::VectorXd xi_;
  std::unique_ptr<const Record> corrected_;
  std::unique_ptr<StateSteps> own_;
  std::vector<Beside> beside_;          // of each moving parameter
  std::vector<Drive> drives_;           // of each varying part
  std::vector<Eigen::MatrixXd> terms_;  // of each: [A | D | b], n_z * length rows
};

}  // namespace sepcal::states
