// SPDX-License-Identifier: BSD-3-Clause
#include "flight/files/table_form.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <deque>
#include <map>
#include <tuple>

#include "flight/files/icartt.hpp"
#include "flight/files/number_text.hpp"
#include "flight/files/row_cells.hpp"
#include "flight/files/table_head.hpp"
#include "flight/files/text_lines.hpp"
#include "flight/files/time_column.hpp"
#include "sepcal/error.hpp"

namespace sepcal::files {
namespace {

constexpr std::size_t most_lines = 200;     // that are looked at first
constexpr std::size_t most_above = 20'000;  // lines among which the rows begin
constexpr std::size_t most_later = 200;     // rows that show how numbers are written farther on
constexpr std::size_t most_cells = 4000;    // of a row
constexpr std::size_t longest_value = 64;   // characters of a number or a time

struct Delimiter {
  char mark;
  const char* option;
  const char* name;
};

// Of forms that fit as well, the first counts.
constexpr std::array delimiters{
    Delimiter{',', ",", "commas"},     Delimiter{';', ";", "semicolons"},
    Delimiter{'\t', "tab", "tabs"},    Delimiter{'|', "|", "upright strokes"},
    Delimiter{' ', "space", "blanks"},
};

std::vector<std::string_view> split_lines(std::string_view text, std::size_t most) {
  std::vector<std::string_view> lines;
  while (!text.empty() && lines.size() < most) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, end);
    while (line.ends_with('\r')) line.remove_suffix(1);
    lines.push_back(line);
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  if (!lines.empty() && lines.front().starts_with("\xEF\xBB\xBF")) lines.front().remove_prefix(3);
  return lines;
}

bool is_missing(std::string_view cell) {
  constexpr std::array words{"",     "-",    "--",  "---",  "na",   "n/a", "nan",
                             "null", "none", "inf", "-inf", "#n/a", "?"};
  std::string lower(cell);
  std::ranges::transform(lower, lower.begin(), [](unsigned char c) { return std::tolower(c); });
  return std::ranges::find(words, lower) != words.end();
}

/// Where the number ends in "14.2 m/s"; npos where no unit follows one.
std::size_t find_suffix(std::string_view cell) {
  constexpr std::size_t longest = 8;
  const std::size_t digits = cell.find_last_of("0123456789");
  if (digits == std::string_view::npos || cell.size() > longest_value ||
      cell.find_first_of("0123456789+-.,") != 0) {
    return std::string_view::npos;
  }
  for (std::size_t end = std::min(cell.size() - 1, digits); end > 0; --end) {
    const std::string_view rest = cell.substr(end + 1);
    if (rest.size() > longest) break;  // a line that another delimiter cuts
    if (!look_at_number(cell.substr(0, end + 1)).is_number) continue;
    return !rest.empty() && is_unit_like(rest) ? end + 1 : std::string_view::npos;
  }
  return std::string_view::npos;
}

bool is_value(std::string_view cell) {
  if (cell.size() > longest_value) return parse_number(cell).has_value();
  return look_at_number(cell).is_number || is_time_text(cell) ||
         find_suffix(cell) != std::string_view::npos;
}

/// The lines cut by a delimiter.
struct Layout {
  const Delimiter* by = nullptr;
  std::vector<std::vector<std::string_view>> lines;  // empty: nothing stands there, or a comment
  std::size_t first_row = 0;                         // among the lines
  std::size_t cells = 0;                             // of a row
  int head_fits = 0;    // the line above the rows has as many cells: 2; one less or more: 1
  double values = 0.0;  // numbers and times in a row, on average

