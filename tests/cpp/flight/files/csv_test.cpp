// SPDX-License-Identifier: BSD-3-Clause
// The reader of text tables: what it takes and says of it, and one clear line for what it refuses.
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
using namespace std::string_literals;
using namespace std::string_view_literals;

namespace {

using Lines = std::vector<std::string>;
using Rows = std::vector<Lines>;
using Numbers = std::vector<std::vector<std::optional<double>>>;

Rows read_rows(std::string_view bytes) {
  const TemporaryFolder folder;
  CsvReader reader(folder.write(bytes));
  Rows rows{reader.header()};
  while (reader.next()) rows.emplace_back(reader.cells().begin(), reader.cells().end());
  return rows;
}

Numbers numbers_of(std::string_view bytes, const sepcal::CsvForm& form = {}) {
  const TemporaryFolder folder;
  CsvReader reader(folder.write(bytes), {}, form);
  Numbers rows;
  while (reader.next()) {
    rows.emplace_back();
    for (std::size_t i = 0; i < reader.header().size(); ++i) {
      rows.back().push_back(reader.number(i));
    }
  }
  return rows;
}

Lines notes_of(std::string_view bytes) {
  const TemporaryFolder folder;
  CsvReader reader(folder.write(bytes));
  while (reader.next()) {
  }
  return reader.notes();
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
  CHECK(refuse(",,\n,,\n") == "flight.csv: no column has a name or a value; is this a CSV file?");
  CHECK(refuse("a,b\n") == "flight.csv: there is a header, but no row of data below it");
  CHECK(refuse("a,b\n\n\n") == "flight.csv: there is a header, but no row of data below it");
}

TEST_CASE("binary files name the byte") {
  CHECK(refuse("a,b\n1,\0"
               "2\n"sv) ==
        "flight.csv line 2: byte 0x00 (byte 6 of the file) is no "
        "text; is this a CSV file?");
  CHECK(refuse("\x1A\x8B\x08\n") ==
        "flight.csv line 1: byte 0x1a (byte 0 of the file) is no text; is this a CSV file?");
  CHECK_MESSAGE(refuse("a,b\n1,2\x7F\n").find("0x7f (byte 7") != std::string::npos, "delete");
  const std::string one_line(3'000'000, '7');
  CHECK(refuse(one_line) == "flight.csv line 1: is longer than 1 MiB; is this a CSV file?");
  CHECK(refuse("a\n1\r2\r3\n") ==
        "flight.csv line 2: a carriage return inside the line; end lines "
        "with LF or CRLF");
}

TEST_CASE("forms that nobody reads are named with the way out") {
  for (const auto bytes : {"CDF\x01\0\0\0\0\0\0\0\x0a"sv, "CDF\x02\0\0\0\0\0\0\0\x0a"sv}) {
    CHECK(refuse(bytes) ==
          "flight.csv: this is a file of another form (classic netCDF), no CSV file; write it as "
          "netCDF-4, which sepcal's Python package reads: nccopy -k netCDF-4 OLD.nc NEW.nc");
  }
  // By the format's table: kind, rows, columns, complex or not, the name's length, the name.
  const std::string little = "\0\0\0\0\x05\0\0\0\x01\0\0\0\0\0\0\0\x07\0\0\0time_s\0"s;
  const std::string big = "\0\0\x03\xe8\0\0\0\x05\0\0\0\x01\0\0\0\0\0\0\0\x07time_s\0"s;
  for (const std::string& head : {little, big}) {
    CHECK(refuse(head + std::string(40, '\0')) ==
          "flight.csv: this is a file of another form (MATLAB 4), no CSV file; load it in MATLAB "
          "and save it anew, which sepcal's Python package reads: save('log.mat', '-v7')");
  }
  CHECK(refuse("BZh91AY&SY") ==
        "flight.csv: this is a file of another form (bzip2), no CSV file; unpack it: bunzip2");
}

TEST_CASE("UTF-8 is taken as it is, other bytes for Windows-1252") {
  CHECK(read_rows("a,b\n\xC2\xB5T,\xE2\x82\xAC\xF0\x9F\x9B\xA9\n") ==
        Rows{{"a", "b"}, {"\xC2\xB5T", "\xE2\x82\xAC\xF0\x9F\x9B\xA9"}});
  CHECK(read_rows("Kurs \xB0,\x80\n1,2\n") == Rows{{"Kurs \xC2\xB0", "\xE2\x82\xAC"}, {"1", "2"}});
  CHECK(notes_of("Kurs \xB0,b\n1,2\n") == Lines{"the text is not UTF-8: taken for Windows-1252"});
}

TEST_CASE("a plain table leaves nothing to say") {
  CHECK(notes_of("a,b\n1,2\n3,4\n").empty());
  CHECK(notes_of("a,b\r\n1,\r\n3,4").empty());
  CHECK(notes_of("a,b\nx,y\nx,y\n").empty());
}

TEST_CASE("other delimiters, and decimal commas") {
  CHECK(read_rows("a;b;c\n1,5;2;3\n") == Rows{{"a", "b", "c"}, {"1,5", "2", "3"}});
  CHECK(numbers_of("a;b\n1,5;-2e1\n") == Numbers{{1.5, -20.0}});
  CHECK(notes_of("a;b\n1,5;2\n") ==
        Lines{"semicolons part the columns", "a comma is the decimal mark"});
  CHECK(numbers_of("a\tb\n1\t\n") == Numbers{{1.0, {}}});
  CHECK(numbers_of("  a   b \n  1  -2\n 3   4 \n") == Numbers{{1.0, -2.0}, {3.0, 4.0}});
  CHECK(numbers_of("| a | b |\n|---|---|\n| 1 | 2 |\n") == Numbers{{1.0, 2.0}});
  CHECK(numbers_of("a,b\n\"1,5\",\"2,25\"\n") == Numbers{{1.5, 2.25}});
}

TEST_CASE("thousands, and what may be either") {
  CHECK(numbers_of("a;b\n1.234,5;2\n") == Numbers{{1234.5, 2.0}});
  CHECK(numbers_of("a;b\n1'234.5;2\n") == Numbers{{1234.5, 2.0}});
  CHECK(numbers_of("a;b\n1\xE2\x80\x99"
                   "234.5;2\n") == Numbers{{1234.5, 2.0}});
  CHECK(numbers_of("a;b\n-1\xE2\x80\x99"
                   "234\xE2\x80\x99"
                   "567.5;2\n12;3\n") == Numbers{{-1234567.5, 2.0}, {12.0, 3.0}});
  CHECK(numbers_of("a;b\n1\x92"
                   "234.5;2\n") == Numbers{{1234.5, 2.0}});  // in Windows-1252
  CHECK(numbers_of("a;b\n1\xE2\x80\x99"
                   "23;2\n") == Numbers{{{}, 2.0}});
  CHECK(numbers_of("a;b\n1 234,5;2\n") == Numbers{{1234.5, 2.0}});
  CHECK(numbers_of("a;b\n\"1,234.5\";2\n") == Numbers{{1234.5, 2.0}});
  CHECK(numbers_of("a;b\n1,234;0,5\n") == Numbers{{1.234, 0.5}});
  CHECK(refuse("a;b\n1,234;2\n") ==
        "flight.csv: '1,234' is a number with decimals or with thousands: say decimal ',' or "
        "decimal '.'");
  CHECK(numbers_of("a;b\n1,234;2\n", {.decimal = ","}) == Numbers{{1.234, 2.0}});
  CHECK(numbers_of("a;b\n1,234;2\n", {.decimal = "."}) == Numbers{{1234.0, 2.0}});
  // Files are put together from sources that differ: what a column shows holds for it.
  CHECK(numbers_of("a;b;c\n0,1;27.65;1.600,0\n0,2;27.69;1.600,5\n") ==
        Numbers{{0.1, 27.65, 1600.0}, {0.2, 27.69, 1600.5}});
  CHECK(numbers_of("a;b\n1.5;2.000,5\n") == Numbers{{1.5, 2000.5}});
  CHECK(refuse("a;b\n1.500;2,5\n") ==
        "flight.csv: '1.500' is a number with decimals or with thousands: say decimal ',' or "
        "decimal '.'");
  CHECK(numbers_of("a;b\n1.500;2,5\n", {.decimal = "."}) == Numbers{{1.5, 2.5}});
  CHECK(numbers_of("a;b\n1.500;2,5\n", {.decimal = ","}) == Numbers{{1500.0, 2.5}});
  // What does not stand in threes is no number: 27.65 is not 2765.
  CHECK(numbers_of("a;b\n1.234,5;2\n27.65;2\n") == Numbers{{1234.5, 2.0}, {{}, 2.0}});
  CHECK(numbers_of("a\n\xE2\x88\x92"
                   "1.5\n2\n") == Numbers{{-1.5}, {2.0}});
}

/// A file of three variables as the standard's example has one: a scale, flags of readings that are
/// missing and below the limit.
const char* const icartt =
    "19, 1001, V02_2016\n"
    "Doe, Jane\n"
    "An institute\n"
    "Air data of a \"test aircraft\n"
    "A MISSION\n"
    "1, 1\n"
    "2024, 05, 04, 2024, 06, 01\n"
    "1.0\n"
    "Time_Start, seconds, Time_Start, seconds from midnight UTC\n"
    "3\n"
    "1, 1, 0.1\n"
    "-9999, -9999, -99999\n"
    "TAS, m/s, Platform_AirSpeed\n"
    "alt, m\n"
    "press, hPa, Met_StaticPressure\n"
    "0\n"
    "1\n"
    "LLOD_FLAG: -8888\n"
    "Time_Start, TAS, alt, press\n"
    "43200, 101.5, 1200, 9000\n"
    "43201, -9999, 1201, 9001\n"
    "43202, 102.5, -8888, -99999\n";

TEST_CASE("ICARTT") {
  CHECK(read_rows(icartt)[0] == Lines{"time_s", "TAS (m/s)", "alt (m)", "press (hPa)"});
  CHECK(numbers_of(icartt) == Numbers{{43200.0, 101.5, 1200.0, 900.0},
                                      {43201.0, {}, 1201.0, 0.1 * 9001},
                                      {43202.0, 102.5, {}, {}}});
  CHECK(notes_of(icartt) ==
        Lines{"ICARTT: the 19 lines of the head give names and units, and which numbers are "
              "missing ones",
              "time is from 'Time_Start', in seconds"});
  const TemporaryFolder folder;
  CsvReader reader(folder.write(icartt));
  CHECK(reader.text() == "Time_Start (seconds),TAS (m/s),alt (m),press (hPa)");
  while (reader.next()) {
    if (reader.line() == 22) CHECK(reader.text() == "43202,102.5,,");
  }
  // A head that is not whole is lines above the rows.
  CHECK(read_rows("3, 1001\nx\na,b\n1,2\n3,4\n")[0] == Lines{"a", "b"});
}

TEST_CASE("lines above the rows") {
  CHECK(read_rows("# Logger\nsn 7\na,b\n1,2\n") == Rows{{"a", "b"}, {"1", "2"}});
  CHECK(notes_of("# Logger\nsn 7\na,b\n1,2\n") == Lines{"2 lines above the rows are left out"});
  CHECK(read_rows("sep=;\na;b\n1;2\n") == Rows{{"a", "b"}, {"1", "2"}});
  CHECK(read_rows("# a b\n1 2\n3 4\n") == Rows{{"a", "b"}, {"1", "2"}, {"3", "4"}});
  CHECK(read_rows("vn,t\nm/s,s\n1,2\n") == Rows{{"vn (m/s)", "time_s"}, {"1", "2"}});
  CHECK(read_rows("bx by t\n  (nt)\n1 2 3\n4 5 6\n").front() == Lines{"bx", "by", "t"});
  CHECK(read_rows("#m/s,degrees\nvn,track\n1,2\n") ==
        Rows{{"vn (m/s)", "track (degrees)"}, {"1", "2"}});
  // A data logger's four lines (Campbell Scientific, TOA5).
  CHECK(read_rows("\"TOA5\",\"CR1000\"\n\"n\",\"vn\"\n\"RN\",\"m/s\"\n\"\",\"Smp\"\n1,2\n2,3\n") ==
        Rows{{"n (RN)", "vn (m/s)"}, {"1", "2"}, {"2", "3"}});
  CHECK(read_rows("1,2\n3,4\n") == Rows{{"column_1", "column_2"}, {"1", "2"}, {"3", "4"}});
  CHECK(read_rows("\n\na,b\n\n1,2\n") == Rows{{"a", "b"}, {"1", "2"}});
}

TEST_CASE("columns that number rows, have no name or one name") {
  CHECK(read_rows(",a\n0,5\n1,6\n") == Rows{{"a"}, {"5"}, {"6"}});
  CHECK(read_rows("a b\n\"1\" 5 6\n\"2\" 7 8\n") == Rows{{"a", "b"}, {"5", "6"}, {"7", "8"}});
  CHECK(read_rows("a,b\n1,2,\n3,4,\n") == Rows{{"a", "b"}, {"1", "2"}, {"3", "4"}});
  CHECK(read_rows("a,b,\n1,2,\n3,4,\n") == Rows{{"a", "b"}, {"1", "2"}, {"3", "4"}});
  CHECK(read_rows("a,,b\n1,2,3\n") == Rows{{"a", "column_2", "b"}, {"1", "2", "3"}});
  CHECK(read_rows("a,b,a\n1,2,3\n") == Rows{{"a.1", "b", "a.2"}, {"1", "2", "3"}});
  CHECK(notes_of("a,b,a\n1,2,3\n") == Lines{"column 'a' is there twice: the first is a.1"});
  CHECK(read_rows("\"a\tb\",c\n1,2\n") == Rows{{"a\tb", "c"}, {"1", "2"}});
}

TEST_CASE("names with digits are no numbers") {
  CHECK(read_rows("T1,T2,q0,Ax1\n1,2,3,4\n5,6,7,8\n").front() == Lines{"T1", "T2", "q0", "Ax1"});
  CHECK(read_rows("Flight 7;;\nx;y;z\n1;2;3\n").front() == Lines{"x", "y", "z"});
  CHECK(read_rows("Logger,XY,v1\nvn_mps,b2,c2\n1,2,3\n").front() == Lines{"vn_mps", "b2", "c2"});
}

TEST_CASE("a table of other numbers above the log") {
  CHECK(read_rows("id,gain\n1,2\n2,3\n\ntime_s,vn_mps\n0,1\n0.5,2\n") ==
        Rows{{"time_s", "vn_mps"}, {"0", "1"}, {"0.5", "2"}});
  std::string bytes;
  for (int i = 0; i < 30; ++i) bytes += "PARAM_" + std::to_string(i) + ",0.7\n";
  bytes += "time_s,vn_mps,ve_mps\n";
  for (int i = 0; i < 30; ++i) bytes += std::to_string(i) + ",1,2\n";
  CHECK(read_rows(bytes).front() == Lines{"time_s", "vn_mps", "ve_mps"});
  CHECK(read_rows(bytes).size() == 31);
}

TEST_CASE("a header of one name less is nobody's") {
  CHECK(read_rows("a,b\n5.5,1,2\n7.5,3,4\n").front() == Lines{"column_1", "column_2", "column_3"});
}

TEST_CASE("exponents of Fortran") {
  CHECK(numbers_of("a,b\n1.5D+02,2.d-1\n1D0,3\n") == Numbers{{150.0, 0.2}, {1.0, 3.0}});
}

TEST_CASE("a unit in each cell") {
  CHECK(read_rows("v,n\n14.2 m/s,1\n15 m/s,2\n").front() == Lines{"v (m/s)", "n"});
  CHECK(numbers_of("v,n\n14.2 m/s,1\n15 m/s,2\n") == Numbers{{14.2, 1.0}, {15.0, 2.0}});
}

TEST_CASE("units that differ from cell to cell") {
  const std::string table = "a,ias\n1,12 kt\n2,10 m/s\n3,14 kt\n";
  CHECK(read_rows(table)[0] == Lines{"a", "ias (kt)"});
  CHECK(numbers_of(table) == Numbers{{1.0, 12.0}, {2.0, {}}, {3.0, 14.0}});
  CHECK(notes_of(table) ==
        Lines{"cells of ias are in kt and others in m/s: those in kt alone are read; convert the "
              "rest",
              "the cells of ias name their unit"});
}

TEST_CASE("a line of units that contradicts a header") {
  const std::string table = "time_s,ias_kt,alt_ft\ns,m/s,feet\n0,12,3\n1,13,3\n2,12,3\n";
  CHECK(read_rows(table)[0] == Lines{"time_s", "ias_kt", "alt_ft"});
  CHECK(notes_of(table) ==
        Lines{"line 2 gives units",
              "the header ias_kt and the line of units, m/s, say different units: the header "
              "holds"});
  CHECK(notes_of("time_s,IAS [kt],p_radps,vn_mps\ns,kts,rad/s,m/s\n0,1,2,3\n1,2,3,4\n") ==
        Lines{"line 2 gives units"});
}

TEST_CASE("lines that are no rows") {
  CHECK(read_rows("a,b\n1,2\n\n3,4\n") == Rows{{"a", "b"}, {"1", "2"}, {"3", "4"}});
  CHECK(notes_of("a,b\n1,2\n\n3,4\n") == Lines{"line 3 is blank and is passed"});
  CHECK(notes_of("a,b\n1,2\n\n\n").empty());
  CHECK(notes_of("a,b\n1,2\n# pause\nend of log\n") ==
        Lines{"2 lines are no rows and are passed, the first is line 3"});
  CHECK(read_rows("a,b\n1,2\na,b\n3,4\n") == Rows{{"a", "b"}, {"1", "2"}, {"3", "4"}});
  CHECK(notes_of("a,b\n1,2\na,b\n3,4\n") == Lines{"line 3 is the header once more and is passed"});
}

TEST_CASE("a row of another length has no values") {
  CHECK(numbers_of("a,b,c\n1,2,3\n1,2\n4,5,6\n") ==
        Numbers{{1.0, 2.0, 3.0}, {{}, {}, {}}, {4.0, 5.0, 6.0}});
  CHECK(numbers_of("a,b\n1,2\n1,2,3\n3,4\n") == Numbers{{1.0, 2.0}, {{}, {}}, {3.0, 4.0}});
}

TEST_CASE("the end of a log that was cut") {
  CHECK(numbers_of("a,b\n1,2.50\n3,4.75\n5,") == Numbers{{1.0, 2.5}, {3.0, 4.75}});
  CHECK(numbers_of("a,b\n1,2.50\n3,4.75\n5,6.2") == Numbers{{1.0, 2.5}, {3.0, 4.75}});
  CHECK(numbers_of("a,b\n1,2.50\n3,4.75\n5,6.25") == Numbers{{1.0, 2.5}, {3.0, 4.75}, {5.0, 6.25}});
  CHECK(notes_of("a,b\n1,2\n3") == Lines{"line 3, the last, breaks off and is left out"});
  CHECK(read_rows("a,b\n1,2\n\0\0\0"sv) == Rows{{"a", "b"}, {"1", "2"}});
  CHECK(notes_of("a,b\n1,2\n\0\0\0"sv) == Lines{"the file ends with 3 NUL bytes"});
}

TEST_CASE("UTF-16 and the line ends of old") {
  CHECK(read_rows("\xFF\xFE"
                  "a\0,\0b\0\n\0"
                  "1\0,\0\xAC\x20\n\0"sv) == Rows{{"a", "b"}, {"1", "\xE2\x82\xAC"}});
  CHECK(read_rows("\xFE\xFF\0a\0,\0b\0\n\0"
                  "1\0,\0"
                  "2\0\n"sv) == Rows{{"a", "b"}, {"1", "2"}});
  CHECK(read_rows("a\0,\0b\0b\0,\0c\0\n\0"
                  "1\0,\0"
                  "2\0,\0"
                  "3\0\n\0"sv) == Rows{{"a", "bb", "c"}, {"1", "2", "3"}});
  CHECK(read_rows("a,b\r1,2\r3,4\r") == Rows{{"a", "b"}, {"1", "2"}, {"3", "4"}});
  CHECK(read_rows("a,b\r\r\n1,2\r\r\n") == Rows{{"a", "b"}, {"1", "2"}});
}

TEST_CASE("time in text") {
  const auto seconds = [](const std::string& header, const std::vector<std::string>& stamps) {
    std::string bytes = header + ";x\n";
    for (const std::string& stamp : stamps) bytes += stamp + ";1\n";
    std::vector<double> times;
    for (const auto& row : numbers_of(bytes)) times.push_back(row[0].value_or(-1.0));
    return times;
  };
  using Times = std::vector<double>;
  CHECK(seconds("time", {"10:00:00.25", "10:00:00.5"}) == Times{36000.25, 36000.5});
  CHECK(seconds("Clock", {"23:59:59.5", "0:00:00.5"}) == Times{86399.5, 86400.5});
  CHECK(seconds("t", {"1:00:00 PM", "1:00:01 PM"}) == Times{46800.0, 46801.0});
  CHECK(seconds("t", {"12:34.5", "12:35.5"}) == Times{754.5, 755.5});
  CHECK(seconds("when", {"2024-05-03T10:00:00.2Z", "2024-05-04T00:00:00Z"}) ==
        Times{36000.2, 86400.0});
  CHECK(seconds("when", {"2024-05-03 10:00:00+02:00", "2024-05-03 10:00:01+02:00"}) ==
        Times{28800.0, 28801.0});
  CHECK(seconds("when", {"20240503T100000.5", "20240503T100001"}) == Times{36000.5, 36001.0});
  CHECK(seconds("when", {"03-May-2024 10:00:00", "04-May-2024 00:00:01"}) ==
        Times{36000.0, 86401.0});
  CHECK(seconds("when", {"13.05.2024 10:00:00", "14.05.2024 00:00:00"}) == Times{36000.0, 86400.0});
  CHECK(seconds("when", {"5/13/2024 10:00:00 AM", "5/13/2024 1:00:00 PM"}) ==
        Times{36000.0, 46800.0});
  // A day or a month first: the time of day is enough, midnight included.
  CHECK(seconds("when", {"03/05/2024 23:59:59", "04/05/2024 00:00:01"}) == Times{86399.0, 86401.0});
  CHECK(seconds("when", {"20240513100000.5", "20240513100001.5"}) == Times{36000.5, 36001.5});
  CHECK(seconds("t", {"134:10:00:00.25", "134:10:00:00.50"})[1] == 133 * 86400.0 + 36000.5);
  CHECK(seconds("t", {"10:00:00:250", "10:00:00:500"}) == Times{36000.25, 36000.5});
  CHECK(seconds("JulianDate", {"2460443.916667", "2460443.916678"})[0] ==
        doctest::Approx(36000.0).epsilon(1e-5));
  CHECK(seconds("stamp", {"133592040000000000", "133592040010000000"})[0] == 36000.0);
  std::vector<std::string> packed;
  for (int k = 0; k < 12; ++k) packed.push_back(std::to_string(105850 + (k < 10 ? k : k + 40)));
  CHECK(seconds("t", packed)[9] == 39539.0);   // 10:58:59
  CHECK(seconds("t", packed)[10] == 39540.0);  // 10:59:00
  packed[3] = "105860";
  CHECK(seconds("t", packed)[9] == 105859.0);
  CHECK(seconds("timestamp", {"1714730400.25", "1714730401.25"}) == Times{36000.25, 36001.25});
  CHECK(seconds("timestamp", {"1714730400250", "1714730401250"}) == Times{36000.25, 36001.25});
  CHECK(seconds("t", {"0.0", "0.2", "0.4"}) == Times{0.0, 0.2, 0.4});
  CHECK(numbers_of("Date,Time,x\n2024-05-03,23:59:59,1\n2024-05-04,00:00:01,2\n") ==
        Numbers{{{}, 86399.0, 1.0}, {{}, 86401.0, 2.0}});
  CHECK(read_rows("Date,Time,x\n2024-05-03,23:59:59,1\n").front() == Lines{"Date", "time_s", "x"});
  CHECK(read_rows("Elapsed Time (min),x\n0.1,1\n0.2,2\n").front() == Lines{"time_min", "x"});
  CHECK(read_rows("millis,x\n100,1\n200,2\n").front() == Lines{"time_ms", "x"});
  CHECK(read_rows("Zeit [s],x\n1,1\n2,2\n").front() == Lines{"time_s", "x"});
  // Seconds of a day are no days, and hours no seconds.
  CHECK(numbers_of("time,x\n43500.0,1\n43500.1,2\n") == Numbers{{43500.0, 1.0}, {43500.1, 2.0}});
  CHECK(seconds("datenum", {"739375.416666667", "739375.416678241"})[1] ==
        doctest::Approx(36001.0).epsilon(1e-7));
  CHECK(read_rows("time,x\n10.50000,1\n10.50003,2\n").front() == Lines{"time", "x"});
  // Which count is not known: nothing is guessed.
  CHECK(read_rows("t,x\n0,1\n200,2\n400,3\n").front() == Lines{"t", "x"});
}

TEST_CASE("clocks of points, and packed ones that say so") {
  const std::string points = "UTC,a\n10.14.30.0,1\n10.14.30.5,2\n10.15.01.25,3\n";
  CHECK(numbers_of(points) == Numbers{{36870.0, 1.0}, {36870.5, 2.0}, {36901.25, 3.0}});
  CHECK(notes_of(points) == Lines{"time is from 'UTC', a time of day, in seconds since midnight"});
  const std::string dates = "day,a\n30.04.24,1\n30.04.24,2\n";
  CHECK(read_rows(dates)[0] == Lines{"day", "a"});  // no clock
  const std::string packed = "hhmmss,a\n101430.0,1\n101430.5,2\n";
  CHECK(numbers_of(packed) == Numbers{{36870.0, 1.0}, {36870.5, 2.0}});
  CHECK(notes_of(packed) ==
        Lines{"time is from 'hhmmss', a time of day as HHMMSS, in seconds since midnight"});
}

TEST_CASE("counts since an epoch whose digits are lost") {
  std::string rows;
  for (int i = 0; i < 20; ++i) rows += "1.714781E+09," + std::to_string(i) + "\n";
  const std::string said =
      "' has lost the digits that tell its rows apart: row after row is '1.714781E+09'; have it "
      "written with all digits, as 1714781000.25";
  CHECK(refuse("Timestamp,a\n" + rows) == "flight.csv: 'Timestamp" + said);
  CHECK(refuse("time_s,a\n" + rows) == "flight.csv: 'time_s" + said);
  CHECK(read_rows("time_s,Timestamp\n0,1.714781E+09\n1,1.714781E+09\n").size() == 3);
  CHECK(read_rows("a,b\n" + rows).size() == 21);
}

TEST_CASE("gzip and Zstandard") {
  const Rows rows{{"a", "b"}, {"1", "2"}, {"3", "4"}};
  // Of "a,b\n1,2\n3,4\n": gzip -9n, of the lines in two members, and zstd.
  const auto packed =
      "\x1f\x8b\x08\x00\x00\x00\x00\x00\x02\x03\x4b\xd4\x49\xe2\x32\xd4\x31\xe2\x32\xd6\x31\xe1\x02\x00\xe5\xe9\xd6\xce\x0c\x00\x00\x00"sv;
  CHECK(read_rows(packed) == rows);
  CHECK(
      read_rows(
          "\x1f\x8b\x08\x00\x00\x00\x00\x00\x02\x03\x4b\xd4\x49\xe2\x32\xd4\x31\xe2\x02\x00\x7b\x07\x97\x0a\x08\x00\x00\x00\x1f\x8b\x08\x00\x00\x00\x00\x00\x02\x03\x33\xd6\x31\xe1\x02\x00\x3e\x2d\x72\xa9\x04\x00\x00\x00"sv) ==
      rows);
  CHECK(
      read_rows(
          "\x28\xb5\x2f\xfd\x04\x58\x61\x00\x00\x61\x2c\x62\x0a\x31\x2c\x32\x0a\x33\x2c\x34\x0a\xe1\xb3\xcb\x2e"sv) ==
      rows);
  CHECK(refuse(packed.substr(0, 20)) ==
        "flight.csv: its gzip data breaks off or is damaged; 'zcat FILE > flight.csv' unpacks what "
        "there is");
  std::string damaged(packed);
  damaged[24] ^= 0x10;
  CHECK(refuse(damaged).find("breaks off or is damaged") != std::string::npos);
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
        "ends on its line (its header has no comma; is this a CSV file?)");
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
