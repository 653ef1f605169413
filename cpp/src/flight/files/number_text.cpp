// SPDX-License-Identifier: BSD-3-Clause
#include "flight/files/number_text.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <span>

#include "sepcal/flight/csv.hpp"

namespace sepcal::files {
namespace {

constexpr std::array<std::string_view, 2> minuses{"\xE2\x88\x92",
                                                  "\xE2\x80\x93"};  // U+2212, U+2013
constexpr std::array<std::string_view, 3> wide_blanks{"\xC2\xA0", "\xE2\x80\xAF", "\xE2\x80\x89"};
constexpr std::array<std::string_view, 2> apostrophes{"\xE2\x80\x99", "\x92"};  // Windows-1252's

bool is_digit(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; }

/// With "-" for a minus sign, " " for every blank and "'" for the Swiss mark of thousands.
std::string in_ascii(std::string_view cell) {
  const auto is_ascii = [](char c) { return static_cast<unsigned char>(c) < 0x80; };
  if (std::ranges::all_of(cell, is_ascii)) return std::string(cell);
  std::string text;
  const auto take_one_of = [&](std::span<const std::string_view> signs, char letter) {
    const auto sign =
        std::ranges::find_if(signs, [&](std::string_view each) { return cell.starts_with(each); });
    if (sign == signs.end()) return false;
    text += letter;
    cell.remove_prefix(sign->size());
    return true;
  };
  while (!cell.empty()) {
    if (take_one_of(wide_blanks, ' ') || take_one_of(minuses, '-') ||
        take_one_of(apostrophes, '\'')) {
      continue;
    }
    text += cell.front();
    cell.remove_prefix(1);
  }
  return text;
}

/// What stands between a sign and an exponent.
std::string_view mantissa_of(std::string_view text) {
  if (text.starts_with('-') || text.starts_with('+')) text.remove_prefix(1);
  return text.substr(0, text.find_first_of("eEdD"));
}

/// With an e where the exponent of Fortran stands.
std::string with_e(std::string text) {
  const std::size_t mark = text.find_first_of("dD");
  const bool is_exponent = mark != std::string::npos && mark > 0 && mark + 1 < text.size() &&
                           (is_digit(text[mark - 1]) || text[mark - 1] == '.');
  if (is_exponent) text[mark] = 'e';
  return text;
}

/// Whether `mark` parts digits into a group of one to three and groups of three.
bool groups_by(std::string_view digits, char mark) {
  std::size_t at = digits.find(mark);
  if (at == 0 || at > 3 || digits.front() == '0') return false;
  for (;;) {
    const std::size_t next = std::min(digits.find(mark, at + 1), digits.size());
    if (next - at != 4) return false;
    if (next == digits.size()) return true;
    at = next;
  }
}

std::string without(std::string_view text, std::string_view marks) {
  std::string left(text);
  std::erase_if(left, [&](char c) { return marks.find(c) != std::string_view::npos; });
  return left;
}

/// Whether marks of groups stand in the digits before the decimals alone, each kind in threes.
bool are_groups(std::string_view mantissa, const NumberMarks& marks) {
  if (mantissa.find_first_of(marks.groups) == std::string_view::npos) return true;
  const std::string_view whole = mantissa.substr(0, mantissa.find(marks.decimal));
  if (mantissa.substr(whole.size()).find_first_of(marks.groups) != std::string_view::npos) {
    return false;
  }
  return std::ranges::all_of(marks.groups, [&](char mark) {
    if (whole.find(mark) == std::string_view::npos) return true;
    std::string others = marks.groups;
    std::erase(others, mark);
    return groups_by(without(whole, others), mark);
  });
}

/// The usual number of few digits, without a copy on the heap.
std::optional<double> parse_short(std::string_view cell, char decimal) {
  std::array<char, 32> text{};
  if (cell.size() > text.size()) return std::nullopt;
  for (std::size_t i = 0; i < cell.size(); ++i) {
    const char c = cell[i];
    if (c != decimal && !is_digit(c) && c != '-') return std::nullopt;
    text[i] = c == decimal ? '.' : c;
  }
  return parse_number({text.data(), cell.size()});
}

}  // namespace

NumberLook look_at_number(std::string_view cell) {
  if (parse_number(cell)) return {.is_number = true};
  const std::string text = in_ascii(cell);
  NumberLook look;
  look.is_odd = text != cell || text.find_first_of("dD") != std::string::npos;
  std::string digits(mantissa_of(text));
  if (digits.empty() || !std::ranges::all_of(digits, [](char c) {
        return is_digit(c) || c == '.' || c == ',' || c == '\'' || c == ' ';
      })) {
    return {};
  }
  for (const char mark : {' ', '\''}) {
    if (digits.find(mark) == std::string::npos) continue;
    if (!groups_by(digits.substr(0, digits.find_first_of(".,")), mark)) return {};
    look.groups += mark;
  }
  if (digits.back() == ',') return {};  // punctuation of a text
  digits = without(digits, look.groups);
  const auto commas = std::ranges::count(digits, ',');
  const auto points = std::ranges::count(digits, '.');
  const std::size_t last = digits.find_last_of(".,");
  if (commas > 0 && points > 0) {  // the last mark is the decimal one
    const char decimal = digits[last];
    const char group = decimal == ',' ? '.' : ',';
    if (!groups_by(std::string_view(digits).substr(0, last), group)) return {};
    look.decimal_comma = decimal == ',';
    look.groups += group;
  } else if (commas > 1 || points > 1) {
    const char group = commas > 1 ? ',' : '.';
    if (!groups_by(digits, group)) return {};
    look.groups += group;
  } else if (commas == 1) {
    look.either = groups_by(digits, ',') && look.groups.empty();
    look.decimal_comma = !look.either;
  }
  look.is_number =
      parse_number_as(text, {look.decimal_comma || look.either ? ',' : '.', look.groups})
          .has_value();
  return look.is_number ? look : NumberLook{};
}

std::optional<double> parse_number_as(std::string_view cell, const NumberMarks& marks) {
  if (marks.is_plain()) {
    const auto number = parse_number(cell);
    const bool is_odd = cell.find_first_of(
                            "\xE2\x92"
                            "dD") != std::string_view::npos;
    if (number || !is_odd) return number;
  }
  if (const auto number = parse_short(cell, marks.decimal)) return number;
  const std::string text = in_ascii(cell);
  if (!are_groups(mantissa_of(text), marks)) return std::nullopt;
  std::string digits = with_e(without(text, marks.groups));
  if (marks.decimal == ',') {
    if (digits.find('.') != std::string::npos) return std::nullopt;
    std::ranges::replace(digits, ',', '.');
  }
  return parse_number(digits);
}

int count_decimals(std::string_view cell, char decimal) {
  const std::string_view digits = mantissa_of(cell);
  if (digits.empty() || !is_digit(digits.back())) return -1;
  const std::size_t point = digits.find(decimal);
  return point == std::string_view::npos ? 0 : static_cast<int>(digits.size() - point - 1);
}

}  // namespace sepcal::files
