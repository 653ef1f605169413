// SPDX-License-Identifier: BSD-3-Clause
// A model's inputs out of a record, as a block points to them.
#pragma once

#include <cstddef>
#include <vector>

#include "sepcal/detail/block_model.hpp"
#include "sepcal/record.hpp"

namespace sepcal::test {

struct BlockInputs {
  std::vector<const double*> pointers;         // n_u
  std::vector<std::vector<double>> constants;  // of the inputs that the record doesn't have
};

/// From row `first` of the record on; an input that isn't there takes its `absent` value.
inline BlockInputs block_inputs(const BlockModel& model, const Record& record,
                                std::size_t first = 0) {
  BlockInputs inputs;
  for (const Variable& input : model.tables().inputs) {
    if (record.has(input.name)) {
      inputs.pointers.push_back(record.column(input.name).data() + first);
    } else {
      inputs.constants.emplace_back(record.length() - first, input.absent);
      inputs.pointers.push_back(inputs.constants.back().data());
    }
  }
  return inputs;
}

}  // namespace sepcal::test
