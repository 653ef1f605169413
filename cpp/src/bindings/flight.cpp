// SPDX-License-Identifier: BSD-3-Clause
// Flights, and what is done with a probe on one: calibrate, compare, apply, save and load.
#include "sepcal/flight/flight.hpp"

#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include "arrays.hpp"
#include "bindings.hpp"
#include "sepcal/error.hpp"
#include "sepcal/flight/apply.hpp"
#include "sepcal/flight/calibration.hpp"
#include "sepcal/flight/comparison.hpp"

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
      .def_property_readonly("maneuvers", &maneuvers);
  module.def("read_csv", [](const std::string& file) { return read_csv(file); }, WithoutGil());
}

py::list describe(const std::vector<Misfit>& misfits) {
  py::list list;
  for (const Misfit& misfit : misfits) {
    list.append(py::dict("segment"_a = misfit.segment, "output"_a = misfit.output,
                         "unit"_a = misfit.unit, "rows"_a = misfit.rows, "rmse"_a = misfit.rmse,
                         "mean"_a = misfit.mean, "lag_one"_a = misfit.lag_one));
  }
  return list;
}

/// Keys as the fields of sepcal.Comparison.
py::dict describe(Comparison comparison) {
  return py::dict("status"_a = to_string(comparison.status), "message"_a = comparison.message,
                  "overall"_a = describe(comparison.overall),
                  "where"_a = describe(comparison.where), "residuals"_a = comparison.residuals,
                  "notes"_a = comparison.notes, "json"_a = to_json(comparison),
                  "time"_a = adopt(std::move(comparison.time)));
}

py::dict compare_with(const Calibration& calibration, const Flight& flight) {
  const auto run = [&] {
    const py::gil_scoped_release release;
    return compare(calibration, flight);
  };
  return describe(run());
}

/// {header: values}
py::dict apply_to(const Calibration& calibration, const Flight& flight) {
  const auto run = [&] {
    const py::gil_scoped_release release;
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
    return apply_to_file(calibration, file, output);
  };
  return describe(run());
}

Calibration calibrate_probe(const Model& model, const Flight& flight,
                            const CalibrationOptions& options) {
  if (model.probe == nullptr) {
    throw Error("this model takes no flight; give its inputs and outputs as {name: array}");
  }
  return calibrate(model.probe, flight, options);
}

}  // namespace

void define_flight(py::module_& module) {
  define_flights(module);
  py::class_<Calibration>(module, "Calibration")
      .def_property_readonly("fit",
                             [](const Calibration& self) { return bindings::describe(self.fit); })
      .def_readonly("notes", &Calibration::notes)
      .def_property_readonly("file", [](const Calibration& self) { return self.flight.file; })
      .def("compare", &compare_with)
      .def("apply", &apply_to)
      .def("apply_to_file", &apply_file)
      .def("to_json", [](const Calibration& self) { return to_json(self); })
      .def("save", &write_calibration, WithoutGil());
  module.def("calibrate", &calibrate_probe, WithoutGil());
  module.def("parse_calibration", [](const std::string& json, const std::string& source) {
    return parse_calibration(json, source);
  });
  module.def("read_calibration", [](const std::string& file) { return read_calibration(file); });
}

}  // namespace sepcal::bindings