  bool is_better_than(const Layout& other) const {
    return std::tuple(head_fits, values, cells) >
           std::tuple(other.head_fits, other.values, other.cells);
  }
};

/// How many values a line's cells are; nothing where it is no row's.
std::optional<std::size_t> count_values(const std::vector<std::string_view>& cells) {
  std::size_t values = 0;
  std::size_t filled = 0;
  for (std::size_t i = 0; i < std::min(cells.size(), most_cells); ++i) {
    if (is_missing(cells[i])) continue;
    ++filled;
    values += is_value(cells[i]) ? 1U : 0U;
  }
  const auto is_mark = [](std::string_view cell) { return cell == "," || cell == ";"; };
  if (std::ranges::any_of(cells, is_mark)) return std::nullopt;  // another delimiter's
  if (filled == 0) return cells.size() > 1 ? std::optional(values) : std::nullopt;
  return values > 0 && 10 * values >= 3 * filled ? std::optional(values) : std::nullopt;
}

/// Cells of which a doubled quote is one; kept by `texts`.
std::vector<std::string_view> cut(std::string_view line, char delimiter,
                                  std::deque<std::string>& texts) {
  RowCells cells;
  if (!cells.cut(line, delimiter).empty()) return {};
  std::vector<std::string_view> kept;
  for (const std::string_view cell : cells.cells()) {
    const bool in_line =
        cell.empty() || (cell.data() >= line.data() && cell.data() <= line.data() + line.size());
    if (!in_line) texts.emplace_back(cell);
    kept.push_back(in_line ? cell : std::string_view(texts.back()));
  }
  return kept;
}

/// A comment's text, and any other line.
std::string_view without_mark(std::string_view line) {
  while (!line.empty() && std::string_view("#%! ").find(line.front()) != std::string_view::npos) {
    line.remove_prefix(1);
  }
  while (line.starts_with("//")) line.remove_prefix(2);
  return line;
}

/// Layout::head_fits.
int fit_head(std::span<const std::string_view> lines, const Layout& layout,
             std::deque<std::string>& texts) {
  if (layout.cells < 2) return 1;
  for (std::size_t i = layout.first_row; i > 0; --i) {
    if (is_blank(lines[i - 1])) continue;
    const std::size_t cells = cut(without_mark(lines[i - 1]), layout.by->mark, texts).size();
    if (cells == layout.cells) return 2;
    return cells + 1 == layout.cells || cells == layout.cells + 1 ? 1 : 0;
  }
  return 2;
}

/// The length that most lines have; of two the longer one.
std::map<std::size_t, std::size_t>::const_iterator commonest(
    const std::map<std::size_t, std::size_t>& lengths) {
  return std::ranges::max_element(
      lengths, {}, [](const auto& length) { return std::pair(length.second, length.first); });
}

/// The cells that nearly all of the last rows have; 0 where these differ, or are few.
std::size_t find_length_at_end(const Layout& layout,
                               const std::vector<std::optional<std::size_t>>& values) {
  constexpr std::size_t most = 20;
  constexpr std::size_t fewest = 10;
  std::map<std::size_t, std::size_t> lengths;
  std::size_t rows = 0;
  for (std::size_t i = values.size(); i > 0 && rows < most; --i) {
    if (!values[i - 1]) continue;
    ++rows;
    ++lengths[layout.lines[i - 1].size()];
  }
  const auto usual = commonest(lengths);
  return rows >= fewest && 5 * usual->second >= 4 * rows ? usual->first : 0;
}

/// A line farther down that names quantities, above as many rows as this has cells: what stands
/// before it is another table, or a preamble of numbers.
std::optional<std::size_t> find_later_head(std::span<const std::string_view> lines,
                                           const Layout& layout,
                                           const std::vector<std::optional<std::size_t>>& values) {
  constexpr std::size_t reach = 100;
  const std::size_t last = std::min(lines.size(), layout.first_row + reach);
  for (std::size_t i = layout.first_row + 1; i + 1 < last; ++i) {
    const auto& cells = layout.lines[i];
    if (values[i] || cells.size() != layout.cells) continue;
    const auto before = lines.first(i);
    if (std::ranges::find(before, lines[i]) != before.end()) continue;  // the header once more
    std::vector<std::string> names;
    for (const std::string_view cell : cells) names.push_back(to_utf8(cell));
    if (std::ranges::find(names, "") != names.end() || !names_quantities(names)) continue;
    for (std::size_t row = i + 1; row < last; ++row) {
      if (values[row]) return row;
    }
  }
  return std::nullopt;
}

/// The rows begin at the first line like one that is followed by others as long.
Layout lay_out(std::span<const std::string_view> lines, const Delimiter& by,
               std::deque<std::string>& texts) {
  Layout layout;
  layout.by = &by;
  std::vector<std::optional<std::size_t>> values;
  for (const std::string_view line : lines) {
    const bool is_left_out = is_blank(line) || is_comment(line);
    layout.lines.push_back(is_left_out ? std::vector<std::string_view>()
                                       : cut(line, by.mark, texts));
    values.push_back(count_values(layout.lines.back()));
  }
  const std::size_t length_at_end = find_length_at_end(layout, values);
  constexpr std::size_t followers = 20;
  for (std::size_t first = 0; first < lines.size(); ++first) {
    if (!values[first]) continue;
    std::map<std::size_t, std::size_t> lengths;
    std::size_t rows = 0;
    std::size_t seen = 0;
    for (std::size_t i = first; i < lines.size() && seen < followers; ++i) {
      if (layout.lines[i].empty()) continue;
      const auto above = lines.begin() + static_cast<std::ptrdiff_t>(first);
      if (!values[i] && std::find(lines.begin(), above, lines[i]) != above) continue;  // repeated
      ++seen;
      if (!values[i]) continue;
      ++rows;
      ++lengths[layout.lines[i].size()];
    }
    const auto usual = commonest(lengths);
    const std::size_t own = layout.lines[first].size();
    const bool goes_on = length_at_end == 0 || usual->first == length_at_end;
    if (!goes_on || 5 * rows < 4 * seen || (own != usual->first && own != usual->first + 1))
      continue;
    layout.first_row = first;
    layout.cells = usual->first;
    std::size_t sum = 0;
    std::size_t count = 0;
    for (std::size_t i = first; i < lines.size(); ++i) {
      sum += values[i].value_or(0);
      count += values[i] ? 1U : 0U;
    }
    layout.values = static_cast<double>(sum) / static_cast<double>(count);
    if (const auto later = find_later_head(lines, layout, values)) layout.first_row = *later;
    layout.head_fits = fit_head(lines, layout, texts);
    break;
  }
  return layout;
}

const Delimiter* find_delimiter(const std::string& asked) {
  if (asked.empty()) return nullptr;
  for (const Delimiter& known : delimiters) {
    if (asked == known.option || (asked.size() == 1 && asked.front() == known.mark)) return &known;
  }
  throw OptionError({Option{"delimiter"}, " is ',', ';', '|', tab or space, not '" + asked + "'"});
}

/// The one that "sep=;" names, as spreadsheets write it.
std::string find_sep(std::string_view line) {
  while (line.starts_with('"')) line.remove_prefix(1);
  std::string lower(line.substr(0, 4));
  std::ranges::transform(lower, lower.begin(), [](unsigned char c) { return std::tolower(c); });
  if (lower != "sep=" || line.size() < 5) return "";
  return std::string(1, line[4]);
}

/// Where no line looks like a row: the mark that is in the first line most often.
const Delimiter& find_commonest(std::string_view line) {
  return *std::ranges::max_element(delimiters, {}, [&](const Delimiter& by) {
    return by.mark == ' ' ? 0 : std::ranges::count(line, by.mark);
  });
}

class Recogniser {
 public:
  Recogniser(const std::string& file, std::string_view text, const CsvForm& asked)
      : file_(file), asked_(asked), all_(split_lines(text, most_above)) {
    // A line that ends with the file may be cut.
    if (!text.ends_with('\n') && all_.size() > 2) all_.pop_back();
  }

