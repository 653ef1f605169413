// SPDX-License-Identifier: BSD-3-Clause
// Records that are smooth functions of time, and the rows of any model by the names of its
// parameters: what compositions are compared by.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "block_inputs.hpp"
#include "sepcal/detail/block_model.hpp"
#include "sepcal/record.hpp"
#include "simulated_records.hpp"

namespace sepcal::test {

using Signals = std::map<std::string, std::function<double(double)>>;

/// An aircraft that circles through more than a turn (its yaw wraps), climbs and slips.
inline Signals five_hole_signals() {
  const auto airspeed = [](double t) { return 22.0 + 3.0 * std::sin(0.5 * t) + std::cos(1.7 * t); };
  const auto impact = [=](double t) { return 0.6 * airspeed(t) * airspeed(t); };
  const auto static_pressure = [](double t) { return 95000.0 - 120.0 * std::sin(0.2 * t); };
  return {{"roll", [](double t) { return 0.5 * std::sin(0.9 * t); }},
          {"pitch", [](double t) { return 0.1 + 0.15 * std::cos(0.7 * t); }},
          {"yaw", [](double t) { return std::remainder(0.6 * t + 2.5, 2.0 * std::numbers::pi); }},
          {"p", [](double t) { return 0.45 * std::cos(0.9 * t); }},
          {"q", [](double t) { return 0.2 + 0.1 * std::sin(0.8 * t); }},
          {"r", [](double t) { return 0.4 * std::sin(0.3 * t + 1.0); }},
          {"pt", [=](double t) { return static_pressure(t) + impact(t); }},
          {"ps", static_pressure},
          {"dpa", [=](double t) { return 4.5 * impact(t) * (0.05 + 0.04 * std::sin(1.1 * t)); }},
          {"dpb", [=](double t) { return 4.0 * impact(t) * 0.06 * std::cos(1.3 * t); }},
          {"rho", [](double t) { return 1.15 + 0.02 * std::cos(0.4 * t); }},
          {"altitude_m", [](double t) { return 300.0 + 40.0 * std::sin(0.2 * t); }},
          {"throttle", [](double t) { return 0.5 + 0.3 * std::sin(0.6 * t + 0.4); }},
          {"flap", [](double t) { return 0.2 + 0.1 * std::cos(0.25 * t); }}};
}

/// A magnetometer that tumbles in a field of 50 uT, with a current and a temperature.
inline Signals magnetometer_signals() {
  const auto across = [](double t) { return 50.0 * std::cos(0.3 * t + 0.5); };
  return {{"hx", [=](double t) { return across(t) * std::cos(0.8 * t); }},
          {"hy", [=](double t) { return across(t) * std::sin(0.8 * t); }},
          {"hz", [](double t) { return 50.0 * std::sin(0.3 * t + 0.5); }},
          {"hx_dot", [](double t) { return 12.0 * std::sin(0.7 * t); }},
          {"hy_dot", [](double t) { return 9.0 * std::cos(0.6 * t); }},
          {"hz_dot", [](double t) { return 15.0 * std::cos(0.3 * t + 0.5); }},
          {"roll", [](double t) { return 0.6 * std::sin(0.5 * t); }},
          {"pitch", [](double t) { return 0.4 * std::cos(0.35 * t); }},
          {"current_a", [](double t) { return 8.0 + 5.0 * std::sin(0.9 * t); }},
          {"temp_degc", [](double t) { return 20.0 + 0.5 * t; }}};
}

/// The signals and "time" at the times [s]; those named in `moved` are read `lead` seconds later.
inline Record sample(const Signals& signals, const std::vector<double>& time, double lead = 0.0,
                     const std::vector<std::string>& moved = {}) {
  Record record;
  record.add("time", time);
  for (const auto& [name, at] : signals) {
    const bool moves = std::ranges::find(moved, name) != moved.end();
    std::vector<double> column;
    for (const double t : time) column.push_back(at(moves ? t + lead : t));
    record.add(name, std::move(column));
  }
  return record;
}

/// `rows` times from `first` on, every `interval` seconds, each off by up to a tenth of it.
inline std::vector<double> uneven_times(std::size_t rows, double interval, double first = 0.0) {
  std::vector<double> time;
  for (std::size_t k = 0; k < rows; ++k) {
    const auto count = static_cast<double>(k);
    time.push_back(first + interval * (count + 0.1 * std::sin(7.0 * count)));
  }
  return time;
}

using NamedValues = std::map<std::string, double>;

/// Plausible values: nonlinear ones within the middle of their bounds, the others small.
inline NamedValues draw_values(const Tables& tables, Draws& draws) {
  NamedValues values;
  for (const Variable& parameter : tables.linear) {
    values[parameter.name] = draws.uniform(-0.1, 0.1);
  }
  for (const Variable& parameter : tables.nonlinear) {
    const bool bounded = std::isfinite(parameter.upper - parameter.lower);
    const double middle = bounded ? 0.5 * (parameter.lower + parameter.upper) : 0.0;
    const double reach = bounded                  ? 0.3 * (parameter.upper - parameter.lower)
                         : parameter.unit == "Pa" ? 20.0
                                                  : 0.01;
    values[parameter.name] = middle + draws.uniform(-reach, reach);
  }
  return values;
}

inline Eigen::VectorXd in_order(const std::vector<Variable>& parameters,
                                const NamedValues& values) {
  Eigen::VectorXd ordered(static_cast<Eigen::Index>(parameters.size()));
  for (std::size_t k = 0; k < parameters.size(); ++k) {
    ordered[static_cast<Eigen::Index>(k)] = values.at(parameters[k].name);
  }
  return ordered;
}

/// [A | D | b] (n_z * N rows) over the record's segments, in blocks of up to `most` rows.
inline Eigen::MatrixXd tangent_rows(const BlockModel& model, const Record& record,
                                    const NamedValues& values, std::size_t most = 64) {
  const Tables& tables = model.tables();
  const Eigen::VectorXd xi1 = in_order(tables.linear, values);
  const Eigen::VectorXd xi2 = in_order(tables.nonlinear, values);
  const auto total = static_cast<Eigen::Index>(record.rows());
  Eigen::MatrixXd all(tables.n_z() * total, tables.n_1() + tables.n_2() + 1);
  Eigen::Index offset = 0;
  for (const Segment& segment : record.segments()) {
    for (std::size_t first = segment.first; first < segment.last; first += most) {
      const std::size_t rows = std::min(most, segment.last - first);
      const auto count = static_cast<Eigen::Index>(rows);
      const BlockInputs inputs = block_inputs(model, record, first);
      Eigen::MatrixXd part =
          Eigen::MatrixXd::Constant(tables.n_z() * count, all.cols(), not_a_number);
      model.evaluate({inputs.pointers, rows, first, first == segment.first}, values_of(xi2),
                     values_of(xi1), nullptr, part);
      for (Eigen::Index j = 0; j < tables.n_z(); ++j) {
        all.middleRows(j * total + offset, count) = part.middleRows(j * count, count);
      }
      offset += count;
    }
  }
  return all;
}

/// The columns of A and D by their parameters' names, and "b".
inline std::map<std::string, Eigen::VectorXd> named_columns(const BlockModel& model,
                                                            const Record& record,
                                                            const NamedValues& values) {
  const Eigen::MatrixXd rows = tangent_rows(model, record, values);
  std::map<std::string, Eigen::VectorXd> columns{{"b", rows.rightCols<1>()}};
  Eigen::Index k = 0;
  for (const Variable& parameter : model.tables().parameters()) {
    columns[parameter.name] = rows.col(k++);
  }
  return columns;
}

/// The largest difference of two models' columns of one name, relative to the column's largest
/// entry; infinity where their parameters are not the same.
inline double largest_difference(const BlockModel& a, const BlockModel& b, const Record& record,
                                 const NamedValues& values) {
  if (a.tables().n_1() != b.tables().n_1() || a.tables().n_2() != b.tables().n_2()) return infinity;
  const auto of_a = named_columns(a, record, values);
  double largest = 0.0;
  for (const auto& [name, column] : named_columns(b, record, values)) {
    const auto there = of_a.find(name);
    if (there == of_a.end()) return infinity;
    const double scale = std::max(1e-300, column.cwiseAbs().maxCoeff());
    const double difference = (there->second - column).cwiseAbs().maxCoeff() / scale;
    if (!(difference <= largest)) largest = difference;  // NaN too
  }
  return largest;
}

}  // namespace sepcal::test
