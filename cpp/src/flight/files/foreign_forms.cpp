// SPDX-License-Identifier: BSD-3-Clause
#include "flight/files/foreign_forms.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>

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
    Opening{"FEA1"sv, "Feather"},
    Opening{"\xff\xff\xff\xff"sv, "Arrow stream"},
    Opening{"\x89HDF\r\n\x1a\n"sv, "HDF5"},
    Opening{"MATLAB "sv, "MATLAB"},
    Opening{"PK\x03\x04"sv, "Excel or zip"},
    Opening{"\xd0\xcf\x11\xe0"sv, "old Excel"},
    Opening{"\x89MCAP0\r\n"sv, "MCAP"},
    Opening{"BZh"sv, "bzip2"},
    Opening{"\xfd\x37zXZ"sv, "xz"},
    Opening{"SQLite format 3"sv, "SQLite"},
};

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

}  // namespace

std::optional<std::string> find_foreign_form(std::string_view first_bytes) {
  const auto known = std::ranges::find_if(
      openings, [&](const Opening& opening) { return first_bytes.starts_with(opening.bytes); });
  if (known != openings.end()) return known->form;
  if (is_igc(first_bytes)) return "IGC";
  if (is_nmea(first_bytes)) return "NMEA";
  return std::nullopt;
}

ForeignFile::ForeignFile(const std::string& file, std::string form)
    : Error(
          is_autopilots(form)
              ? fmt::format("{} line 1: this is an autopilot's log ({}), no CSV file; convert it: "
                            "python -m sepcal log {} -o flight.csv",
                            file, form, file)
              : fmt::format("{}: this is a file of another form ({}), no CSV file; sepcal's "
                            "Python package reads it: sepcal.read(\"{}\")",
                            file, form, file)),
      form_(std::move(form)) {}

}  // namespace sepcal::files
