// SPDX-License-Identifier: BSD-3-Clause
// What a log is, before anything is fitted.
#include "sepcal/flight/check.hpp"

#include <utility>

#include "bindings.hpp"
#include "released.hpp"
#include "results.hpp"
#include "structs.hpp"

namespace sepcal::bindings {
namespace {

Checked check_flight(const Model& model, const Flight& flight, const CalibrationOptions& options) {
  const Released released;
  return checked(sepcal::check(probe_of(model), flight, options.log));
}

void define_parts(py::module_& module) {
  BoundStruct<ColumnCheck>(module, "ColumnCheck",
                           "One column of a log, in the header's unit; NaN where there is none.")
      .field("header", &ColumnCheck::header, "")
      .field("quantity", &ColumnCheck::quantity,
             R"(That the probe reads it as, "airspeed"; empty: a channel.)")
      .field("missing", &ColumnCheck::missing, "Cells that are no finite number.")
      .field("least", &ColumnCheck::least, "")
      .field("median", &ColumnCheck::median, "")
      .field("largest", &ColumnCheck::largest, "")
      .field("step", &ColumnCheck::step, "That its values stand apart by, where they lie on steps.")
      .field("repeated", &ColumnCheck::repeated, "Share of rows that repeat the one before.")
      .field("rate", &ColumnCheck::rate, "New values a second [Hz].")
      .comparable()
      .finish();

  BoundStruct<LogNote>(module, "LogNote", "Something about a log.").told().comparable().finish();
}

}  // namespace

void define_check(py::module_& module) {
  define_parts(module);
  BoundStruct<Checked>(module, "FlightCheck",
                       "A log's description, and what each problem does to a calibration.")
      .field("model", &Checked::check, &FlightCheck::model, "")
      .field("file", &Checked::check, &FlightCheck::file, "File of the flight.")
      .field("refused", &Checked::check, &FlightCheck::refused,
             "A fit's refusal of it; empty: it would not refuse.")
      .field("duration", &Checked::check, &FlightCheck::duration, "[s]")
      .field("rate", &Checked::check, &FlightCheck::rate, "Rows a second [Hz].")
      .field("columns", &Checked::check, &FlightCheck::columns, "")
      .field("notes", &Checked::check, &FlightCheck::notes, "Worst first.")
      .field("json", &Checked::json, "")
      .field("text", &Checked::text, "The app's page, as print() shows it.")
      .copied()
      .finish();
  module.def("check", &check_flight);
}

}  // namespace sepcal::bindings