  TableForm recognise() {
    icartt_ = read_icartt(all_);
    choose_layout();
    find_numbers();
    if (icartt_) {
      take_icartt_head(*icartt_);
    } else {
      read_head();
    }
    name_columns();
    find_suffixes();
    note_marks();
    find_time(file_, form_, rows_, shown_, asked_.mapped);
    number_decimals();
    return std::move(form_);
  }

 private:
  void choose_layout() {
    if (icartt_) {
      lay_out_icartt(*icartt_);
    } else {
      find_layout();
    }
    form_.delimiter = layout_.by->mark;
    form_.first_row = layout_.first_row + 1;
    for (std::size_t i = layout_.first_row; i < lines_.size(); ++i) {
      const auto& cells = layout_.lines[i];
      if (cells.size() == layout_.cells || cells.size() == layout_.cells + 1) {
        rows_.push_back(cells);
      }
    }
    shown_ = rows_;
    const std::size_t step = std::max<std::size_t>(1, (all_.size() - lines_.size()) / most_later);
    for (std::size_t i = lines_.size(); i < all_.size(); i += step) {
      auto cells = cut(all_[i], form_.delimiter, texts_);
      if (cells.size() == layout_.cells) shown_.push_back(std::move(cells));
    }
    if (form_.delimiter != ',' && layout_.cells > 1) {
      note(fmt::format("{} part the columns", layout_.by->name));
    }
  }

