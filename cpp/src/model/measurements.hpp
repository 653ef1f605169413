// SPDX-License-Identifier: BSD-3-Clause
// A record as one model sees it: u and z in the order of the model's tables, cut into blocks that
// never cross a segment's edge, and the blocks into chunks that threads share.
#pragma once

#include <cstddef>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/aligned_doubles.hpp"
#include "sepcal/detail/block_model.hpp"
#include "sepcal/record.hpp"

namespace sepcal::model {

/// The record with the outputs that need not be measured, as their value is always the same.
Record with_constant_outputs(const Tables& tables, Record record);

class Measurements {
 public:
  struct Range {
    std::size_t first = 0;  // row of the record
    std::size_t rows = 0;
    std::size_t offset = 0;  // selected rows before it
    bool starts_segment = true;
    /// Where its kept rows begin, in bytes: of a whole block alone.
    std::size_t kept = nowhere;

    static constexpr std::size_t nowhere = std::numeric_limits<std::size_t>::max();
  };

  /// Finds the model's inputs and outputs by name; the record's memory must outlive this. An input
  /// that the record doesn't have takes its `absent` value in every row. Throws Error for another
  /// column that is missing and for a value that is not finite in a selected row.
  Measurements(const BlockModel& model, const Record& record);

  const Record& record() const { return record_; }

  /// Rows in the record's segments, N.
  std::size_t rows() const { return rows_; }

  /// The rows cut where there are gaps, find_runs() of the record.
  const std::vector<Segment>& runs() const { return runs_; }

  /// Blocks of at most block_rows samples, grouped into chunks: what one task works through in
  /// order. The grouping depends on the record alone, never on the number of threads.
  const std::vector<std::vector<Range>>& chunks() const { return chunks_; }

  /// The model's view of a range; `pointers` is scratch that the block refers to. What is kept in
  /// it is for the model that this was made for, and for what it is made of.
  Block block(const Range& range, std::vector<const double*>& pointers) const;

  /// What a pass does at a chunk's end: where the record is mapped, its pages may go.
  void release(const std::vector<Range>& chunk) const;

  /// z of output j over a range.
  std::span<const double> output(int j, const Range& range) const;

  /// u (rows x n_u) and z (rows x n_z), dense, of every row or, evenly, of about `most` of them.
  std::pair<Eigen::MatrixXd, Eigen::MatrixXd> gather(std::size_t most) const;

  /// Sum of z^2 of output j.
  double output_square(int j) const { return output_squares_[static_cast<std::size_t>(j)]; }

  /// What of the rows depends on u alone is kept where it takes no more: beyond the caches it comes
  /// as fast from arithmetic as from memory.
  static constexpr std::size_t most_kept_bytes = 4 << 20;
  static constexpr std::size_t block_rows = 128;   // all outputs' [A D r] stay in the first cache
  static constexpr std::size_t chunk_rows = 4096;  // enough work to be worth a thread's while

 private:
  /// Where an input's values are: a column, or one block of a constant.
  struct Input {
    const double* values = nullptr;
    bool constant = false;
  };

  /// Where the model has something to keep and there is room for it.
  void keep_rows(const BlockModel& model);

  Record record_;  // whose memory this views
  std::vector<Input> inputs_;
  std::vector<std::vector<double>> constants_;
  std::vector<std::span<const double>> outputs_;
  std::vector<double> output_squares_;
  std::vector<std::vector<Range>> chunks_;
  std::vector<Segment> runs_;
  std::size_t rows_ = 0;
  base::AlignedDoubles kept_;
};

}  // namespace sepcal::model
