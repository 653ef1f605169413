// SPDX-License-Identifier: BSD-3-Clause
// Models, and a fit on columns that are the model's own inputs and outputs.
#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include <array>
#include <optional>

#include "arrays.hpp"
#include "bindings.hpp"
#include "sepcal/flight/calibration.hpp"
#include "sepcal/models/scalar_examples.hpp"

namespace sepcal::bindings {
namespace {

/// [(name, unit, lower, upper), ...]
template <auto Table>
py::list describe_table(const Model& model) {
  py::list list;
  for (const Variable& variable : model.block->tables().*Table) {
    list.append(py::make_tuple(variable.name, variable.unit, variable.lower, variable.upper));
  }
  return list;
}

/// [A | b], or [A | D | b] where xi1 is given: (n_z * N) x columns, an output after the other.
Eigen::MatrixXd evaluate(const Model& model, const py::dict& columns, const Eigen::VectorXd& xi2,
                         const std::optional<Eigen::VectorXd>& xi1) {
  const Record record = record_of(columns, {});
  const py::gil_scoped_release release;
  const Tables& tables = model.block->tables();
  std::vector<const double*> inputs;
  for (const Variable& input : tables.inputs) inputs.push_back(record.column(input.name).data());
  const auto measurements = static_cast<Eigen::Index>(record.length()) * tables.n_z();
  Eigen::MatrixXd rows(measurements, tables.n_1() + (xi1 ? tables.n_2() : 0) + 1);
  const auto carry = model.block->new_carry();
  model.block->evaluate({.inputs = inputs, .rows = record.length()}, xi2.data(),
                        xi1 ? values_of(*xi1) : nullptr, carry.get(), rows);
  return rows;
}

py::dict fit_columns(const Model& model, const py::dict& columns,
                     const std::vector<std::string>& labels, const CalibrationOptions& options) {
  const Record record = record_of(columns, labels);
  const auto run = [&] {
    const py::gil_scoped_release release;
    return fit(*model.block, record, options.fit);
  };
  return describe(run());
}

}  // namespace

void define_engine(py::module_& module) {
  py::class_<Model>(module, "Model")
      .def_property_readonly("inputs", &describe_table<&Tables::inputs>)
      .def_property_readonly("outputs", &describe_table<&Tables::outputs>)
      .def_property_readonly("linear", &describe_table<&Tables::linear>)
      .def_property_readonly("nonlinear", &describe_table<&Tables::nonlinear>)
      .def("evaluate", &evaluate);

  using Vector = std::array<double, 3>;
  module.def("scalar_example_1", [] { return Model(block_model(ScalarExample1{})); });
  module.def("scalar_example_2", [] { return Model(block_model(ScalarExample2{})); });
  module.def("five_hole_probe", [](double k_alpha, double k_beta, const Vector& lever_arm) {
    return Model(std::shared_ptr<const Probe>(five_hole_probe(k_alpha, k_beta, lever_arm)));
  });
  module.def("magnetometer", [](const std::optional<Vector>& field) {
    return Model(std::shared_ptr<const Probe>(magnetometer_probe(field)));
  });
  module.def("fit", &fit_columns);
}

}  // namespace sepcal::bindings
