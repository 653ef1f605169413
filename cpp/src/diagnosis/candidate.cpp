// SPDX-License-Identifier: BSD-3-Clause
#include "diagnosis/candidate.hpp"

#include <algorithm>
#include <cmath>

#include "base/parts_of_record.hpp"
#include "effects/driven_rows.hpp"
#include "model/measurements.hpp"
#include "model/sweep.hpp"
#include "sepcal/composition.hpp"
#include "sepcal/error.hpp"

namespace sepcal::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::RowVectorXd;
using Eigen::VectorXd;

constexpr double rounding = 1e-11;  // of an output's rms: a smaller residual is none

/// `count` values within the bounds of a shape, away from the ends, where a step or a ramp would
/// leave one side without rows; evenly in the logarithm where the bounds span a decade above zero.
std::vector<double> spread(const Variable& shape, int count) {
  const bool by_ratio = shape.lower > 0 && shape.upper > 10.0 * shape.lower && shape.name != "t0";
  std::vector<double> values;
  for (int i = 0; i < count; ++i) {
    const double share = (i + 0.5) / count;
    values.push_back(by_ratio ? shape.lower * std::pow(shape.upper / shape.lower, share)
                              : shape.lower + share * (shape.upper - shape.lower));
  }
  return values;
}

ShapeGrid grid_of(const Effect& effect) {
  constexpr int times = 40;
  constexpr int others = 9;
  ShapeGrid grid{"", {not_a_number}};
  if (!effect.driver || !effect.driver->shape()) return grid;
  const Variable& shape = *effect.driver->shape();
  grid.parameter = effect.name + "." + shape.name;
  grid.values = spread(shape, shape.name == "t0" ? times : others);
  grid.tried = static_cast<double>(grid.values.size());
  return grid;
}

/// The names of an effect's parameters but its shape's, found by composing it with `model`.
std::vector<Variable> coefficients_of(const BlockModel& with, const BlockModel& without,
                                      const std::string& shape) {
  std::vector<Variable> names;
  const std::vector<Variable> before = without.tables().parameters();
  for (const Variable& parameter : with.tables().parameters()) {
    const bool old = std::ranges::find(before, parameter.name, &Variable::name) != before.end();
    if (!old && parameter.name != shape) names.push_back(parameter);
  }
  return names;
}

Index find_column(const std::vector<Variable>& parameters, const std::string& name) {
  return std::ranges::find(parameters, name, &Variable::name) - parameters.begin();
}

/// The values of a model's parameters by name; zero for a coefficient that has none.
VectorXd values_in_order(const std::vector<Variable>& parameters,
                         const base::ParameterValues& values) {
  VectorXd ordered = VectorXd::Zero(static_cast<Index>(parameters.size()));
  for (std::size_t k = 0; k < parameters.size(); ++k) {
    const auto at = values.find(parameters[k].name);
    if (at != values.end()) ordered[static_cast<Index>(k)] = at->second;
  }
  return ordered;
}

/// Of what an output measured about its mean, with N - 1.
double variance_of(const model::Measurements& measurements, int output) {
  double count = 0.0;
  double mean = 0.0;
  double square = 0.0;  // about it
  for (const auto& chunk : measurements.chunks()) {
    for (const model::Measurements::Range& range : chunk) {
      for (const double value : measurements.output(output, range)) {
        const double off = value - mean;
        mean += off / ++count;
        square += off * (value - mean);
      }
    }
  }
  return count > 1.0 ? square / (count - 1.0) : 0.0;
}

/// Whether the effect is a port's columns times a driver's functions and nothing else.
bool is_driven(const Effect& effect, const EffectKit& kit) {
  return effect.driver && effect.terms.empty() && effect.delays.empty() &&
         std::ranges::find(kit.ports, effect.port, &Port::name) != kit.ports.end();
}

}  // namespace

CandidateRoom::CandidateRoom(const DiagnosedFit& fitted, base::ThreadPool& pool)
    : fitted_(fitted),
      record_(fitted.record),
      settings_(fitted.effects),
      effects_(make_effects(fitted.kit, *fitted.model, settings_, record_)),
      values_(fitted.fit.by_name()) {
  linearise(fitted.fit, pool);
}

void CandidateRoom::add_wandering() {
  linearisation_.wandering = wandering_columns();
  if (linearisation_.wandering.cols() > 0) linearisation_.times = times();
}