  void lay_out_icartt(const IcarttHead& head) {
    lines_ = std::span(all_).first(std::min(head.lines + most_lines, all_.size()));
    layout_.by = &delimiters.front();
    layout_.first_row = head.lines;
    layout_.cells = head.columns.size();
    layout_.lines.resize(head.lines);
    for (const std::string_view line : lines_.subspan(head.lines)) {
      layout_.lines.push_back(cut(line, layout_.by->mark, texts_));
    }
  }

  void take_icartt_head(const IcarttHead& head) {
    form_.header_line = head.lines;
    for (const IcarttColumn& column : head.columns) {
      names_.push_back(column.name);
      units_.push_back(column.unit);
    }
    note(
        fmt::format("ICARTT: the {} lines of the head give names and units, and which numbers are "
                    "missing ones",
                    head.lines));
  }

  void find_layout() {
    std::string asked = asked_.delimiter;
    if (!all_.empty() && asked.empty()) {
      asked = find_sep(all_.front());
      if (!asked.empty()) all_.front() = {};  // it is read
    }
    const Delimiter* const only = find_delimiter(asked);
    for (std::size_t most = most_lines; layout_.cells == 0 && lines_.size() < all_.size();
         most *= 10) {
      lines_ = std::span(all_).first(std::min(most, all_.size()));
      layout_ = {};
      for (const Delimiter& by : delimiters) {
        if (only != nullptr && only != &by) continue;
        Layout tried = lay_out(lines_, by, texts_);
        if (layout_.by == nullptr || tried.is_better_than(layout_)) layout_ = std::move(tried);
      }
    }
    if (layout_.cells == 0) lay_out_text(only);
  }

  /// A table without a row that has numbers: its first line names the columns.
  void lay_out_text(const Delimiter* only) {
    const auto first = std::ranges::find_if_not(lines_, is_blank);
    const std::string_view line = first == lines_.end() ? std::string_view() : *first;
    layout_ = lay_out(lines_, only != nullptr ? *only : find_commonest(line), texts_);
    const auto head = static_cast<std::size_t>(first - lines_.begin());
    layout_.cells = head < layout_.lines.size() ? layout_.lines[head].size() : 0;
    if (layout_.cells == 0 && head < lines_.size()) {  // a comment, or a quote never closed
      layout_.lines[head] = {lines_[head]};
      layout_.cells = 1;
    }
    layout_.first_row = head + 1;
  }

  /// What the numbers of one cell of all rows show.
  struct Shown {
    bool comma = false;             // parts decimals
    bool point = false;             // does
    bool may_group = true;          // every point stands as if it parted thousands
    bool whole = false;             // there are numbers without a mark: below a thousand, maybe
    std::string_view either = {};   // a number whose comma may part decimals or thousands
    std::string_view pointed = {};  // one with a point
    std::string groups = {};
  };

