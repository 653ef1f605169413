// SPDX-License-Identifier: BSD-3-Clause
// Several sensors as one model (Sun & Gebre-Egziabher, Eq. A5), put together at run time:
// static_concatenation.hpp while compiling.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "sepcal/detail/block_model.hpp"

namespace sepcal {

struct Sensor {
  std::string label;  // its outputs and parameters are called "label.name"; empty: as they are
  std::shared_ptr<const BlockModel> model;
};

/// All of them as one model: outputs and parameters one sensor after another, A block-diagonal,
/// inputs of one name one input. Throws Error for no sensor, a name that belongs to two, an input
/// in two units, and a model that carries a state.
std::shared_ptr<const BlockModel> concatenate(const std::vector<Sensor>& sensors);

}  // namespace sepcal
