// SPDX-License-Identifier: BSD-3-Clause
#include "flight/logs/chosen_rows.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "sepcal/detail/quantity.hpp"
#include "sepcal/error.hpp"

namespace sepcal::logs {
namespace {

/// The label of a row, from stretches that cover the rows.
RowText labels_of(const Flight& flight) {
  auto stretches = std::make_shared<const std::vector<Segment>>(flight.label_stretches());
  if (stretches->empty()) return {};
  return [stretches](std::size_t row) -> std::string_view {
    return std::ranges::upper_bound(*stretches, row, {}, &Segment::last)->label;
  };
}

/// A quantity that was logged in another unit than `name` says: "roll_deg" of roll_rad; empty where
/// there is none.
RowNumber in_other_unit(const std::string& name, const FindQuantity& find) {
  const std::size_t split = name.rfind('_');
  if (split == std::string::npos) return {};
  const auto quantity = find(name.substr(0, split));
  if (!quantity) return {};
  const files::Unit* unit = files::find_unit(quantity->unit->kind, name.substr(split + 1));
  if (unit == nullptr) return {};
  const double zero = unit->convert(0.0);
  const double one = unit->convert(1.0) - zero;
  return [quantity = *quantity, zero, one](std::size_t row) {
    return (quantity.at(row) - zero) / one;
  };
}

}  // namespace

RowTruth rows_where(const Flight& flight, const LogChoice& choice, const FindQuantity& find) {
  if (choice.where.empty()) return {};
  const auto number = [&](const std::string& name) -> RowNumber {
    if (const Flight::Column* column = flight.find(name)) {
      return [values = column->values](std::size_t row) { return values[row]; };
    }
    if (const auto quantity = find(name)) {
      return [quantity = *quantity](std::size_t row) { return quantity.at(row); };
    }
    if (RowNumber converted = in_other_unit(name, find)) return converted;
    throw Error(fmt::format("'{}' is no column; {}", name, flight.list_columns()));
  };
  try {
    return parse_condition(choice.where, {number, labels_of(flight)});
  } catch (const Error& error) {
    throw OptionError({flight.name() + ": ", Option{"where"}, fmt::format(": {}", error.what())});
  }
}

RowTruth rows_within_times(const Flight& flight, const LogChoice& choice) {
  if (!choice.from_time && !choice.to_time) return {};
  const auto time = files::find_quantity(flight, "time", files::UnitKind::time);
  const Option used{choice.from_time ? "from_time" : "to_time"};
  if (!time) {
    throw OptionError({flight.name() + ": ", used,
                       fmt::format(" needs a column time_s; {}", flight.list_columns())});
  }
  const double first = choice.from_time.value_or(-infinity);
  const double last = choice.to_time.value_or(infinity);
  if (!(first < last)) {
    throw OptionError({Option{"from_time"}, fmt::format(" {} is not before ", first),
                       Option{"to_time"}, fmt::format(" {}", last)});
  }
  return [time = *time, first, last](std::size_t row) {
    const double now = time.at(row);
    return now >= first && now <= last;
  };
}

}  // namespace sepcal::logs
