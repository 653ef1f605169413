// SPDX-License-Identifier: BSD-3-Clause
// A driver at work on a port: the effect that it makes, and what the effects there come to.
#include <algorithm>
#include <cmath>
#include <span>

#include "base/parameter_values.hpp"
#include "effects/driven_rows.hpp"
#include "sepcal/detail/named_effects.hpp"
#include "sepcal/error.hpp"

namespace sepcal {

using namespace effects;  // this room's own

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// NaN in the rows whose delayed value lies beyond the segment's ends.
void forget_beyond(std::span<const double> time, const Segment& segment, double delay,
                   MatrixXd& phi) {
  for (std::size_t row = segment.first; row < segment.last; ++row) {
    const double then = time[row] - delay;
    if (then >= time[segment.first] && then <= time[segment.last - 1]) continue;
    phi.row(static_cast<Index>(row)).setConstant(not_a_number);
  }
}

/// The largest |phi| of a driver over the record, its shape in the middle of its bounds.
double largest(const Driver& driver, const Record& record) {
  const auto& shape = driver.shape();
  const double middle = shape ? 0.5 * (shape->lower + shape->upper) : 0.0;
  const MatrixXd phi = drive(driver, middle, record);
  double most = 0.0;
  for (const double value : phi.reshaped()) {
    if (std::isfinite(value)) most = std::max(most, std::abs(value));
  }
  return most > 0 ? most : 1.0;
}

const Variable& input_of(const BlockModel& model, const std::string& name) {
  const auto& inputs = model.tables().inputs;
  const auto at = std::ranges::find(inputs, name, &Variable::name);
  if (at == inputs.end()) throw Error("the model has no input '" + name + "'");
  return *at;
}

}  // namespace

MatrixXd effects::drive(const Driver& driver, double shape, const Record& record) {
  const auto rows = static_cast<Index>(record.length());
  MatrixXd phi = MatrixXd::Constant(rows, driver.functions(), not_a_number);
  for (const Segment& segment : record.segments()) {
    const double* d = nullptr;
    if (driver.input()) d = record.column(driver.input()->name).data() + segment.first;
    driver.evaluate(
        d, segment.first, shape,
        phi.middleRows(static_cast<Index>(segment.first), static_cast<Index>(segment.rows())),
        nullptr);
    if (driver.reach() > 0) forget_beyond(record.column("time"), segment, shape, phi);
  }
  return phi;
}

Effect make_driven(const std::string& owner, const Port& port, const DriverPointer& driver,
                   const std::string& unit, const BlockModel& model, const Record& record) {
  Effect effect{.name = owner, .port = port.name, .driver = driver};
  effect.most = port.plausible;
  Varying varying{driver, {}, unit};
  std::vector<DrivenInput> inputs;
  for (const Port::Component& component : port.components) {
    effect.components.push_back(component.name);
    if (component.input.empty()) {
      varying.components.push_back({component.name, component.linear, component.shares});
    } else {
      DrivenInput& driven = inputs.emplace_back(
          DrivenInput{component.name, input_of(model, component.input), component.sign});
      if (!component.times.empty()) driven.times = input_of(model, component.times);
    }
  }
  if (!varying.components.empty()) effect.varying.push_back(std::move(varying));
  if (!inputs.empty()) {
    const double bounds = port.plausible / largest(*driver, record);
    effect.corrections.push_back(driven_inputs(owner, driver, inputs, unit, bounds));
  }
  return effect;
}

Interval plausible_range(const Effect& effect, const Variable& parameter, const Record& record) {
  const auto said = effect.plausible.find(parameter.name);
  if (said != effect.plausible.end()) return said->second;
  const bool is_shape = effect.driver && effect.driver->shape() &&
                        parameter.name == effect.name + "." + effect.driver->shape()->name;
  if (!effect.driver || is_shape || !std::isfinite(effect.most)) {
    return {parameter.lower, parameter.upper};
  }
  const double bound = effect.most / largest(*effect.driver, record);
  return {-bound, bound};
}

VectorXd port_total(const std::vector<Effect>& effects, const std::string& port,
                    const std::string& component, const std::map<std::string, double>& values,
                    const Record& record) {
  VectorXd total;
  for (const Effect& effect : effects) {
    if (effect.port != port) continue;
    if (std::ranges::find(effect.components, component) == effect.components.end()) continue;
    const DriverPointer known = effect.driver ? effect.driver : constant_driver();
    const Driver& driver = *known;
    const double shape =
        driver.shape() ? base::value_of(values, effect.name + "." + driver.shape()->name) : 0.0;
    VectorXd s(driver.functions());
    for (Index j = 0; j < s.size(); ++j) {
      s[j] = base::value_of(
          values, effect.name + "." + component + driver.suffixes()[static_cast<std::size_t>(j)]);
    }
    const VectorXd share = drive(driver, shape, record) * s;
    total = total.size() == 0 ? share : VectorXd(total + share);
  }
  return total;
}

}  // namespace sepcal
