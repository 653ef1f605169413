// SPDX-License-Identifier: BSD-3-Clause
#include "diagnosis/candidate.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <iterator>

#include "base/parts_of_record.hpp"
#include "diagnosis/innovation_rows.hpp"
#include "effects/driven_rows.hpp"
#include "model/measurements.hpp"
#include "model/smooth_inputs.hpp"
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

/// Whether the parameter is one of the candidate's.
bool is_of(const Candidate& candidate, const std::string& parameter) {
  return parameter == candidate.shape.parameter ||
         std::ranges::find(candidate.coefficients, parameter, &Variable::name) !=
             candidate.coefficients.end();
}

/// Whether the effect is a port's columns times a driver's functions and nothing else.
bool is_driven(const Effect& effect, const EffectKit& kit) {
  return effect.driver && effect.terms.empty() && effect.delays.empty() &&
         std::ranges::find(kit.ports, effect.port, &Port::name) != kit.ports.end();
}

constexpr int of_any_form = 3;

}  // namespace

std::tuple<std::size_t, int, std::size_t> complexity_of(const Candidate& candidate) {
  int form = 0;
  for (const EffectSetting& setting : candidate.settings) {
    const EffectName name = parse_effect_name(setting.name);
    int own = 0;
    const bool has_levels = name.shape == EffectName::Shape::levels;
    if (name.shape == EffectName::Shape::spline || name.base == "maneuver" ||
        (has_levels && name.thresholds.size() > 1)) {
      own = of_any_form;
    } else if (name.shape == EffectName::Shape::product ||
               (name.shape == EffectName::Shape::power && name.number > 1)) {
      own = 1;
    } else if (name.shape == EffectName::Shape::exponent || has_levels) {
      own = 2;
    }
    form = std::max(form, own);
  }
  if (form < 2 && !candidate.shape.parameter.empty()) form = 2;
  return {candidate.settings.size(), form, candidate.coefficients.size()};
}

bool is_of_any_form(const Candidate& candidate) {
  return std::get<1>(complexity_of(candidate)) == of_any_form;
}

bool is_simple(const Candidate& candidate) {
  return candidate.settings.size() == 1 && !is_of_any_form(candidate);
}

bool is_line_of(const Candidate& line, const Candidate& curve, bool at_its_port) {
  if (!is_of_lines(line, 1) || !is_of_any_form(curve) || curve.settings.size() > 1) return false;
  const EffectName straight = parse_effect_name(line.settings.front().name);
  const EffectName bent = parse_effect_name(curve.settings.front().name);
  return !straight.base.empty() && straight.base == bent.base &&
         (!at_its_port || straight.port == bent.port);
}

bool is_lag(const Candidate& candidate) {
  return candidate.settings.size() == 1 && candidate.coefficients.size() == 1 &&
         candidate.coefficients.front().unit == "s" && candidate.shape.parameter.empty();
}

bool is_of_lines(const Candidate& candidate, std::size_t effects) {
  const auto [own, form, coefficients] = complexity_of(candidate);
  return own == effects && form == 0;
}

namespace {

/// Whether a residual is clearly less than another: a tenth in some output, and a tenth more in
/// none.
bool is_clearly_less(const VectorXd& residual, const VectorXd& other, Index rows) {
  constexpr double clearly = 0.9;
  bool is_less = false;
  for (Index first = 0; first < residual.size(); first += rows) {
    const double square = residual.segment(first, rows).squaredNorm();
    const double before = other.segment(first, rows).squaredNorm();
    if (clearly * square > before) return false;
    is_less = is_less || square < clearly * before;
  }
  return is_less;
}

}  // namespace

CandidateRoom::CandidateRoom(const DiagnosedFit& fitted, base::ThreadPool& pool)
    : CandidateRoom(fitted, {}, pool) {}

CandidateRoom::CandidateRoom(const DiagnosedFit& fitted, const Candidate& released,
                             base::ThreadPool& pool, Regressors regressors)
    : fitted_(fitted),
      record_(fitted.record),
      settings_(fitted.effects),
      effects_(make_effects(fitted.kit, *fitted.model, settings_, record_)),
      values_(fitted.fit.by_name()) {
  linearise(released, pool, regressors);
}

void CandidateRoom::add_input_drift() {
  linearisation_.input_drift = input_drift_columns();
  if (linearisation_.input_drift.cols() > 0) linearisation_.times = times();
}

