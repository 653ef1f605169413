// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/record.hpp"

#include <algorithm>

#include "sepcal/error.hpp"

namespace sepcal {

Record& Record::add(std::string name, std::vector<double> values) {
  const auto owned = std::make_shared<const std::vector<double>>(std::move(values));
  return view(std::move(name), *owned, owned);
}

Record& Record::view(std::string name, std::span<const double> values,
                     std::shared_ptr<const void> owner) {
  if (name.empty()) throw Error("a column of the record has no name");
  if (has(name)) throw Error("column '" + name + "' is in the record already; rename one");
  if (!columns_.empty() && values.size() != length_) {
    throw Error("column '" + name + "' has " + std::to_string(values.size()) +
                " values, the others have " + std::to_string(length_));
  }
  if (columns_.empty()) {
    length_ = values.size();
    if (length_ > 0) segments_ = {{"", 0, length_}};
  }
  columns_.push_back({std::move(name), values, std::move(owner)});
  return *this;
}

Record& Record::replace(std::string_view name, std::vector<double> values) {
  const std::span<const double> before = column(name);
  if (values.size() != before.size()) {
    throw Error("column '" + std::string(name) + "' has " + std::to_string(before.size()) +
                " values, and " + std::to_string(values.size()) + " are to replace them");
  }
  const auto owned = std::make_shared<const std::vector<double>>(std::move(values));
  Column& column = *std::ranges::find(columns_, name, &Column::name);
  column.values = *owned;
  column.owner = owned;
  return *this;
}

Record& Record::map(std::function<void(std::size_t first, std::size_t last)> release) {
  release_ = std::move(release);
  return *this;
}

bool Record::has(std::string_view name) const {
  return std::ranges::find(columns_, name, &Column::name) != columns_.end();
}

std::span<const double> Record::column(std::string_view name) const {
  const auto found = std::ranges::find(columns_, name, &Column::name);
  if (found != columns_.end()) return found->values;
  std::string list;
  for (const Column& column : columns_) list += (list.empty() ? "" : ", ") + column.name;
  throw Error("column '" + std::string(name) +
              "' is missing; the record has: " + (list.empty() ? "none" : list));
}

std::vector<std::string> Record::names() const {
  std::vector<std::string> names;
  names.reserve(columns_.size());
  for (const Column& column : columns_) names.push_back(column.name);
  return names;
}

std::size_t Record::rows() const {
  std::size_t rows = 0;
  for (const Segment& segment : segments_) rows += segment.rows();
  return rows;
}

Record& Record::cut(std::vector<Segment> segments) {
  std::size_t end = 0;
  for (const Segment& segment : segments) {
    const auto fail = [&segment](const std::string& what) {
      throw Error("segment '" + segment.label + "', rows " + std::to_string(segment.first) +
                  " to " + std::to_string(segment.last) + ", " + what);
    };
    if (segment.first >= segment.last) fail("is empty: its last row must be past its first");
    if (segment.first < end) fail("overlaps or precedes the one before it");
    if (segment.last > length_) {
      fail("leaves the record, which has " + std::to_string(length_) + " rows");
    }
    end = segment.last;
  }
  segments_ = std::move(segments);
  return *this;
}

}  // namespace sepcal
