// SPDX-License-Identifier: BSD-3-Clause
// A calibration as something that a vehicle loads.
#include "sepcal/flight/export.hpp"

#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <map>
#include <utility>

#include "bindings.hpp"
#include "released.hpp"
#include "results.hpp"
#include "structs.hpp"

namespace sepcal::bindings {
namespace {

/// sepcal.Exported
struct ExportedFile {
  std::string output;
  std::string text;
  std::map<std::string, double> parameters;
  std::optional<Approximation> approximation;
  std::optional<std::string> rotation;
  std::optional<Approximation> other_approximation;
  std::vector<std::string> left_to_others;
  std::vector<std::string> notes;
  std::string json;
  std::string page;
};

/// A file that appears whole or not at all, as the apps'.
ExportedFile write_export(const Calibration& calibration, const std::string& output,
                          const std::string& target, const std::optional<Flight>& flight,
                          std::optional<int> sensor, std::optional<std::uint32_t> device_id,
                          std::optional<std::array<double, 3>> mounting,
                          std::optional<double> in_use, const std::string& logged_airspeed,
                          const std::optional<std::string>& airspeed_sensor,
                          std::optional<std::array<double, 3>> cal_air,
                          const std::vector<std::string>& without, bool force,
                          const std::optional<std::string>& rotation, bool single) {
  const Released released;
  const auto to = choice_of<ExportTarget>("to", target);
  std::optional<AirspeedSensor> tube;
  if (airspeed_sensor) tube = choice_of<AirspeedSensor>("airspeed_sensor", *airspeed_sensor);
  std::optional<ExportRotation> how;
  if (rotation) how = choice_of<ExportRotation>("rotation", *rotation);
  Exported exported = sepcal::export_to_file(
      calibration, flight ? &*flight : nullptr,
      {.target = to,
       .sensor = sensor,
       .device_id = device_id,
       .in_use = in_use,
       .logged_airspeed = choice_of<LoggedAirspeed>("logged_airspeed", logged_airspeed),
       .airspeed_sensor = tube,
       .cal_air = cal_air,
       .rotation = how,
       .mounting = mounting,
       .single = single,
       .without = without,
       .force = force},
      output);
  ExportedFile result{.output = output,
                      .text = std::move(exported.text),
                      .parameters = {},
                      .approximation = exported.approximation,
                      .rotation = {},
                      .other_approximation = exported.other_approximation,
                      .left_to_others = exported.left_to_others,
                      .notes = exported.notes,
                      .json = to_json(exported, output),
                      .page = without_last_end(to_text(exported, output))};
  if (exported.rotation) result.rotation = to_string(*exported.rotation);
  for (const VehicleParameter& one : exported.parameters) result.parameters[one.name] = one.value;
  return result;
}

/// sepcal.logs: the name of a tube's sensor and whether air flows through it; None: not known.
std::optional<std::pair<std::string, bool>> pressure_sensor(std::uint32_t device_id) {
  const auto sensor = px4_pressure_sensor(device_id);
  if (!sensor) return std::nullopt;
  return std::pair(std::string(sensor->name), sensor->kind == AirspeedSensor::sdp3x);
}

}  // namespace

void define_export(py::module_& module) {
  BoundStruct<Approximation>(
      module, "Approximation",
      "What a vehicle's correction lacks of a calibration's, over the fitted "
      "rows of a flight; NaN where it isn't known.")
      .field("dropped", &Approximation::dropped, "In words.")
      .field("flight", &Approximation::flight, "")
      .field("rows", &Approximation::rows, "That both correct.")
      .field("rotation_deg", &Approximation::rotation_deg,
             "Between sensor and body, which has no home on the vehicle.")
      .field("heading_rms_deg", &Approximation::heading_rms_deg,
             "The vehicle's magnetic heading less the calibration's.")
      .field("heading_largest_deg", &Approximation::heading_largest_deg, "By size.")
      .field("strength_rms_ut", &Approximation::strength_rms_ut, "The field's strength, likewise.")
      .field("airspeed_rms_mps", &Approximation::airspeed_rms_mps, "The true airspeed, likewise.")
      .field("airspeed_largest_mps", &Approximation::airspeed_largest_mps, "By size.")
      .field("residual_before", &Approximation::residual_before,
             "RMS of measured less modelled, of the calibration.")
      .field("residual_after", &Approximation::residual_after,
             "Residual of what the vehicle holds.")
      .field("residual_unit", &Approximation::residual_unit, "")
      .comparable()
      .finish();
  BoundStruct<ExportedFile>(module, "Exported", "The result of export().")
      .field("output", &ExportedFile::output, "The file.")
      .field("text", &ExportedFile::text, "All that is in it.")
      .field("parameters", &ExportedFile::parameters, "Parameters of an autopilot, by name.")
      .field("approximation", &ExportedFile::approximation, "None where nothing was changed.")
      .field("rotation", &ExportedFile::rotation,
             "For a magnetometer that the calibration turns: keep or refit, else None.")
      .field("other_approximation", &ExportedFile::other_approximation,
             "The loss of the other one; None where it is not known.")
      .field("left_to_others", &ExportedFile::left_to_others,
             "Effects that act on the reference or the wind: no part of a correction.")
      .field("notes", &ExportedFile::notes,
             "Notes on what a person must know or do, one line each.")
      .field("json", &ExportedFile::json, "As the app's export prints it.")
      .field("page", &ExportedFile::page, "The app's page, as print() shows it.")
      .copied()
      .finish();
  module.def("export_to_file", &write_export);
  module.def("px4_pressure_sensor", &pressure_sensor);
  module.def("sdp3x_pressure", py::vectorize(&sdp3x_pressure));
}

}  // namespace sepcal::bindings
