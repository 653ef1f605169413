// SPDX-License-Identifier: BSD-3-Clause
#include "flight/export/held_rotation.hpp"

#include <fmt/format.h>

#include <utility>
#include <vector>

#include "flight/export/approximation.hpp"
#include "flight/export/fit_for_use.hpp"
#include "flight/export/vehicle_notes.hpp"

namespace sepcal::exporting {
namespace {

/// One of the two, on a flight.
struct Held {
  Calibration calibration;
  Approximation approximation;
};

Held hold(const ToHold& field, Calibration calibration) {
  Approximation approximation =
      field_approximation(field.given, calibration, held_field(calibration), *field.flight);
  return {std::move(calibration), std::move(approximation)};
}

/// The refit, or a note on why there is none. Throws Error where it is asked for.
std::optional<Held> try_refit(const ToHold& field, const Calibration& kept,
                              const ExportOptions& options, std::vector<std::string>& notes) {
  if (field.of_several) {
    notes.emplace_back("the calibration is of several flights, and a refit is of one: it is kept");
    return std::nullopt;
  }
  try {
    Calibration refit = refit_kept(kept, *field.flight, options.progress);
    if (!options.force) check_fit_for_use(refit, "the refit");
    return hold(field, std::move(refit));
  } catch (const Error& error) {
    if (options.rotation == ExportRotation::refit) throw;
    notes.push_back(
        fmt::format("the rotation is kept out, as there is no refit: {}", error.what()));
    return std::nullopt;
  }
}

/// As asked, else the one whose heading is nearer at its worst: where that is not known, keep.
bool takes_refit(const Approximation& keep, const Approximation& refit,
                 const ExportOptions& options) {
  if (options.rotation) return *options.rotation == ExportRotation::refit;
  return refit.heading_largest_deg < keep.heading_largest_deg;
}

/// What a strength shows holds all of it: no rotation.
Approximation hold_strength(const ToHold& field, Calibration& held) {
  held = field.base;
  Approximation approximation;
  if (field.flight != nullptr) approximation = hold(field, held).approximation;
  drop_rotation(false, approximation);
  return approximation;
}

}  // namespace

Approximation hold_field(const ToHold& field, const ExportOptions& options, Calibration& held,
                         Exported& exported) {
  if (!is_of_known_field(field.base)) return hold_strength(field, held);
  Approximation approximation;
  held = keep_held(field.base, field.mounting);
  exported.rotation = ExportRotation::keep;
  if (field.flight == nullptr) {
    approximation.rotation_deg = angle_of(lost_rotation(field.base, held));
    exported.notes.emplace_back(
        "the flight is not at hand as it was fitted: the calibration is kept less its rotation; "
        "give the flight after the calibration to see what that loses in heading, and whether a "
        "refit loses less");
  } else {
    Held taken = hold(field, held);
    std::optional<Held> other = try_refit(field, held, options, exported.notes);
    if (other && takes_refit(taken.approximation, other->approximation, options)) {
      std::swap(taken, *other);
      exported.rotation = ExportRotation::refit;
    }
    held = std::move(taken.calibration);
    approximation = std::move(taken.approximation);
    if (other) exported.other_approximation = std::move(other->approximation);
  }
  drop_rotation(true, approximation);
  return approximation;
}

}  // namespace sepcal::exporting