void CandidateRoom::linearise(const Fit& fit, base::ThreadPool& pool) {
  const auto model = this->model();
  const Tables& tables = model->tables();
  const std::vector<Variable> parameters = tables.parameters();
  if (!std::ranges::equal(fit.parameters, parameters, {}, &Parameter::name, &Variable::name)) {
    throw Error("the fit's parameters are not those of its model with its effects");
  }
  Record rows = record_;
  rows.cut(fitted_.rows);
  const model::Measurements measurements(*model, rows);
  RowLayout& layout = linearisation_.layout;
  layout = {.segments = base::join_segments(fitted_.rows),
            .runs = measurements.runs(),
            .rows = static_cast<Index>(rows.rows())};
  std::vector<Index> columns;
  for (std::size_t k = 0; k < fit.parameters.size(); ++k) {
    if (fit.parameters[k].fixed || fit.parameters[k].at_bound) continue;
    columns.push_back(static_cast<Index>(k));
    linearisation_.parameters.push_back(fit.parameters[k].name);
  }
  columns.push_back(static_cast<Index>(parameters.size()));
  MatrixXd& tangent = linearisation_.tangent;
  tangent = model::Sweep(*model, measurements, pool).tangent_columns(fit.xi1(), fit.xi2(), columns);
  const auto count = static_cast<double>(layout.rows);
  for (int j = 0; j < tables.n_z(); ++j) {
    const auto& output = tables.outputs[static_cast<std::size_t>(j)];
    const double rmse =
        tangent.rightCols<1>().middleRows(j * layout.rows, layout.rows).norm() / std::sqrt(count);
    const double rms = std::sqrt(measurements.output_square(j) / count);
    if (!(rmse > rounding * rms) || !(rmse > 0)) continue;
    layout.outputs.push_back({j, output.name, output.unit, rmse, variance_of(measurements, j)});
  }
  scale_outputs(tangent);
  linearisation_.residual = tangent.rightCols<1>();
  tangent.conservativeResize(Eigen::NoChange, tangent.cols() - 1);
}

/// Those of a correction that the fit has already are the tangent's.
MatrixXd CandidateRoom::wandering_columns() {
  Columns all;
  for (const EffectKit::Maker& maker : fitted_.kit.wandering) {
    EffectSetting setting;
    const Effect effect = maker(*fitted_.model, setting, record_);
    std::vector<std::string> names;
    for (const Variable& coefficient :
         coefficients_of(*compose(fitted_.model, {effect}, record_), *fitted_.model, {})) {
      names.push_back(coefficient.name);
    }
    const std::vector<std::string>& fitted = linearisation_.parameters;
    const auto known = std::ranges::find(fitted, names.front());
    const std::vector<Parameter>& own = fitted_.fit.parameters;
    const bool has = std::ranges::find(own, names.front(), &Parameter::name) != own.end();
    if (has && known == fitted.end()) continue;  // held, as the caller has it
    all = join(all, known == fitted.end()
                        ? Columns(composed_columns({effect}, {}, names))
                        : view(linearisation_.tangent.middleCols(
                              known - fitted.begin(), static_cast<Index>(names.size()))));
  }
  return all.dense(linearisation_.layout);
}

void CandidateRoom::scale_outputs(MatrixXd& stacked) const {
  const RowLayout& layout = linearisation_.layout;
  for (std::size_t j = 0; j < layout.outputs.size(); ++j) {
    const UsedOutput& output = layout.outputs[j];
    for (auto column : stacked.colwise()) {
      column.segment(layout.first(j), layout.rows) =
          column.segment(output.index * layout.rows, layout.rows) / output.scale;
    }
  }
  if (stacked.rows() != layout.count()) {
    stacked.conservativeResize(layout.count(), Eigen::NoChange);
  }
}

MatrixXd CandidateRoom::composed_columns(const std::vector<Effect>& added,
                                         const base::ParameterValues& shapes,
                                         const std::vector<std::string>& names) const {
  const auto model = model_with(added);
  base::ParameterValues values = values_;
  values.insert(shapes.begin(), shapes.end());
  Record rows = record_;
  rows.cut(fitted_.rows);
  const model::Measurements measurements(*model, rows);
  const std::vector<Variable> parameters = model->tables().parameters();
  std::vector<Index> columns;
  for (const std::string& name : names) columns.push_back(find_column(parameters, name));
  base::ThreadPool alone(1);
  MatrixXd stacked =
      model::Sweep(*model, measurements, alone)
          .tangent_columns(values_in_order(model->tables().linear, values),
                           values_in_order(model->tables().nonlinear, values), columns);
  scale_outputs(stacked);
  return stacked;
}

std::shared_ptr<const BlockModel> CandidateRoom::model() const {
  return compose(fitted_.model, effects_, record_);
}

std::shared_ptr<const BlockModel> CandidateRoom::model_with(
    const std::vector<Effect>& added) const {
  std::vector<Effect> all = effects_;
  all.insert(all.end(), added.begin(), added.end());
  return compose(fitted_.model, all, record_);
}

const Candidate& CandidateRoom::make(const std::string& name) {
  const auto known = made_.find(name);
  if (known != made_.end()) return known->second;
  Candidate candidate = make_anew(name);
  const std::string resolved = candidate.name;
  const auto made = made_.emplace(resolved, std::move(candidate)).first;
  return resolved == name ? made->second : made_.emplace(name, made->second).first->second;
}

