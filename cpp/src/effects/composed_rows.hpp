// SPDX-License-Identifier: BSD-3-Clause
// The rows of one block of a composed model, its inputs being corrected already: the model's own
// columns, those of varying parameters and terms, and the tangent. A model's own linear parameter p
// that varies counts as xi1_p + drift, drift = sum_j s_j phi_j(d), row by row; since A xi1 + b is
// affine in xi1, so is every derivative, and a drift adds its share of a unit step's.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <map>
#include <utility>
#include <vector>

#include "effects/composed_parts.hpp"
#include "effects/corrected_inputs.hpp"

namespace sepcal::effects {

class ComposedRows {
 public:
  /// Everything must outlive this. xi1 may be nullptr: no tangent. `columns`: the corrected inputs;
  /// drivers are read from `block`, as they were logged.
  ComposedRows(const BlockModel& model, const Tables& tables, const ComposedParts& parts,
               const Block& block, const double* xi2, const double* xi1,
               const std::vector<InputColumn>& columns);

  /// Of a model that carries a state: the carry of the pass in which a linear parameter of its own
  /// is greater by one. nullptr of any other model.
  using CarryOf = std::function<Carry*(int target)>;

  /// Sets [A | b] or [A | D | b], D without what corrections of the inputs add.
  void fill(Eigen::Ref<Eigen::MatrixXd> rows, Carry* carry, const CarryOf& stepped) const;

  /// Adds the derivatives of A xi1 + b along the slopes of the inputs (n_z * rows x directions).
  void add_slopes(Eigen::Ref<Eigen::MatrixXd> slopes) const;

 private:
  /// phi of a varying part (rows x functions) and its derivative with respect to the shape.
  struct Drive {
    Eigen::MatrixXd values;
    Eigen::MatrixXd slopes;
  };

  Drive drive(const VaryingPart& part) const;
  void note_drift(const VaryingPart& part, const Drive& drive);
  std::vector<const double*> select(const std::vector<int>& inputs) const;
  Block with(const std::vector<const double*>& inputs) const;
  std::vector<std::pair<Eigen::Index, const double*>> bases(
      const VaryingPart& part, std::size_t component,
      const Eigen::Ref<const Eigen::MatrixXd>& A) const;
  Eigen::VectorXd step(int target) const;

  void fill_own(Eigen::Ref<Eigen::MatrixXd> rows, Carry* carry) const;
  void fill_varying(const VaryingPart& part, const Drive& drive,
                    Eigen::Ref<Eigen::MatrixXd> rows) const;
  void fill_term(const TermPart& part, Eigen::Ref<Eigen::MatrixXd> rows) const;
  void add_drift_to_tangent(Eigen::Ref<Eigen::MatrixXd> rows, const CarryOf& stepped) const;

  std::vector<int> find_moving(const std::vector<int>& inputs) const;
  void add_slopes(const VaryingPart& part, const Drive& drive,
                  Eigen::Ref<Eigen::MatrixXd> slopes) const;
  void add_chain(const Eigen::MatrixXd& by_input, const std::vector<int>& inputs,
                 const std::vector<int>& moving, Eigen::Ref<Eigen::MatrixXd> slopes) const;

  const BlockModel& model_;
  const Tables& tables_;
  const ComposedParts& parts_;
  const Block& block_;
  const double* xi2_;
  const double* xi1_;
  const std::vector<InputColumn>& columns_;
  Eigen::Index rows_;
  std::vector<Drive> drives_;              // of each varying part
  std::map<int, Eigen::VectorXd> drifts_;  // by the model's linear parameter: rows
};

}  // namespace sepcal::effects
