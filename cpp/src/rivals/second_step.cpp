// SPDX-License-Identifier: BSD-3-Clause
#include "rivals/second_step.hpp"

#include <string>
#include <utility>

#include "sepcal/error.hpp"

namespace sepcal::rivals {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

Tables tables_of(const ChangeOfVariables& change, Index states) {
  Tables tables;
  for (Index i = 0; i < states; ++i) tables.outputs.emplace_back(std::to_string(i + 1), "1");
  tables.nonlinear = change.parameters();
  return tables;
}

}  // namespace

SecondStepModel::SecondStepModel(const ChangeOfVariables& change, MatrixXd root)
    : BlockModel(tables_of(change, root.rows())), change_(change), root_(std::move(root)) {}

void SecondStepModel::evaluate(const Block& /*block*/, const double* xi2, const double* xi1,
                               Carry* /*carry*/, Eigen::Ref<MatrixXd> rows) const {
  const VectorXd xi = Eigen::Map<const VectorXd>(xi2, tables().n_2());
  const VectorXd states = change_.at(xi);
  check(states.size());
  rows.rightCols<1>() = root_ * states;
  if (xi1 != nullptr) rows.leftCols(tables().n_2()) = slopes(xi);
}

void SecondStepModel::check(Index states) const {
  if (states == root_.cols()) return;
  throw Error("the change of variables gives " + std::to_string(states) +
              " states, the first step has " + std::to_string(root_.cols()));
}

Record SecondStepModel::measure(const VectorXd& states) const {
  const VectorXd z = root_ * states;
  Record record;
  for (Index i = 0; i < z.size(); ++i) {
    record.add(tables().outputs[static_cast<std::size_t>(i)].name, std::vector<double>{z[i]});
  }
  return record;
}

MatrixXd SecondStepModel::slopes(const VectorXd& xi) const {
  const MatrixXd by_parameter = change_.slopes(xi);
  check(by_parameter.rows());
  return root_ * by_parameter;
}

}  // namespace sepcal::rivals
