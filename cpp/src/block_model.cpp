// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/block_model.hpp"

#include <utility>

#include "sepcal/error.hpp"

namespace sepcal {

BlockModel::BlockModel(Tables tables) : tables_(std::move(tables)) { tables_.check_names(); }

void BlockModel::input_tangent(const Block& /*block*/, const double* /*xi2*/, const double* /*xi1*/,
                               std::span<const int> inputs,
                               // NOLINTNEXTLINE(performance-unnecessary-value-param): an output
                               Eigen::Ref<Eigen::MatrixXd> /*columns*/) const {
  if (inputs.empty()) return;
  throw Error("the model can't be differentiated by its input '" +
              tables_.inputs[static_cast<std::size_t>(inputs.front())].name +
              "', so that no effect can correct it; make at(u, xi2) a template in u's number type");
}

}  // namespace sepcal
