// SPDX-License-Identifier: BSD-3-Clause
// A user's log all the way from bytes to what a fit takes: CsvReader, read_csv(), and every probe's
// prepare() and read(). Whatever is accepted must agree with independent readings of the same
// bytes: OpenSSL's SHA-256 in one call, strtod(), a count of line ends.
#include <openssl/sha.h>

#include <algorithm>
#include <array>
#include <cmath>
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

/// The file's rows as text. Refused or not, it ends within the file.
std::vector<std::vector<std::string>> read_rows(const std::string& file, std::string_view bytes) {
  const auto lines = static_cast<std::size_t>(std::ranges::count(bytes, '\n')) + 1;
  CsvReader reader(file);
  std::vector<std::vector<std::string>> rows{reader.header()};
  require(!reader.header().empty() && reader.line() == 1, "the header is line 1");
  for (const std::string& name : reader.header()) {
    require(!name.empty() && is_utf8(name), "a column has a name, in UTF-8");
  }
  while (reader.next()) {
    rows.emplace_back(reader.cells().begin(), reader.cells().end());
    require(rows.back().size() == reader.header().size(), "a row has the header's cells");
    require(reader.line() == rows.size() && reader.line() <= lines, "lines are counted from 1");
    require(bytes.find(reader.text()) != std::string_view::npos, "a row's text is the file's");
    for (const std::string& cell : rows.back()) check_number(cell);
  }
  require(rows.size() > 1, "a file that is taken has a row");
  require(reader.sha256() == sha256_in_one_call(bytes), "the hash is SHA-256");
  return rows;
}

/// read_csv() sees the rows that CsvReader saw.
void check_flight(const Flight& flight, const std::vector<std::vector<std::string>>& rows) {
  const std::vector<std::string>& header = rows.front();
  require(flight.rows() == rows.size() - 1, "a flight has the file's rows");
  for (std::size_t column = 0; column < header.size(); ++column) {
    const Flight::Column* found = flight.find(header[column]);
    require((found == nullptr) == (header[column] == "maneuver"), "a column is labels or numbers");
    for (std::size_t row = 0; row < flight.rows(); ++row) {
      const std::string& cell = rows[row + 1][column];
      if (found == nullptr) {
        require(flight.maneuvers()[row] == cell, "a label is the cell's text");
        continue;
      }
      const auto number = parse_number(cell);
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
  std::vector<std::vector<std::string>> rows;
  const bool taken = accepts([&] { rows = read_rows(file.name(), bytes); });
  const bool flown = accepts([&] {
    const sepcal::Flight flight = sepcal::read_csv(file.name());
    require(taken, "a flight is read from no file that the reader refuses");
    check_flight(flight, rows);
    for (const auto& probe : probes()) check_probe(*probe, flight);
  });
  require(flown == taken, "a file that the reader takes is a flight");
  return 0;
}