void CandidateRoom::linearise(const Candidate& released, base::ThreadPool& pool,
                              Regressors regressors) {
  const Fit& fit = fitted_.fit;
  const auto model = this->model();
  const Tables& tables = model->tables();
  const std::vector<Variable> parameters = tables.parameters();
  if (!std::ranges::equal(fit.parameters, parameters, {}, &Parameter::name, &Variable::name)) {
    throw Error("the fit's parameters are not those of its model with its effects");
  }
  used_ = record_;
  used_.cut(fitted_.rows);
  const Record& rows = used_;
  const model::Measurements measurements(*model, rows);
  noise_ = fitted_.noise ? fitted_.noise : noise_of(fit, *model);
  if (const auto* along = dynamic_cast<const PathModel*>(model.get())) {
    followed_ = model;
    linearisation_.follows_path = true;
    path_ = along->path_tangent(used_, values_in_order(parameters, values_), noise_);
  }
  RowLayout& layout = linearisation_.layout;
  layout = {.segments = base::join_segments(fitted_.rows),
            .runs = measurements.runs(),
            .rows = static_cast<Index>(rows.rows())};
  std::vector<Index> columns;
  for (std::size_t k = 0; k < fit.parameters.size(); ++k) {
    const Parameter& parameter = fit.parameters[k];
    if (parameter.fixed || parameter.at_bound || is_of(released, parameter.name)) continue;
    columns.push_back(static_cast<Index>(k));
    linearisation_.parameters.push_back(parameter.name);
  }
  const auto own = static_cast<Index>(released.coefficients.size());
  for (const Variable& coefficient : released.coefficients) {
    columns.push_back(find_column(parameters, coefficient.name));
  }
  columns.push_back(static_cast<Index>(parameters.size()));
  MatrixXd& tangent = linearisation_.tangent;
  tangent =
      noise_
          ? innovation_rows(*model, used_, fit.values(), *noise_, columns)
          : model::Sweep(*model, measurements, pool).tangent_columns(fit.xi1(), fit.xi2(), columns);
  regressors_ = record_;
  const bool has_readings = measurements.output_square(0) > 0.0;  // not an equation of the inputs
  if (has_readings && !noise_ && !path_) {
    if (regressors == Regressors::read) smooth_regressors(columns, pool);
    if (regressors == Regressors::undisturbed) undisturb_regressors(columns, pool);
  }
  for (Index k = 0; k < own; ++k) {
    const Index at = tangent.cols() - 1 - own + k;
    tangent.rightCols<1>() +=
        values_.at(released.coefficients[static_cast<std::size_t>(k)].name) * tangent.col(at);
  }
  const auto count = static_cast<double>(layout.rows);
  for (int j = 0; j < tables.n_z(); ++j) {
    const auto& output = tables.outputs[static_cast<std::size_t>(j)];
    const double rmse =
        tangent.rightCols<1>().middleRows(j * layout.rows, layout.rows).norm() / std::sqrt(count);
    const double rms = std::sqrt(measurements.output_square(j) / count);
    if (!(rmse > rounding * rms) || !(rmse > 0)) continue;
    layout.outputs.push_back({.index = j,
                              .name = output.name,
                              .unit = noise_ ? "" : output.unit,
                              .scale = rmse,
                              .variance = variance_of(measurements, j)});
  }
  const bool one_unit = !noise_ && !common_unit(layout).empty();
  for (UsedOutput& output : layout.outputs) output.weight = one_unit ? output.scale : 1.0;
  scale_outputs(tangent);
  linearisation_.residual = tangent.rightCols<1>();
  if (own > 0) release(released, tangent.middleCols(tangent.cols() - 1 - own, own));
  tangent.conservativeResize(Eigen::NoChange, tangent.cols() - 1 - own);
}

void CandidateRoom::smooth_regressors(std::vector<Index> columns, base::ThreadPool& pool) {
  const Record smooth = model::smooth_inputs(record_, fitted_.model->tables());
  const auto model = compose(fitted_.model, effects_, smooth);
  Record rows = smooth;
  rows.cut(fitted_.rows);
  const model::Measurements measurements(*model, rows);
  const model::Sweep sweep(*model, measurements, pool);
  const Fit& fit = fitted_.fit;
  MatrixXd& tangent = linearisation_.tangent;
  const VectorXd residual = tangent.rightCols<1>();
  const VectorXd of_smooth = sweep.tangent_columns(fit.xi1(), fit.xi2(), {columns.back()});
  if (!is_clearly_less(of_smooth, residual, linearisation_.layout.rows)) return;  // they are true
  columns.pop_back();
  tangent.leftCols(tangent.cols() - 1) = sweep.tangent_columns(fit.xi1(), fit.xi2(), columns);
  regressors_ = smooth;
}

