// SPDX-License-Identifier: BSD-3-Clause
// Flights, and what is done with a probe on one: calibrate, compare, add, apply, save and load.
#include "sepcal/flight/flight.hpp"

#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include <cmath>

#include "arrays.hpp"
#include "bindings.hpp"
#include "python_effect.hpp"
#include "sepcal/error.hpp"
#include "sepcal/flight/adding.hpp"
#include "sepcal/flight/apply.hpp"
#include "sepcal/flight/calibration.hpp"
#include "sepcal/flight/comparison.hpp"
#include "sepcal/flight/flight_diagnosis.hpp"
#include "sepcal/flight/probe_effects.hpp"

namespace sepcal::bindings {
namespace {

using namespace py::literals;
using WithoutGil = py::call_guard<py::gil_scoped_release>;

std::vector<std::string> headers(const Flight& flight) {
  std::vector<std::string> headers;
  for (const Flight::Column& column : flight.columns()) headers.push_back(column.header);
  return headers;
}

void view(Flight& flight, const std::string& header, const Array& values) {
  auto [span, owner] = view_array(values);
  flight.view(header, span, std::move(owner));
}

/// None where there is no such column.
py::object column(const Flight& flight, const std::string& header) {
  const Flight::Column* found = flight.find(header);
  if (found == nullptr) return py::none();
  return read_only_array(found->values, found->owner);
}

std::vector<std::string> maneuvers(const Flight& flight) {
  return {flight.maneuvers().begin(), flight.maneuvers().end()};
}

/// [(header, values, first cell that is no number or None), ...]
using PickledColumns =
    std::vector<std::tuple<std::string, Array, std::optional<std::pair<std::size_t, std::string>>>>;
using PickledFlight =
    std::tuple<std::string, std::string, PickledColumns, std::vector<std::string>>;

/// All that a flight is, so that another process says and writes the same of it.
PickledFlight pickled(const Flight& flight) {
  PickledColumns columns;
  for (const auto& [header, values, owner, first_text] : flight.columns()) {
    std::optional<std::pair<std::size_t, std::string>> text;
    if (first_text) text.emplace(first_text->row, first_text->text);
    columns.emplace_back(header, read_only_array(values, owner), std::move(text));
  }
  return {flight.name(), flight.sha256(), std::move(columns), maneuvers(flight)};
}

Flight unpickled(const PickledFlight& state) {
  const auto& [name, sha256, columns, labels] = state;
  Flight flight(name, sha256);
  for (const auto& [header, values, text] : columns) {
    std::optional<Flight::Cell> first_text;
    if (text) first_text = Flight::Cell{text->first, text->second};
    auto [span, owner] = view_array(values);
    flight.view(header, span, std::move(owner), std::move(first_text));
  }
  if (!labels.empty()) flight.label(labels);
  return flight;
}

void define_flights(py::module_& module) {
  py::class_<Flight>(module, "Flight")
      .def(py::init<std::string>())
      .def("view", &view, "header"_a, "values"_a.noconvert())
      .def("label",
           [](Flight& self, std::vector<std::string> labels) { self.label(std::move(labels)); })
      .def("column", &column)
      .def("list_columns", &Flight::list_columns)
      .def_property_readonly("name", &Flight::name)
      .def_property_readonly("sha256", &Flight::sha256)
      .def_property_readonly("rows", &Flight::rows)
      .def_property_readonly("headers", &headers)
      .def_property_readonly("maneuvers", &maneuvers)
      .def(py::pickle(&pickled, &unpickled));
  module.def("read_csv", [](const std::string& file) { return read_csv(file); }, WithoutGil());
}

py::list describe(const std::vector<Misfit>& misfits) {
  py::list list;
  for (const Misfit& misfit : misfits) {
    list.append(py::dict("segment"_a = misfit.segment, "output"_a = misfit.output,
                         "unit"_a = misfit.unit, "rows"_a = misfit.rows, "rmse"_a = misfit.rmse,
                         "mean"_a = misfit.mean, "lag_one"_a = misfit.lag_one,
                         "verdict"_a = verdict_on_noise(misfit)));
  }
  return list;
}

py::list describe(const std::vector<ChannelMisfit>& channels) {
  py::list list;
  for (const ChannelMisfit& channel : channels) {
    list.append(py::dict("driver"_a = channel.driver, "output"_a = channel.output,
                         "share_line"_a = channel.share_line,
                         "share_smooth"_a = channel.share_smooth, "slope"_a = channel.slope,
                         "slope_error"_a = channel.slope_error, "unit"_a = channel.unit));
  }
  return list;
}

py::list describe(const std::vector<Window>& windows) {
  const auto by_output = [](const std::vector<OutputValue>& values) {
    py::dict dictionary;
    for (const OutputValue& value : values) dictionary[py::str(value.name)] = value.value;
    return dictionary;
  };
  py::list list;
  for (const Window& window : windows) {
    list.append(py::dict("first_s"_a = window.first_s, "last_s"_a = window.last_s,
                         "rows"_a = window.rows, "rmse"_a = by_output(window.rmse),
                         "mean"_a = by_output(window.mean)));
  }
  return list;
}

/// Keys as the fields of sepcal.Comparison.
py::dict describe(Comparison comparison) {
  py::dict described(
      "model"_a = comparison.model, "file"_a = comparison.flight.file,
      "status"_a = to_string(comparison.status), "message"_a = comparison.message,
      "overall"_a = describe(comparison.overall), "where"_a = describe(comparison.where),
      "channels"_a = describe(comparison.channels), "windows"_a = describe(comparison.windows),
      "residuals"_a = comparison.residuals, "notes"_a = comparison.notes,
      "json"_a = to_json(comparison));
  add_pages(described, comparison);
  described["time"] = adopt(std::move(comparison.time));
  return described;
}

/// {name: keys as the fields of sepcal.Derived}
py::dict describe(const std::vector<Derived>& derived) {
  py::dict by_name;
  for (const Derived& quantity : derived) {
    by_name[py::str(quantity.name)] = py::dict(
        "name"_a = quantity.name, "value"_a = quantity.value,
        "standard_error"_a = quantity.standard_error,
        "standard_error_white"_a = quantity.standard_error_white, "unit"_a = quantity.unit);
  }
  return by_name;
}

py::dict compare_with(const Calibration& calibration, const Flight& flight) {
  const auto run = [&] {
    const py::gil_scoped_release release;
    need_own_effects(calibration);
    return compare(calibration, flight);
  };
  return describe(run());
}

/// What the app's diagnose prints, as JSON and as text, and notes.
py::dict diagnose_on(const Calibration& calibration, const Flight& flight,
                     const std::vector<PythonEffect>& own,
                     const std::optional<SizedEffect>& injected, int simulations,
                     std::uint64_t seed) {
  const OwnEffects makers = own_effects(own, effect_kit(calibration.probe->name()));
  DiagnosisOptions options;
  options.threads = calibration.options.fit.threads;
  options.simulations = simulations;
  options.seed = seed;
  const auto run = [&] {
    const py::gil_scoped_release release;
    need_own_effects(calibration);
    return injected ? diagnose_with(*injected, calibration, flight, makers, options)
                    : diagnose(calibration, flight, makers, options);
  };
  const FlightDiagnosis diagnosis = run();
  py::dict described("json"_a = to_json(diagnosis), "notes"_a = diagnosis.notes);
  add_pages(described, diagnosis);
  return described;
}

/// {header: values}
py::dict apply_to(const Calibration& calibration, const Flight& flight) {
  const auto run = [&] {
    const py::gil_scoped_release release;
    need_own_effects(calibration);
    return apply(calibration, flight);
  };
  py::dict corrected;
  for (CorrectedColumn& column : run()) {
    corrected[py::str(column.header)] = adopt(std::move(column.values));
  }
  return corrected;
}

/// Keys as the fields of sepcal.Applied.
py::dict describe(const Applied& applied) {
  return py::dict("rows"_a = applied.rows, "rows_left_empty"_a = applied.rows_left_empty,
                  "headers"_a = applied.headers, "notes"_a = applied.notes);
}

py::dict apply_file(const Calibration& calibration, const std::string& file,
                    const std::string& output) {
  const auto run = [&] {
    const py::gil_scoped_release release;
    need_own_effects(calibration);
    return apply_to_file(calibration, file, output);
  };
  return describe(run());
}

Calibration calibrate_probe(const Model& model, const Flight& flight, CalibrationOptions options,
                            const std::vector<PythonEffect>& own) {
  if (model.probe == nullptr) {
    throw Error("this model takes no flight; give its inputs and outputs as {name: array}");
  }
  options.own_effects = own_effects(own, effect_kit(model.probe->name()));
  const py::gil_scoped_release release;
  return calibrate(model.probe, flight, options);
}

Calibration add_to(const Calibration& base, const Flight& flight, const std::string& effect,
                   const std::vector<PythonEffect>& own) {
  const OwnEffects makers = own_effects(own, effect_kit(base.probe->name()));
  const py::gil_scoped_release release;
  need_own_effects(base);
  return add(base, flight, effect, makers);
}

/// Keys as the fields of sepcal.HistoryEntry; None where a number is undefined.
py::list describe(const std::vector<HistoryEntry>& history) {
  const auto number = [](double value) -> py::object {
    return std::isnan(value) ? py::object(py::none()) : py::object(py::float_(value));
  };
  py::list list;
  for (const HistoryEntry& entry : history) {
    list.append(py::dict("effect"_a = entry.effect, "rmse_before"_a = number(entry.rmse_before),
                         "rmse_after"_a = number(entry.rmse_after),
                         "held_out_before"_a = number(entry.held_out_before),
                         "held_out_after"_a = number(entry.held_out_after),
                         "predicted_drop"_a = number(entry.predicted_drop)));
  }
  return list;
}

Calibration with_own_effects(Calibration calibration, const std::vector<PythonEffect>& own) {
  give_own_effects(calibration, own);
  return calibration;
}

}  // namespace

void define_flight(py::module_& module) {
  define_flights(module);
  py::class_<Calibration>(module, "Calibration")
      .def_property_readonly(
          "fit", [](const Calibration& self) { return bindings::describe(self.fit, self.options); })
      .def_property_readonly("derived",
                             [](const Calibration& self) { return describe(self.derived); })
      .def_property_readonly("history",
                             [](const Calibration& self) { return describe(self.history); })
      .def_readonly("notes", &Calibration::notes)
      .def_property_readonly("file", [](const Calibration& self) { return self.flight.file; })
      .def("compare", &compare_with)
      .def("diagnose",
           [](const Calibration& self, const Flight& flight, const std::vector<PythonEffect>& own,
              const std::optional<std::pair<std::string, std::vector<double>>>& injected,
              int simulations, std::uint64_t seed) {
             std::optional<SizedEffect> hidden;
             if (injected) hidden = SizedEffect{injected->first, injected->second};
             return diagnose_on(self, flight, own, hidden, simulations, seed);
           })
      .def("intervals", &bindings::find_intervals)
      .def("predict", &bindings::predict)
      .def("add", &add_to)
      .def("apply", &apply_to)
      .def("apply_to_file", &apply_file)
      .def_property_readonly("model", [](const Calibration& self) { return self.probe->name(); })
      .def_property_readonly(
          "unit",
          [](const Calibration& self) { return self.probe->model().tables().outputs.front().unit; })
      .def("pages",
           [](const Calibration& self) {
             py::dict described;
             add_pages(described, self);
             return described;
           })
      .def("to_json", [](const Calibration& self) { return to_json(self); })
      .def("save", &write_calibration, WithoutGil());
  module.def("calibrate", &calibrate_probe);
  using Own = std::vector<PythonEffect>;
  module.def("parse_calibration",
             [](const std::string& json, const std::string& source, const Own& own) {
               return with_own_effects(parse_calibration(json, source), own);
             });
  module.def("read_calibration", [](const std::string& file, const Own& own) {
    return with_own_effects(read_calibration(file), own);
  });
}

}  // namespace sepcal::bindings
