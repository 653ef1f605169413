// SPDX-License-Identifier: BSD-3-Clause
// A flight: what was logged, as it was logged.
#include "sepcal/flight/flight.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "sepcal/error.hpp"
#include "temporary_folder.hpp"

namespace flight_test {

using doctest::Contains;
using sepcal::Error;
using sepcal::Flight;
using sepcal::read_csv;
using sepcal::test::TemporaryFolder;

TEST_CASE("a file's columns keep their header, order and unit") {
  const TemporaryFolder folder;
  const auto file = folder.write("time_s,maneuver,roll_deg\n0,climb,1.5\n0.5,,-2\n1,\"a, b\",+3\n");
  const Flight flight = read_csv(file);
  REQUIRE(flight.columns().size() == 2);
  CHECK(flight.columns()[0].header == "time_s");
  CHECK(flight.rows() == 3);
  const auto* roll = flight.find("roll_deg");
  REQUIRE(roll != nullptr);
  CHECK(std::vector(roll->values.begin(), roll->values.end()) == std::vector<double>{1.5, -2, 3});
  CHECK_FALSE(roll->first_text.has_value());
  CHECK(flight.find("roll") == nullptr);
  const auto labels = flight.maneuvers();
  CHECK(std::vector(labels.begin(), labels.end()) == std::vector<std::string>{"climb", "", "a, b"});
  CHECK(flight.name() == file);
  CHECK(flight.locate(0) == file + " line 2");
  CHECK(flight.list_columns() == "the file has: time_s, roll_deg, maneuver");
  // sha256sum of the same bytes (GNU coreutils).
  CHECK(flight.sha256() == "3fa2f19cdb6c3963fcb6079a648b4c720300f1d8e91653beeca5c54c21663dad");
}

TEST_CASE("text becomes NaN, and the first of it is remembered") {
  const TemporaryFolder folder;
  const Flight flight = read_csv(folder.write("a,b,c\n1,x,nan\n,y,2\nn/a,3,inf\n"));
  const auto* a = flight.find("a");
  REQUIRE(a->first_text.has_value());
  CHECK(a->first_text->row == 1);
  CHECK(a->first_text->text.empty());
  CHECK(a->values[0] == 1);
  CHECK(std::isnan(a->values[1]));
  CHECK(std::isnan(a->values[2]));
  CHECK(flight.find("b")->first_text->text == "x");
  CHECK(flight.find("b")->values[2] == 3);
  CHECK(flight.find("c")->first_text->text == "nan");
  CHECK(std::isnan(flight.find("c")->values[2]));
  CHECK(flight.maneuvers().empty());
}

TEST_CASE("arrays go in with and without a copy") {
  auto owner = std::make_shared<std::vector<double>>(std::vector<double>{1, 2});
  Flight flight;
  flight.add("time_s", {0, 1}).view("roll_rad", *owner, owner).label({"a", "b"});
  CHECK(flight.find("roll_rad")->values.data() == owner->data());
  CHECK(owner.use_count() == 2);
  CHECK(flight.rows() == 2);
  CHECK(flight.maneuvers()[1] == "b");
  CHECK(flight.sha256().empty());
  CHECK(flight.locate(0) == "flight row 0");
  CHECK(flight.list_columns() == "the flight has: time_s, roll_rad, maneuver");
  CHECK(Flight("log").locate(3) == "log row 3");
  CHECK(Flight().list_columns() == "the flight has: none");
}

TEST_CASE("a table that another process read keeps its file and its text") {
  const std::vector<double> speeds{1.0, std::nan("")};
  Flight flight("log.csv", std::string(64, 'a'));
  flight.view("vn_mps", speeds, nullptr, Flight::Cell{1, "n/a"});
  CHECK(flight.sha256() == std::string(64, 'a'));
  CHECK(flight.locate(1) == "log.csv line 3");
  CHECK(flight.list_columns() ==
        "the file has: vn_mps, and no comma in its header; is this a CSV file?");
  REQUIRE(flight.find("vn_mps")->first_text.has_value());
  CHECK(flight.find("vn_mps")->first_text->row == 1);
  CHECK(flight.find("vn_mps")->first_text->text == "n/a");
}

TEST_CASE("arrays that don't fit are refused") {
  Flight flight("log");
  flight.add("time_s", {0, 1});
  CHECK_THROWS_WITH_AS(flight.add("time_s", {0, 1}),
                       "log: column 'time_s' is there twice; rename or delete one", Error);
  CHECK_THROWS_WITH_AS(flight.add("a", {0}), "log: column 'a' has 1 values, the others have 2",
                       Error);
  CHECK_THROWS_WITH_AS(flight.add("", {0, 1}), Contains("has no name"), Error);
  CHECK_THROWS_WITH_AS(flight.add("maneuver", {0, 1}), Contains("is for labels"), Error);
  CHECK_THROWS_WITH_AS(flight.label({"a"}), Contains("'maneuver' has 1 values"), Error);
  flight.label({"a", "b"});
  CHECK_THROWS_WITH_AS(flight.label({"a", "b"}), Contains("'maneuver' is there twice"), Error);
  Flight labels_first;
  labels_first.label({"a", "b"});
  CHECK_THROWS_WITH_AS(labels_first.add("a", {1}), Contains("the others have 2"), Error);
}

TEST_CASE("a file's faults come through, and progress ends at one") {
  const TemporaryFolder folder;
  CHECK_THROWS_WITH_AS(read_csv(folder.write("a,b\n1,2\n\"3,4\n5,6\n")),
                       Contains("line 3: the quote of cell 1"), Error);
  double last = 0;
  read_csv(folder.write("a\n1\n"), [&](double fraction) { last = fraction; });
  CHECK(last == 1);
}

namespace {

/// Some MiB of rows: numbers, a text now and then, quoted cells and labels.
std::string long_log(std::size_t rows) {
  std::string bytes = "a,maneuver,b,c\n";
  for (std::size_t i = 0; i < rows; ++i) {
    const std::string number = std::to_string(1e-3 * static_cast<double>(i));
    bytes += number + (i / 1000 % 2 == 0 ? ",circle, -" : ",\"a, quoted\" ,") + number;
    bytes += i % 70'000 == 69'999 ? ",n/a\n" : ",\"0." + number.substr(0, 1) + "e-7\"\r\n";
  }
  return bytes;
}

/// What is wrong, without the folder's name before "flight.csv".
std::string refuse(const TemporaryFolder& folder, const std::string& bytes) {
  try {
    read_csv(folder.write(bytes));
  } catch (const Error& error) {
    const std::string message = error.what();
    return message.substr(message.find("flight.csv"));
  }
  return "nothing was refused";
}

/// Where line `number`, counted from 1, begins.
std::size_t find_line(const std::string& bytes, std::size_t number) {
  std::size_t at = 0;
  while (--number > 0) at = bytes.find('\n', at) + 1;
  return at;
}

}  // namespace

TEST_CASE("all threads read what a reader of rows reads, bit for bit") {
  const TemporaryFolder folder;
  constexpr std::size_t rows = 200'000;
  const std::string file = folder.write(long_log(rows));
  for (const int threads : {1, 3}) {
    const Flight flight = read_csv(file, {}, threads);
    REQUIRE(flight.rows() == rows);
    sepcal::CsvReader reader(file);
    bool same = true;
    for (std::size_t row = 0; reader.next(); ++row) {
      const auto cells = reader.cells();
      same = same && flight.maneuvers()[row] == cells[1];
      for (std::size_t i = 0; i < 3; ++i) {
        const double value = flight.columns()[i].values[row];
        const auto number = sepcal::parse_number(cells[i == 0 ? 0 : i + 1]);
        same = same && (number ? value == *number : std::isnan(value));
      }
    }
    CHECK(same);
    CHECK(flight.sha256() == reader.sha256());
    CHECK(flight.columns()[2].first_text->row == 69'999);
    CHECK(flight.columns()[2].first_text->text == "n/a");
    CHECK_FALSE(flight.columns()[0].first_text);
  }
}

TEST_CASE("a fault far down a long file has its line") {
  const TemporaryFolder folder;
  constexpr std::size_t rows = 150'000;
  const std::string bytes = long_log(rows);
  const std::size_t at = find_line(bytes, 123'457);
  const auto with = [&](const std::string& line) { return std::string(bytes).insert(at, line); };
  const sepcal::Flight broken = read_csv(folder.write(with("1,2,3\n")));
  CHECK(broken.rows() == rows + 1);
  CHECK(std::isnan(broken.columns()[0].values[123'455]));
  CHECK(broken.columns()[0].first_text->text == "3 cells in a row of 4");
  CHECK(broken.locate(123'455).ends_with("flight.csv line 123457"));
  const sepcal::Flight blank = read_csv(folder.write(with("\n")));
  CHECK(blank.rows() == rows);
  CHECK(blank.locate(123'455).ends_with("flight.csv line 123458"));
  CHECK(blank.notes().front().ends_with("line 123457 is blank and is passed"));
  CHECK(refuse(folder, with("1,x,\"2,3\n")) ==
        "flight.csv line 123457: the quote of cell 3 is never closed; a quoted cell ends on its "
        "line");
  CHECK(refuse(folder, with("1,x\x01,2,3\n")).starts_with("flight.csv line 123457: byte 0x01"));
  CHECK(refuse(folder, with(std::string(std::size_t{1} << 20U, '1') + "\n")) ==
        "flight.csv line 123457: is longer than 1 MiB; is this a CSV file?");
  CHECK(read_csv(folder.write(bytes + "\n \n\n")).rows() == rows);
}

}  // namespace flight_test
