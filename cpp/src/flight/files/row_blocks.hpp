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
  std::size_t bytes = 0;            // of the text that they were parsed from
  std::vector<Flight::Line> lines;  // of the first row, and of each that isn't in the next line
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

  /// The rows that come next, in order, none of them empty; nothing at the end. Valid until the
  /// next call. Throws Error as CsvReader does.
  std::span<const RowPart> next();

  /// About as many rows as the file has, judged by the first block; 0 where nothing is known.
  std::size_t expected_rows() const { return expected_rows_; }

 private:
  std::size_t parse(std::string_view text);
  bool parse_part(std::string_view text, RowPart& part) const;
  void read_by_rows();
  void take(std::span<const std::string_view> cells, RowPart& part) const;
  void put(std::size_t column, std::optional<double> number, std::string_view cell,
           RowPart& part) const;
  void clear(RowPart& part) const;

  CsvReader& reader_;
  std::size_t labels_at_;
  base::ThreadPool& pool_;
  bool is_plain_;
  std::vector<RowPart> parts_;
  std::size_t expected_rows_ = 0;
};

}  // namespace sepcal::files
