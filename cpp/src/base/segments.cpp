// SPDX-License-Identifier: BSD-3-Clause
// Where a record is cut into segments, and which of them a selection such as
// "wind_circle_1,510.9:530" takes.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <set>
#include <sstream>

#include "base/excerpt.hpp"
#include "base/gaps.hpp"
#include "base/segments.hpp"
#include "sepcal/detail/quantity.hpp"
#include "sepcal/error.hpp"
#include "sepcal/record.hpp"

namespace sepcal {

using namespace base;  // this room's own

namespace {

/// Seconds, both ends included.
struct Span {
  double from = 0;
  double to = 0;
};

std::string_view trim(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

std::optional<double> parse_time(std::string_view text) {
  double time = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), time);
  const bool whole = error == std::errc{} && end == text.data() + text.size();
  return whole ? std::optional(time) : std::nullopt;
}

std::optional<Span> parse_span(std::string_view text) {
  const std::size_t colon = text.find(':');
  if (colon == std::string_view::npos) return std::nullopt;
  const auto from = parse_time(trim(text.substr(0, colon)));
  const auto to = parse_time(trim(text.substr(colon + 1)));
  if (!from || !to || std::isnan(*from) || std::isnan(*to)) return std::nullopt;
  return Span{*from, *to};
}

/// The rows of `segment` whose time lies in `span`; time increases within a segment.
Segment intersect(const Segment& segment, std::span<const double> time, const Span& span) {
  const auto rows = time.subspan(segment.first, segment.rows());
  const auto first = std::ranges::lower_bound(rows, span.from) - rows.begin();
  const auto last = std::ranges::upper_bound(rows, span.to) - rows.begin();
  return {segment.label, segment.first + static_cast<std::size_t>(first),
          segment.first + static_cast<std::size_t>(last)};
}

std::string list_labels(const std::vector<Segment>& segments) {
  std::string list;
  std::set<std::string_view> listed;
  for (const Segment& segment : segments) {
    if (segment.label.empty() || !listed.insert(segment.label).second) continue;
    list += (list.empty() ? "" : ", ") + segment.label;
  }
  return list.empty() ? "none" : list;
}

/// ", within 0.02 to 119.7"; nothing where no time is recorded.
std::string describe_time(const Record& record) {
  if (!record.has("time") || record.length() == 0) return {};
  std::ostringstream text;
  text.precision(10);
  text << ", within " << record.column("time").front() << " to " << record.column("time").back();
  return text.str();
}

/// The gap of the intervals within the record's segments; without a copy where they are many.
double find_gap_within(const Record& record, std::span<const double> time) {
  constexpr std::size_t most_copied = std::size_t{1} << 20U;
  const std::size_t count = time.empty() ? 0 : record.rows() - record.segments().size();
  const auto pass = [&](const auto& visit) {
    for_each_piece(record, [&](std::size_t first, std::size_t last) {
      const bool begins = std::ranges::binary_search(record.segments(), first, {}, &Segment::first);
      for (std::size_t i = begins ? first + 1 : first; i < last; ++i) visit(time[i] - time[i - 1]);
    });
  };
  if (count > most_copied) return find_gap(count, pass);
  std::vector<double> intervals;
  if (count > 0) pass([&](double interval) { intervals.push_back(interval); });
  return find_gap(std::move(intervals));
}

/// The rows of each label, one stretch after another.
std::vector<Segment> runs_of(std::span<const std::string> labels) {
  std::vector<Segment> runs;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    if (i == 0 || labels[i] != labels[i - 1]) runs.push_back({labels[i], i, i});
    runs.back().last = i + 1;
  }
  return runs;
}

}  // namespace

Record Record::select(std::string_view selection) const {
  if (trim(selection).empty()) return *this;
  // What each item takes of each segment, by the segment's index.
  std::vector<std::vector<Segment>> taken(segments_.size());
  for (std::size_t at = 0; at <= selection.size();) {
    const std::size_t comma = std::min(selection.find(',', at), selection.size());
    const auto item = trim(selection.substr(at, comma - at));
    at = comma + 1;
    bool matched = false;
    for (std::size_t i = 0; i < segments_.size(); ++i) {
      if (item.empty() || segments_[i].label != item) continue;
      taken[i].push_back(segments_[i]);
      matched = true;
    }
    if (matched) continue;
    if (const auto span = parse_span(item)) {
      const auto time = column("time");
      for (std::size_t i = 0; i < segments_.size(); ++i) {
        const Segment part = intersect(segments_[i], time, *span);
        if (part.first >= part.last) continue;
        taken[i].push_back(part);
        matched = true;
      }
    }
    if (!matched) {
      const std::string within =
          item == trim(selection) ? "" : " in '" + std::string(selection) + "'";
      throw Error("no segment is '" + std::string(item) + "'" + within +
                  "; name a label or a span FROM:TO of time in s" + describe_time(*this) +
                  "; the labels are: " + list_labels(segments_));
    }
  }
  std::vector<Segment> selected;
  for (auto& parts : taken) {
    std::ranges::sort(parts, {}, &Segment::first);
    const std::size_t segment_begins = selected.size();
    for (const Segment& part : parts) {
      // Parts that overlap or touch are one: there is no gap between them.
      if (selected.size() > segment_begins && part.first <= selected.back().last) {
        selected.back().last = std::max(selected.back().last, part.last);
      } else {
        selected.push_back(part);
      }
    }
  }
  Record record = *this;
  record.cut(std::move(selected));
  return record;
}

std::vector<Segment> find_segments(std::span<const double> time,
                                   std::span<const std::string> labels) {
  if (!labels.empty() && labels.size() != time.size()) {
    throw Error("there are " + std::to_string(labels.size()) + " labels for " +
                std::to_string(time.size()) + " rows; give one a row or none");
  }
  Record record;
  record.view("time", time);
  return find_segments(record, runs_of(labels));
}

std::vector<Segment> base::find_segments(const Record& record, const std::vector<Segment>& labels) {
  const std::span<const double> time = record.column("time");
  for_each_piece(record, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = std::max<std::size_t>(first, 1); i < last; ++i) {
      if (time[i] > time[i - 1]) continue;
      throw Error("time does not increase at row " + std::to_string(i) +
                  " (the first is 0): sort the rows and delete repeated ones");
    }
  });
  const double gap = find_gap_within(record, time);
  std::vector<Segment> segments;
  auto label = labels.begin();
  for_each_piece(record, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      while (label != labels.end() && i >= label->last) ++label;
      const bool labelled = label != labels.end();
      if (i == 0 || time[i] - time[i - 1] > gap || (labelled && i == label->first)) {
        segments.push_back({labelled ? label->label : "", i, i});
      }
      segments.back().last = i + 1;
    }
  });
  return segments;
}

std::vector<Segment> find_runs(const Record& record) {
  const auto time = record.has("time") ? record.column("time") : std::span<const double>();
  const double gap = find_gap_within(record, time);
  std::vector<Segment> runs;
  std::size_t row = 0;
  double last = not_a_number;
  for (const Segment& segment : record.segments()) {
    const double interval = time.empty() ? not_a_number : time[segment.first] - last;
    if (!(interval > 0.0 && interval <= gap)) runs.push_back({"", row, row});
    row += segment.rows();
    runs.back().last = row;
    if (!time.empty()) last = time[segment.last - 1];
  }
  return runs;
}

}  // namespace sepcal
