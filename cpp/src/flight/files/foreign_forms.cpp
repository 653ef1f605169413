// SPDX-License-Identifier: BSD-3-Clause
#include "flight/files/foreign_forms.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdint>

#include "base/escaping.hpp"

namespace sepcal::files {
namespace {

using namespace std::string_view_literals;

struct Opening {
  std::string_view bytes;
  const char* form;
};

constexpr std::array openings{
    Opening{"\xa3\x95"sv, "DataFlash"},
    Opening{"FMT, "sv, "DataFlash"},
    Opening{"ULog"sv, "ULog"},
    Opening{"PAR1"sv, "Parquet"},
    Opening{"ARROW1"sv, "Arrow"},
    Opening{"FEA1"sv, "Feather of version 1"},
    Opening{"\xff\xff\xff\xff"sv, "Arrow stream"},
    Opening{"\x89HDF\r\n\x1a\n"sv, "HDF5"},
    Opening{"MATLAB "sv, "MATLAB"},
    Opening{"PK\x03\x04"sv, "Excel or zip"},
    Opening{"\xd0\xcf\x11\xe0"sv, "old Excel"},
    Opening{"\x89MCAP0\r\n"sv, "MCAP"},
    Opening{"CDF\x01"sv, "classic netCDF"},
    Opening{"CDF\x02"sv, "classic netCDF"},
    Opening{"CDF\x05"sv, "classic netCDF"},
    Opening{"BZh"sv, "bzip2"},
    Opening{"\xfd\x37zXZ"sv, "xz"},
    Opening{"SQLite format 3"sv, "SQLite"},
};

constexpr const char* matlab_4 = "MATLAB 4";

/// What makes a file that is read of one that the Python package does not read either.
struct WayOut {
  std::string_view form;
  const char* way;
};

constexpr std::array ways_out{
    WayOut{"classic netCDF",
           "write it as netCDF-4, which sepcal's Python package reads: nccopy -k "
           "netCDF-4 OLD.nc NEW.nc"},
    WayOut{matlab_4,
           "load it in MATLAB and save it anew, which sepcal's Python package reads: "
           "save('log.mat', '-v7')"},
    WayOut{"Feather of version 1", "write it anew, which makes version 2"},
    WayOut{"old Excel", "save it as CSV or .xlsx"},
    WayOut{"bzip2", "unpack it: bunzip2"},
    WayOut{"xz", "unpack it: unxz"},
    WayOut{"SQLite", "write the table as CSV"},
};

/// The four bytes at `at` as an integer.
std::uint32_t integer_at(std::string_view bytes, std::size_t at, bool big_endian) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    const std::size_t from = big_endian ? at + i : at + 3 - i;
    value = value << 8U | static_cast<unsigned char>(bytes[from]);
  }
  return value;
}

/// Version 4 has no magic number. Five integers: the kind of the first matrix, 10 P + T and in the
/// thousands the machine, its sizes, whether it is complex, its name's length with the NUL behind
/// it; then the name (MAT-File Format, version 4).
bool is_matlab_4(std::string_view bytes) {
  constexpr std::size_t head = 20;
  constexpr std::uint32_t longest_name = 64;
  constexpr std::uint32_t kinds = 60;  // P to 5
  constexpr std::uint32_t sparse = 2;  // the highest T
  if (bytes.size() <= head) return false;
  for (const bool big_endian : {false, true}) {
    const std::uint32_t machine = big_endian ? 1000 : 0;
    const std::uint32_t kind = integer_at(bytes, 0, big_endian);
    const std::uint32_t is_complex = integer_at(bytes, 12, big_endian);
    const std::uint32_t length = integer_at(bytes, 16, big_endian);
    if (kind < machine || kind >= machine + kinds || kind % 10 > sparse || is_complex > 1 ||
        length < 2 || length > longest_name || bytes.size() < head + length) {
      continue;
    }
    const std::string_view name = bytes.substr(head, length - 1);
    const auto is_of_name = [](unsigned char c) { return std::isalnum(c) != 0 || c == '_'; };
    const bool is_name = std::isalpha(static_cast<unsigned char>(name.front())) != 0 &&
                         std::ranges::all_of(name, is_of_name);
    if (is_name && bytes[head + length - 1] == '\0') return true;
  }
  return false;
}

bool is_upper_or_digit(char c) { return (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9'); }

/// A recorder's name, AXXX..., and then header records H (FAI technical specification of IGC
/// files).
bool is_igc(std::string_view text) {
  const std::size_t end = text.find('\n');
  return text.starts_with('A') && end != std::string_view::npos && end >= 4 &&
         std::ranges::all_of(text.substr(1, 3), is_upper_or_digit) &&
         (text.substr(end + 1).starts_with('H') || text.find("\nHFDTE") != std::string_view::npos);
}

/// "$GPRMC,": a sentence of NMEA 0183, of a talker and a kind in five letters.
bool is_nmea(std::string_view text) {
  return text.size() > 6 && text.front() == '$' && text[6] == ',' &&
         std::ranges::all_of(text.substr(1, 5), is_upper_or_digit);
}

bool is_autopilots(const std::string& form) { return form == "DataFlash" || form == "ULog"; }

std::string describe_foreign(const std::string& file, const std::string& form) {
  if (is_autopilots(form)) {
    return fmt::format(
        "{} line 1: this is an autopilot's log ({}), no CSV file; convert it: "
        "python -m sepcal log {} -o flight.csv",
        file, form, file);
  }
  const auto* const known = std::ranges::find(ways_out, form, &WayOut::form);
  if (known != ways_out.end()) {
    return fmt::format("{}: this is a file of another form ({}), no CSV file; {}", file, form,
                       known->way);
  }
  return fmt::format(
      "{}: this is a file of another form ({}), no CSV file; sepcal's Python package "
      "reads it: sepcal.read(\"{}\")",
      file, form, file);
}

}  // namespace

std::optional<std::string> find_foreign_form(std::string_view first_bytes) {
  const auto known = std::ranges::find_if(
      openings, [&](const Opening& opening) { return first_bytes.starts_with(opening.bytes); });
  if (known != openings.end()) return known->form;
  if (is_igc(first_bytes)) return "IGC";
  if (is_nmea(first_bytes)) return "NMEA";
  if (is_matlab_4(first_bytes)) return matlab_4;
  return std::nullopt;
}

ForeignFile::ForeignFile(const std::string& file, std::string form)
    : Error(describe_foreign(file, form)), form_(std::move(form)) {}

}  // namespace sepcal::files
