// SPDX-License-Identifier: BSD-3-Clause
// Models, and a fit on columns that are the model's own inputs and outputs.
#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include <array>
#include <cmath>
#include <list>
#include <optional>
#include <tuple>
#include <utility>

#include "arrays.hpp"
#include "base/name_list.hpp"
#include "base/sentences.hpp"
#include "bindings.hpp"
#include "flight/probes/mounting.hpp"
#include "flight/verbs/held_options.hpp"
#include "python_effect.hpp"
#include "python_model.hpp"
#include "released.hpp"
#include "results.hpp"
#include "sepcal/concatenation.hpp"
#include "sepcal/detail/compiled_models.hpp"
#include "sepcal/detail/flight/effect_catalogue.hpp"
#include "sepcal/detail/innovation_model.hpp"
#include "sepcal/detail/models/scalar_examples.hpp"
#include "sepcal/error.hpp"
#include "sepcal/fit_with_effects.hpp"
#include "sepcal/flight/calibration.hpp"
#include "sepcal/flight/own_model.hpp"

namespace sepcal::bindings {
namespace {

using namespace py::literals;

/// [(name, unit, lower, upper, absent), ...]; `absent` is NaN but for an input that data may lack.
template <auto Table>
py::list describe_table(const Model& model) {
  py::list list;
  for (const Variable& variable : model.block->tables().*Table) {
    list.append(py::make_tuple(variable.name, variable.unit, variable.lower, variable.upper,
                               variable.absent));
  }
  return list;
}

using Row = std::tuple<std::string, std::string, double, double>;  // name, unit, lower, upper

std::vector<Variable> to_table(const std::vector<Row>& rows) {
  std::vector<Variable> table;
  for (const auto& [name, unit, lower, upper] : rows) table.emplace_back(name, unit, lower, upper);
  return table;
}

Model python_model(const std::string& name, const std::array<std::vector<Row>, 4>& tables,
                   const PythonFunctions& functions, const Source& source) {
  const Tables all{to_table(tables[0]), to_table(tables[1]), to_table(tables[2]),
                   to_table(tables[3])};
  return plain_model(name, std::make_shared<const PythonModel>(name, all, functions),
                     {source.first, source.second});
}

/// The model for a record of these columns.
Model lay_along(const Model& model, const py::dict& columns,
                const std::vector<std::string>& labels) {
  if (!model.along) return model;
  const Record record = record_of(columns, labels);
  Model laid(model.along(&record));
  laid.held = model.held;
  return laid;
}

/// A record as one block; inputs that it lacks are constant.
class WholeRecord {
 public:
  WholeRecord(const Tables& tables, const Record& record) : rows_(record.length()) {
    for (const Variable& input : tables.inputs) {
      const bool absent = !record.has(input.name) && std::isfinite(input.absent);
      if (absent) constants_.emplace_back(rows_, input.absent);
      inputs_.push_back(absent ? constants_.back().data() : record.column(input.name).data());
    }
  }

  Block block() const { return {.inputs = inputs_, .rows = rows_}; }