  std::vector<Shown> look_at_numbers() {
    std::vector<Shown> shown(layout_.cells + 1);
    for (const auto& row : shown_) {
      for (std::size_t i = 0; i < std::min(row.size(), shown.size()); ++i) {
        const std::string_view cell = row[i];
        const std::size_t suffix = find_suffix(cell);
        const std::string_view number =
            suffix == std::string_view::npos ? cell : cell.substr(0, suffix);
        const NumberLook look = look_at_number(number);
        if (!look.is_number) continue;
        Shown& column = shown[i];
        form_.is_odd = form_.is_odd || look.is_odd;
        column.comma = column.comma || look.decimal_comma;
        if (number.find('.') != std::string_view::npos &&
            look.groups.find('.') == std::string::npos) {
          column.point = true;
          column.pointed = number;
          column.may_group = column.may_group && parse_number_as(number, {',', "."}).has_value();
        }
        if (look.either) column.either = cell;
        column.whole = column.whole || (look.groups.empty() &&
                                        number.find_first_of(".,eE") == std::string_view::npos);
        for (const char mark : look.groups) {
          if (column.groups.find(mark) == std::string::npos) column.groups += mark;
        }
      }
    }
    return shown;
  }

  /// What parts decimals and thousands, a column: files are put together from sources that differ.
  void find_numbers() {
    if (!asked_.decimal.empty() && asked_.decimal != "," && asked_.decimal != ".") {
      throw OptionError({Option{"decimal"}, " is '.' or ',', not '" + asked_.decimal + "'"});
    }
    const std::vector<Shown> shown = look_at_numbers();
    const auto shows = [&](char group) {
      return std::ranges::any_of(shown, [group](const Shown& column) {
        return column.groups.find(group) != std::string::npos;
      });
    };
    const bool comma = std::ranges::any_of(shown, &Shown::comma) || shows('.');
    const bool point = shows(',') || std::ranges::any_of(shown, [](const Shown& column) {
                         return column.point && !column.may_group;
                       });
    const bool alone = comma != point;  // one mark in all columns that tell
    for (const Shown& column : shown) {
      NumberMarks marks{.decimal = comma && !point ? ',' : '.', .groups = column.groups};
      if (column.comma || column.groups.find('.') != std::string::npos) {
        marks.decimal = ',';
        if (column.point && column.may_group) marks.groups += '.';
      } else if (column.point && column.may_group &&
                 (comma || (column.whole && form_.delimiter != ','))) {
        marks.decimal = decide(column.pointed, alone && shows('.') ? ',' : '\0');
        if (marks.decimal == ',') marks.groups += '.';
      } else if (column.point) {
        marks.decimal = '.';
      } else if (!column.either.empty() && column.groups.empty()) {
        const bool is_clear = alone && !(comma && column.whole);
        marks.decimal = decide(column.either, is_clear ? (comma ? ',' : '.') : '\0');
      }
      if (marks.decimal == '.' && !column.either.empty()) add_group(marks, ',');
      shown_marks_.push_back(marks.groups);
      std::erase(shown_marks_.back(), marks.decimal);
      for (const Shown& other : shown) {  // of a column that has shown no thousands yet
        if (other.comma == (marks.decimal == ',')) {
          for (const char mark : other.groups) add_group(marks, mark);
        }
      }
      std::erase(marks.groups, marks.decimal);
      marks_.push_back(std::move(marks));
    }
  }

  static void add_group(NumberMarks& marks, char mark) {
    if (marks.groups.find(mark) == std::string::npos) marks.groups += mark;
  }

  /// The decimal mark of a column with a number that may be read in two ways.
  char decide(std::string_view number, char shown_by_others) const {
    if (!asked_.decimal.empty()) return asked_.decimal.front();
    if (shown_by_others != '\0') return shown_by_others;
    throw OptionError(
        {fmt::format("{}: '{}' is a number with decimals or with thousands: say ", file_, number),
         Option{"decimal"}, " ',' or ", Option{"decimal"}, " '.'"});
  }

  void note_marks() {
    std::vector<std::string> with_comma;
    std::map<char, std::vector<std::string>> with_groups;
    for (const ColumnForm& column : form_.columns) {
      if (column.marks.decimal == ',') with_comma.push_back(column.logged);
      const std::string& groups = shown_marks_[column.cell];
      for (const char mark : groups) with_groups[mark].push_back(column.logged);
    }
    if (!with_comma.empty() && with_comma.size() == form_.columns.size()) {
      note("a comma is the decimal mark");
    } else if (!with_comma.empty()) {
      note(fmt::format("a comma is the decimal mark of {}, a point that of the others",
                       fmt::join(with_comma, ", ")));
    }
    for (const auto& [mark, columns] : with_groups) {
      note(fmt::format("'{}' parts thousands of {}", mark, fmt::join(columns, ", ")));
    }
  }

