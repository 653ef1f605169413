// SPDX-License-Identifier: BSD-3-Clause
// What a model reads of a log: its quantities by the base name of their columns.
#pragma once

#include <array>
#include <span>
#include <string_view>

#include "flight/files/units.hpp"
#include "flight/logs/chosen_rows.hpp"

namespace sepcal {
class Probe;
}

namespace sepcal::probes {

/// How a fit takes a quantity that was logged: row by row, as a truth that is not looked at, or not
/// at all.
enum class Taken { by_row, as_known, never };

/// A quantity of a probe: the base name of its column and what kind of unit follows it.
struct ProbeQuantity {
  std::string_view name;
  files::UnitKind kind;
  bool is_driver = false;             // may drive effects too, then under its whole header
  bool is_extra = false;              // no fit needs it: effects may
  const files::Unit* bare = nullptr;  // of a header that is its name alone; nullptr: none may be
  Taken taken = Taken::by_row;
  std::array<std::string_view, 2> unless = {};  // logged, these are taken in its place
  bool is_measured = false;  // a reading of the instrument itself: joined rates stand in its rows
};

/// How a fit looks at a log: at an instrument's readings, at the coefficients of each row, or at a
/// trajectory, whose state goes on from row to row; the latter two of an aircraft, whose motion all
/// its sensors show.
enum class LooksAt { readings, coefficients, trajectory };

/// What a model reads of a log, needed or not.
struct ModelQuantities {
  // Implicit: whoever asks for a model's quantities has its probe.
  ModelQuantities(const Probe& probe);  // NOLINT(google-explicit-constructor)
  ModelQuantities(std::span<const ProbeQuantity> quantities, LooksAt what)
      : list(quantities), looks_at(what) {}

  std::span<const ProbeQuantity> list;
  LooksAt looks_at = LooksAt::readings;
};

/// Whether a choice takes a row by what it holds and when it was logged; empty where it takes all.
/// `flight` as read_as() gives it. Throws OptionError as the choice's condition and times do.
logs::RowTruth rows_taken(const ModelQuantities& model, const Flight& flight,
                          const LogChoice& choice);

}  // namespace sepcal::probes