 private:
  std::size_t rows_;
  std::vector<const double*> inputs_;
  std::list<std::vector<double>> constants_;
};

/// [A | b], or [A | D | b] where xi1 is given: (n_z * N) x columns, an output after the other.
Eigen::MatrixXd evaluate(const Model& model, const py::dict& columns, const Eigen::VectorXd& xi2,
                         const std::optional<Eigen::VectorXd>& xi1) {
  const Record record = record_of(columns, {});
  const Released released;
  const Tables& tables = model.block->tables();
  const WholeRecord whole(tables, record);
  const auto measurements = static_cast<Eigen::Index>(record.length()) * tables.n_z();
  Eigen::MatrixXd rows(measurements, tables.n_1() + (xi1 ? tables.n_2() : 0) + 1);
  const auto carry = model.block->new_carry();
  model.block->evaluate(whole.block(), values_of(xi2), xi1 ? values_of(*xi1) : nullptr, carry.get(),
                        rows);
  return rows;
}

/// Readings of a trajectory that noises drive, (N, n_z). `xi`: all parameters; `sizes`: of process
/// noises, then of outputs'; `normals`: independent standard normal numbers.
Eigen::MatrixXd draw(const Model& model, const py::dict& columns, const Eigen::VectorXd& xi,
                     const Eigen::VectorXd& sizes, const Eigen::VectorXd& normals) {
  Record record = record_of(columns, {});
  const Released released;
  for (const Variable& output : model.block->tables().outputs) {
    record.add(output.name, std::vector<double>(record.length(), 0.0));
  }
  const auto innovations = model.block->innovations(record);
  if (innovations == nullptr) throw Error("only a model with a state has process noise");
  Eigen::VectorXd theta(innovations->size());
  theta << xi, sizes.array().log().matrix();
  Eigen::Index next = 0;
  return innovations->draw(theta, [&] { return normals[next++]; });
}

/// d(A xi1 + b)/du of the inputs chosen by their place: (n_z * N) x inputs.
Eigen::MatrixXd input_tangent(const Model& model, const py::dict& columns,
                              const Eigen::VectorXd& xi2, const Eigen::VectorXd& xi1,
                              const std::vector<int>& inputs) {
  const Record record = record_of(columns, {});
  const Released released;
  const Tables& tables = model.block->tables();
  const WholeRecord whole(tables, record);
  Eigen::MatrixXd tangent(static_cast<Eigen::Index>(record.length()) * tables.n_z(),
                          static_cast<Eigen::Index>(inputs.size()));
  model.block->input_tangent(whole.block(), values_of(xi2), values_of(xi1), inputs, tangent);
  return tangent;
}

/// "b_psi is held at 0; ..." of what a model holds by default.
std::string note_held(const Model& model, const CalibrationOptions& given, const Fit& fit) {
  std::vector<std::string> names;
  for (const Parameter& parameter : fit.parameters) {
    const bool by_default =
        model.held.contains(parameter.name) && !given.fit.fix.contains(parameter.name);
    if (by_default && parameter.fixed) names.push_back(parameter.name);
  }
  if (names.empty()) return "";
  return "held at zero, as hardly any record tells " +
         std::string(names.size() > 1 ? "them" : "it") + ": " + base::list_names(names) +
         " (free=[...] frees)";
}

FittedModel fit_columns(const Model& model, const py::dict& columns,
                        const std::vector<std::string>& labels, CalibrationOptions options,
                        const std::vector<PythonEffect>& own) {
  Record record = record_of(columns, labels);
  EffectKit kit = model.kit();
  options.own_effects = own_effects(own, kit);
  const auto run = [&] {
    if (model.probe != nullptr) {
      Calibration calibration = calibrate(model.probe, record, options);
      options.effects = std::move(calibration.options.effects);
      return std::move(calibration.fit);
    }
    if (!options.free.empty() && model.held.empty()) {
      throw Error("free is for sepcal's own probes: this model holds no parameter by default");
    }
    const CalibrationOptions held = verbs::hold(model.held, model.block->tables(), options);
    for (const auto& [name, maker] : options.own_effects) kit.own[name] = maker;
    Fit fit = fit_with_effects(model.block, kit, options.effects, std::move(record), held.fit);
    fit.message = base::join_sentences({fit.message, note_held(model, options, fit)});
    return fit;
  };
  const Released released;
  Fit fit = run();
  Page page = page_of(fit, options);
  return fitted_model(std::move(fit), std::move(options.effects), std::move(page));
}

}  // namespace

void define_engine(py::module_& module) {
  py::class_<Model>(module, "Model")
      .def_property_readonly("inputs", &describe_table<&Tables::inputs>)
      .def_property_readonly("outputs", &describe_table<&Tables::outputs>)
      .def_property_readonly("linear", &describe_table<&Tables::linear>)
      .def_property_readonly("nonlinear", &describe_table<&Tables::nonlinear>)
      .def("along", &lay_along)
      .def("evaluate", &evaluate)
      .def("draw", &draw)
      .def_property_readonly("process_noises",
                             [](const Model& model) {
                               std::vector<std::string> names;
                               for (const Variable& noise : model.block->process_noises()) {
                                 names.push_back(noise.name);
                               }
                               return names;
                             })
      .def_property_readonly("ships_a_probe",
                             [](const Model& model) { return model.probe != nullptr; })
      .def("input_tangent", &input_tangent);

  module.def("effects_of", [](const Model& model) { return effect_catalogue(probe_of(model)); });

  using Vector = std::array<double, 3>;
  module.def("scalar_example_1",
             [] { return plain_model("scalar-example-1", block_model(ScalarExample1{})); });
  module.def("scalar_example_2",
             [] { return plain_model("scalar-example-2", block_model(ScalarExample2{})); });
  module.def("accelerometer",
             [] { return plain_model("accelerometer", block_model(Accelerometer{})); });
  module.def("concatenation", [](const std::vector<std::pair<std::string, Model>>& parts) {
    std::vector<Sensor> sensors;
    for (const auto& [label, model] : parts) sensors.push_back({label, model.block});
    return plain_model("concatenation", concatenate(sensors));
  });
  module.def("five_hole_probe", [](double k_alpha, double k_beta, const Vector& lever_arm) {
    return Model(std::shared_ptr<const Probe>(five_hole_probe(k_alpha, k_beta, lever_arm)));
  });
  module.def("vane_boom", [](const Vector& lever_arm) {
    return Model(std::shared_ptr<const Probe>(vane_boom_probe(lever_arm)));
  });
  module.def("pitot_static",
             [] { return Model(std::shared_ptr<const Probe>(pitot_static_probe())); });
  module.def(
      "attitude_independent_magnetometer",
      [](std::optional<double> field_strength, double noise) {
        return Model(
            std::shared_ptr<const Probe>(attitude_independent_probe(field_strength, noise)));
      },
      "field_strength"_a, "noise"_a = 0.0);
  module.def("angles_of_quaternion", &probes::angles_of_quaternion, "quaternion"_a);
  // `mounting`: none, a sensor in body axes; empty, to be found in the flight; or three angles.
  module.def("magnetometer", [](const std::optional<Vector>& field,
                                const std::optional<std::vector<double>>& mounting) {
    std::map<std::string, std::vector<double>> settings;
    if (field) settings["field"] = {field->begin(), field->end()};
    if (mounting) settings["mounting"] = *mounting;
    return Model(std::shared_ptr<const Probe>(make_probe("magnetometer", settings)));
  });
  py::class_<PythonFunctions>(module, "PythonFunctions")
      .def(py::init<py::object, py::object, py::object, py::object>(), "gather"_a, "at"_a,
           "try_at"_a, "derivatives"_a);
  module.def("python_model", &python_model);
  module.def("fit", &fit_columns);
}

}  // namespace sepcal::bindings
