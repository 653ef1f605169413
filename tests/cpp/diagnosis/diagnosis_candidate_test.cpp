// SPDX-License-Identifier: BSD-3-Clause
// The columns that a candidate would add, dz/d eta at eta = 0 and the fit's estimates, against
// differences of what the composed model predicts: every effect of the catalogue on every probe.
#include "diagnosis/candidate.hpp"

#include <algorithm>
#include <cmath>

#include "flights_with_effects.hpp"
#include "model/measurements.hpp"
#include "model/sweep.hpp"
#include "sepcal/composition.hpp"
#include "sepcal/detail/flight/effect_catalogue.hpp"
#include "sepcal/effect_name.hpp"

namespace diagnosis_candidate_test {

using namespace sepcal;
using namespace sepcal::test;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// What the model with the fit's effects and these predicts of a record, less the measurements:
/// rows x n_z.
class Prediction {
 public:
  Prediction(const DiagnosedFit& fitted, const std::string& effects, Record record)
      : record_(std::move(record)) {
    std::vector<EffectSetting> settings = fitted.effects;
    for (const std::string& name : split_effects(effects)) settings.push_back({.name = name});
    model_ =
        compose(fitted.model, make_effects(fitted.kit, *fitted.model, settings, record_), record_);
    record_.cut(fitted.rows);
    values_ = fitted.fit.by_name();
    for (const Variable& parameter : model_->tables().parameters())
      values_.try_emplace(parameter.name);
  }

  void hold(const std::string& name, double value) { values_.at(name) = value; }

  MatrixXd at(const std::string& name, double value) const {
    base::ParameterValues values = values_;
    values.at(name) = value;
    const model::Measurements measurements(*model_, record_);
    base::ThreadPool alone(1);
    const Tables& tables = model_->tables();
    return -model::Sweep(*model_, measurements, alone)
                .residuals(base::in_order(tables.linear, values),
                           base::in_order(tables.nonlinear, values));
  }

  /// Richardson's extrapolation of differences about zero; of forward ones where below zero
  /// nothing is defined.
  MatrixXd slope(const std::string& name, double step, bool forward) const {
    const auto central = [&](double h) -> MatrixXd {
      return (at(name, h) - at(name, -h)) / (2.0 * h);
    };
    if (!forward) return (4.0 * central(0.5 * step) - central(step)) / 3.0;
    return (4.0 * at(name, step) - at(name, 2.0 * step) - 3.0 * at(name, 0.0)) / (2.0 * step);
  }

 private:
  Record record_;
  std::shared_ptr<const BlockModel> model_;
  base::ParameterValues values_;
};

/// A column of the stacked, scaled rows as a matrix of rows x used outputs in their units.
MatrixXd in_units(const diagnosis::RowLayout& layout, const VectorXd& column) {
  MatrixXd outputs(layout.rows, static_cast<Index>(layout.outputs.size()));
  for (std::size_t j = 0; j < layout.outputs.size(); ++j) {
    outputs.col(static_cast<Index>(j)) =
        layout.outputs[j].scale * column.segment(layout.first(j), layout.rows);
  }
  return outputs;
}

/// The rows that a fit with the effect would use: those near an edge are guessed at.
std::vector<Index> inner_rows(const DiagnosedFit& fitted, const diagnosis::Candidate& candidate) {
  Record record = fitted.record;
  record.cut(fitted.rows);
  const Record inner = without_edges(record, reach(candidate.effects));
  std::vector<Index> rows;
  Index before = 0;
  for (const Segment& whole : fitted.rows) {
    for (std::size_t row = whole.first; row < whole.last; ++row, ++before) {
      const auto holds = [&](const Segment& at) { return at.first <= row && row < at.last; };
      if (std::ranges::any_of(inner.segments(), holds)) rows.push_back(before);
    }
  }
  return rows;
}

/// The largest entry of the columns of this unit, in the outputs' units.
double size_of(const diagnosis::RowLayout& layout, const diagnosis::Candidate& candidate,
               const MatrixXd& columns, const std::string& unit) {
  double size = 0.0;
  for (Index k = 0; k < columns.cols(); ++k) {
    if (candidate.coefficients[static_cast<std::size_t>(k)].unit != unit) continue;
    size = std::max(size, in_units(layout, columns.col(k)).cwiseAbs().maxCoeff());
  }
  return size;
}

/// Checks columns() of the effect at its first, middle and last shape.
void check_columns(const DiagnosedFit& fitted, diagnosis::CandidateRoom& room,
                   const std::string& name) {
  CAPTURE(name);
  const diagnosis::Candidate candidate = room.make(name);
  const std::vector<Index> rows = inner_rows(fitted, candidate);
  const std::vector<double>& shapes = candidate.shape.values;
  Prediction prediction(fitted, name, room.regressors());
  REQUIRE(!candidate.coefficients.empty());
  for (const double shape : {shapes.front(), shapes[shapes.size() / 2], shapes.back()}) {
    CAPTURE(shape);
    if (!candidate.shape.parameter.empty()) prediction.hold(candidate.shape.parameter, shape);
    const MatrixXd columns = room.columns(candidate, shape).whole.dense(room.fit().layout);
    REQUIRE(columns.cols() == static_cast<Index>(candidate.coefficients.size()));
    REQUIRE(columns.allFinite());
    for (Index k = 0; k < columns.cols(); ++k) {
      const Variable& coefficient = candidate.coefficients[static_cast<std::size_t>(k)];
      CAPTURE(coefficient.name);
      const double size = size_of(room.fit().layout, candidate, columns, coefficient.unit);
      REQUIRE(size > 0.0);
      const double step = 3e-4 / size;  // changes a prediction by that much of its unit
      const MatrixXd expected = prediction.slope(coefficient.name, step, coefficient.lower == 0.0);
      const MatrixXd found = in_units(room.fit().layout, columns.col(k));
      CHECK((found - expected)(rows, Eigen::all).cwiseAbs().maxCoeff() < 1e-6 * size);
    }
    if (std::isnan(shape)) break;
  }
}

std::string with_driver(std::string_view probe, std::string_view catalogued) {
  std::string name(catalogued);
  const std::size_t at = name.find("DRIVER");
  if (at == std::string::npos) return name;
  const bool of_air = probe == "five-hole" || probe == "pitot-static";
  return name.replace(at, 6, of_air ? "throttle" : "current_a");
}

void check_catalogue(const char* probe, const std::vector<std::string>& fitted_effects,
                     const std::vector<std::string>& others, std::size_t rows) {
  CAPTURE(probe);
  const SimulatedFlight simulated = fly(probe, {}, {.rows = rows, .noise = 0.2, .seed = 8});
  const Calibration calibration = calibrate_with(probe, simulated, fitted_effects);
  const DiagnosedFit fitted = diagnosed_fit(calibration, make_flight(simulated));
  base::ThreadPool pool(1);
  diagnosis::CandidateRoom room(fitted, pool);
  std::vector<std::string> names = others;
  for (const CataloguedEffect& effect : effect_catalogue(probe)) {
    if (effect.equation.starts_with("alias")) continue;
    names.push_back(with_driver(probe, effect.name));
  }
  for (const std::string& name : names) {
    if (std::ranges::find(fitted_effects, name) == fitted_effects.end()) {
      check_columns(fitted, room, name);
    }
  }
}

}  // namespace