Candidate CandidateRoom::make_anew(const std::string& name) {
  Candidate candidate{.name = name};
  const std::vector<std::string> parts = split_effects(name);
  if (parts.size() == 1) {
    candidate.settings = {{.name = parts.front()}};
    candidate.effects = make_effects(fitted_.kit, *fitted_.model, candidate.settings, record_);
  } else {
    for (const std::string& part : parts) {
      const Candidate& single = make(part);
      candidate.settings.push_back(single.settings.front());
      candidate.effects.push_back(single.effects.front());
    }
  }
  std::vector<Effect> all = effects_;
  candidate.shape = {"", {not_a_number}};
  for (const Effect& effect : candidate.effects) {
    const auto before = compose(fitted_.model, all, record_);
    all.push_back(effect);
    const ShapeGrid grid = grid_of(effect);
    if (!grid.parameter.empty()) {
      if (!candidate.shape.parameter.empty()) {
        throw Error("effect " + name + " would need a scan in two directions; try them one by one");
      }
      candidate.shape = grid;
    }
    const auto with = compose(fitted_.model, all, record_);
    const auto names = coefficients_of(*with, *before, grid.parameter);
    candidate.coefficients.insert(candidate.coefficients.end(), names.begin(), names.end());
    if (is_driven(effect, fitted_.kit)) {
      port_columns(*std::ranges::find(fitted_.kit.ports, effect.port, &Port::name));
    }
  }
  const Effect& first = candidate.effects.front();
  if (candidate.effects.size() == 1 && is_driven(first, fitted_.kit) && first.driver->is_step()) {
    candidate.stepping_port = first.port;
  }
  std::string joined;
  for (const EffectSetting& setting : candidate.settings) {
    joined += (joined.empty() ? "" : "+") + setting.name;
    for (const std::string& driver : driver_channels(parse_effect_name(setting.name))) {
      if (std::ranges::find(candidate.drivers, driver) == candidate.drivers.end()) {
        candidate.drivers.push_back(driver);
      }
    }
  }
  candidate.name = joined;
  return candidate;
}

std::vector<double> CandidateRoom::times() const {
  Record rows = record_;
  rows.cut(fitted_.rows);
  return base::gather_time(rows);
}

const MatrixXd& CandidateRoom::port_columns(const Port& port) {
  const auto known = ports_.find(port.name);
  if (known != ports_.end()) return known->second;
  const Effect constant =
      make_driven("constant", port, constant_driver(), port.unit, *fitted_.model, record_);
  std::vector<std::string> names;
  for (const Port::Component& component : port.components)
    names.push_back("constant." + component.name);
  return ports_.emplace(port.name, composed_columns({constant}, {}, names)).first->second;
}

CandidateColumns CandidateRoom::driven_columns(const Effect& effect, double shape) const {
  const RowLayout& layout = linearisation_.layout;
  const auto phi = std::make_shared<MatrixXd>(effects::drive(*effect.driver, shape, record_));
  for (std::size_t i = 0; i < layout.segments.size(); ++i) {  // none lies behind its rows there
    const Segment& from = fitted_.rows[i];
    const auto length = static_cast<Index>(from.rows());
    for (auto column : phi->colwise()) {
      column.segment(static_cast<Index>(layout.segments[i].first), length) =
          column.segment(static_cast<Index>(from.first), length).unaryExpr([](double value) {
            return std::isfinite(value) ? value : 0.0;
          });
    }
  }
  if (phi->rows() != layout.rows) phi->conservativeResize(layout.rows, Eigen::NoChange);
  const auto about = [&](const RowVectorXd& centre) -> Columns {
    const MatrixXd& port = ports_.at(effect.port);
    return {port.cols() * phi->cols(),
            [&port, phi, centre, N = layout.rows](Index first, Eigen::Ref<MatrixXd> rows) {
              const MatrixXd driver = phi->middleRows(first % N, rows.rows()).rowwise() - centre;
              for (Index c = 0; c < port.cols(); ++c) {
                rows.middleCols(c * driver.cols(), driver.cols()) =
                    driver.array().colwise() * port.col(c).segment(first, rows.rows()).array();
              }
            }};
  };
  return {about(RowVectorXd::Zero(phi->cols())), about(phi->colwise().mean())};
}

CandidateColumns CandidateRoom::columns(const Candidate& candidate, double shape) const {
  CandidateColumns all;
  const auto append = [&all](const CandidateColumns& part) {
    all = {join(all.whole, part.whole), join(all.varying, part.varying)};
  };
  for (const Effect& effect : candidate.effects) {
    if (is_driven(effect, fitted_.kit)) {
      append(driven_columns(effect, effect.driver->shape() ? shape : 0.0));
      continue;
    }
    std::vector<std::string> names;
    for (const Variable& coefficient : candidate.coefficients) {
      if (coefficient.name.starts_with(effect.name + ".")) names.push_back(coefficient.name);
    }
    base::ParameterValues shapes;
    if (effect.driver && effect.driver->shape()) shapes[candidate.shape.parameter] = shape;
    const Columns part = composed_columns({effect}, shapes, names);
    append({part, part});
  }
  return all;
}

}  // namespace sepcal::diagnosis
