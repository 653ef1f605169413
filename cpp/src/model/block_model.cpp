// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/detail/block_model.hpp"

#include <utility>

#include "model/differences.hpp"
#include "sepcal/detail/innovation_model.hpp"
#include "sepcal/error.hpp"

namespace sepcal {

using namespace model;  // this room's own

using Eigen::Index;
using Eigen::Map;
using Eigen::MatrixXd;
using Eigen::VectorXd;

BlockModel::BlockModel(Tables tables) : tables_(std::move(tables)) { tables_.check_names(); }

void BlockModel::evaluate_points(const Block& block, const MatrixXd& points,
                                 std::span<const std::unique_ptr<Carry>> carries, MatrixXd& scratch,
                                 const VisitRows& visit) const {
  scratch.resize(static_cast<Index>(block.rows) * tables_.n_z(), tables_.n_1() + 1);
  for (Index s = 0; s < points.cols(); ++s) {
    evaluate(block, points.col(s).data(), nullptr, carries[static_cast<std::size_t>(s)].get(),
             scratch);
    visit(s, scratch);
  }
}

std::size_t BlockModel::kept_bytes(std::size_t /*rows*/) const { return 0; }

void BlockModel::keep_rows(const Block& /*block*/, void* /*to*/) const {
  throw Error("the model keeps nothing of its rows");
}

bool BlockModel::evaluate_lanes(const LaneBlock& /*block*/, const PointTiles& /*points*/,
                                double* /*scratch*/, const VisitTile& /*visit*/) const {
  throw Error("the model has no lanes");
}

void BlockModel::prepare_rows(const Block& /*block*/, void* /*to*/) const {
  throw Error("the model has no lanes for trials");
}

void BlockModel::fill_trials(const TrialRows& /*trials*/, double* /*to*/) const {
  throw Error("the model has no lanes for trials");
}

void BlockModel::input_tangent(const Block& block, const double* xi2, const double* xi1,
                               std::span<const int> inputs,
                               // NOLINTNEXTLINE(performance-unnecessary-value-param): an output
                               Eigen::Ref<Eigen::MatrixXd> columns) const {
  if (inputs.empty()) return;
  if (new_carry() != nullptr) {
    throw Error("a model that carries a state can't be differentiated by its input '" +
                tables_.inputs[static_cast<std::size_t>(inputs.front())].name +
                "'; no effect can correct it");
  }
  const Index n_1 = tables_.n_1();
  const Map<const VectorXd> linear(xi1, n_1);
  MatrixXd rows(static_cast<Index>(block.rows) * tables_.n_z(), n_1 + 1);
  const auto predict = [&](const Block& moved) {
    evaluate(moved, xi2, nullptr, nullptr, rows);
    return VectorXd(rows.leftCols(n_1) * linear + rows.col(n_1));
  };
  differentiate_by_inputs(predict, block, inputs, columns);
}

MatrixXd BlockModel::guess(const MatrixXd& /*u*/, const MatrixXd& /*z*/) const {
  return MatrixXd(tables_.n_2(), 0);
}

std::map<std::string, double> BlockModel::starting_values(const Record& /*record*/) const {
  return {};
}

std::vector<std::string> BlockModel::idle_parameters(const Record& /*record*/) const { return {}; }

double BlockModel::growth(const Record& /*record*/, const VectorXd& /*xi*/) const { return 1.0; }

double BlockModel::coarseness(const Record& /*record*/, const VectorXd& /*xi*/) const {
  return 0.0;
}

MatrixXd BlockModel::score_noise(const Record& /*record*/, const VectorXd& xi,
                                 const VectorXd& /*noise*/, const VectorXd& /*density*/) const {
  return MatrixXd::Zero(xi.size(), xi.size());
}

std::unique_ptr<InnovationModel> BlockModel::innovations(const Record& /*record*/) const {
  return nullptr;
}

bool BlockModel::enclose(const Block& /*block*/, std::span<const Enclosure> /*xi2*/,
                         EnclosedRows& /*rows*/) const {
  return false;
}

bool BlockModel::add_second_derivatives(
    const Block& /*block*/, const double* /*xi2*/, const double* /*xi1*/,
    // NOLINTNEXTLINE(performance-unnecessary-value-param): an output
    Eigen::Ref<Eigen::MatrixXd> /*sum*/) const {
  return false;
}

}  // namespace sepcal
