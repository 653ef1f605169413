// SPDX-License-Identifier: BSD-3-Clause
#include "base/page.hpp"
#include "flight/export/provenance.hpp"
#include "flight/export/vehicle_notes.hpp"
#include "flight/files/json_values.hpp"
#include "sepcal/flight/export.hpp"

namespace sepcal {

using base::Page;
using base::page;
using namespace exporting;  // this room's own

namespace {

files::Json write_approximation(const Approximation& approximation) {
  using files::number;
  return {{"dropped", approximation.dropped},
          {"flight", approximation.flight},
          {"rows", approximation.rows},
          {"rotation_deg", number(approximation.rotation_deg)},
          {"heading_rms_deg", number(approximation.heading_rms_deg)},
          {"heading_largest_deg", number(approximation.heading_largest_deg)},
          {"strength_rms_ut", number(approximation.strength_rms_ut)},
          {"airspeed_rms_mps", number(approximation.airspeed_rms_mps)},
          {"airspeed_largest_mps", number(approximation.airspeed_largest_mps)},
          {"residual_before", number(approximation.residual_before)},
          {"residual_after", number(approximation.residual_after)},
          {"residual_unit", approximation.residual_unit}};
}

}  // namespace

std::string to_text(const Exported& exported, const std::string& output) {
  Page text = page("wrote {}: ", output);
  if (exported.parameters.empty()) {
    text += page("the correction as a {} header, with its self-test\n",
                 exported.target == ExportTarget::c ? "C" : "C++");
  } else {
    text += page("{} parameters of {}\n", exported.parameters.size(),
                 exported.target == ExportTarget::px4 ? "PX4" : "ArduPilot");
  }
  for (const std::string& effect : exported.left_to_others) {
    text += page("{}: acts on the reference or the wind, no part of the correction\n", effect);
  }
  if (!exported.approximation) return text.text();
  if (!exported.approximation->flight.empty()) {
    text += page("against the calibration, over {} rows of {}:\n", exported.approximation->rows,
                 exported.approximation->flight);
  }
  for (const std::string& line : approximation_lines(*exported.approximation))
    text += page("  {}\n", line);
  for (const std::string& line : rotation_lines(exported)) text += page("  {}\n", line);
  return text.text();
}

std::string to_json(const Exported& exported, const std::string& output) {
  files::Json parameters = files::Json::object();
  for (const VehicleParameter& one : exported.parameters) {
    parameters[one.name] = files::number(one.value);
  }
  const Fit& fit = exported.calibration.fit;
  files::Json estimates = files::Json::object();
  for (const Parameter& one : fit.parameters) estimates[one.name] = files::number(one.value);
  return files::text_of(
      {{"schema_version", schema_version},
       {"model", exported.calibration.probe->name()},
       {"to", to_string(exported.target)},
       {"output", output},
       {"parameters", std::move(parameters)},
       {"held", std::move(estimates)},
       {"left_to_others", exported.left_to_others},
       {"approximation", exported.approximation ? write_approximation(*exported.approximation)
                                                : files::Json(nullptr)},
       {"rotation", exported.rotation ? files::Json(to_string(*exported.rotation)) : files::Json()},
       {"other_approximation", exported.other_approximation
                                   ? write_approximation(*exported.other_approximation)
                                   : files::Json(nullptr)},
       {"status", to_string(fit.status)},
       {"message", fit.message}});
}

}  // namespace sepcal
