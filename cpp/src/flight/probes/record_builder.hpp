// SPDX-License-Identifier: BSD-3-Clause
// The steps from a flight to a record that all probes share. A probe names its quantities, says
// which ones it needs, drops the rows it can't use and finishes.
#pragma once

#include <functional>
#include <initializer_list>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "flight/files/headers.hpp"
#include "flight/files/units.hpp"
#include "flight/probes/kept_rows.hpp"
#include "flight/probes/plausible_readings.hpp"
#include "flight/probes/quantities.hpp"
#include "sepcal/detail/flight/probe_columns.hpp"

namespace sepcal::probes {

using files::LoggedQuantity;

class RecordBuilder {
 public:
  using Names = std::initializer_list<std::string_view>;
  using RowTest = std::function<bool(std::size_t row)>;
  using RowValue = std::function<double(std::size_t row)>;

  /// `flight` as read_as() gives it. Throws Error for one of the quantities in two units, for a
  /// column of drop_repeats or a name in a condition that is not there.
  RecordBuilder(const Flight& flight, std::span<const ProbeQuantity> quantities,
                const LogChoice& choice);

  bool has(Names names) const;

  /// Where one of these was not logged and a header nearly is its: "; did you mean ...?"; else
  /// nothing.
  OptionError::Message ask_for_near_miss(Names names) const;

  /// Throws Error for a quantity that was not logged.
  const LoggedQuantity& logged(std::string_view name) const;

  /// Columns that the record has, or throws Error that names those that were not logged.
  void need(Names names);

  /// Columns that need() would ask for, but that only serve to compute others.
  void consult(Names names);

  /// Columns that the record has too if all of them were logged and hold nothing but numbers;
  /// returns whether the kept rows do. Call it after the rows were chosen.
  bool offer(Names names);

  /// Throws Error for, or drops, rows in which a needed or consulted cell is no finite number,
  /// as it stands or once converted. Of rates that are joined such rows are dropped.
  void keep_valid();

  /// Throws Error where time does not increase from one kept row to the next.
  void check_time() const;

  struct Loss {
    std::size_t rows = 0;
    std::size_t first = 0;  // the flight's row
  };

  /// Drops the rows that fail `test`.
  Loss keep(const RowTest& test, std::string_view reason);

  /// As keep(), but unless drop_invalid the first lost row is an error that says `complaint(row)`.
  void keep_or_refuse(const RowTest& test, std::string_view reason,
                      const std::function<std::string(std::size_t row)>& complaint);

  /// The flight's rows that are kept.
  const KeptRows& rows() const { return rows_; }

  /// A column of the probe's own making, computed from the flight's row when finishing.
  void compute(std::string name, RowValue value);

  /// Of a magnetometer, what its readings are held against: of one in counts far from 50 uT.
  void expect_field(double strength) { field_strength_ = strength; }

  /// A line for people; the flight's name is put before it.
  void note(std::string_view text);

  /// The kept rows, with candidate drivers and segments; readings that no flight has are noted.
  /// Throws Error where no row is left.
  ProbeRecord finish();

  /// All rows, those kept marked as valid; no drivers, one segment. Notes as finish() does.
  ProbeReadings finish_readings();

 private:
  std::string say_not_used(const Flight::Column& column, std::size_t row,
                           const RowTest& is_valid) const;
  void find_quantity(const ProbeQuantity& quantity);
  void note_unknown_units();
  void choose_rows(const LogChoice& choice);
  void drop_repeats(const std::vector<std::string>& columns);
  void refuse_other_rates(const std::vector<const LoggedQuantity*>& quantities,
                          const RowTest& is_whole) const;
  const ProbeQuantity& quantity_of(std::string_view name) const;
  std::vector<std::string> other_headers() const;
  OptionError::Message say_unknown(std::string_view name) const;
  std::vector<files::MappedColumn> find_near_columns(std::span<const std::string_view> names) const;
  [[noreturn]] void fail_missing(std::span<const std::string_view> names) const;
  bool is_quantity(const Flight::Column& column) const;
  bool is_named_like_quantity(std::string_view header) const;
  std::optional<Reading> find_reading(std::string_view name) const;
  void note_implausible();
  void add(std::string name, const RowValue& value);
  void take(std::string name, const Flight::Column& column, const files::Unit* unit);
  std::vector<Segment> label_kept() const;
  void take_quantities();
  void check_computed() const;
  void take_drivers();
  void note_dropped(std::string_view consequence);

  const Flight& flight_;
  std::span<const ProbeQuantity> quantities_;
  bool drop_invalid_;
  std::optional<double> field_strength_;
  bool is_joined_;  // to the rows of what is measured
  std::map<std::string_view, LoggedQuantity> logged_;
  std::map<std::string_view, const Flight::Column*> unknown_;  // of a quantity's name in no unit
  std::vector<std::string_view> taken_;                        // quantities that the record has
  std::vector<std::string_view> checked_;  // quantities in which every kept cell is a number
  std::vector<std::pair<std::string, RowValue>> computed_;
  KeptRows rows_;
  Record record_;
  std::vector<Dropped> dropped_;
  std::vector<std::string> notes_;
};

}  // namespace sepcal::probes