/// By Newton's steps of the least disturbances, in units of each input's spread, that leave
/// nothing. A row stays as it was read where no such reading is one: of air that stands, say.
void CandidateRoom::undisturb_regressors(std::vector<Index> columns, base::ThreadPool& pool) {
  constexpr int rounds = 3;
  const auto model = compose(fitted_.model, effects_, record_);
  const Index n_z = model->tables().n_z();
  std::vector<std::size_t> places;  // of the rows in the record
  for (const Segment& segment : fitted_.rows) {
    for (std::size_t at = segment.first; at < segment.last; ++at) places.push_back(at);
  }
  const auto rows_fitted = static_cast<Index>(places.size());
  std::vector<bool> as_read(places.size(), false);
  for (int round = 0; round <= rounds; ++round) {
    const ResidualSlopes slopes = slopes_by(*model, fitted_.kit.disturbed, regressors_);
    const auto inputs = static_cast<Index>(slopes.inputs.size());
    if (inputs == 0) break;
    MatrixXd disturbances = MatrixXd::Zero(rows_fitted, inputs);
    for (Index row = 0; row < rows_fitted; ++row) {
      const auto of_row = Eigen::seqN(row, n_z, rows_fitted);
      const auto at = static_cast<std::size_t>(row);
      as_read[at] = as_read[at] || !slopes.residual(of_row).allFinite();
      if (as_read[at] || round == rounds) continue;
      const MatrixXd slope = slopes.columns(of_row, Eigen::all) * slopes.spreads.asDiagonal();
      const VectorXd least = slopes.spreads.cwiseProduct(
          slope.completeOrthogonalDecomposition().solve(-slopes.residual(of_row)));
      as_read[at] = !least.allFinite();
      if (!as_read[at]) disturbances.row(row) = least;
    }
    for (Index k = 0; k < inputs; ++k) {
      const std::string& name = slopes.inputs[static_cast<std::size_t>(k)];
      const auto read = record_.column(name);
      const auto now = regressors_.column(name);
      std::vector<double> values(now.begin(), now.end());
      for (std::size_t row = 0; row < places.size(); ++row) {
        double& value = values[places[row]];
        value = as_read[row] ? read[places[row]] : value + disturbances(static_cast<Index>(row), k);
      }
      regressors_.replace(name, std::move(values));
    }
  }
  Record rows = regressors_;
  rows.cut(fitted_.rows);
  const model::Measurements measurements(*model, rows);
  columns.pop_back();  // the residual is that of the readings
  MatrixXd& tangent = linearisation_.tangent;
  tangent.leftCols(tangent.cols() - 1) =
      model::Sweep(*model, measurements, pool)
          .tangent_columns(fitted_.fit.xi1(), fitted_.fit.xi2(), columns);
}

/// Candidates derive columns of their own, after the fit was linearised.
Record CandidateRoom::regressors() const {
  Record record = regressors_;
  for (const std::string& name : record_.names()) {
    if (!record.has(name)) record.view(name, record_.column(name));
  }
  return record;
}

void CandidateRoom::release(const Candidate& released, const MatrixXd& columns) {
  made_.emplace(released.name, released);
  Index at = 0;
  for (std::size_t i = 0; i < released.effects.size(); ++i) {
    const Effect& effect = released.effects[i];
    const auto own = static_cast<Index>(released.counts[i]);
    if (is_driven(effect, fitted_.kit)) {
      open(port_of(effect));
    } else {
      const Columns part = MatrixXd(columns.middleCols(at, own));
      released_.emplace(released.settings[i].name, CandidateColumns{part, part});
    }
    at += own;
  }
}