  /// The lines above the rows that have as many cells, and whose comments have.
  std::vector<HeadLine> head_lines() {
    constexpr std::size_t most = 6;
    std::vector<HeadLine> head;
    for (std::size_t i = std::min(layout_.first_row, lines_.size()); i > 0 && head.size() < most;
         --i) {
      if (is_blank(lines_[i - 1])) continue;
      const auto cells = cut(without_mark(lines_[i - 1]), layout_.by->mark, texts_);
      if (!cells.empty() && cells.front() == "TOA5") continue;  // of a data logger, names follow
      const bool is_one = cells.size() == layout_.cells ||
                          (cells.size() + 1 == layout_.cells && cells.size() > 1) ||
                          (cells.size() == layout_.cells + 1 && cells.back().empty());
      if (!is_one && (is_comment(lines_[i - 1]) || cells.empty())) continue;
      const auto is_unit = [](std::string_view cell) { return is_unit_like(cell); };
      if (!is_one && std::ranges::all_of(cells, is_unit)) continue;  // of some columns alone
      if (!is_one) break;
      HeadLine line{i - 1, {}};
      for (const std::string_view cell : cells) line.cells.push_back(to_utf8(cell));
      head.insert(head.begin(), std::move(line));
    }
    return head;
  }

  void read_head() {
    const std::vector<HeadLine> lines = head_lines();
    const TableHead head = choose_head(lines);
    if (head.names == nullptr) {
      note(
          "no line names the columns: they are column_1, column_2 and so on, and `map` names them");
      return;
    }
    form_.header_line = head.names->line + 1;
    names_ = head.names->cells;
    if (head.units != nullptr) {
      units_ = head.units->cells;
      note(fmt::format("line {} gives units", head.units->line + 1));
    }
    std::size_t left_out = 0;
    for (std::size_t i = 0; i < std::min(layout_.first_row, lines_.size()); ++i) {
      const bool is_read = i + 1 == form_.header_line || is_blank(lines_[i]) ||
                           (head.units != nullptr && i == head.units->line);
      left_out += is_read ? 0U : 1U;
    }
    if (left_out > 0) {
      note(fmt::format("{} line{} above the rows {} left out", left_out, left_out == 1 ? "" : "s",
                       left_out == 1 ? "is" : "are"));
    }
  }

  bool is_empty(std::size_t cell) const {
    return std::ranges::all_of(
        shown_, [&](const auto& row) { return cell >= row.size() || row[cell].empty(); });
  }

  /// 0, 1, 2 ... or 1, 2, 3 ...: rows that are numbered.
  bool counts_rows(std::size_t cell) const {
    std::optional<double> before;
    for (const auto& row : rows_) {
      const auto number = parse_number(row[cell]);
      if (!number || (!before && *number > 1.0) || (before && *number != *before + 1.0)) {
        return false;
      }
      before = number;
    }
    return before.has_value();
  }

  void name_columns() {
    form_.cells = layout_.cells;
    const bool ends_empty = form_.cells > 1 && is_empty(form_.cells - 1);
    if (ends_empty && names_.size() + 1 == form_.cells) --form_.cells;
    const bool one_more =
        std::ranges::any_of(rows_, [&](const auto& row) { return row.size() == form_.cells + 1; });
    form_.one_more = one_more && is_empty(form_.cells);
    if (names_.size() == form_.cells + 1 && names_.back().empty()) names_.pop_back();
    if (form_.one_more) note("the rows end with one delimiter more");
    if (!names_.empty() && names_.size() + 1 == form_.cells) take_one_name_less();
    names_.resize(form_.cells);
    units_.resize(form_.cells);
    for (std::size_t cell = 0; cell < form_.cells; ++cell) {
      std::string logged = names_[cell];
      if (logged.empty()) {
        if (is_empty(cell)) continue;
        if (cell == 0 && form_.header_line > 0 && counts_rows(0)) {
          note("the first column, without a name, numbers the rows and is left out");
          continue;
        }
        logged = fmt::format("column_{}", cell + 1);
        if (form_.header_line > 0) note(fmt::format("a column without a name is {}", logged));
      }
      if (contradicts_unit(logged, units_[cell])) {
        note(
            fmt::format("the header {} and the line of units, {}, say different units: the header "
                        "holds",
                        logged, units_[cell]));
      }
      const std::string header = with_unit(logged, units_[cell]);
      form_.columns.push_back({.header = header,
                               .logged = logged,
                               .written = header,
                               .cell = cell,
                               .marks = marks_[cell]});
      if (!icartt_) continue;
      form_.columns.back().scale = icartt_->columns[cell].scale;
      form_.columns.back().missing = icartt_->columns[cell].missing;
    }
    number_doubles();
  }

