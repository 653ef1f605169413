// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/flight/flight.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <system_error>
#include <variant>

#include "base/spool.hpp"
#include "base/thread_pool.hpp"
#include "flight/files/foreign_forms.hpp"
#include "flight/files/row_blocks.hpp"
#include "sepcal/detail/quantity.hpp"
#include "sepcal/error.hpp"

namespace sepcal {
namespace {

constexpr std::string_view maneuver = "maneuver";

/// A column while its rows come in.
struct GrowingColumn {
  std::vector<double> values;
  std::optional<Flight::Cell> first_text;

  void append(std::span<const double> rows, const std::optional<Flight::Cell>& text) {
    if (text && !first_text) first_text = Flight::Cell{values.size() + text->row, text->text};
    values.insert(values.end(), rows.begin(), rows.end());
  }
};

/// One row more.
void append_label(std::vector<Segment>& stretches, const std::string& label) {
  if (stretches.empty() || stretches.back().label != label) {
    const std::size_t row = stretches.empty() ? 0 : stretches.back().last;
    stretches.push_back({label, row, row});
  }
  ++stretches.back().last;
}

/// Set before files are read, by one thread.
ForeignReader& foreign_reader() {
  static ForeignReader reader;
  return reader;
}

/// Whether it is FILE::TABLE, which names a table in a file, and no file has that whole name.
bool names_table(const std::string& file) {
  const std::size_t at = file.rfind("::");
  std::error_code ignored;
  return at != std::string::npos && !std::filesystem::exists(file, ignored) &&
         std::filesystem::exists(file.substr(0, at), ignored);
}

/// The file's reader, or the flight that it is of another form.
std::variant<std::unique_ptr<CsvReader>, Flight> open_table(const std::string& file,
                                                            const Progress& progress,
                                                            const CsvForm& form) {
  if (foreign_reader() && names_table(file)) return foreign_reader()(file, "");
  try {
    return std::make_unique<CsvReader>(file, progress, form);
  } catch (const files::ForeignFile& foreign) {
    if (!foreign_reader()) throw;
    return foreign_reader()(file, foreign.form());
  }
}

/// Where the part's rows, which begin with row `first`, stand in the file.
void append_lines(std::vector<Flight::Line>& lines, const files::RowPart& part, std::size_t first) {
  for (const Flight::Line& line : part.lines) {
    const Flight::Line next{first + line.row, line.line};
    const bool follows =
        !lines.empty() && next.line - lines.back().line == next.row - lines.back().row;
    if (!follows) lines.push_back(next);
  }
}

/// The flight with what its reader decided.
Flight tell_reading(Flight& flight, const CsvReader& reader, const CsvForm& form) {
  for (std::size_t i = 0; i < reader.header().size(); ++i) {
    const std::string& header = reader.header()[i];
    const std::string& logged = reader.logged()[i];
    if (header == logged || header == maneuver || std::ranges::count(reader.logged(), logged) > 1) {
      continue;
    }
    flight.call_in_log(header, logged);
  }
  for (const std::string& note : reader.notes()) {
    flight.note(fmt::format("{}: {}", flight.name(), note));
  }
  return flight.read_as(form);
}

/// Gives back memory that was asked for in vain, where it is worth a copy.
template <class T>
void shrink(std::vector<T>& values) {
  if (values.capacity() > values.size() + values.size() / 8) values.shrink_to_fit();
}

}  // namespace

Flight& Flight::add(std::string header, std::vector<double> values) {
  const auto owned = std::make_shared<const std::vector<double>>(std::move(values));
  return view(std::move(header), *owned, owned);
}

Flight& Flight::view(std::string header, std::span<const double> values,
                     std::shared_ptr<const void> owner, std::optional<Cell> first_text) {
  check_header(header);
  check_length(header, values.size());
  columns_.push_back({std::move(header), values, std::move(owner), std::move(first_text)});
  return *this;
}

void Flight::check_header(const std::string& header) const {
  if (header.empty()) throw Error(name_ + ": a column has no name");
  if (header == maneuver) {
    throw Error(name_ + ": column 'maneuver' is for labels, a text a row, not for numbers");
  }
  if (std::ranges::find(columns_, header, &Column::header) != columns_.end()) {
    throw Error(fmt::format("{}: column '{}' is there twice; rename or delete one", name_, header));
  }
}

Flight::Column& Flight::column(std::string_view header) {
  const Column* found = find(header);
  if (found == nullptr) {
    throw Error(fmt::format("{}: there is no column '{}'; {}", name_, header, list_columns()));
  }
  return columns_[static_cast<std::size_t>(found - columns_.data())];
}

Flight& Flight::rename(std::string_view header, std::string to) {
  Column& renamed = column(header);
  check_header(to);
  if (renamed.logged.empty()) renamed.logged = renamed.header;
  renamed.header = std::move(to);
  if (renamed.logged == renamed.header) renamed.logged.clear();
  return *this;
}

Flight& Flight::call_in_log(std::string_view header, std::string logged) {
  column(header).logged = std::move(logged);
  return *this;
}

Flight& Flight::replace(std::string_view header, std::vector<double> values) {
  const auto owned = std::make_shared<const std::vector<double>>(std::move(values));
  return replace(header, *owned, owned);
}

Flight& Flight::replace(std::string_view header, std::span<const double> values,
                        std::shared_ptr<const void> owner) {
  Column& replaced = column(header);
  check_length(header, values.size());
  replaced.values = values;
  replaced.owner = std::move(owner);
  return *this;
}

Flight& Flight::drop(std::string_view header) {
  columns_.erase(columns_.begin() + (&column(header) - columns_.data()));
  return *this;
}

Flight& Flight::label(std::vector<std::string> maneuvers) {
  if (maneuvers_) throw Error(name_ + ": column 'maneuver' is there twice");
  check_length(maneuver, maneuvers.size());
  maneuvers_ = std::make_shared<const std::vector<std::string>>(std::move(maneuvers));
  return *this;
}

Flight& Flight::map(std::shared_ptr<base::Spool> spool) {
  spool_ = std::move(spool);
  return *this;
}

Flight& Flight::join(std::vector<Part> parts) {
  parts_ = std::move(parts);
  return *this;
}

Flight& Flight::number_lines(std::vector<Line> lines) {
  lines_ = std::move(lines);
  return *this;
}

Flight& Flight::read_as(CsvForm form) {
  form_ = std::move(form);
  return *this;
}

Flight& Flight::note(std::string text) {
  notes_.push_back(std::move(text));
  return *this;
}

Flight& Flight::label_stretches(std::vector<Segment> stretches) {
  label_stretches_ = std::move(stretches);
  return *this;
}

std::vector<Segment> Flight::label_stretches() const {
  std::vector<Segment> stretches = label_stretches_;
  for (const std::string& label : maneuvers()) append_label(stretches, label);
  return stretches;
}

void Flight::release(std::size_t first, std::size_t last) const {
  if (spool_) spool_->release(first, last);
}

const Flight::Column* Flight::find(std::string_view header) const {
  auto found = std::ranges::find(columns_, header, &Column::header);
  if (found == columns_.end()) found = std::ranges::find(columns_, header, &Column::logged);
  return found == columns_.end() || header.empty() ? nullptr : &*found;
}

std::string Flight::locate(std::size_t row) const {
  const auto after = std::ranges::upper_bound(parts_, row, {}, &Part::first);
  const Part part = parts_.empty() ? Part{name_, 0} : *std::prev(after);
  const std::size_t in_part = row - part.first;
  if (!from_file() || lines_.empty()) return fmt::format("{} row {}", part.name, in_part);
  const Line line = *std::prev(std::ranges::upper_bound(lines_, in_part, {}, &Line::row));
  return fmt::format("{} line {}", part.name, line.line + in_part - line.row);
}

std::string Flight::list_columns() const {
  if (from_file() && columns_.size() == 1 && !maneuvers_) {
    return fmt::format("the file has: {}, and no comma in its header; is this a CSV file?",
                       columns_.front().logged_header());
  }
  std::string list = from_file() ? "the file has: " : "the flight has: ";
  const std::size_t prefix = list.size();
  const auto append = [&](std::string_view header) {
    if (list.size() > prefix) list += ", ";
    list += header;
  };
  constexpr std::size_t most_columns = 40;
  const std::size_t listed = std::min(columns_.size(), most_columns);
  for (std::size_t i = 0; i < listed; ++i) append(columns_[i].logged_header());
  if (listed < columns_.size()) append(fmt::format("{} more", columns_.size() - listed));
  if (maneuvers_ || !label_stretches_.empty()) append(maneuver);
  if (list.size() == prefix) list += "none";
  return list;
}

/// The first column sets the length; the others keep to it.
void Flight::check_length(std::string_view header, std::size_t length) {
  if (columns_.empty() && !maneuvers_) {
    rows_ = length;
  } else if (length != rows_) {
    throw Error(fmt::format("{}: column '{}' has {} values, the others have {}", name_, header,
                            length, rows_));
  }
}

void read_foreign_files_with(ForeignReader reader) { foreign_reader() = std::move(reader); }

Flight read_csv(const std::string& file, const Progress& progress, int threads,
                const CsvForm& form) {
  const auto opened = open_table(file, progress, form);
  if (const auto* foreign = std::get_if<Flight>(&opened)) return *foreign;
  CsvReader& reader = *std::get<std::unique_ptr<CsvReader>>(opened);
  base::ThreadPool pool(threads);
  const auto& header = reader.header();
  std::vector<GrowingColumn> columns(header.size());
  std::vector<std::string> labels;
  std::vector<Flight::Line> lines;
  std::size_t rows = 0;
  const auto maneuver_at =
      static_cast<std::size_t>(std::ranges::find(header, maneuver) - header.begin());
  files::RowBlocks blocks(reader, maneuver_at, pool);
  for (auto parts = blocks.next(); !parts.empty(); parts = blocks.next()) {
    for (GrowingColumn& column : columns) column.values.reserve(blocks.expected_rows());
    for (const files::RowPart& part : parts) {
      labels.insert(labels.end(), part.labels.begin(), part.labels.end());
      append_lines(lines, part, rows);
      rows += part.rows;
      for (std::size_t i = 0; i < header.size(); ++i) {
        columns[i].append(part.columns[i], part.first_text[i]);
      }
    }
  }
  shrink(labels);
  for (GrowingColumn& column : columns) shrink(column.values);
  Flight flight(file, reader.sha256());
  for (std::size_t i = 0; i < header.size(); ++i) {
    if (i == maneuver_at) continue;
    const auto owned = std::make_shared<const std::vector<double>>(std::move(columns[i].values));
    flight.view(header[i], *owned, owned, std::move(columns[i].first_text));
  }
  if (maneuver_at < header.size()) flight.label(std::move(labels));
  return tell_reading(flight.number_lines(std::move(lines)), reader, form);
}

Flight stream_csv(const std::string& file, const std::string& folder, const Progress& progress,
                  int threads, const CsvForm& form) {
  const auto opened = open_table(file, progress, form);
  if (const auto* foreign = std::get_if<Flight>(&opened)) return *foreign;
  CsvReader& reader = *std::get<std::unique_ptr<CsvReader>>(opened);
  base::ThreadPool pool(threads);
  const auto& header = reader.header();
  const auto spool = std::make_shared<base::Spool>(folder);
  const auto maneuver_at =
      static_cast<std::size_t>(std::ranges::find(header, maneuver) - header.begin());
  std::vector<std::unique_ptr<base::Spool::Column>> columns;
  for (std::size_t i = 0; i < header.size(); ++i) {
    columns.push_back(i == maneuver_at ? nullptr : std::make_unique<base::Spool::Column>(*spool));
  }
  std::vector<std::optional<Flight::Cell>> first_text(header.size());
  std::vector<Segment> labels;
  std::vector<Flight::Line> lines;
  std::size_t rows = 0;
  files::RowBlocks blocks(reader, maneuver_at, pool);
  for (auto parts = blocks.next(); !parts.empty(); parts = blocks.next()) {
    for (const files::RowPart& part : parts) {
      for (const std::string& label : part.labels) append_label(labels, label);
      append_lines(lines, part, rows);
      for (std::size_t i = 0; i < header.size(); ++i) {
        if (i == maneuver_at) continue;
        columns[i]->append(part.columns[i]);
        if (const auto& text = part.first_text[i]; text && !first_text[i]) {
          first_text[i] = Flight::Cell{rows + text->row, text->text};
        }
      }
      rows += part.rows;
    }
  }
  Flight flight(file, reader.sha256());
  for (std::size_t i = 0; i < header.size(); ++i) {
    if (i == maneuver_at) continue;
    flight.view(header[i], columns[i]->finish(), spool, std::move(first_text[i]));
  }
  flight.label_stretches(std::move(labels)).map(spool).number_lines(std::move(lines));
  return tell_reading(flight, reader, form);
}

}  // namespace sepcal
