// SPDX-License-Identifier: BSD-3-Clause
// The tables of a composition, and what of a record its delays leave.
#include <algorithm>
#include <cmath>

#include "effects/composed_model.hpp"
#include "effects/composed_tables.hpp"
#include "sepcal/composition.hpp"
#include "sepcal/detail/path_model.hpp"
#include "sepcal/error.hpp"

namespace sepcal {

using namespace effects;  // this room's own

namespace {

/// The longest shift that a parameter's bounds allow, its own or those given instead.
double longest_shift(const std::string& parameter, const Interval& own,
                     const std::map<std::string, Interval>& bounds) {
  const auto given = bounds.find(parameter);
  const Interval& interval = given == bounds.end() ? own : given->second;
  const double longest = std::max(std::abs(interval.lower), std::abs(interval.upper));
  if (std::isfinite(longest)) return longest;
  throw Error("the bounds of '" + parameter +
              "' must be finite: they say how many rows at the edges are not used");
}

/// Whether it has a part beside the model itself.
bool joins(const Effect& effect) {
  return !effect.varying.empty() || !effect.terms.empty() || !effect.corrections.empty() ||
         !effect.delays.empty();
}

}  // namespace

std::shared_ptr<const BlockModel> compose(std::shared_ptr<const BlockModel> model,
                                          const std::vector<Effect>& effects,
                                          const Record& record) {
  for (const Effect& effect : effects) {
    if (effect.remodel) model = effect.remodel(model);
  }
  if (std::ranges::all_of(effects, [](const Effect& effect) { return !joins(effect); })) {
    return model;
  }
  if (const auto* own = dynamic_cast<const PathModel*>(model.get())) {
    return own->compose_with(model, effects, record);
  }
  return std::make_shared<const ComposedModel>(std::move(model), effects, record);
}

std::map<std::string, double> initial_corrections(const std::vector<Effect>& effects) {
  std::map<std::string, double> zeros;
  for (const Effect& effect : effects) {
    std::string shape;
    if (effect.driver && effect.driver->shape()) {
      shape = effect.name + "." + effect.driver->shape()->name;
    }
    for (const auto& correction : effect.corrections) {
      for (const Variable& parameter : correction->nonlinear()) {
        if (parameter.name != shape) zeros[parameter.name] = 0.0;
      }
    }
    for (const Delay& delay : effect.delays) zeros[delay.parameter.name] = 0.0;
  }
  return zeros;
}

double reach(const std::vector<Effect>& effects, const std::map<std::string, Interval>& bounds) {
  double of_inputs = 0.0;   // delays add up
  double of_drivers = 0.0;  // drivers are delayed one by one, as they were logged
  for (const Effect& effect : effects) {
    for (const Delay& delay : effect.delays) {
      const Variable& tau = delay.parameter;
      const double longest = longest_shift(tau.name, {tau.lower, tau.upper}, bounds);
      if (delay.kind == Delay::Kind::inputs_lagging) continue;
      of_inputs += delay.kind == Delay::Kind::outputs_lagging ? longest * oldest_age : longest;
    }
    const auto note_driver = [&](double own) {
      if (own == 0.0) return;
      of_drivers = std::max(of_drivers, longest_shift(effect.name + ".tau", {-own, own}, bounds));
    };
    for (const auto& correction : effect.corrections) note_driver(correction->reach());
    for (const Varying& varying : effect.varying) note_driver(varying.driver->reach());
  }
  return std::max(of_inputs, of_drivers);
}

Record without_edges(Record record, double margin) {
  if (!(margin > 0)) return record;
  const std::span<const double> time = record.column("time");
  std::vector<Segment> kept;
  for (Segment segment : record.segments()) {
    const double first = time[segment.first] + margin;
    const double last = time[segment.last - 1] - margin;
    while (segment.first < segment.last && time[segment.first] < first) ++segment.first;
    while (segment.last > segment.first && time[segment.last - 1] > last) --segment.last;
    if (segment.first < segment.last) kept.push_back(segment);
  }
  if (kept.empty()) {
    throw Error("no segment is longer than twice " + std::to_string(margin) +
                " s, the reach of the effects in time; narrow the bounds of their tau");
  }
  record.cut(std::move(kept));
  return record;
}

}  // namespace sepcal
