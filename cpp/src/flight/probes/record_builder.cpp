// SPDX-License-Identifier: BSD-3-Clause
#include "flight/probes/record_builder.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "base/escaping.hpp"
#include "base/excerpt.hpp"
#include "base/segments.hpp"
#include "base/spool.hpp"
#include "flight/files/invalid_cells.hpp"
#include "flight/logs/chosen_rows.hpp"
#include "flight/probes/joined_quantities.hpp"
#include "flight/probes/plausible_readings.hpp"
#include "flight/probes/sampled_rows.hpp"
#include "sepcal/effect_name.hpp"
#include "sepcal/error.hpp"

namespace sepcal::probes {

namespace {

/// Of a flight whose columns are mapped, what lets their pages go.
KeptRows::Release release_of(const Flight& flight) {
  if (!flight.is_mapped()) return {};
  return [spool = flight.spool()](std::size_t first, std::size_t last) {
    spool->release(first, last);
  };
}

/// What logs have in the place of some quantities.
std::string say_other_ways(std::span<const std::string_view> names) {
  std::string ways;
  if (std::ranges::find(names, "vn") != names.end()) {
    ways += "; speed and track would do as well: gs_kt, track_deg and vs_fpm";
  }
  if (std::ranges::find(names, "roll") != names.end()) {
    ways += "; a quaternion from body to north-east-down would do as well: qw, qx, qy, qz";
  }
  return ways;
}

}  // namespace

constexpr std::size_t most_notes = 10;  // of one kind; more of them nobody reads

RecordBuilder::RecordBuilder(const Flight& flight, std::span<const ProbeQuantity> quantities,
                             const LogChoice& choice)
    : flight_(flight),
      quantities_(quantities),
      drop_invalid_(choice.drop_invalid),
      is_joined_(!choice.join.empty()),
      rows_(flight.rows(), release_of(flight)) {
  for (const ProbeQuantity& quantity : quantities_) find_quantity(quantity);
  choose_rows(choice);
  if (!choice.drop_repeats.empty()) drop_repeats(choice.drop_repeats);
}

void RecordBuilder::choose_rows(const LogChoice& choice) {
  const auto find = [this](const std::string& name) {
    const auto found = logged_.find(name);
    return found == logged_.end() ? std::nullopt : std::optional(found->second);
  };
  if (const auto measured = rows_measured(quantities_, flight_, choice)) {
    keep(measured, "they have no reading of what is measured, to whose rows the rest is joined");
  }
  if (const auto within = logs::rows_within_times(flight_, choice)) {
    keep(within, fmt::format("they are not within the times chosen, {} to {} s",
                             choice.from_time ? fmt::format("{}", *choice.from_time) : "the first",
                             choice.to_time ? fmt::format("{}", *choice.to_time) : "the last"));
  }
  if (const auto holds = logs::rows_where(flight_, choice, find)) {
    keep(holds, fmt::format("{} does not hold there", choice.where));
  }
}

void RecordBuilder::drop_repeats(const std::vector<std::string>& columns) {
  if (flight_.is_mapped()) {
    throw OptionError({Option{"drop_repeats"}, " looks at whole columns, which ", Option{"stream"},
                       " never has in memory; leave one of them out"});
  }
  const std::vector<double> time = has({"time"}) ? logged("time").values() : std::vector<double>();
  const std::vector<bool> sampled = find_sampled(flight_, columns, time);
  keep([&](std::size_t row) { return sampled[row]; },
       fmt::format("they lie between samples of {}", fmt::join(columns, ", ")));
}

/// A column of the quantity's name in an unknown unit is a column like any other, with a note;
/// fail_missing() names it where the quantity is needed and isn't there in a known one.
void RecordBuilder::find_quantity(const ProbeQuantity& quantity) {
  LoggedQuantity found;
  const Flight::Column* unknown = nullptr;
  for (const Flight::Column& column : flight_.columns()) {
    const std::string_view header = column.header;
    const files::Unit* unit = files::unit_in(header, quantity.name, quantity.kind, quantity.bare);
    if (unit == nullptr) {
      const std::string_view name = header.substr(0, header.rfind('_'));
      // "roll_rad.2" is the second of one name, and in no other unit.
      const bool is_numbered = header.find('.') != std::string_view::npos;
      if (quantity.bare == nullptr && name == quantity.name && !is_numbered) unknown = &column;
    } else if (found.column != nullptr) {
      throw OptionError(
          {fmt::format("{}: {} is there twice, as '{}' and '{}'; ", flight_.name(), quantity.name,
                       found.column->logged_header(), column.logged_header()),
           Option{"ignore"}, " " + base::in_shell(column.logged_header()), " leaves one out"});
    } else {
      found = {&column, unit};
    }
  }
  if (found.column == nullptr) {
    const auto own = files::find_quantity(flight_, quantity.name, quantity.kind, quantity.bare);
    if (own) found = *own;
  }
  if (found.column != nullptr) logged_.emplace(quantity.name, found);
  if (unknown == nullptr || unknown->header == quantity.name) return;  // take_drivers() says so
  unknown_.emplace(quantity.name, unknown);
}

/// Once it is known what the fit needs.
void RecordBuilder::note_unknown_units() {
  for (const auto& [name, column] : unknown_) {
    const auto found = logged_.find(name);
    if (found != logged_.end()) {
      note(fmt::format("column '{}' is not read as {}, which '{}' logs: its unit is unknown",
                       column->logged_header(), name, found->second.column->logged_header()));
    } else {
      note(
          fmt::format("column '{}' is not read as {}, which this fit does without: its unit is "
                      "unknown",
                      column->logged_header(), name));
    }
  }
}

bool RecordBuilder::has(Names names) const {
  return std::ranges::all_of(names, [&](std::string_view name) { return logged_.contains(name); });
}

const LoggedQuantity& RecordBuilder::logged(std::string_view name) const {
  const auto found = logged_.find(name);
  if (found == logged_.end()) fail_missing({&name, 1});
  return found->second;
}

const ProbeQuantity& RecordBuilder::quantity_of(std::string_view name) const {
  return *std::ranges::find(quantities_, name, &ProbeQuantity::name);
}

/// Of the columns that are none of the probe's quantities.
std::vector<std::string> RecordBuilder::other_headers() const {
  std::vector<std::string> others;
  for (const Flight::Column& column : flight_.columns()) {
    if (!is_quantity(column)) others.push_back(column.logged_header());
  }
  return others;
}

OptionError::Message RecordBuilder::ask_for_near_miss(Names names) const {
  const std::vector<std::string> others = other_headers();
  for (const std::string_view name : names) {
    if (has({name})) continue;
    if (unknown_.contains(name)) return files::around("; ", say_unknown(name), "");
    auto asked = files::ask_for_near_miss(name, quantity_of(name).kind, others);
    if (!asked.empty()) return asked;
  }
  return {};
}

OptionError::Message RecordBuilder::say_unknown(std::string_view name) const {
  const ProbeQuantity& quantity = quantity_of(name);
  const Flight::Column& column = *unknown_.at(name);
  const auto accepted = files::accepted_headers(name, quantity.kind, quantity.bare);
  return {fmt::format("column '{}' has no known unit; {} may be logged as: {}; ", column.header,
                      name, fmt::join(accepted, ", ")),
          Option{"map"},
          fmt::format(" {} reads it as the first",
                      files::map_pair(accepted.front(), column.logged_header()))};
}

/// Of all that are missing, and of the time, a velocity and what is measured, so that one option
/// reads the log; nothing where the first that is missing has none, or several.
std::vector<files::MappedColumn> RecordBuilder::find_near_columns(
    std::span<const std::string_view> names) const {
  std::vector<std::string> others = other_headers();
  std::erase_if(others, [](const std::string& header) {
    return header.find_first_of(",=") != std::string::npos;  // which --map parts pairs at
  });
  std::vector<files::MappedColumn> found;
  for (const ProbeQuantity& quantity : quantities_) {
    const bool is_missing = std::ranges::find(names, quantity.name) != names.end();
    const bool is_needed = quantity.is_measured || quantity.kind == files::UnitKind::time ||
                           quantity.kind == files::UnitKind::speed;
    if ((!is_missing && !is_needed) || has({quantity.name}) || unknown_.contains(quantity.name)) {
      continue;
    }
    auto column = files::find_near_column(quantity.name, quantity.kind, others);
    if (!column) {
      if (quantity.name == names.front()) return {};
      continue;
    }
    if (!column->says_unit) {
      const files::Unit& unit = files::likely_unit(flight_, column->header, quantity.kind);
      column->accepted = fmt::format("{}_{}", quantity.name, unit.suffix);
    }
    std::erase(others, column->header);
    found.push_back(std::move(*column));
  }
  return found;
}

void RecordBuilder::fail_missing(std::span<const std::string_view> names) const {
  const auto inside = [this](std::string_view name) {
    const ProbeQuantity& quantity = quantity_of(name);
    return files::accepted_headers(name, quantity.kind, quantity.bare).front();
  };
  const std::string_view name = names.front();
  const ProbeQuantity& quantity = quantity_of(name);
  if (unknown_.contains(name)) {
    throw OptionError(files::around(flight_.name() + ": ", say_unknown(name), ""));
  }
  std::vector<std::string> others;
  std::ranges::transform(names.subspan(1), std::back_inserter(others), inside);
  const std::vector<files::MappedColumn> near = find_near_columns(names);
  throw OptionError(files::around(
      flight_.name() + ": ",
      near.empty() ? files::describe_missing(name, quantity.kind, other_headers(), quantity.bare)
                   : files::around(files::say_missing(name, quantity.kind, quantity.bare),
                                   files::ask_for_columns(near), ""),
      fmt::format("{}{}; {}{}",
                  others.empty() ? "" : fmt::format("; missing too: {}", fmt::join(others, ", ")),
                  say_other_ways(names), flight_.list_columns(),
                  flight_.is_mapped()
                      ? "; quaternions and positions of a streamed log are not converted"
                      : "")));
}

void RecordBuilder::need(Names names) {
  consult(names);
  taken_.insert(taken_.end(), names);
}

void RecordBuilder::consult(Names names) {
  std::vector<std::string_view> missing;
  std::ranges::copy_if(names, std::back_inserter(missing),
                       [this](std::string_view name) { return !logged_.contains(name); });
  if (!missing.empty()) fail_missing(missing);
  checked_.insert(checked_.end(), names);
}

/// With the first of its cells that fails the test. A column that has numbers in most of them is
/// slower than the log, or has gaps: the rows where it has them are a log too.
std::string RecordBuilder::say_not_used(const Flight::Column& column, std::size_t row,
                                        const RowTest& is_valid) const {
  std::string said =
      fmt::format("column '{}' is not used: {}", column.header, files::describe_cell(column, row));
  std::size_t valid = 0;
  rows_.for_each([&](std::size_t at) { valid += is_valid(at) ? 1 : 0; });
  if (valid == 0) return said;
  return said + fmt::format(
                    "; {} of {} rows have a number there, and a log of these rows alone has the "
                    "column",
                    valid, rows_.size());
}

bool RecordBuilder::offer(Names names) {
  if (!has(names)) return false;
  for (const std::string_view name : names) {
    const auto& [column, unit] = logged(name);
    const auto is_valid = [&](std::size_t row) { return files::is_valid(*column, unit, row); };
    if (const auto row = rows_.find_if_not(is_valid)) {
      note(say_not_used(*column, *row, is_valid));
      return false;
    }
  }
  taken_.insert(taken_.end(), names);
  return true;
}

void RecordBuilder::keep_valid() {
  std::vector<const LoggedQuantity*> quantities;
  quantities.reserve(checked_.size());
  for (const std::string_view name : checked_) quantities.push_back(&logged(name));
  const auto find_invalid = [&quantities](std::size_t row) {
    return std::ranges::find_if(quantities, [row](const LoggedQuantity* quantity) {
      return !files::is_reading(quantity->at(row));
    });
  };
  const auto is_whole = [&](std::size_t row) { return find_invalid(row) == quantities.end(); };
  const auto say_cell = [&](const LoggedQuantity& quantity, std::size_t row) {
    const bool time = quantity.unit->kind == files::UnitKind::time;
    return fmt::format(
        "column '{}' {}, not {}", quantity.column->header,
        files::describe_cell(*quantity.column, row),
        time ? "a time in numbers, as 12.34, whose start does not matter" : "a finite number");
  };
  for (const LoggedQuantity* quantity : quantities) {
    const auto first = rows_.find_if_not([](std::size_t) { return false; });
    const auto is_there = [&](std::size_t row) { return !files::is_reading(quantity->at(row)); };
    if (!first || rows_.find_if_not(is_there)) continue;
    throw OptionError(
        {fmt::format("{}: {}, and has none in any of {} rows; ", flight_.locate(*first),
                     say_cell(*quantity, *first), rows_.size()),
         Option{"map"}, " reads it from another column"});
  }
  if (is_joined_) {
    keep(is_whole, "a needed column has no samples on both sides of them");
    return;
  }
  refuse_other_rates(quantities, is_whole);
  keep_or_refuse(is_whole, "a cell of a needed column is no finite number",
                 [&](std::size_t row) { return say_cell(**find_invalid(row), row); });
}

/// Where columns of numbers hardly ever stand in one row, each was logged by itself.
void RecordBuilder::refuse_other_rates(const std::vector<const LoggedQuantity*>& quantities,
                                       const RowTest& is_whole) const {
  if (flight_.is_mapped()) return;
  std::vector<std::size_t> readings(quantities.size(), 0);
  std::size_t whole = 0;
  rows_.for_each([&](std::size_t row) {
    for (std::size_t k = 0; k < quantities.size(); ++k) {
      readings[k] += files::is_reading(quantities[k]->at(row)) ? 1 : 0;
    }
    whole += is_whole(row) ? 1 : 0;
  });
  const auto fewest = std::ranges::min_element(readings);
  if (fewest == readings.end() || *fewest <= 2 * whole) return;
  if (drop_invalid_ && whole > 0) return;
  std::vector<std::string> rates;
  for (std::size_t k = 0; k < quantities.size(); ++k) {
    if (readings[k] == rows_.size()) continue;
    rates.push_back(fmt::format("{} (in {} rows)", quantities[k]->column->header, readings[k]));
  }
  throw OptionError(
      {fmt::format("{}: {} of {} rows has all that is needed: {} were logged at different times; ",
                   flight_.name(),
                   whole == 0 ? "none" : fmt::format("one in {}", rows_.size() / whole),
                   rows_.size(), fmt::join(rates, ", ")),
       Option{"join"},
       " smooth brings them to the rows of what is measured; linear and held do too"});
}

/// In seconds: times that differ as they were logged may be one there.
void RecordBuilder::check_time() const {
  const LoggedQuantity& time = logged("time");
  std::optional<std::size_t> last;
  double before = 0.0;
  rows_.for_each([&](std::size_t row) {
    const double now = time.at(row);
    if (last && !(now > before)) {
      throw Error(fmt::format(
          "{}: {} {} at {}, after {}; time must increase: sort the rows and delete repeated ones{}",
          flight_.locate(row), time.column->header, now == before ? "repeats" : "runs back",
          time.column->values[row], time.column->values[*last],
          flight_.is_mapped() ? "; clocks of a streamed log are not joined" : ""));
    }
    last = row;
    before = now;
  });
}

RecordBuilder::Loss RecordBuilder::keep(const RowTest& test, std::string_view reason) {
  const auto lost_from = rows_.find_if_not(test);
  if (!lost_from) return {};
  const std::size_t before = rows_.size();
  rows_.keep_if(test);
  const Loss loss{before - rows_.size(), *lost_from};
  dropped_.push_back({std::string(reason), loss.rows});
  return loss;
}

void RecordBuilder::keep_or_refuse(const RowTest& test, std::string_view reason,
                                   const std::function<std::string(std::size_t row)>& complaint) {
  const Loss loss = keep(test, reason);
  if (loss.rows == 0 || drop_invalid_) return;
  if (rows_.empty()) {
    throw Error(fmt::format("{}: {}; none of {} rows is without such a fault",
                            flight_.locate(loss.first), complaint(loss.first), loss.rows));
  }
  throw OptionError({fmt::format("{}: {}; ", flight_.locate(loss.first), complaint(loss.first)),
                     Option{"drop_invalid"}, " drops such rows"});
}

void RecordBuilder::compute(std::string name, RowValue value) {
  computed_.emplace_back(std::move(name), std::move(value));
}

void RecordBuilder::note(std::string_view text) {
  notes_.push_back(fmt::format("{}: {}", flight_.name(), text));
}

/// A quantity in use, in the kept rows.
std::optional<Reading> RecordBuilder::find_reading(std::string_view name) const {
  // Of a flight that may be longer than memory: rows spread evenly.
  const std::size_t stride =
      flight_.is_mapped() ? 1 + (rows_.size() - 1) / base::excerpt_rows : std::size_t{1};
  Reading reading{std::string(name), std::nullopt, {}};
  const auto read = [&](const auto& value) {
    reading.values.reserve(rows_.size() / stride + 1);
    std::size_t index = 0;
    rows_.for_each([&](std::size_t row) {
      if (index++ % stride == 0) reading.values.push_back(value(row));
    });
  };
  const auto computed = std::ranges::find(
      computed_, name, [](const auto& entry) { return std::string_view(entry.first); });
  if (computed != computed_.end()) {
    read(computed->second);
    return reading;
  }
  const bool is_taken = std::ranges::find(taken_, name) != taken_.end();
  if (!is_taken && std::ranges::find(checked_, name) == checked_.end()) return std::nullopt;
  const LoggedQuantity& quantity = logged(name);
  reading.header = quantity.column->header;
  reading.logged = quantity.column->logged;
  if (quantity.unit->is_inside()) reading.relabel = quantity.unit->kind;
  read([&](std::size_t row) { return quantity.at(row); });
  return reading;
}

void RecordBuilder::note_implausible() {
  const auto find = [this](std::string_view name) { return find_reading(name); };
  for (const Implausible& implausible : find_implausible(find, field_strength_)) {
    note(implausible.sentence);
  }
}

ProbeRecord RecordBuilder::finish() {
  if (rows_.empty()) {
    throw Error(fmt::format("{}: no row is left of {}: {}", flight_.name(), flight_.rows(),
                            dropped_.empty() ? "there was none" : dropped_.back().reason));
  }
  note_implausible();
  note_unknown_units();
  take_quantities();
  check_computed();
  take_drivers();
  if (flight_.is_mapped()) record_.map(release_of(flight_));
  record_.cut(base::find_segments(record_, label_kept()));
  note_dropped("were dropped");
  return {std::move(record_), flight_.rows(), std::move(dropped_), std::move(notes_),
          flight_.is_mapped() ? std::vector<std::size_t>() : rows_.list()};
}

/// The flight's labels as stretches of kept rows.
std::vector<Segment> RecordBuilder::label_kept() const {
  std::vector<Segment> kept;
  const std::vector<Segment> labels = flight_.label_stretches();
  auto label = labels.begin();
  std::size_t index = 0;
  if (labels.empty()) return kept;
  rows_.for_each([&](std::size_t row) {
    while (row >= label->last) ++label;
    if (kept.empty() || kept.back().label != label->label) {
      kept.push_back({label->label, index, index});
    }
    kept.back().last = ++index;
  });
  return kept;
}

ProbeReadings RecordBuilder::finish_readings() {
  note_implausible();
  std::vector<bool> valid(flight_.rows(), false);
  rows_.for_each([&](std::size_t row) { valid[row] = true; });
  rows_ = KeptRows(flight_.rows(), release_of(flight_));
  take_quantities();
  note_dropped("can't be calibrated");
  return {std::move(record_), std::move(valid), std::move(dropped_), std::move(notes_)};
}

/// Takes a column's kept rows; without a copy where they are all rows and in the unit used inside.
void RecordBuilder::take(std::string name, const Flight::Column& column, const files::Unit* unit) {
  const bool converts = unit != nullptr && !unit->is_inside();
  if (!converts && rows_.size() == flight_.rows()) {
    record_.view(std::move(name), column.values, column.owner);
    return;
  }
  add(std::move(name), [&](std::size_t row) {
    const double value = column.values[row];
    return converts ? unit->convert(value) : value;
  });
}

/// A column of its own: where the flight's columns are mapped, another one of their kind.
void RecordBuilder::add(std::string name, const RowValue& value) {
  if (flight_.is_mapped()) {
    base::Spool::Column column(*flight_.spool());
    rows_.for_each([&](std::size_t row) { column.append(value(row)); });
    record_.view(std::move(name), column.finish(), flight_.spool());
    return;
  }
  std::vector<double> values;
  values.reserve(rows_.size());
  rows_.for_each([&](std::size_t row) { values.push_back(value(row)); });
  record_.add(std::move(name), std::move(values));
}

void RecordBuilder::take_quantities() {
  for (const std::string_view name : taken_) {
    const LoggedQuantity& quantity = logged(name);
    take(std::string(name), *quantity.column, quantity.unit);
  }
  for (const auto& [name, value] : computed_) add(name, value);
}

/// Each is a reading; what is computed of them need not be: 1e100 Pa at 1e-300 K.
void RecordBuilder::check_computed() const {
  for (const auto& [name, value] : computed_) {
    const auto column = record_.column(name);
    const KeptRows indices(column.size(), release_of(flight_));
    const auto bad =
        indices.find_if_not([&](std::size_t i) { return files::is_reading(column[i]); });
    if (!bad) continue;
    throw Error(fmt::format("{}: {} is computed from this row's readings as {}; check them",
                            flight_.locate(rows_.at(*bad)), name, column[*bad]));
  }
}

/// Whether one of the probe's quantities is read from the column, and no driver.
bool RecordBuilder::is_quantity(const Flight::Column& column) const {
  return std::ranges::any_of(quantities_, [&](const ProbeQuantity& quantity) {
    const auto found = logged_.find(quantity.name);
    return !quantity.is_driver && found != logged_.end() && found->second.column == &column;
  });
}

/// A rate without a unit under a rate's name would be taken for one in rad/s.
bool RecordBuilder::is_named_like_quantity(std::string_view header) const {
  const auto found = std::ranges::find(quantities_, header, &ProbeQuantity::name);
  return found != quantities_.end() && found->is_extra;
}

void RecordBuilder::take_drivers() {
  std::vector<std::string> refused;
  std::vector<std::string> unnameable;
  for (const Flight::Column& column : flight_.columns()) {
    if (is_quantity(column)) continue;
    const auto is_valid = [&](std::size_t row) { return files::is_valid(column, nullptr, row); };
    if (const auto row = rows_.find_if_not(is_valid)) {
      refused.push_back(fmt::format("column '{}' can't drive an effect: at {} it {}", column.header,
                                    flight_.locate(*row), files::describe_cell(column, *row)));
    } else if (is_named_like_quantity(column.header)) {
      refused.push_back(
          fmt::format("column '{}' is not used: it is named like a quantity, and its unit is "
                      "unknown; rename it",
                      column.header));
    } else if (record_.has(column.header)) {
      refused.push_back(
          fmt::format("column '{}' can't drive an effect: it is named like a quantity "
                      "of the probe; rename it",
                      column.header));
    } else {
      if (!can_name(column.header) && column.header != files::flight_number) {
        unnameable.push_back(column.header);
      }
      take(column.header, column, nullptr);  // what can't be named is compared all the same
    }
  }
  if (unnameable.size() == 1) {
    refused.push_back(fmt::format(
        "column '{}' can't drive an effect: a name has no blanks, brackets or ^; rename it, "
        "e.g. to throttle_pct",
        unnameable.front()));
  } else if (!unnameable.empty()) {
    refused.push_back(
        fmt::format("columns '{}' can't drive an effect: a name has no blanks, "
                    "brackets or ^; rename those that may",
                    fmt::join(unnameable, "', '")));
  }
  const std::size_t told = std::min(refused.size(), most_notes);
  for (std::size_t i = 0; i < told; ++i) note(refused[i]);
  if (told < refused.size()) {
    note(fmt::format("{} more columns can't drive an effect", refused.size() - told));
  }
}

void RecordBuilder::note_dropped(std::string_view consequence) {
  for (const Dropped& dropped : dropped_) {
    note(fmt::format("{} of {} rows {}: {}", dropped.rows, flight_.rows(), consequence,
                     dropped.reason));
  }
}

}  // namespace sepcal::probes
