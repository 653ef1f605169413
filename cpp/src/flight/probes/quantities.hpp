// SPDX-License-Identifier: BSD-3-Clause
// What each probe, or model of an aircraft, reads of a log: its quantities by the base name of
// their columns.
#pragma once

#include <span>
#include <string_view>

#include "flight/files/units.hpp"
#include "flight/logs/chosen_rows.hpp"

namespace sepcal {
class Probe;
}

namespace sepcal::probes {

/// A quantity of a probe: the base name of its column and what kind of unit follows it.
struct ProbeQuantity {
  std::string_view name;
  files::UnitKind kind;
  bool is_driver = false;             // may drive effects too, then under its whole header
  bool is_extra = false;              // no fit needs it: effects may
  const files::Unit* bare = nullptr;  // of a header that is its name alone; nullptr: none may be
};

/// What a model reads of a log, needed or not, and the model's name.
struct ModelQuantities {
  // Implicit: whoever asks for a model's quantities has its name or a probe.
  // NOLINTBEGIN(google-explicit-constructor)
  ModelQuantities(std::string_view name);
  ModelQuantities(const char* name) : ModelQuantities(std::string_view(name)) {}
  ModelQuantities(const Probe& probe);
  // NOLINTEND(google-explicit-constructor)

  std::string_view model;
  std::span<const ProbeQuantity> list;
};

/// Whether the model carries a state from row to row: one of an aircraft's, but for equation error.
bool has_state(std::string_view model);

/// Of the model by that name, needed or not. Throws Error where there is no such model.
std::span<const ProbeQuantity> quantities_of(std::string_view model);

/// Whether a choice takes a row by what it holds and when it was logged; empty where it takes all.
/// `flight` as read_as() gives it. Throws OptionError as the choice's condition and times do.
logs::RowTruth rows_taken(const ModelQuantities& model, const Flight& flight,
                          const LogChoice& choice);

}  // namespace sepcal::probes
