// SPDX-License-Identifier: BSD-3-Clause
#include "effects/composed_model.hpp"

#include <algorithm>

#include "effects/composed_lanes.hpp"
#include "effects/composed_rows.hpp"
#include "effects/composed_tables.hpp"
#include "sepcal/error.hpp"

namespace sepcal::effects {

using Eigen::MatrixXd;
using Eigen::Ref;

ComposedModel::ComposedModel(std::shared_ptr<const BlockModel> model,
                             const std::vector<Effect>& effects, const Record& record)
    : BlockModel(join_tables(*model, effects)),
      model_(std::move(model)),
      parts_(find_parts(tables(), *model_, effects)),
      corrections_(tables(), parts_, record) {}

void ComposedModel::evaluate_at(const LagNode& node, const Block& block, const double* xi2,
                                const double* xi1, Carry* carry, Ref<MatrixXd> rows) const {
  const int directions = xi1 == nullptr || corrections_.none() ? 0 : tables().n_2();
  const std::vector<InputColumn> columns = corrections_.correct(block, xi2, node, directions);
  const ComposedRows composed(*model_, tables(), parts_, block, xi2, xi1, columns);
  composed.fill(rows, carry, [](int) { return nullptr; });
  if (directions > 0) composed.add_slopes(rows.middleCols(tables().n_1(), directions));
}

void ComposedModel::evaluate(const Block& block, const double* xi2, const double* xi1, Carry* carry,
                             Ref<MatrixXd> rows) const {
  const std::span<const LagNode> nodes = corrections_.nodes();
  if (nodes.size() == 1) return evaluate_at(nodes.front(), block, xi2, xi1, carry, rows);
  MatrixXd at_node(rows.rows(), rows.cols());
  rows.setZero();
  for (const LagNode& node : nodes) {
    evaluate_at(node, block, xi2, xi1, carry, at_node);
    rows += node.weight * at_node;
  }
}

std::size_t ComposedModel::lane_width() const {
  const bool plain =
      parts_.terms.empty() && parts_.corrections.empty() && parts_.delays.empty() &&
      std::ranges::all_of(parts_.varying, [](const VaryingPart& part) { return part.shape < 0; });
  return plain ? model_->lane_width() : 0;
}

bool ComposedModel::evaluate_lanes(const LaneBlock& block, const PointTiles& points,
                                   double* scratch, const VisitTile& visit) const {
  const ComposedLanes composed(*model_, tables(), parts_, block);
  base::AlignedDoubles own(composed.own_size());
  return model_->evaluate_lanes(composed.own_block(), points, own.data(),
                                [&](std::size_t tile, const double* rows) {
                                  composed.fill(rows, scratch);
                                  visit(tile, scratch);
                                });
}

void ComposedModel::input_tangent(const Block& block, const double* xi2, const double* xi1,
                                  std::span<const int> inputs, Ref<MatrixXd> columns) const {
  if (inputs.empty()) return;
  if (!parts_.delays.empty()) {
    throw Error("a model with an effect in time can't be differentiated by its inputs");
  }
  for (const int input : inputs) {
    const std::string& effect = parts_.driven_by[static_cast<std::size_t>(input)];
    if (effect.empty()) continue;
    throw Error("the model can't be differentiated by its input '" +
                tables().inputs[static_cast<std::size_t>(input)].name + "', which drives effect " +
                effect + "; compose all effects at once");
  }
  const std::vector<InputColumn> moved = corrections_.correct_moving(block, xi2, inputs);
  columns.setZero();
  ComposedRows(*model_, tables(), parts_, block, xi2, xi1, moved).add_slopes(columns);
}

MatrixXd ComposedModel::guess(const MatrixXd& u, const MatrixXd& z) const {
  const MatrixXd own = model_->guess(u.leftCols(model_->tables().n_u()), z);
  MatrixXd all = MatrixXd::Zero(tables().n_2(), own.cols());
  all.topRows(own.rows()) = own;
  return all;
}

}  // namespace sepcal::effects
