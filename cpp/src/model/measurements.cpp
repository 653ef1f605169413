// SPDX-License-Identifier: BSD-3-Clause
#include "model/measurements.hpp"

#include <algorithm>
#include <cmath>

#include "base/excerpt.hpp"
#include "sepcal/error.hpp"

namespace sepcal::model {

using Eigen::Index;
using Eigen::MatrixXd;

namespace {

void check_finite(const std::string& name, std::span<const double> values, const Record& record) {
  base::for_each_piece(record, [&](std::size_t first, std::size_t last) {
    for (std::size_t row = first; row < last; ++row) {
      if (std::isfinite(values[row])) continue;
      throw Error("column '" + name + "' is not a finite number in row " + std::to_string(row) +
                  " (counted from 0); remove that row or mend it");
    }
  });
}

}  // namespace

Record with_constant_outputs(const Tables& tables, Record record) {
  for (const Variable& output : tables.outputs) {
    if (record.has(output.name) || !std::isfinite(output.absent)) continue;
    record.add(output.name, std::vector<double>(record.length(), output.absent));
  }
  return record;
}

Measurements::Measurements(const BlockModel& model, const Record& record)
    : record_(record), runs_(find_runs(record)), rows_(record.rows()) {
  const auto find = [&](const Variable& variable) {
    const std::span<const double> column = record.column(variable.name);
    check_finite(variable.name, column, record);
    return column;
  };
  for (const Variable& input : model.tables().inputs) {
    if (!record.has(input.name) && std::isfinite(input.absent)) {
      constants_.emplace_back(block_rows, input.absent);
      inputs_.push_back({constants_.back().data(), true});
    } else {
      inputs_.push_back({find(input).data(), false});
    }
  }
  for (const Variable& output : model.tables().outputs) outputs_.push_back(find(output));

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
  for (const std::span<const double> z : outputs_) {
    double sum = 0.0;
    base::for_each_piece(record, [&](std::size_t first, std::size_t last) {
      for (const double value : z.subspan(first, last - first)) sum += value * value;
    });
    output_squares_.push_back(sum);
  }
  keep_rows(model);
}

void Measurements::keep_rows(const BlockModel& model) {
  constexpr std::size_t line = 64;  // bytes that blocks begin at
  if (record_.is_mapped()) return;
  std::size_t bytes = 0;
  for (std::vector<Range>& chunk : chunks_) {
    for (Range& range : chunk) {
      range.kept = bytes;
      bytes += (model.kept_bytes(range.rows) + line - 1) / line * line;
    }
  }
  if (bytes == 0 || bytes > most_kept_bytes) return;
  base::AlignedDoubles kept(bytes / sizeof(double));
  std::vector<const double*> pointers;
  for (const std::vector<Range>& chunk : chunks_) {
    for (const Range& range : chunk) {
      model.keep_rows(block(range, pointers), reinterpret_cast<std::byte*>(kept.data()) +  // NOLINT
                                                  range.kept);
    }
  }
  kept_ = std::move(kept);
}

Block Measurements::block(const Range& range, std::vector<const double*>& pointers) const {
  pointers.clear();
  for (const Input& input : inputs_) {
    pointers.push_back(input.constant ? input.values : input.values + range.first);
  }
  Block block{pointers, range.rows, range.first, range.starts_segment};
  if (!kept_.empty() && range.kept != Range::nowhere) {
    block.kept = reinterpret_cast<const std::byte*>(kept_.data()) + range.kept;  // NOLINT: bytes
  }
  return block;
}

void Measurements::release(const std::vector<Range>& chunk) const {
  if (!record_.is_mapped()) return;
  for (std::size_t i = 0; i < chunk.size();) {
    const std::size_t first = chunk[i].first;
    std::size_t last = first;
    for (; i < chunk.size() && chunk[i].first == last; ++i) last += chunk[i].rows;
    record_.release(first, last);
  }
}

std::span<const double> Measurements::output(int j, const Range& range) const {
  return outputs_[static_cast<std::size_t>(j)].subspan(range.first, range.rows);
}

std::pair<MatrixXd, MatrixXd> Measurements::gather(std::size_t most) const {
  const std::size_t stride = (rows_ + most - 1) / most;
  const std::size_t rows = (rows_ + stride - 1) / stride;
  MatrixXd u(rows, inputs_.size());
  MatrixXd z(rows, outputs_.size());
  std::vector<const double*> pointers;
  Index at = 0;
  for (const std::vector<Range>& chunk : chunks_) {
    for (const Range& range : chunk) {
      const Block inputs = block(range, pointers);
      for (std::size_t row = (stride - range.offset % stride) % stride; row < range.rows;
           row += stride, ++at) {
        for (Index i = 0; i < u.cols(); ++i)
          u(at, i) = inputs.inputs[static_cast<std::size_t>(i)][row];
        for (Index j = 0; j < z.cols(); ++j) z(at, j) = output(static_cast<int>(j), range)[row];
      }
    }
    release(chunk);
  }
  return {u, z};
}

}  // namespace sepcal::model
