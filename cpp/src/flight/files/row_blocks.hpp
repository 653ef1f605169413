// SPDX-License-Identifier: BSD-3-Clause
// The rows of a CSV file as numbers, some MiB of text at a time, parsed on all cores. What is
// irregular is left to CsvReader, which reads row by row and says what is wrong, so that values and
// errors are the same either way.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/thread_pool.hpp"
#include "sepcal/flight/flight.hpp"

namespace sepcal::files {

/// Rows that follow each other.
struct RowPart {
  std::size_t rows = 0;
  /// One a header, `rows` values each, NaN for text; empty for the labels'.
  std::vector<std::vector<double>> columns;
  std::vector<std::optional<Flight::Cell>> first_text;  // one a header; rows from this part's first
  std::vector<std::string> labels;                      // `rows` of them, or none at all
};

class RowBlocks {
 public:
  /// `labels_at`: the header whose cells are labels, or as many as there are headers. The reader
  /// has read no row yet; it and the pool must outlive this.
  RowBlocks(CsvReader& reader, std::size_t labels_at, base::ThreadPool& pool);

  /// The rows that come next, in order; empty at the end. Valid until the next call. Throws Error
  /// as CsvReader does.
  std::span<const RowPart> next();

  /// About as many rows as the file has, judged by the first block; 0 where nothing is known.
  std::size_t expected_rows() const { return expected_rows_; }

 private:
  bool parse(std::string_view text);
  bool parse_part(std::string_view text, std::size_t at);
  void read_by_rows();
  void take(std::span<const std::string_view> cells, RowPart& part) const;
  static void clear(RowPart& part);

  CsvReader& reader_;
  std::size_t labels_at_;
  base::ThreadPool& pool_;
  std::vector<RowPart> parts_;
  std::size_t expected_rows_ = 0;
};

}  // namespace sepcal::files
