// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/block_model.hpp"

#include <utility>

namespace sepcal {

BlockModel::BlockModel(Tables tables) : tables_(std::move(tables)) { tables_.check_names(); }

}  // namespace sepcal