  /// Where rows are numbered by a column without a name, it is the first one. Else nobody can tell
  /// which has none.
  void take_one_name_less() {
    if (counts_rows(0)) {
      names_.insert(names_.begin(), "");
      if (!units_.empty() && units_.size() + 1 == form_.cells) units_.insert(units_.begin(), "");
      return;
    }
    note(
        fmt::format("line {} has {} names for {} columns, and which of them has none is not known: "
                    "they are column_1, column_2 and so on, and `map` names them",
                    form_.header_line, names_.size(), form_.cells));
    names_.clear();
    units_.clear();
    form_.header_line = 0;
  }

  /// Of several columns with one name all are numbered, so that none is taken for the other.
  void number_doubles() {
    std::map<std::string, std::size_t> count;
    for (const ColumnForm& column : form_.columns) ++count[column.header];
    std::map<std::string, std::size_t> given;
    for (ColumnForm& column : form_.columns) {
      if (count[column.header] < 2) continue;
      const std::string header = column.header;
      do {
        column.header = fmt::format("{}.{}", header, ++given[header]);
      } while (count.contains(column.header));
      column.written = column.header;
      if (given[header] == 1) {
        note(fmt::format("column '{}' is there {}: the first is {}", header,
                         count[header] == 2 ? "twice" : fmt::format("{} times", count[header]),
                         column.header));
      }
    }
  }

  void find_suffixes() {
    std::vector<std::string> with;
    for (ColumnForm& column : form_.columns) {
      if (column.header == "maneuver") continue;  // labels
      std::map<std::string, std::size_t> suffixes;
      std::size_t such = 0;
      std::size_t filled = 0;
      for (const auto& row : shown_) {
        if (column.cell >= row.size() || is_missing(row[column.cell])) continue;
        const std::string_view cell = row[column.cell];
        ++filled;
        const std::size_t at = find_suffix(cell);
        if (at == std::string_view::npos) continue;
        ++suffixes[std::string(cell.substr(at))];
        ++such;
      }
      if (such == 0 || 10 * such < 9 * filled) continue;
      column.suffix = std::ranges::max_element(suffixes, {}, [](const auto& suffix) {
                        return suffix.second;
                      })->first;
      column.header = with_unit(column.header, to_utf8(column.suffix));
      column.written = column.header;
      with.push_back(column.logged);
      if (suffixes.size() > 1) note_other_suffixes(column, suffixes);
    }
    if (!with.empty()) {
      note(fmt::format("the cells of {} name their unit", fmt::join(with, ", ")));
    }
  }

  void note_other_suffixes(const ColumnForm& column,
                           const std::map<std::string, std::size_t>& suffixes) {
    constexpr std::size_t most = 3;
    const auto unit_of = [](std::string_view suffix) {
      return to_utf8(suffix.substr(suffix.find_first_not_of(' ')));
    };
    std::vector<std::string> others;
    for (const auto& [suffix, cells] : suffixes) {
      if (suffix != column.suffix && others.size() < most) others.push_back(unit_of(suffix));
    }
    note(
        fmt::format("cells of {0} are in {1} and others in {2}: those in {1} alone are read; "
                    "convert the rest",
                    column.logged, unit_of(column.suffix), fmt::join(others, ", ")));
  }

