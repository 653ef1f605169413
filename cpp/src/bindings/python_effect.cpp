// SPDX-License-Identifier: BSD-3-Clause
#include "python_effect.hpp"

#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "arrays.hpp"
#include "sepcal/detail/flight/probe_effects.hpp"
#include "sepcal/error.hpp"

namespace sepcal::bindings {
namespace {

using Columns = std::vector<std::pair<std::string, Eigen::MatrixXd>>;
using Function = std::shared_ptr<const py::object>;  // takes the GIL to give it back

/// The record's columns; the arrays keep it alive. The GIL is held.
py::dict columns_of(const Record& record) {
  const auto kept = std::make_shared<const Record>(record);
  py::dict columns;
  for (const std::string& name : kept->names()) {
    columns[py::str(name)] = read_only_array(kept->column(name), kept);
  }
  return columns;
}

/// What the function gives of a record; the GIL is held.
py::object ask(const Function& function, const BlockModel& model, const Record& record) {
  return (*function)(columns_of(record), model.tables().n_z());
}

std::vector<double> ask_driver(const Function& function, const BlockModel& model,
                               const Record& record) {
  const py::gil_scoped_acquire gil;
  const auto answer = ask(function, model, record).cast<Array>();
  return {answer.data(), answer.data() + answer.size()};
}

Columns ask_columns(const Function& function, const BlockModel& model, const Record& record) {
  const py::gil_scoped_acquire gil;
  return ask(function, model, record).cast<Columns>();
}

/// Throws Error for a value within the segments that is no number.
void check_finite(const std::string& name, const std::vector<double>& values,
                  const Record& record) {
  for (const Segment& segment : record.segments()) {
    for (std::size_t row = segment.first; row < segment.last; ++row) {
      if (std::isfinite(values[row])) continue;
      throw Error("effect " + name + ": its function gives " + std::to_string(values[row]) +
                  " in row " + std::to_string(row) + " (counted from 0); give finite numbers");
    }
  }
}

/// On a port: what the function gives is the driver.
EffectKit::Maker on_port(const std::string& name, const Port& port, const std::string& unit,
                         const Function& function) {
  return [=](const BlockModel& model, EffectSetting& setting, Record& record) {
    if (record.has(name)) {
      throw Error("effect " + name +
                  ": the record has a column of that name; give the effect another");
    }
    std::vector<double> values = ask_driver(function, model, record);
    if (!setting.known) check_finite(name, values, record);
    record.add(name, std::move(values));
    return make_driven(name, port, power_driver({name, ""}, 0.0, 1), unit, model, record);
  };
}

/// Without a port: the function gives columns of the outputs.
EffectKit::Maker on_outputs(const std::string& name, const std::string& unit,
                            const Function& function) {
  return [=](const BlockModel& model, EffectSetting& /*setting*/, Record& record) {
    return column_effect(name, unit, ask_columns(function, model, record), model, record);
  };
}

EffectKit::Maker make(const PythonEffect& effect, const EffectKit& kit) {
  const auto& [name, port, unit, function] = effect;
  if (!port) return on_outputs(name, unit, share(function));
  const auto found = std::ranges::find(kit.ports, *port, &Port::name);
  if (found != kit.ports.end()) return on_port(name, *found, unit, share(function));
  std::string known;
  for (const Port& one : kit.ports) known += (known.empty() ? "" : ", ") + one.name;
  throw Error("effect " + name + ": there is no port '" + *port + "'; the model has: " + known);
}

}  // namespace

OwnEffects own_effects(const std::vector<PythonEffect>& effects, const EffectKit& kit) {
  OwnEffects own;
  for (const PythonEffect& effect : effects) {
    const std::string& name = std::get<0>(effect);
    const bool is_port = std::ranges::find(kit.ports, name, &Port::name) != kit.ports.end();
    if (is_port || kit.own.contains(name) || kit.aliases.contains(name)) {
      throw Error("effect " + name + ": the model has an effect or a port of that name already; " +
                  "give yours another");
    }
    if (own.contains(name)) {
      throw Error("effect " + name + " is given twice; give each a name of its own");
    }
    own[name] = make(effect, kit);
  }
  return own;
}

void give_own_effects(Calibration& calibration, const std::vector<PythonEffect>& effects) {
  OwnEffects own = own_effects(effects, effect_kit(*calibration.probe));
  for (const auto& [name, maker] : own) {
    std::string there;
    for (const EffectSetting& setting : calibration.options.effects) {
      there += (there.empty() ? "" : ", ") + setting.name;
    }
    if (std::ranges::find(calibration.options.effects, name, &EffectSetting::name) !=
        calibration.options.effects.end()) {
      continue;
    }
    throw Error("the calibration has no effect " + name +
                "; it has: " + (there.empty() ? "none" : there));
  }
  calibration.options.own_effects = std::move(own);
}

void need_own_effects(const Calibration& calibration) {
  const EffectKit kit = effect_kit(*calibration.probe);
  for (const EffectSetting& setting : calibration.options.effects) {
    const bool is_driven = setting.name.find('[') != std::string::npos;
    if (is_driven || kit.own.contains(setting.name)) continue;
    if (calibration.options.own_effects.contains(setting.name)) continue;
    throw Error("the calibration's effect " + setting.name +
                " is of its author's own making and not in the file; give it: "
                "sepcal.load(file, effects=[sepcal.Effect(\"" +
                setting.name + "\", ...)])");
  }
}

}  // namespace sepcal::bindings