/// Those of a correction that the fit has already are the tangent's.
MatrixXd CandidateRoom::input_drift_columns() {
  Columns all;
  for (const EffectKit::Maker& maker : fitted_.kit.attitude_errors) {
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
  base::ParameterValues values = values_;
  values.insert(shapes.begin(), shapes.end());
  if (path_) return path_columns(change_by(added, values, names));
  Record rows = regressors();
  const auto model = compose(fitted_.model, with_those_of_fit(added), rows);
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

CandidateRoom::ResidualSlopes CandidateRoom::slopes_by(const BlockModel& model,
                                                       const std::vector<std::string>& inputs,
                                                       const Record& at) const {
  constexpr double of_spread = 1e-4;
  const auto last = static_cast<Index>(model.tables().parameters().size());  // the residual
  base::ThreadPool alone(1);
  const auto residual = [&](Record record) -> VectorXd {
    record.cut(fitted_.rows);
    const model::Measurements measurements(model, record);
    return model::Sweep(model, measurements, alone)
        .tangent_columns(fitted_.fit.xi1(), fitted_.fit.xi2(), {last});
  };
  ResidualSlopes slopes{.residual = residual(at), .inputs = {}, .spreads = {}, .columns = {}};
  std::vector<VectorXd> columns;
  std::vector<double> spreads;
  for (const std::string& input : inputs) {
    if (input == "time" || !at.has(input)) continue;
    const auto values = at.column(input);
    const Eigen::Map<const VectorXd> known(values.data(), static_cast<Index>(values.size()));
    const double spread = (known.array() - known.mean()).matrix().norm() /
                          std::sqrt(static_cast<double>(known.size()));
    const double step = of_spread * spread;
    if (!(step > 0.0) || !std::isfinite(step)) continue;
    Record changed = at;
    std::vector<double> moved(values.begin(), values.end());
    for (double& value : moved) value += step;
    changed.replace(input, std::move(moved));
    columns.emplace_back((residual(std::move(changed)) - slopes.residual) / step);
    slopes.inputs.push_back(input);
    spreads.push_back(spread);
  }
  slopes.spreads = Eigen::Map<const VectorXd>(spreads.data(), static_cast<Index>(spreads.size()));
  slopes.columns.resize(slopes.residual.size(), static_cast<Index>(columns.size()));
  for (Index k = 0; k < slopes.columns.cols(); ++k) {
    slopes.columns.col(k) = columns[static_cast<std::size_t>(k)];
  }
  return slopes;
}

MatrixXd CandidateRoom::input_columns() const {
  const MatrixXd& corrections = linearisation_.input_drift;
  if (follows_path() || noise_) return corrections;
  const auto model = compose(fitted_.model, effects_, regressors_);
  std::vector<std::string> inputs;
  for (const Variable& input : model->tables().inputs) inputs.push_back(input.name);
  MatrixXd each = slopes_by(*model, inputs, regressors_).columns;
  if (each.cols() > 0) scale_outputs(each);
  MatrixXd all(linearisation_.layout.count(), each.cols() + corrections.cols());
  all << each, corrections;
  return all;
}

std::shared_ptr<const BlockModel> CandidateRoom::model() const {
  return compose(fitted_.model, effects_, record_);
}

std::shared_ptr<const BlockModel> CandidateRoom::model_with(
    const std::vector<Effect>& added) const {
  return compose(fitted_.model, with_those_of_fit(added), record_);
}

std::vector<Effect> CandidateRoom::with_those_of_fit(const std::vector<Effect>& added) const {
  std::vector<Effect> all = effects_;
  all.insert(all.end(), added.begin(), added.end());
  return all;
}

const Candidate& CandidateRoom::make(const EffectSetting& setting) {
  const std::string& name = setting.name;
  const auto known = made_.find(name);
  if (known != made_.end()) return known->second;
  Candidate candidate = make_anew(setting);
  const std::string resolved = candidate.name;
  const auto made = made_.emplace(resolved, std::move(candidate)).first;
  return resolved == name ? made->second : made_.emplace(name, made->second).first->second;
}

Candidate CandidateRoom::make_anew(const EffectSetting& given) {
  const std::string& name = given.name;
  Candidate candidate{.name = name};
  const std::vector<std::string> parts = split_effects(name);
  if (parts.size() == 1) {
    candidate.settings = {given};
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
    candidate.counts.push_back(names.size());
    if (is_driven(effect, fitted_.kit)) {
      open(port_of(effect));
    }
  }
  const Effect& first = candidate.effects.front();
  if (candidate.effects.size() == 1 && is_driven(first, fitted_.kit) && first.driver->is_step()) {
    candidate.stepping_port = first.port;
  }
  candidate.stands_in = std::ranges::any_of(candidate.settings, [&](const EffectSetting& setting) {
    const EffectName own = parse_effect_name(setting.name);
    const auto port = std::ranges::find(fitted_.kit.ports, own.port, &Port::name);
    if (port == fitted_.kit.ports.end() || port->causes.empty() || own.base.empty()) return false;
    return std::ranges::none_of(
        port->causes, [&](const std::string& cause) { return own.base.starts_with(cause); });
  });
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

const Port& CandidateRoom::port_of(const Effect& effect) const {
  return *std::ranges::find(fitted_.kit.ports, effect.port, &Port::name);
}

/// Whether what it does in one row goes on in those after it: inputs are integrated, and a filter's
/// state remembers its readings.
bool CandidateRoom::acts_on_path(const Port& port) const {
  if (!path_) return false;
  return noise_.has_value() ||
         std::ranges::any_of(port.components, [](const Port::Component& component) {
           return !component.input.empty();
         });
}

void CandidateRoom::open(const Port& port) {
  if (ports_.contains(port.name) || path_ports_.contains(port.name)) return;
  const Effect constant =
      make_driven("constant", port, constant_driver(), port.unit, *fitted_.model, record_);
  std::vector<std::string> names;
  for (const Port::Component& component : port.components)
    names.push_back("constant." + component.name);
  if (acts_on_path(port)) {
    PathChange change = change_by({constant}, values_, names);
    if (!change.steps.isZero(0.0)) {
      throw Error("port " + port.name +
                  " acts on inputs and on what is read: no driver follows both along a path; make "
                  "two ports of it");
    }
    path_ports_.emplace(port.name, std::move(change));
  } else {
    ports_.emplace(port.name, composed_columns({constant}, {}, names));
  }
}

const MatrixXd* CandidateRoom::columns_of(const std::string& port) const {
  const auto known = ports_.find(port);
  return known == ports_.end() ? nullptr : &known->second;
}

/// What these parameters do along the path: to inputs, which a driver may then follow, and to steps
/// and readings.
PathChange CandidateRoom::change_by(const std::vector<Effect>& added,
                                    const base::ParameterValues& values,
                                    const std::vector<std::string>& names) const {
  const auto model = model_with(added);
  const std::vector<Variable> all = model->tables().parameters();
  const VectorXd xi = values_in_order(all, values);
  std::vector<Index> places;
  for (const std::string& name : names) places.push_back(find_column(all, name));
  Record rows = record_;  // with what the effects derive from other columns
  rows.cut(fitted_.rows);
  PathChange change;
  const bool of_inputs = std::ranges::all_of(added, [](const Effect& effect) {
    return effect.varying.empty() && effect.terms.empty() && !effect.remodel;
  });
  if (!of_inputs) return path_->change(*model, rows, xi, places);
  const Index n_1 = model->tables().n_1();
  change.inputs =
      dynamic_cast<const PathModel&>(*model).input_slopes(rows, xi.tail(model->tables().n_2()));
  for (Index& place : places) place -= n_1;
  for (InputSlopes& moved : change.inputs) {
    moved.slopes = moved.slopes(Eigen::all, places).eval();
  }
  return change;
}

MatrixXd CandidateRoom::path_columns(const PathChange& change) const {
  MatrixXd stacked = path_->columns(change);
  scale_outputs(stacked);
  return stacked;
}

/// The same where a driver's functions multiply it.
Columns CandidateRoom::drive_path(const PathChange& change, const MatrixXd& phi) const {
  const std::vector<Segment>& layout = linearisation_.layout.segments;
  const auto driven = [&](const MatrixXd& whole, Index blocks, auto first_of) {
    MatrixXd result = MatrixXd::Zero(whole.rows(), whole.cols() * phi.cols());
    const Index block = whole.rows() / blocks;
    for (std::size_t i = 0; i < layout.size(); ++i) {
      const auto from = static_cast<Index>(layout[i].first);
      const auto count = static_cast<Index>(layout[i].rows());
      for (Index k = 0; k < result.cols(); ++k) {
        for (Index j = 0; j < blocks; ++j) {
          const Index to = j * block + static_cast<Index>(first_of(i));
          result.col(k).segment(to, count) =
              whole.col(k / phi.cols())
                  .segment(to, count)
                  .cwiseProduct(phi.col(k % phi.cols()).segment(from, count));
        }
      }
    }
    return result;
  };
  PathChange all;
  for (const InputSlopes& moved : change.inputs) {
    all.inputs.push_back({moved.input, driven(moved.slopes, 1, [&](std::size_t i) {
                            return fitted_.rows[i].first;
                          })});
  }
  if (change.readings.size() > 0) {
    all.readings = driven(change.readings, fitted_.model->tables().n_z(),
                          [&](std::size_t i) { return layout[i].first; });
  }
  return path_columns(all);
}

Columns CandidateRoom::drive(const Port& port, const MatrixXd& phi) const {
  const RowLayout& layout = linearisation_.layout;
  if (acts_on_path(port)) return drive_path(path_ports_.at(port.name), phi);
  const MatrixXd& columns = ports_.at(port.name);
  const auto shared = std::make_shared<const MatrixXd>(phi);
  return {columns.cols() * phi.cols(),
          [&columns, shared, N = layout.rows](Index first, Eigen::Ref<MatrixXd> rows) {
            const auto driver = shared->middleRows(first % N, rows.rows());
            for (Index c = 0; c < columns.cols(); ++c) {
              rows.middleCols(c * driver.cols(), driver.cols()) =
                  driver.array().colwise() * columns.col(c).segment(first, rows.rows()).array();
            }
          }};
}

MatrixXd CandidateRoom::functions_of(const Effect& effect, double shape) const {
  const RowLayout& layout = linearisation_.layout;
  MatrixXd phi = effects::drive(*effect.driver, effect.driver->shape() ? shape : 0.0, record_);
  for (std::size_t i = 0; i < layout.segments.size(); ++i) {  // none lies behind its rows there
    const Segment& from = fitted_.rows[i];
    const auto length = static_cast<Index>(from.rows());
    for (auto column : phi.colwise()) {
      column.segment(static_cast<Index>(layout.segments[i].first), length) =
          column.segment(static_cast<Index>(from.first), length).unaryExpr([](double value) {
            return std::isfinite(value) ? value : 0.0;
          });
    }
  }
  if (phi.rows() != layout.rows) phi.conservativeResize(layout.rows, Eigen::NoChange);
  return phi;
}

CandidateColumns CandidateRoom::driven_columns(const Effect& effect, double shape) const {
  const MatrixXd phi = functions_of(effect, shape);
  const Port& port = port_of(effect);
  return {drive(port, phi), drive(port, phi.rowwise() - phi.colwise().mean().eval())};
}

/// Of the effect that is `place`-th of the candidate's.
CandidateColumns CandidateRoom::effect_columns(const Candidate& candidate, std::size_t place,
                                               std::span<const Variable> coefficients,
                                               double shape) const {
  const Effect& effect = candidate.effects[place];
  const auto released = released_.find(candidate.settings[place].name);
  if (released != released_.end()) return released->second;
  if (is_driven(effect, fitted_.kit)) {
    return driven_columns(effect, shape);
  }
  std::vector<std::string> names;
  for (const Variable& coefficient : coefficients) names.push_back(coefficient.name);
  base::ParameterValues shapes;
  if (effect.driver && effect.driver->shape()) shapes[candidate.shape.parameter] = shape;
  const Columns part = composed_columns({effect}, shapes, names);
  return {part, part};
}

/// Made once, as far as memory goes: a path is followed from its start for every one, and a model
/// is evaluated anew with an effect that nothing drives.
CandidateColumns CandidateRoom::keep(const std::string& key,
                                     const std::function<CandidateColumns()>& make) const {
  constexpr Index most_kept = 33554432;  // 256 MB
  {
    const std::lock_guard lock(keeping_);
    const auto known = kept_columns_.find(key);
    if (known != kept_columns_.end()) return known->second;
  }
  CandidateColumns made = make();
  const std::lock_guard lock(keeping_);
  const Index size = linearisation_.layout.count() * (made.whole.cols() + made.varying.cols());
  if (kept_ + size > most_kept) return made;
  kept_ += size;
  return kept_columns_.try_emplace(key, std::move(made)).first->second;
}

CandidateColumns CandidateRoom::columns(const Candidate& candidate, double shape) const {
  constexpr std::size_t few_columns = 3;
  CandidateColumns all;
  std::span<const Variable> coefficients(candidate.coefficients);
  for (std::size_t i = 0; i < candidate.effects.size(); ++i) {
    const auto make = [&] {
      return effect_columns(candidate, i, coefficients.first(candidate.counts[i]), shape);
    };
    const std::string key = candidate.settings[i].name + ' ' + std::to_string(shape);
    const bool is_composed = !is_driven(candidate.effects[i], fitted_.kit) && std::isnan(shape);
    const bool is_kept = path_ || (is_composed && candidate.counts[i] <= few_columns);
    const CandidateColumns part = is_kept ? keep(key, make) : make();
    all = {join(all.whole, part.whole), join(all.varying, part.varying)};
    coefficients = coefficients.subspan(candidate.counts[i]);
  }
  return all;
}

}  // namespace sepcal::diagnosis
