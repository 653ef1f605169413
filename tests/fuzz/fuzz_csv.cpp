// SPDX-License-Identifier: BSD-3-Clause
// A user's log all the way from bytes to what a fit takes: CsvReader, read_csv(), and every probe's
// prepare() and read(). Whatever is accepted must agree with independent readings of the same
// bytes: OpenSSL's SHA-256 in one call, strtod().
#include <openssl/sha.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <set>
#include <vector>

#include "fuzzing.hpp"
#include "memory_file.hpp"
#include "sepcal/flight/flight.hpp"
#include "small_flights.hpp"

namespace sepcal::fuzz {
namespace {

std::string sha256_in_one_call(std::string_view bytes) {
  std::array<unsigned char, SHA256_DIGEST_LENGTH> digest{};
  SHA256(reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size(), digest.data());
  std::string text;
  for (const unsigned char byte : digest) {
    std::array<char, 3> two{};
    std::snprintf(two.data(), two.size(), "%02x", byte);
    text += two.data();
  }
  return text;
}

/// What is accepted as a number is one to strtod() too, the same to the last bit.
void check_number(const std::string& text) {
  const auto number = parse_number(text);
  if (!number) return;
  char* end = nullptr;
  const double other = std::strtod(text.c_str(), &end);
  require(end == text.c_str() + text.size(), "a number is its whole text");
  require(std::isfinite(*number) && *number == other, "a number is the one that strtod() reads");
}

/// What CsvReader gives of a file.
struct Table {
  std::vector<std::string> header;
  std::vector<std::vector<std::string>> cells;
  std::vector<std::vector<std::optional<double>>> numbers;
};

/// Refused or not, it ends within the file.
Table read_table(const std::string& file, std::string_view bytes) {
  CsvReader reader(file);
  Table table{reader.header(), {}, {}};
  require(reader.logged().size() == table.header.size(), "a column is one of the file's");
  for (const std::string& name : table.header) {
    require(!name.empty() && is_utf8(name), "a column has a name, in UTF-8");
  }
  require(std::set(table.header.begin(), table.header.end()).size() == table.header.size(),
          "a column's name is its own");
  std::size_t line = 0;
  while (reader.next()) {
    table.cells.emplace_back(reader.cells().begin(), reader.cells().end());
    require(table.cells.back().size() == table.header.size(), "a row has the header's cells");
    require(reader.line() > line, "lines are counted on");
    line = reader.line();
    table.numbers.emplace_back();
    for (std::size_t i = 0; i < table.header.size(); ++i) {
      table.numbers.back().push_back(reader.number(i));
      require(std::isfinite(table.numbers.back().back().value_or(0.0)), "a number is finite");
    }
    require(reader.text().find('\n') == std::string_view::npos, "a row's text is one line");
    for (const std::string& cell : table.cells.back()) check_number(cell);
  }
  require(!table.cells.empty(), "a file that is taken has a row");
  require(reader.sha256() == sha256_in_one_call(bytes), "the hash is SHA-256");
  for (const std::string& note : reader.notes()) require(is_utf8(note), "a note is UTF-8");
  return table;
}

/// read_csv() sees the rows that CsvReader saw.
void check_flight(const Flight& flight, const Table& table) {
  require(flight.rows() == table.cells.size(), "a flight has the file's rows");
  for (std::size_t column = 0; column < table.header.size(); ++column) {
    const bool is_label = table.header[column] == "maneuver";
    const Flight::Column* found = is_label ? nullptr : flight.find(table.header[column]);
    require((found == nullptr) == is_label, "a column is labels or numbers");
    for (std::size_t row = 0; row < flight.rows(); ++row) {
      if (is_label) continue;
      const auto number = table.numbers[row][column];
      const double value = found->values[row];
      require(number ? value == *number : std::isnan(value), "a value is the cell's number");
      require(number || (found->first_text && found->first_text->row <= row),
              "a column remembers its first text");
    }
  }
}

bool is_finite(double value) { return std::isfinite(value); }

void check_notes(const std::vector<std::string>& notes) {
  for (const std::string& note : notes) require(is_utf8(note), "a note is UTF-8");
}

void check_record(const Flight& flight, const ProbeRecord& prepared) {
  check_notes(prepared.notes);
  require(prepared.rows_used() > 0 && prepared.rows_used() <= flight.rows(), "rows used are rows");
  require(prepared.flight_rows.size() == prepared.rows_used(), "each of them is a flight's");
  require(std::ranges::is_sorted(prepared.flight_rows), "rows keep their order");
  for (const std::string& name : prepared.record.names()) {
    require(std::ranges::all_of(prepared.record.column(name), is_finite),
            "a record's values are finite");
  }
  const auto time = prepared.record.column("time");
  require(std::ranges::adjacent_find(time, std::ranges::greater_equal{}) == time.end(),
          "time increases");
  std::size_t end = 0;
  for (const Segment& segment : prepared.record.segments()) {
    require(segment.first >= end && segment.first < segment.last, "segments follow one another");
    end = segment.last;
  }
  require(end <= prepared.rows_used(), "segments end within the record");
}

void check_probe(const Probe& probe, const Flight& flight) {
  for (const bool drop_invalid : {false, true}) {
    accepts([&] { check_record(flight, probe.prepare(flight, {.drop_invalid = drop_invalid})); });
    accepts([&] {
      const ProbeReadings readings = probe.read(flight, {.drop_invalid = drop_invalid});
      check_notes(readings.notes);
      require(readings.valid.size() == flight.rows(), "every row is valid or not");
    });
  }
}

}  // namespace
}  // namespace sepcal::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace sepcal::fuzz;
  static MemoryFile file;
  const std::string_view bytes = text_of(data, size);
  file.hold(bytes);
  Table table;
  const bool taken = accepts([&] { table = read_table(file.name(), bytes); });
  const bool flown = accepts([&] {
    const sepcal::Flight flight = sepcal::read_csv(file.name());
    require(taken, "a flight is read from no file that the reader refuses");
    check_flight(flight, table);
    for (const auto& probe : probes()) check_probe(*probe, flight);
  });
  require(flown == taken, "a file that the reader takes is a flight");
  return 0;
}
