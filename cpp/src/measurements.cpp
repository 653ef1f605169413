// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/measurements.hpp"

#include <algorithm>
#include <cmath>

#include "sepcal/error.hpp"

namespace sepcal {
namespace {

void check_finite(const std::string& name, std::span<const double> values, const Record& record) {
  for (const Segment& segment : record.segments()) {
    for (std::size_t row = segment.first; row < segment.last; ++row) {
      if (std::isfinite(values[row])) continue;
      throw Error("column '" + name + "' is not a finite number in row " + std::to_string(row) +
                  " (counted from 0); remove that row or mend it");
    }
  }
}

}  // namespace

Measurements::Measurements(const BlockModel& model, const Record& record) : rows_(record.rows()) {
  const auto find = [&](const std::vector<Variable>& table) {
    std::vector<std::span<const double>> columns;
    for (const Variable& variable : table) {
      columns.push_back(record.column(variable.name));
      check_finite(variable.name, columns.back(), record);
    }
    return columns;
  };
  inputs_ = find(model.tables().inputs);
  outputs_ = find(model.tables().outputs);

  const bool in_order = model.new_carry() != nullptr;
  std::size_t in_chunk = chunk_rows;
  std::size_t offset = 0;
  for (const Segment& segment : record.segments()) {
    for (std::size_t first = segment.first; first < segment.last; first += block_rows) {
      const Range range{first, std::min(block_rows, segment.last - first), offset,
                        first == segment.first};
      offset += range.rows;
      if (in_chunk >= chunk_rows && (range.starts_segment || !in_order)) {
        chunks_.emplace_back();
        in_chunk = 0;
      }
      chunks_.back().push_back(range);
      in_chunk += range.rows;
    }
  }
}

Block Measurements::block(const Range& range, std::vector<const double*>& pointers) const {
  pointers.clear();
  for (const auto& column : inputs_) pointers.push_back(column.data() + range.first);
  return {pointers, range.rows, range.first, range.starts_segment};
}

std::span<const double> Measurements::output(int j, const Range& range) const {
  return outputs_[static_cast<std::size_t>(j)].subspan(range.first, range.rows);
}

double Measurements::output_square(int j) const {
  double sum = 0.0;
  for (const auto& chunk : chunks_) {
    for (const Range& range : chunk) {
      for (const double z : output(j, range)) sum += z * z;
    }
  }
  return sum;
}

}  // namespace sepcal
