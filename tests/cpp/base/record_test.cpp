// SPDX-License-Identifier: BSD-3-Clause
// The record: columns with and without a copy, segments, selections.
#include "sepcal/record.hpp"

#include <doctest/doctest.h>

#include <limits>

#include "sepcal/error.hpp"

namespace record_test {

using doctest::Contains;
using sepcal::Error;
using sepcal::find_runs;
using sepcal::find_segments;
using sepcal::Record;
using sepcal::Segment;

namespace {

/// Ten rows, one a second from 100 s: "climb", "turn", "climb" again.
Record make_record() {
  Record record;
  record.add("time", {100, 101, 102, 103, 104, 105, 106, 107, 108, 109});
  record.cut({{"climb", 0, 4}, {"turn", 4, 7}, {"climb", 7, 10}});
  return record;
}

std::string describe(const std::vector<Segment>& segments) {
  std::string text;
  for (const Segment& segment : segments) {
    text += segment.label + "[" + std::to_string(segment.first) + "," +
            std::to_string(segment.last) + ") ";
  }
  return text;
}

std::string select(std::string_view selection) {
  return describe(make_record().select(selection).segments());
}

}  // namespace

TEST_CASE("an owned column is copied in, a viewed one is not") {
  const std::vector<double> outside{1, 2, 3};
  Record record;
  record.add("a", {4, 5, 6}).view("b", outside);
  CHECK(record.column("b").data() == outside.data());
  CHECK(record.column("a")[2] == 6);
  CHECK(record.names() == std::vector<std::string>{"a", "b"});
  CHECK(record.length() == 3);
  CHECK(record.has("a"));
  CHECK_FALSE(record.has("c"));
}

TEST_CASE("a viewed column lives as long as its owner is needed") {
  auto owner = std::make_shared<std::vector<double>>(std::vector<double>{1, 2});
  const std::weak_ptr<std::vector<double>> watch = owner;
  {
    Record record;
    record.view("a", *owner, owner);
    const Record copy = record;
    owner.reset();
    CHECK(copy.column("a")[1] == 2);
    CHECK_FALSE(watch.expired());
  }
  CHECK(watch.expired());
}

TEST_CASE("columns that don't fit are refused") {
  Record record;
  record.add("a", {1, 2});
  CHECK_THROWS_WITH_AS(record.add("a", {1, 2}), Contains("'a' is in the record already"), Error);
  CHECK_THROWS_WITH_AS(record.add("b", {1}), Contains("'b' has 1 values, the others have 2"),
                       Error);
  CHECK_THROWS_WITH_AS(record.add("", {1, 2}), Contains("no name"), Error);
  CHECK_THROWS_WITH_AS(record.column("c"), "column 'c' is missing; the record has: a", Error);
  CHECK_THROWS_WITH_AS(Record().column("c"), Contains("the record has: none"), Error);
  CHECK(record.names() == std::vector<std::string>{"a"});
}

TEST_CASE("a record is one segment until it is cut") {
  Record record;
  CHECK(record.segments().empty());
  record.add("a", {1, 2, 3});
  CHECK(describe(record.segments()) == "[0,3) ");
  record.cut({{"x", 0, 1}, {"y", 2, 3}});
  CHECK(record.rows() == 2);
  CHECK(record.length() == 3);
}

TEST_CASE("impossible segments are refused") {
  Record record = make_record();
  CHECK_THROWS_WITH_AS(record.cut({{"x", 2, 2}}), Contains("'x', rows 2 to 2, is empty"), Error);
  CHECK_THROWS_WITH_AS(record.cut({{"x", 3, 2}}), Contains("is empty"), Error);
  CHECK_THROWS_WITH_AS(record.cut({{"x", 0, 5}, {"y", 4, 6}}), Contains("overlaps"), Error);
  CHECK_THROWS_WITH_AS(record.cut({{"x", 5, 6}, {"y", 0, 1}}), Contains("precedes"), Error);
  CHECK_THROWS_WITH_AS(record.cut({{"x", 0, 11}}), Contains("has 10 rows"), Error);
  CHECK(record.segments().size() == 3);
}

TEST_CASE("a selection takes labels and spans of time, both ends included") {
  CHECK(select("turn") == "turn[4,7) ");
  CHECK(select("climb") == "climb[0,4) climb[7,10) ");
  CHECK(select("101:102") == "climb[1,3) ");
  CHECK(select(" 102.5 : 105 ") == "climb[3,4) turn[4,6) ");
  CHECK(select("") == "climb[0,4) turn[4,7) climb[7,10) ");
  CHECK(select("109:200, turn") == "turn[4,7) climb[9,10) ");
}

TEST_CASE("a row that is selected twice counts once") {
  CHECK(select("turn,turn") == "turn[4,7) ");
  CHECK(select("turn,104:105") == "turn[4,7) ");
  CHECK(select("100:101,101:102") == "climb[0,3) ");
  CHECK(select("100:101,102:103") == "climb[0,4) ");
  CHECK(select("100:100,102:102") == "climb[0,1) climb[2,3) ");
  CHECK(make_record().select("100:109,climb").rows() == 10);
}

TEST_CASE("a selection copies no samples and can be narrowed") {
  const Record record = make_record();
  const Record part = record.select("climb");
  CHECK(part.column("time").data() == record.column("time").data());
  CHECK(describe(part.select("103:107").segments()) == "climb[3,4) climb[7,8) ");
}

TEST_CASE("a selection that matches nothing is an error that lists the labels") {
  CHECK_THROWS_WITH_AS(select("clmb"), Contains("'clmb'"), Error);
  CHECK_THROWS_WITH_AS(select("clmb"), Contains("the labels are: climb, turn"), Error);
  CHECK_THROWS_WITH_AS(select("turn,"), Contains("no segment is ''"), Error);
  CHECK_THROWS_WITH_AS(select("200:300"), Contains("'200:300'"), Error);
  CHECK_THROWS_WITH_AS(select("105:104"), Contains("'105:104'"), Error);
  CHECK_THROWS_WITH_AS(select("104:"), Contains("FROM:TO"), Error);
  Record untimed;
  untimed.add("a", {1, 2});
  CHECK_THROWS_WITH_AS(untimed.select("turn"), Contains("the labels are: none"), Error);
  CHECK_THROWS_WITH_AS(untimed.select("0:1"), Contains("column 'time' is missing"), Error);
}

TEST_CASE("segments end at changes of label and at gaps over five median intervals") {
  const std::vector<double> time{0, 1, 2, 3, 8, 13.5, 14.5};
  CHECK(describe(find_segments(time, {})) == "[0,5) [5,7) ");
  const std::vector<std::string> labels{"a", "a", "b", "b", "b", "b", "a"};
  CHECK(describe(find_segments(time, labels)) == "a[0,2) b[2,5) b[5,6) a[6,7) ");
}

TEST_CASE("the median of an even number of intervals is the mean of the middle two") {
  // Intervals 1, 1, 3, 9.9: the median is 2, so 9.9 is no gap; with 10.1 it is one.
  CHECK(find_segments(std::vector<double>{0, 1, 2, 5, 14.9}, {}).size() == 1);
  CHECK(find_segments(std::vector<double>{0, 1, 2, 5, 15.1}, {}).size() == 2);
}

TEST_CASE("four lost samples of a regular record are no gap, five are") {
  const auto lose = [](int lost) {
    std::vector<double> time;
    for (int i = 0; i < 100; ++i) {
      if (i <= 50 || i > 50 + lost) time.push_back(380 + 0.02 * i);
    }
    return find_segments(time, {}).size();
  };
  CHECK(lose(4) == 1);
  CHECK(lose(5) == 2);
}

TEST_CASE("short records have one segment, empty ones none") {
  CHECK(find_segments({}, {}).empty());
  CHECK(describe(find_segments(std::vector<double>{7}, {})) == "[0,1) ");
}

TEST_CASE("time must increase, and labels must be as many as rows") {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  CHECK_THROWS_WITH_AS(find_segments(std::vector<double>{0, 1, 1}, {}), Contains("row 2"), Error);
  CHECK_THROWS_WITH_AS(find_segments(std::vector<double>{0, -1}, {}), Contains("row 1"), Error);
  CHECK_THROWS_WITH_AS(find_segments(std::vector<double>{0, nan, 2}, {}), Contains("row 1"), Error);
  CHECK_THROWS_WITH_AS(find_segments(std::vector<double>{0, 1}, std::vector<std::string>{"a"}),
                       Contains("1 labels for 2 rows"), Error);
}

TEST_CASE("stamps that come in bursts are no gaps, a pause among them is one") {
  std::vector<double> time;
  double now = 0.0;
  for (int burst = 0; burst < 200; ++burst) {
    for (int row = 0; row < 4; ++row) time.push_back(now += 0.0033);
    now += 0.008 + 0.0005 * (burst % 60);  // up to 0.038 s: more than five medians
    if (burst == 120) now += 1.0;
  }
  const std::vector<Segment> segments = find_segments(time, {});
  REQUIRE(segments.size() == 2);
  CHECK(segments[0].last == 4 * 121);
}

TEST_CASE("scattered dropouts of any length stay gaps") {
  std::vector<double> time;
  double now = 0.0;
  for (int row = 0; row < 1000; ++row) {
    now += row % 100 == 99 ? 0.04 * (row / 100 + 1) : 0.01;
    time.push_back(now);
  }
  CHECK(find_segments(time, {}).size() == 10);  // from 0.08 s on: nine
}

TEST_CASE("a run goes on where a label changes and ends at a gap") {
  const auto runs = [](std::vector<double> time, std::vector<Segment> segments) {
    Record record;
    record.add("time", std::move(time)).cut(std::move(segments));
    return describe(find_runs(record));
  };
  CHECK(describe(find_runs(make_record())) == "[0,10) ");
  CHECK(runs({0, 1, 2, 3, 10, 11, 12}, {{"a", 0, 2}, {"b", 2, 4}, {"c", 4, 7}}) == "[0,4) [4,7) ");
  // Rows that nobody selected: two of them are no gap, six are one. Runs are gathered rows.
  CHECK(runs({0, 1, 2, 3, 4, 5}, {{"a", 0, 2}, {"b", 4, 6}}) == "[0,4) ");
  CHECK(runs({0, 1, 2, 3, 4, 5, 6, 7, 8, 9}, {{"a", 0, 2}, {"b", 8, 10}}) == "[0,2) [2,4) ");
  // Two logs, one behind the other: time runs back.
  CHECK(runs({0, 1, 2, 0, 1, 2}, {{"a", 0, 3}, {"b", 3, 6}}) == "[0,3) [3,6) ");
  Record timeless;
  timeless.add("u", {1, 2, 3, 4}).cut({{"a", 0, 2}, {"b", 2, 4}});
  CHECK(describe(find_runs(timeless)) == "[0,2) [2,4) ");
}

TEST_CASE("a column's values are replaced, as many") {
  Record record;
  record.add("a", {1.0, 2.0}).add("b", {3.0, 4.0});
  record.replace("a", {5.0, 6.0});
  CHECK(record.column("a")[1] == 6.0);
  CHECK(record.column("b")[1] == 4.0);
  CHECK_THROWS_WITH_AS(record.replace("c", {1.0, 2.0}), Contains("'c' is missing"), Error);
  CHECK_THROWS_WITH_AS(record.replace("a", {1.0}), Contains("has 2 values, and 1"), Error);
}

}  // namespace record_test