TEST_CASE(
    "the columns of every catalogued effect are the slopes of what a model with it predicts") {
  check_catalogue("five-hole", {},
                  {"wind[spline(altitude_m,6)]", "wind[alpha]", "beta_offset[r]",
                   "wind[altitude_m]+airspeed_scale[alpha^2]", "heading_bias+wind[ramp(time)]"},
                  400);
  check_catalogue("pitot-static", {}, {"wind[time^2]", "airspeed_bias[decay(time)]"}, 400);
  check_catalogue("magnetometer", {}, {"bias[spline(time,6)]", "axis_scale[step(time)]"}, 400);
  check_catalogue("magnetometer-norm", {}, {"bias[throttle^n]", "bias[delay(current_a)]"}, 400);
}

TEST_CASE("so they are beside effects that the fit has, one of them in time") {
  check_catalogue("five-hole", {"wind[altitude_m]", "alpha_offset[throttle]", "time_offset"},
                  {"wind[spline(time,6)]"}, 1200);
  check_catalogue("magnetometer", {"bias[current_a]", "cubic_nonlinearity"}, {"scale[time^3]"},
                  400);
}

TEST_CASE("what varies of a driven effect: its driver about the mean of the rows used") {
  const SimulatedFlight simulated = fly("five-hole", {}, {.noise = 0.2, .seed = 8});
  const Calibration calibration = calibrate_with("five-hole", simulated, {});
  DiagnosedFit fitted = diagnosed_fit(calibration, make_flight(simulated));
  fitted.rows.pop_back();
  fitted.rows.front().first += 7;
  base::ThreadPool pool(1);
  diagnosis::CandidateRoom room(fitted, pool);
  const diagnosis::Candidate candidate = room.make("wind[throttle]");
  const double shape = candidate.shape.values.front();
  double sum = 0.0;
  double count = 0.0;
  for (const Segment& segment : fitted.rows) {
    for (std::size_t row = segment.first; row < segment.last; ++row, ++count) {
      sum += simulated.column("throttle")[row];
    }
  }
  const auto& port = *std::ranges::find(fitted.kit.ports, "wind", &Port::name);
  const auto [whole, varying] = room.columns(candidate, shape);
  const diagnosis::RowLayout& layout = room.fit().layout;
  const MatrixXd expected = whole.dense(layout) - sum / count * *room.columns_of(port.name);
  CHECK((varying.dense(layout) - expected).cwiseAbs().maxCoeff() < 1e-12);
}

TEST_CASE("a candidate by an alias, of a pair; what can't be made is refused") {
  const SimulatedFlight simulated = fly("five-hole", {}, {.noise = 0.2, .seed = 8});
  const Calibration calibration = calibrate_with("five-hole", simulated, {});
  const DiagnosedFit fitted = diagnosed_fit(calibration, make_flight(simulated));
  base::ThreadPool pool(1);
  diagnosis::CandidateRoom room(fitted, pool);
  const diagnosis::Candidate pair = room.make("wind_shear+propwash");
  CHECK(pair.name == "wind[altitude_m]+pressure_offset[throttle]");
  CHECK(pair.drivers == std::vector<std::string>{"altitude_m", "throttle"});
  CHECK(pair.coefficients.size() == 3);
  CHECK(room.make("heading_bias").drivers.empty());
  check_refused([&] { room.make("wind[engine_2]"); }, {"wind[engine_2]", "no channel 'engine_2'"});
  check_refused([&] { room.make("water_blockage+wind[ramp(time)]"); }, {"scan in two directions"});

  DiagnosedFit other = fitted;
  other.fit.parameters.pop_back();
  check_refused([&] { diagnosis::CandidateRoom(other, pool); }, {"are not those of its model"});
}

}  // namespace diagnosis_candidate_test
