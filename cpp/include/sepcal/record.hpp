// SPDX-License-Identifier: BSD-3-Clause
// Measured samples: named columns of equal length, cut into segments. A record views memory that
// somebody else keeps (NumPy's, a telemetry buffer's) or owns it; selecting segments copies
// nothing.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace sepcal {

/// Rows [first, last) without a gap. No derivative, lag or whitening crosses a segment's edge.
struct Segment {
  std::string label;
  std::size_t first = 0;
  std::size_t last = 0;

  std::size_t rows() const { return last - first; }
};

class Record {
 public:
  /// Adds a column that the record owns. Throws Error for a name used twice or another length.
  Record& add(std::string name, std::vector<double> values);

  /// Adds a column without copying it; `owner` keeps the memory alive (or the caller does).
  Record& view(std::string name, std::span<const double> values,
               std::shared_ptr<const void> owner = nullptr);

  /// Puts other values in a column's place, as many, which the record owns. Throws Error for a name
  /// that is not there and for another length.
  Record& replace(std::string_view name, std::vector<double> values);

  /// Says that the columns are mapped from files and may be longer than memory. `release` is told
  /// the rows [first, last) that a pass has done with, from any thread, so that their pages can go
  /// (madvise with MADV_DONTNEED); it may be told of rows that another thread still reads. A fit of
  /// more than 100,000 such rows finds its noise model from that many of them.
  Record& map(std::function<void(std::size_t first, std::size_t last)> release);

  bool is_mapped() const { return static_cast<bool>(release_); }

  /// Lets rows [first, last) of a mapped record go; does nothing for another one.
  void release(std::size_t first, std::size_t last) const {
    if (release_) release_(first, last);
  }

  bool has(std::string_view name) const;

  /// All rows of a column. Throws Error naming the column and listing those that are there.
  std::span<const double> column(std::string_view name) const;

  std::vector<std::string> names() const;

  /// Length of the columns.
  std::size_t length() const { return length_; }

  /// Rows in the selected segments.
  std::size_t rows() const;

  /// One segment over all rows unless cut.
  const std::vector<Segment>& segments() const { return segments_; }

  /// Sets the segments. Throws Error where one is empty, overlaps, runs back or leaves the record.
  Record& cut(std::vector<Segment> segments);

  /// The same columns, with only the named segments. `selection` names labels or spans of the
  /// column `time` [s]: "wind_circle_1,510.9:530" (a span includes both its ends). Empty: all.
  /// Throws Error for a name or a span that matches nothing, listing the labels.
  Record select(std::string_view selection) const;

 private:
  struct Column {
    std::string name;
    std::span<const double> values;
    std::shared_ptr<const void> owner;
  };

  std::vector<Column> columns_;
  std::vector<Segment> segments_;
  std::size_t length_ = 0;
  std::function<void(std::size_t, std::size_t)> release_;
};

/// Cuts at every change of `labels` (may be empty) and at every gap in `time` [s] over five median
/// intervals. Throws Error where time does not increase (naming the row, counted from zero).
std::vector<Segment> find_segments(std::span<const double> time,
                                   std::span<const std::string> labels);

/// The rows of the record's segments one after another, cut only where `time` [s] has a gap over
/// five median intervals or runs back: noise runs on where a label changes. Cut like the segments
/// where the record has no time.
std::vector<Segment> find_runs(const Record& record);

}  // namespace sepcal
