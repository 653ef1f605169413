// SPDX-License-Identifier: BSD-3-Clause
#include "flight/verbs/injection.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "model/measurements.hpp"
#include "model/sweep.hpp"
#include "sepcal/error.hpp"

namespace sepcal::verbs {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

void check_new(const std::vector<EffectSetting>& settings) {
  const std::string& name = settings.back().name;
  for (std::size_t i = 0; i + 1 < settings.size(); ++i) {
    if (settings[i].name == name) {
      throw Error(fmt::format("the calibration has the effect {} already", name));
    }
  }
}

std::string shape_of(const Effect& effect) {
  return effect.driver && effect.driver->shape() ? "." + effect.driver->shape()->name : "";
}

MatrixXd added_outputs(const WithInjected& with, const SizedEffect& injected, Injection& injection,
                       base::ThreadPool& pool) {
  const Tables& tables = with.model.tables();
  std::vector<std::string> added;
  for (const Variable& parameter : tables.parameters()) {
    if (!with.estimates.contains(parameter.name)) added.push_back(parameter.name);
  }
  std::vector<double> sizes = injected.sizes;
  if (sizes.size() == 1) sizes.assign(added.size(), sizes.front());
  if (sizes.size() != added.size()) {
    throw Error(fmt::format("inject {}: {} sizes for the {} parameters {}", injection.effect,
                            injected.sizes.size(), added.size(), fmt::join(added, ", ")));
  }
  injection.sizes = sizes;
  base::ParameterValues there = with.estimates;
  base::ParameterValues without = with.estimates;
  for (std::size_t i = 0; i < added.size(); ++i) {
    there[added[i]] = sizes[i];
    const bool is_shape = !with.shape.empty() && added[i].ends_with(with.shape);
    without[added[i]] = is_shape ? sizes[i] : 0.0;
  }
  const model::Measurements measurements(with.model, with.record);
  const model::Sweep sweep(with.model, measurements, pool);
  const auto residuals = [&](const base::ParameterValues& at) {
    return sweep.residuals(base::in_order(tables.linear, at), base::in_order(tables.nonlinear, at));
  };
  const MatrixXd difference = residuals(without) - residuals(there);
  MatrixXd whole =
      MatrixXd::Constant(static_cast<Index>(with.record.length()), difference.cols(), 0.0);
  Index at = 0;
  for (const Segment& segment : with.record.segments()) {
    const auto rows = static_cast<Index>(segment.rows());
    whole.middleRows(static_cast<Index>(segment.first), rows) = difference.middleRows(at, rows);
    at += rows;
  }
  return whole;
}

Record with_outputs(const Record& record, const std::vector<Variable>& outputs,
                    const MatrixXd& added) {
  Record changed;
  for (const std::string& name : record.names()) {
    const auto output = std::ranges::find(outputs, name, &Variable::name);
    if (output == outputs.end()) {
      changed.view(name, record.column(name));
      continue;
    }
    const auto column = record.column(name);
    std::vector<double> values(column.begin(), column.end());
    const VectorXd shift = added.col(output - outputs.begin());
    for (std::size_t row = 0; row < values.size(); ++row) {
      values[row] += shift[static_cast<Index>(row)];
    }
    changed.add(name, std::move(values));
  }
  changed.cut(record.segments());
  return changed;
}

void judge_injection(const Diagnosis& diagnosis, Injection& injection) {
  const std::vector<EffectFinding>& effects = diagnosis.effects;
  const auto own = std::ranges::find(effects, injection.effect, &EffectFinding::name);
  if (own == effects.end()) return;
  injection.estimate = own->coefficients;
  injection.p_adjusted = own->p_adjusted;
  if (own->status == FindingStatus::cannot_be_seen) return;
  const bool as_good = own->beside == Beside::equivalent;
  injection.rank = as_good ? 1 : static_cast<std::size_t>(own - effects.begin()) + 1;
  injection.found = as_good || own->status == FindingStatus::found;
}

}  // namespace sepcal::verbs
