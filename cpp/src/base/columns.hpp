// SPDX-License-Identifier: BSD-3-Clause
// A record with some of its columns replaced or added.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "sepcal/record.hpp"

namespace sepcal::base {

class Columns {
 public:
  explicit Columns(const Record& record) : segments_(record.segments()) {
    for (const std::string& name : record.names()) {
      const auto column = record.column(name);
      set(name, {column.begin(), column.end()});
    }
  }

  void set(const std::string& name, std::vector<double> values) {
    for (auto& [known, column] : columns_) {
      if (known != name) continue;
      column = std::move(values);
      return;
    }
    columns_.emplace_back(name, std::move(values));
  }

  /// Cut as the first one was.
  Record record() const {
    Record record;
    for (const auto& [name, values] : columns_) record.add(name, values);
    return record.cut(segments_);
  }

 private:
  std::vector<std::pair<std::string, std::vector<double>>> columns_;
  std::vector<Segment> segments_;
};

}  // namespace sepcal::base