  void number_decimals() {
    if (form_.cells == 0) return;
    form_.last_marks = marks_[form_.cells - 1];
    for (const auto& row : rows_) {
      if (row.empty() || row.size() < form_.cells) continue;
      const int decimals = count_decimals(row[form_.cells - 1], form_.last_marks.decimal);
      const bool first = &row == &rows_.front();
      form_.last_decimals = first || form_.last_decimals == decimals ? decimals : -1;
      if (form_.last_decimals < 0) return;
    }
  }

  void note(std::string text) { form_.notes.push_back(std::move(text)); }

  const std::string& file_;
  const CsvForm& asked_;
  std::vector<std::string_view> all_;
  std::span<const std::string_view> lines_;  // of all, those that are looked at closely
  std::deque<std::string> texts_;            // keeps what views point to
  std::optional<IcarttHead> icartt_;         // where it is such a file
  Layout layout_;
  SampledRows rows_;                      // of these lines
  SampledRows shown_;                     // the same and some of later lines
  std::vector<NumberMarks> marks_;        // of each cell
  std::vector<std::string> shown_marks_;  // of thousands, of each cell that has shown them
  std::vector<std::string> names_;
  std::vector<std::string> units_;
  TableForm form_;
};

}  // namespace

bool is_comment(std::string_view line) {
  while (!line.empty() && line.front() == ' ') line.remove_prefix(1);
  if (line.starts_with('#') || line.starts_with('%') || line.starts_with('!') ||
      line.starts_with("//"))
    return true;
  return line.find_first_of("-=") != std::string_view::npos &&
         line.find_first_not_of("-=+|: \t") == std::string_view::npos;
}

bool is_whole(const TableForm& form, std::span<const std::string_view> cells) {
  return cells.size() == form.cells ||
         (form.one_more && cells.size() == form.cells + 1 && cells.back().empty());
}

bool TableForm::is_plain() const {
  if (delimiter != ',' || is_odd || columns.size() != cells) return false;
  return std::ranges::all_of(columns, [](const ColumnForm& column) {
    return column.kind == CellKind::number && column.suffix.empty() && column.marks.is_plain() &&
           column.missing.empty() && column.scale == 1.0;
  });
}

TableForm recognise_table(const std::string& file, std::string_view text, const CsvForm& asked) {
  return Recogniser(file, text, asked).recognise();
}

std::optional<double> read_number(const ColumnForm& column,
                                  std::span<const std::string_view> cells) {
  constexpr double day = 86400.0;
  std::string_view cell = cells[column.cell];
  switch (column.kind) {
    case CellKind::clock:
      if (const auto seconds = parse_clock(cell)) return *seconds * column.scale;
      return std::nullopt;
    case CellKind::packed_clock: {
      const auto packed = parse_number_as(cell, column.marks);
      if (!packed) return std::nullopt;
      const double minutes = std::floor(*packed / 100.0);
      return *packed - 40.0 * minutes - 2400.0 * std::floor(minutes / 100.0);
    }
    case CellKind::date_time: {
      const auto stamp = parse_date_time(cell, column.order);
      if (!stamp) return std::nullopt;
      return column.is_of_day ? stamp->seconds
                              : (stamp->days - column.first_day) * day + stamp->seconds;
    }
    case CellKind::dated: {
      const auto days = parse_date(cells[column.date_cell], column.order);
      const auto seconds = parse_clock(cell);
      if (!days || !seconds) return std::nullopt;
      return (*days - column.first_day) * day + *seconds;
    }
    case CellKind::counted: {
      const auto count = parse_number_as(cell, column.marks);
      return count ? std::optional((*count - column.origin) * column.scale) : std::nullopt;
    }
    case CellKind::number:
      break;
  }
  if (!column.suffix.empty() && cell.ends_with(column.suffix)) {
    cell.remove_suffix(column.suffix.size());
    while (cell.ends_with(' ')) cell.remove_suffix(1);
  }
  const auto number = parse_number_as(cell, column.marks);
  if (!number || std::ranges::find(column.missing, *number) != column.missing.end()) {
    return std::nullopt;
  }
  return *number * column.scale;
}

}  // namespace sepcal::files
