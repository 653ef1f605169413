// SPDX-License-Identifier: BSD-3-Clause
// A model of AircraftOptions laid along a flight: what fit(), compare and apply have in common.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "flight/aircraft/aircraft_columns.hpp"
#include "sepcal/detail/block_model.hpp"
#include "sepcal/detail/states/compiled_trajectories.hpp"
#include "sepcal/error.hpp"
#include "sepcal/flight/aircraft.hpp"
#include "sepcal/models/flight_path.hpp"
#include "sepcal/record.hpp"

namespace sepcal::aircraft_log {

struct LaidAircraft {
  std::shared_ptr<const BlockModel> model;
  std::shared_ptr<const StateBlockModel> path;  // the same, where it is a path
  Record record;
  FitOptions fit;
  std::vector<AeroEquation> equations;
  std::shared_ptr<const BlockModel> base;  // the model without effects along its trajectory
  std::vector<EffectSetting> effects;      // with what they took from the flight
  std::vector<Effect> along;               // those along the trajectory, made
  std::optional<Band> band;                // that it is fitted over
  double window = not_a_number;  // of the differentiation of rates [s]; NaN where there is none
  std::vector<std::string> initial_states;  // names of parameters
  std::vector<std::string> notes;
  std::string warning;
  std::vector<std::size_t> flight_rows;  // of the record's rows
  std::vector<GappedOutput> gaps = {};   // of the model; the record has straight lines in them
};

/// The record as the likelihood takes it: NaN where an output has no reading.
Record readings_of(const LaidAircraft& laid);

/// Throws Error where an output has gaps, for a verb that takes every row: "diagnose".
void need_every_reading(const LaidAircraft& laid, std::string_view verb);

/// Those of the effects that act along the trajectory.
std::vector<EffectSetting> effects_along(const AircraftOptions& options,
                                         const std::vector<EffectSetting>& effects);

/// Throws Error as fit_aircraft() does.
LaidAircraft lay(const Flight& flight, const AircraftOptions& options);

/// The same for the first so many rows of its segments.
LaidAircraft lay_first_rows(const Flight& flight, const AircraftOptions& options, std::size_t rows);

/// The same of a record that no log has, with the columns of one that was laid.
LaidAircraft lay_record(Record record, const AircraftOptions& options);

/// Throws Error for a fit over a band, for a verb that looks at rows in time: "is profiled".
void need_rows_in_time(const AircraftFit& fitted, std::string_view what_it_needs);

/// A fit's own options for a flight: of another one than it was fitted to without its initial
/// states.
AircraftOptions options_on(const AircraftFit& fitted, const Flight& flight);

/// The model, which has a state. Throws Error where it has none.
const StateBlockModel& state_model_of(const LaidAircraft& laid, const AircraftFit& fitted);

/// States and process noise along the record at a fit of it.
SmoothedRecord smooth_laid(const AircraftFit& fitted, const Fit& fit, const LaidAircraft& laid,
                           const ProcessNoise& process_noise);

/// The fit of what is laid; the times of steps among its effects are found and kept.
Fit fit_laid(LaidAircraft& laid, const FitOptions& options);

/// The record with inputs as the effects of a fit leave them. It views columns of the one laid.
Record seen_by_model(const LaidAircraft& laid, const Fit& fit);

/// The record with states as the model has them, not as made of what an output read, which its own
/// noise would be seen to follow. `residuals` (rows of the segments x n_z): of the readings.
Record channels_beside(const LaidAircraft& laid, const Eigen::MatrixXd& residuals);

bool is_same_flight(const AircraftFit& fitted, const Flight& flight);

/// The geometry, which every model but path needs. Throws Error where there is none.
const AircraftGeometry& geometry_of(const AircraftOptions& options);

/// What `work` gives; the flight's name opens its messages.
template <class Work>
auto within(const Flight& flight, const Work& work) {
  try {
    return work();
  } catch (const Error& error) {
    throw_within(flight.name() + ": ", error, "");
  }
}

/// The fit as it stands; of another flight than its own with the initial states estimated anew, all
/// else held, and a note.
Fit fit_on(const Flight& flight, const AircraftFit& fitted, LaidAircraft& laid);

/// The equations of options.model, or those given, with the terms of the effects.
std::vector<AeroEquation> equations_of(const AircraftOptions& options);

}  // namespace sepcal::aircraft_log
