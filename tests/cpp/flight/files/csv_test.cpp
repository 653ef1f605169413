// SPDX-License-Identifier: BSD-3-Clause
// The CSV reader: what it takes, and one clear line for everything that it refuses.
#include "sepcal/flight/csv.hpp"

#include <doctest/doctest.h>

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>

#include "sepcal/error.hpp"
#include "temporary_folder.hpp"

namespace csv_test {

using doctest::Contains;
using sepcal::CsvReader;
using sepcal::Error;
using sepcal::parse_number;
using sepcal::test::TemporaryFolder;
using namespace std::string_view_literals;

namespace {

using Rows = std::vector<std::vector<std::string>>;

Rows read_rows(std::string_view bytes) {
  const TemporaryFolder folder;
  CsvReader reader(folder.write(bytes));
  Rows rows{reader.header()};
  while (reader.next()) rows.emplace_back(reader.cells().begin(), reader.cells().end());
  return rows;
}

/// What is wrong, without the folder's name before "flight.csv".
std::string refuse(std::string_view bytes) {
  try {
    read_rows(bytes);
  } catch (const Error& error) {
    const std::string message = error.what();
    return message.substr(message.find("flight.csv"));
  }
  return "nothing was refused";
}

}  // namespace

TEST_CASE("plain rows") {
  CHECK(read_rows("a,b\n1,2\n3,4\n") == Rows{{"a", "b"}, {"1", "2"}, {"3", "4"}});
  CHECK(read_rows("a\n1\n") == Rows{{"a"}, {"1"}});
}

TEST_CASE("CRLF, a byte-order mark, blanks, no last line end, blank lines at the end") {
  CHECK(read_rows("\xEF\xBB\xBF"
                  "a,b\r\n1,2\r\n") == Rows{{"a", "b"}, {"1", "2"}});
  CHECK(read_rows(" a , b\t\n 1 ,\t2 3 \n") == Rows{{"a", "b"}, {"1", "2 3"}});
  CHECK(read_rows("a,b\n1,2") == Rows{{"a", "b"}, {"1", "2"}});
  CHECK(read_rows("a,b\n1,2\n\n \r\n\t\n") == Rows{{"a", "b"}, {"1", "2"}});
  CHECK(read_rows("a,b\n,\n") == Rows{{"a", "b"}, {"", ""}});
}

TEST_CASE("quoted cells") {
  CHECK(read_rows("\"a\",b\n\"1, 2\" , \" x \"\n") == Rows{{"a", "b"}, {"1, 2", " x "}});
  CHECK(read_rows("a,b,c\n\"\"\"q\"\"\",\"r \"\"s\",\"\"\n") ==
        Rows{{"a", "b", "c"}, {"\"q\"", "r \"s", ""}});
  CHECK(read_rows("a,b\n5\" pipe,2\n") == Rows{{"a", "b"}, {"5\" pipe", "2"}});
}

TEST_CASE("lines are numbered from the header's 1, and a row's text is as it stands") {
  const TemporaryFolder folder;
  CsvReader reader(folder.write("a, b\r\n1 ,\"2\"\r\n3,4"));
  CHECK(reader.text() == "a, b");
  REQUIRE(reader.next());
  CHECK(reader.line() == 2);
  CHECK(reader.text() == "1 ,\"2\"");
  REQUIRE(reader.next());
  CHECK(reader.line() == 3);
  CHECK(reader.text() == "3,4");
  CHECK_FALSE(reader.next());
  CHECK_FALSE(reader.next());
}

TEST_CASE("rows, line numbers and the hash are right across chunks") {
  // About 9 MiB, and a row length that shares no factor with a chunk's.
  std::string bytes = "row,filling\n";
  constexpr int rows = 300'000;
  for (int i = 0; i < rows; ++i) bytes += std::to_string(i) + ",abcdefghijklmnopqrstuvw\n";
  const TemporaryFolder folder;
  std::vector<double> progress;
  CsvReader reader(folder.write(bytes), [&](double fraction) { progress.push_back(fraction); });
  std::size_t seen = 0;
  bool right = true;
  while (reader.next()) {
    right = right && reader.cells()[0] == std::to_string(seen) && reader.line() == seen + 2 &&
            reader.cells()[1] == "abcdefghijklmnopqrstuvw";
    ++seen;
  }
  CHECK(right);
  CHECK(seen == rows);
  REQUIRE(progress.size() > 2);
  CHECK(std::ranges::is_sorted(progress));
  CHECK(progress.front() < 0.5);
  CHECK(progress.back() == 1.0);
  // sha256sum of the same bytes (GNU coreutils).
  CHECK(reader.sha256() == "90c0fd9b78d0a7737c56a3b7f23603836c05b1c8b49f60d0e5490241d10e6ff2");
}

TEST_CASE("SHA-256 of the bytes, line ends and mark included") {
  const TemporaryFolder folder;
  CsvReader reader(
      folder.write("\xEF\xBB\xBF"
                   "a,b\r\n1,2\r\n"));
  while (reader.next()) {
  }
  CHECK(reader.sha256() == "12d55567496e2714a23469371b5888bb9d0fb803d52b770c7c08ced31826d2d9");
}

TEST_CASE("files that can't be read") {
  const TemporaryFolder folder;
  const auto missing = (folder.path() / "missing.csv").string();
  CHECK_THROWS_WITH_AS(CsvReader{missing}, (missing + ": no such file").c_str(), Error);
  CHECK_THROWS_WITH_AS(CsvReader{folder.path().string()}, Contains("is a folder"), Error);
  const auto below_file = folder.write("a\n1\n") + "/flight.csv";
  CHECK_THROWS_AS(CsvReader{below_file}, Error);
  // Opens, but its first byte can't be read.
  CHECK_THROWS_WITH_AS(CsvReader{"/proc/self/mem"}, Contains("can't be read: Input/output error"),
                       Error);
  if (::geteuid() != 0) {  // root may read everything
    const auto locked = folder.write("a\n1\n", "locked.csv");
    ::chmod(locked.c_str(), 0);
    CHECK_THROWS_WITH_AS(CsvReader{locked}, Contains("can't be read: Permission denied"), Error);
  }
}

TEST_CASE("files without rows") {
  CHECK(refuse("") == "flight.csv: the file is empty; its first line should name the columns");
  CHECK(refuse("a,b\n") == "flight.csv: there is a header, but no row of data below it");
  CHECK(refuse("a,b\n\n\n") == "flight.csv: there is a header, but no row of data below it");
  CHECK(refuse("\n1,2\n") ==
        "flight.csv line 1: column 1 of 1 has no name; name it or delete the "
        "column");
}

TEST_CASE("binary files name the byte") {
  CHECK(refuse("a,b\n1,\0"
               "2\n"sv) ==
        "flight.csv line 2: byte 0x00 (byte 6 of the file) is no "
        "UTF-8 text; is this a CSV file?");
  CHECK(refuse("\x1F\x8B\x08\n") ==
        "flight.csv line 1: byte 0x1f (byte 0 of the file) is no UTF-8 "
        "text; is this a CSV file?");
  CHECK(refuse("\x89PNG\r\n") ==
        "flight.csv line 1: byte 0x89 (byte 0 of the file) is no UTF-8 "
        "text; is this a CSV file?");
  CHECK_MESSAGE(refuse("a,b\n1,2\x7F\n").find("0x7f (byte 7") != std::string::npos, "delete");
  const std::string one_line(3'000'000, '7');
  CHECK(refuse(one_line) == "flight.csv line 1: is longer than 1 MiB; is this a CSV file?");
  CHECK(refuse("a\n1\r2\r3\n") ==
        "flight.csv line 2: a carriage return inside the line; end lines "
        "with LF or CRLF");
}

TEST_CASE("UTF-8 is taken, other encodings are refused") {
  CHECK(read_rows("a,b\n\xC2\xB5T,\xE2\x82\xAC\xF0\x9F\x9B\xA9\n") ==
        Rows{{"a", "b"}, {"\xC2\xB5T", "\xE2\x82\xAC\xF0\x9F\x9B\xA9"}});
  CHECK_MESSAGE(refuse("a,b\n\xB5T,1\n").find("0xb5 (byte 4") != std::string::npos, "Latin-1");
  CHECK_MESSAGE(refuse("a\n\xE2\x82\n").find("0xe2 (byte 2") != std::string::npos, "cut short");
  CHECK_MESSAGE(refuse("a\n\xE2(\xAC\n").find("0xe2 (byte 2") != std::string::npos, "broken");
  CHECK_MESSAGE(refuse("a\n\xED\xA0\x80\n").find("0xed (byte 2") != std::string::npos, "surrogate");
  CHECK_MESSAGE(refuse("a\n\xE0\x80\xAF\n").find("0xe0 (byte 2") != std::string::npos, "overlong");
  CHECK_MESSAGE(refuse("a\n\xF4\x90\x80\x80\n").find("0xf4 (byte 2") != std::string::npos,
                "above U+10FFFF");
}

TEST_CASE("a name with a tab or a line separator in it is quoted in one line") {
  CHECK(refuse("\"a\tb\",\"a\tb\",c\n1,2,3\n") ==
        "flight.csv line 1: column 'a\\tb' is there twice; rename or delete one");
  CHECK(refuse("x\xE2\x80\xA8,x\xE2\x80\xA8\n1,2\n") ==
        "flight.csv line 1: column 'x\\xe2\\x80\\xa8' is there twice; rename or delete one");
}

TEST_CASE("other separators are named") {
  CHECK_THROWS_WITH_AS(read_rows("a;b;c\n1,5;2;3\n"), Contains("separated by semicolons"), Error);
  CHECK_THROWS_WITH_AS(read_rows("a\tb\n1\t2\n"), Contains("separated by tabs"), Error);
  CHECK_THROWS_WITH_AS(read_rows("a;b\n1;2\n"), Contains("export the file with commas"), Error);
}

TEST_CASE("short and long rows") {
  CHECK(refuse("a,b,c\n1,2,3\n1,2\n") ==
        "flight.csv line 3: 2 cells, but the header has 3 columns; "
        "complete the row or delete it");
  CHECK(refuse("a,b\n1,2,3\n") ==
        "flight.csv line 2: 3 cells, but the header has 2 columns; quote "
        "a cell that holds a comma, and use a point in decimals");
  CHECK(refuse("a,b\n1,2\n\n3,4\n") ==
        "flight.csv line 3: the line is blank, and rows follow; "
        "delete it");
}

TEST_CASE("column names are there and unique") {
  CHECK(refuse("a,b,a\n1,2,3\n") ==
        "flight.csv line 1: column 'a' is there twice; rename or delete "
        "one");
  CHECK(refuse("a,,b\n1,2,3\n") ==
        "flight.csv line 1: column 2 of 3 has no name; name it or delete "
        "the column");
  CHECK(refuse("a,\n1,2\n") ==
        "flight.csv line 1: column 2 of 2 has no name; name it or delete "
        "the column");
}

TEST_CASE("quotes that don't close or don't end the cell") {
  CHECK(refuse("a,b\n1,\"2\n") ==
        "flight.csv line 2: the quote of cell 2 is never closed; a quoted "
        "cell ends on its line");
  CHECK(refuse("a,b\n\"1\"2,3\n") ==
        "flight.csv line 2: text follows the closing quote of cell 1; "
        "double a quote that belongs to the cell");
  CHECK(refuse("\"a\n1\n") ==
        "flight.csv line 1: the quote of cell 1 is never closed; a quoted cell "
        "ends on its line");
}

TEST_CASE("the hash of a file that was not read is refused") {
  const TemporaryFolder folder;
  const CsvReader reader(folder.write("a\n" + std::string(9'000'000, '\n') + "1\n"));
  CHECK_THROWS_WITH_AS(reader.sha256(), Contains("read to the end"), Error);
}

TEST_CASE("numbers are decimal, finite and whole cells") {
  CHECK(parse_number("1.5") == 1.5);
  CHECK(parse_number("+2") == 2.0);
  CHECK(parse_number("-1.25e-3") == -0.00125);
  CHECK(parse_number(".5") == 0.5);
  CHECK(parse_number("5.") == 5.0);
  CHECK(parse_number("0.1") == 0.1);
  CHECK(parse_number("5e-324") == 5e-324);
  for (const char* text :
       {"",         "+",    "-",   ".",   "+-1", "++1", "nan",   "inf",    "-inf", "NaN",
        "infinity", "0x10", "1,5", "1 2", "3m",  "1e",  "1e999", "1e-400", "one",  " 1"}) {
    CAPTURE(text);
    CHECK_FALSE(parse_number(text).has_value());
  }
}

}  // namespace csv_test
